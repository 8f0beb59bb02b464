// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/bag_writer.h"
#include "allan_lio/ros/config_dirs.h"
#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/scene.h"

namespace {

using allan_lio::TimeNs;

constexpr double kOdometryRate = 100.0;  // of /ground_truth/odometry [Hz]

struct Options {
  std::string scene, imu = "mti600", lidar = "velodyne16", out;
  std::int64_t seed = 1;
  std::optional<double> duration;     // [s]
  std::optional<double> max_range;    // [m]
  std::optional<double> range_noise;  // [m]
  double imu_rate = 200.0;            // [Hz]
  double start = 1700000000.0;        // [s]
  std::vector<double> extrinsics;
  allan_lio::ImuErrorConfig errors;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Written so that NaN is refused too.
void require_within(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream text;
  text << option << ": " << value << " is not between " << low << " and " << high;
  throw std::invalid_argument(text.str());
}

void check(const Options& options) {
  constexpr double kShortest = 1e-3, kFarthest = 1e4;  // [s], [m]
  require_within("--duration", options.duration.value_or(1.0), kShortest, 1e6);
  require_within("--max-range", options.max_range.value_or(1.0), 1.0, kFarthest);
  require_within("--range-noise", options.range_noise.value_or(0.0), 0.0, 10.0);
  require_within("--seed", static_cast<double>(options.seed), 0.0, 1e18);
  require_within("--imu-rate", options.imu_rate, 1.0, 1e5);
  require_within("--start", options.start, 0.0, 4e9);
  for (const double number : options.extrinsics) require_within("--extrinsics", number, -1e3, 1e3);
}

std::vector<double> numbers_of(const allan_lio::RigidTransform& T) {
  const Eigen::Vector3d& t = T.translation;
  const Eigen::Quaterniond& q = T.rotation;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

allan_lio::RigidTransform transform_of(const std::vector<double>& v) {
  allan_lio::RigidTransform T;
  T.rotation = Eigen::Quaterniond(v[6], v[3], v[4], v[5]);
  if (!(std::abs(T.rotation.norm() - 1.0) < 1e-3))
    throw std::invalid_argument("--extrinsics: the quaternion (the last four numbers) is not of length 1");
  T.rotation.normalize();
  T.translation << v[0], v[1], v[2];
  return T;
}

std::string default_extrinsics_text() {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  for (const double number : numbers_of(allan_lio::default_T_imu_lidar())) text << ' ' << number;
  return text.str();
}

/// `name`: an IMU of config/imu or a file.
allan_lio::NoiseSpec load_imu(const std::string& name) {
  std::vector<std::string> dirs;
  for (const std::string& dir : allan_lio::config_search_dirs()) dirs.insert(dirs.end(), {dir + "/imu", dir});
  return allan_lio::read_config(allan_lio::load_yaml(name, dirs)).imu.spec;
}

/// "F.bag" to "F.tum".
std::string truth_path(const std::string& bag) {
  const std::filesystem::path path(bag);
  if (path.extension() != ".bag" || path.stem().empty())
    throw std::invalid_argument("--out: '" + bag + "' does not end in .bag");
  return std::filesystem::path(path).replace_extension(".tum").string();
}

/// A bar on a terminal; elsewhere a line every tenth, so that a log stays readable.
class Progress {
 public:
  void show(int done, int total) {
    const int percent = total > 0 ? 100 * done / total : 100;
    if (percent == last_) return;
    last_ = percent;
    if (terminal_) {
      const std::string bar(static_cast<std::size_t>(percent / 2), '#');
      std::fprintf(stderr, "\rsimulating [%-50s] %3d %%%s", bar.c_str(), percent, percent == 100 ? "\n" : "");
    } else if (percent % 10 == 0) {
      std::fprintf(stderr, "simulating: %d %%\n", percent);
    }
    std::fflush(stderr);
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  int last_ = -1;
};

/// Hands the IMU samples and the truth to the bag up to a time, each once.
class Feeder {
 public:
  Feeder(const allan_lio::SimulatedImu& imu, const allan_lio::SimTrajectory& trajectory, TimeNs start, double duration)
      : imu_(imu), trajectory_(trajectory), start_(start), end_(start + allan_lio::to_ns(duration)) {}

  void write_until(TimeNs time, allan_lio::BagWriter& bag) {
    while (true) {
      const TimeNs imu = sample_ < imu_.samples.size() ? imu_.samples[sample_].stamp : time + 1;
      const TimeNs odometry = start_ + allan_lio::to_ns(odometry_ / kOdometryRate);
      if (imu <= std::min(time, odometry)) {
        bag.write_imu(imu_.samples[sample_++]);
      } else if (odometry <= std::min(time, end_)) {
        bag.write_odometry(odometry, trajectory_.at(allan_lio::seconds_between(start_, odometry)));
        ++odometry_;
      } else if (imu <= time) {
        bag.write_imu(imu_.samples[sample_++]);
      } else {
        return;
      }
    }
  }

 private:
  const allan_lio::SimulatedImu& imu_;
  const allan_lio::SimTrajectory& trajectory_;
  TimeNs start_, end_;
  std::size_t sample_ = 0;
  std::int64_t odometry_ = 0;
};

allan_lio::Trajectory truth_at(const allan_lio::SimulatedImu& imu, const allan_lio::SimTrajectory& trajectory,
                               TimeNs start) {
  allan_lio::Trajectory truth;
  for (const allan_lio::ImuSample& sample : imu.samples)
    truth.push_back({sample.stamp, trajectory.at(allan_lio::seconds_between(start, sample.stamp)).T_world_imu});
  return truth;
}

void simulate(const Options& options) {
  check(options);
  const std::string tum = truth_path(options.out);
  const allan_lio::Scene scene = allan_lio::make_scene(options.scene);
  allan_lio::LidarPattern pattern = allan_lio::make_lidar_pattern(options.lidar);
  pattern.max_range = options.max_range.value_or(scene.max_range);
  pattern.range_noise = options.range_noise.value_or(pattern.range_noise);
  const allan_lio::NoiseSpec spec = load_imu(options.imu);
  const TimeNs start = allan_lio::to_ns(options.start);
  const auto seed = static_cast<std::uint64_t>(options.seed);

  const allan_lio::SimTrajectory trajectory(scene.plan);
  const double duration = std::min(options.duration.value_or(trajectory.duration()), trajectory.duration());
  const allan_lio::SimulatedImu imu =
      allan_lio::simulate_imu(trajectory, duration, start, options.imu_rate, spec, options.errors, seed);
  const allan_lio::RayCaster caster(scene.mesh);
  const allan_lio::LidarSimulator lidar(pattern, transform_of(options.extrinsics), trajectory, caster, start, seed,
                                        options.threads);

  // Under another name until it is whole, so that a run that is cut short does not leave half a bag behind.
  const std::string unfinished = options.out + ".part";
  allan_lio::BagWriter bag(unfinished);
  allan_lio::write_tum(tum, truth_at(imu, trajectory, start));
  Feeder feeder(imu, trajectory, start, duration);
  Progress progress;
  const int sweeps = lidar.sweeps_within(duration);
  for (int i = 0; i < sweeps; ++i) {
    const allan_lio::SimSweep sweep = lidar.sweep(i);
    feeder.write_until(sweep.end, bag);
    bag.write_points(sweep);
    progress.show(i + 1, sweeps);
  }
  feeder.write_until(start + allan_lio::to_ns(duration), bag);
  bag.close();
  std::filesystem::rename(unfinished, options.out);
  std::printf("%s: %.1f s, %d sweeps, %zu IMU samples; truth in %s\n", options.out.c_str(), duration, sweeps,
              imu.samples.size(), tum.c_str());
}

void declare(CLI::App& app, Options& options) {
  app.add_option("--scene", options.scene, "one of " + join(allan_lio::scene_names()))->required();
  app.add_option("--imu", options.imu, "IMU whose noise is simulated: a name in config/imu or a file (default mti600)");
  app.add_option("--lidar", options.lidar,
                 "one of " + join(allan_lio::lidar_pattern_names()) + " (default velodyne16)");
  app.add_option("--seed", options.seed, "of all random numbers (default 1)");
  app.add_option("--out", options.out, "F.bag; the truth goes to F.tum beside it")->required();
  app.add_option("--duration", options.duration, "stop after this time [s] (default: the whole way)");
  app.add_option("--imu-rate", options.imu_rate, "[Hz] (default 200)");
  app.add_option("--max-range", options.max_range, "how far the LiDAR sees [m] (default: corridor 60, others 100)");
  app.add_option("--range-noise", options.range_noise, "1 sigma of a range [m] (default 0.02)");
  app.add_option("--extrinsics", options.extrinsics,
                 "T_imu_lidar as x y z [m] qx qy qz qw (default" + default_extrinsics_text() + ")")
      ->expected(7);
  app.add_option("--start", options.start, "stamp of the first sample [s since 1970] (default 1700000000)");
  app.add_flag("!--no-white-noise", options.errors.white, "leave out the IMU's white noise");
  app.add_flag("!--no-bias-walk", options.errors.bias_walk, "leave out the wandering of the IMU's biases");
  app.add_flag("!--no-turn-on-bias", options.errors.turn_on, "leave out the constant part of the IMU's biases");
  app.add_option("--threads", options.threads, "does not change the result (default: all cores)")
      ->check(CLI::Range(1, 1024));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates a spinning LiDAR and an IMU on a way through a scene and writes them to a bag: /points (Velodyne\n"
      "layout, every beam from the pose at its own time), /imu/data, /ground_truth/odometry (100 Hz).");
  Options options;
  options.extrinsics = numbers_of(allan_lio::default_T_imu_lidar());
  declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    simulate(options);
  } catch (const std::exception& error) {
    std::cerr << "simulate_bag: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
