// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>

#include "allan_lio/ros/sensor_check_bag.h"
#include "allan_lio/ros/stop_signals.h"

namespace {

using namespace allan_lio;

constexpr int kFine = 0, kUnusable = 1, kBadUse = 2;

struct Arguments {
  std::vector<std::string> bags;
  std::string imu, lidar, out;
};

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file + ": cannot be written");
}

/// True if nothing is fatal.
bool print_findings(const std::vector<SensorFinding>& findings) {
  std::cout << "\nwhat will go wrong:\n";
  for (const SensorFinding& finding : findings)
    std::cout << (finding.fatal ? "  FATAL: " : "  ") << finding.sentence << '\n';
  if (findings.empty()) std::cout << "  nothing that this check knows\n";
  return std::none_of(findings.begin(), findings.end(), [](const SensorFinding& f) { return f.fatal; });
}

int run(const Arguments& a) {
  const StopSignals stop;
  const SensorCheck check = check_bags(a.bags, a.imu, a.lidar, [&stop](double) { return !stop.flag(); });
  std::cout << describe_sensors(check);
  const bool usable = print_findings(judge_sensors(check));
  const std::string config = suggest_config(check);
  if (usable && !config.empty()) std::cout << "\nsuggested configuration:\n\n" << config;
  if (usable && !a.out.empty()) write(a.out, config);
  std::cout << (usable ? "\nusable\n" : "\nunusable\n");
  std::cout.flush();
  return usable && std::cout ? kFine : kUnusable;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Looks at a recording's sensors before a filter runs on it: topics, rates, gaps, clocks, point times, "
      "standstill, and what will go wrong. Suggests a configuration. No ROS master is needed. Exit status: 0 usable, "
      "1 not, 2 bad call."};
  Arguments arguments;
  app.add_option("bags", arguments.bags, "bag files, merged by time; cut off ones are read as far as they go")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--imu", arguments.imu, "topic of the IMU; without it, the one with most messages");
  app.add_option("--lidar", arguments.lidar, "topic of the LiDAR; without it, the one with most messages");
  app.add_option("--out", arguments.out, "write the suggested configuration to this file");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kFine : kBadUse;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "check_bag: " << error.what() << '\n';
    return kUnusable;
  }
}
