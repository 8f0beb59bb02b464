// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ros/ros.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "allan_lio/ros/bag_player.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "play_bag");
  CLI::App app{
      "Plays bags for the LiDAR-inertial filter, no faster than it takes them, so that nothing is lost whatever the "
      "rate; at the end has it write its results. All topics of the bags and /clock are published."};
  std::vector<std::string> bags;
  allan_lio::BagPlayer::Options options;
  app.add_option("bags", bags, "bag files, merged by time")->required();
  app.add_option("--rate", options.rate,
                 "times real time, gaps of more than an hour left out; 0: as fast as the filter takes it")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--filter", options.filter, "name of the filter's node or nodelet")->capture_default_str();
  app.add_option("--patience", options.patience, "how long to wait for the filter [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--laps", options.laps,
                 "play them so often, the stamps carried on: for an endurance run on a recording that ends where it "
                 "began, at rest, and whose points' times count from the cloud's stamp")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    allan_lio::BagPlayer player(bags, options);
    player.play();
    if (!ros::ok()) {
      std::cerr << "play_bag: interrupted\n";
      return 1;
    }
    std::cout << "play_bag: " << player.scans_sent() << " scans and " << player.imu_sent()
              << " IMU samples played, all of them taken\n";
  } catch (const std::exception& error) {
    std::cerr << "play_bag: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
