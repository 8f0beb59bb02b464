// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/whole_file.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/lio_bag.h"
#include "allan_lio/ros/lio_session.h"
#include "allan_lio/ros/save_map.h"
#include "allan_lio/ros/stop_signals.h"

namespace {

using namespace allan_lio;

constexpr int kBadUse = 2, kFailed = 1, kInterrupted = 130;

struct Arguments {
  std::vector<std::string> bags, overrides;
  std::string config, out;
  int threads = 0;
  bool map = false;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("--bag", a.bags, "bag file; give it again for more, they are merged by time")->required();
  app.add_option("--config", a.config, "name in config/ or config/robots/, or a YAML file")->required();
  app.add_option("--param", a.overrides, "key=value over the configuration, e.g. imu/k_gb=2; may be given again")
      ->take_all();
  app.add_option("--threads", a.threads, "threads of the registration; the result does not depend on it")
      ->check(CLI::Range(1, 64));
  app.add_option("--out", a.out, "directory for trajectory.tum, states.csv and summary.yaml")->required();
  app.add_flag("--map", a.map, "write the map to map.pcd as well");
}

LioConfig read(const Arguments& a) {
  ConfigSource source = load_yaml(a.config, config_search_dirs());
  for (const std::string& text : a.overrides) source = merge(source, parse_override(text));
  if (a.threads > 0) source = merge(source, parse_override("threads=" + std::to_string(a.threads)));
  return read_config(source);
}

/// A bar on a terminal, nothing elsewhere.
class ProgressBar {
 public:
  ProgressBar(ros::Time begin, ros::Time end) : begin_(begin), length_(seconds_between(begin, end)) {}
  ~ProgressBar() { clear(); }
  void show(ros::Time now) {
    const int percent = length_ > 0 ? static_cast<int>(100 * seconds_between(begin_, now) / length_) : 100;
    if (!terminal_ || percent == percent_ || percent < 0 || percent > 100) return;
    percent_ = percent;
    const std::string done(static_cast<std::size_t>(percent / 2), '#');
    std::fprintf(stderr, "\r[%-50s] %3d %%", done.c_str(), percent);
  }
  void clear() {
    if (percent_ >= 0) std::fprintf(stderr, "\r%60s\r", "");
    percent_ = -1;
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  ros::Time begin_;
  double length_;  ///< [s]
  int percent_ = -1;
};

void feed(const BagMessage& message, const LioConfig& config, LioSession& session) {
  try {
    take_lio_message(
        message, config.topics, [&session](const sensor_msgs::Imu& imu) { session.add(imu); },
        [&session](const RawCloud& cloud) { session.add(cloud); });
  } catch (const ros::serialization::StreamOverrunException&) {
    session.count_undecodable("its bytes end too early");
  }
}

void print_summary(const LioSession& session, const Arguments& a) {
  const LioCounters& c = session.odometry().counters();
  if (!session.verdict().empty()) std::cout << session.verdict() << '\n';
  for (const std::string& remark : session.remarks()) std::cout << remark << '\n';
  std::cout << c.scans_used << " of " << c.scans_read + session.undecodable() << " scans used, " << c.imu_read
            << " IMU samples";
  if (c.scans_used > 0)
    std::printf(", %.2f ms of CPU per scan", 1e3 * session.cpu_seconds() / static_cast<double>(c.scans_used));
  std::cout << "\nresults: " << a.out << "/trajectory.tum, states.csv, summary.yaml\n";
}

int run(const Arguments& a) {
  const StopSignals stop;
  const LioConfig config = read(a);
  BagSource bags = open_lio_bags(a.bags, config.topics);
  LioSession session(config, a.out, {});
  session.set_inputs(a.bags);
  if (a.map) check_writable(a.out + "/map.pcd");

  ProgressBar bar(bags.begin(), bags.end());
  BagMessage message;
  bool stopped = false, told_noise = false;
  while (!stopped && session.hopeless().empty() && bags.next(message)) {
    feed(message, config, session);
    if (!told_noise && !session.noise_report().empty()) {
      for (const std::string& line : session.noise_report()) std::cout << line << '\n';
      std::cout.flush();
      told_noise = true;
    }
    bar.show(message.time);
    stopped = stop.flag();
  }
  if (!stopped) session.end_of_data();
  bar.clear();

  std::string trouble = session.why_nothing();
  for (const std::string& text : bags.troubles()) {
    session.add_note(text);
    if (trouble.empty()) trouble = text;
  }
  session.finish(stopped ? "interrupted" : trouble.empty() ? "complete" : "incomplete: " + trouble);
  print_summary(session, a);
  if (stopped) std::cerr << "lio_offline: interrupted; what was computed is written\n";
  if (!trouble.empty()) std::cerr << "lio_offline: " << trouble << '\n';
  if (a.map) save_map(a.out + "/map.pcd", session.odometry().map_points());
  return stopped ? kInterrupted : trouble.empty() ? 0 : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"LiDAR-inertial odometry on bags, without a ROS master."};
  Arguments arguments;
  declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(arguments);
  } catch (const ConfigError& error) {
    std::cerr << "lio_offline: " << error.what() << '\n';
    return kBadUse;
  } catch (const std::exception& error) {
    std::cerr << "lio_offline: " << error.what() << '\n';
    return kFailed;
  }
}
