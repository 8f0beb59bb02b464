// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/states_csv.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/bag_writer.h"
#include "allan_lio/ros/config_dirs.h"
#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/recorded_imu.h"
#include "allan_lio/sim/scenario.h"
#include "allan_lio/sim/sensor_report.h"
#include "allan_lio/sim/sensor_settings.h"

namespace {

using allan_lio::TimeNs;

constexpr double kDefaultStart = 1700000000.0;  // [s since 1970]
constexpr double kOdometryRate = 100.0;         // of /ground_truth/odometry [Hz]

struct Options {
  allan_lio::ScenarioOptions scenario;
  std::string imu = "mti600", lidar = "velodyne16", out;
  std::int64_t seed = 1;
  std::optional<double> duration;     // [s]
  std::optional<double> max_range;    // [m]
  std::optional<double> range_noise;  // [m]
  double imu_rate = 200.0;            // [Hz]
  std::optional<double> start;        // [s]
  std::vector<double> extrinsics;
  allan_lio::ImuErrorConfig errors;
  std::vector<std::string> imu_errors, lidar_effects;  // words of sensor_settings.h
  std::string imu_csv;
#ifdef __SANITIZE_THREAD__
  int threads = 1;  // TBB is not instrumented: all that it hands from thread to thread would be reported
#else
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
#endif
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
  require_within("--start", options.start.value_or(0.0), 0.0, 4e9);
  require_within("--standstill", options.scenario.standstill.value_or(0.0), 0.0, 1e5);
  require_within("--speed", options.scenario.speed, 0.01, 100.0);
  for (const double number : options.scenario.place) require_within("--place", number, -1e5, 1e5);
  if (!options.imu_csv.empty() && options.scenario.trajectory.empty())
    throw std::invalid_argument("--imu-csv: a recorded IMU needs the way that it went, its --trajectory");
  if (!options.imu_csv.empty() && !options.imu_errors.empty())
    throw std::invalid_argument("--imu-csv and --imu-errors: a recorded IMU has errors of its own");
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
  Feeder(const allan_lio::SimulatedImu& imu, const allan_lio::Motion& trajectory, TimeNs start, double duration)
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
  const allan_lio::Motion& trajectory_;
  TimeNs start_, end_;
  std::size_t sample_ = 0;
  std::int64_t odometry_ = 0;
};

allan_lio::Trajectory truth_at(const allan_lio::SimulatedImu& imu, const allan_lio::Motion& trajectory, TimeNs start) {
  allan_lio::Trajectory truth;
  for (const TimeNs stamp : imu.true_stamps)
    truth.push_back({stamp, trajectory.at(allan_lio::seconds_between(start, stamp)).T_world_imu});
  return truth;
}

/// Velocity and biases, for evaluate_trajectory's consistency. A real IMU's biases nobody knows: no file then, nor one
/// of an earlier run.
void write_truth_states(const std::string& path, const allan_lio::SimulatedImu& imu,
                        const allan_lio::Motion& trajectory, TimeNs start) {
  if (imu.gyro_bias.empty()) {
    std::filesystem::remove(path);
    return;
  }
  std::vector<allan_lio::TruthState> truth;
  for (std::size_t k = 0; k < imu.gyro_bias.size(); ++k) {
    const TimeNs stamp = imu.true_stamps[k];
    truth.push_back({stamp, trajectory.at(allan_lio::seconds_between(start, stamp)).velocity_world, imu.gyro_bias[k],
                     imu.accel_bias[k]});
  }
  allan_lio::write_truth_csv(path, truth);
}

/// The real IMU of --imu-csv, or the simulated one.
allan_lio::SimulatedImu make_imu(const Options& options, const allan_lio::Motion& trajectory, double duration,
                                 TimeNs start) {
  if (options.imu_csv.empty())
    return allan_lio::simulate_imu(trajectory, duration, start, options.imu_rate, load_imu(options.imu), options.errors,
                                   static_cast<std::uint64_t>(options.seed));
  return allan_lio::recorded_imu(allan_lio::read_recorded_imu(options.imu_csv), start,
                                 start + allan_lio::to_ns(duration));
}

/// Beside the bag: "F.tum" to "F_sensors.yaml".
void write_sensor_report(const std::string& tum, const allan_lio::LidarPattern& pattern, const Options& options) {
  const std::string path = tum.substr(0, tum.size() - 4) + "_sensors.yaml";
  std::ofstream out(path);
  out << allan_lio::sensor_report(pattern, options.imu_csv, options.errors, options.imu_rate,
                                  static_cast<std::uint64_t>(options.seed));
  if (!out.flush()) throw std::runtime_error(path + ": cannot be written");
}

allan_lio::Scenario load_scenario(const Options& options) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  allan_lio::ScenarioOptions wanted = options.scenario;
  wanted.seed = static_cast<std::uint64_t>(options.seed);
  if (wanted.place.size() == 4) wanted.place[3] *= kDegree;
  // A real IMU's log knows nothing of a rest that is put before the record.
  if (!options.imu_csv.empty() && !wanted.trajectory.empty() && !wanted.standstill) wanted.standstill = 0.0;
  return allan_lio::make_scenario(wanted);
}

void simulate(const Options& asked) {
  Options options = asked;
  options.errors.defects = allan_lio::parse_imu_errors(options.imu_errors);

  check(options);
  const std::string tum = truth_path(options.out);
  const allan_lio::Scenario scenario = load_scenario(options);
  const allan_lio::Motion& trajectory = *scenario.motion;
  allan_lio::LidarPattern pattern = allan_lio::make_lidar_pattern(options.lidar);
  pattern.max_range = options.max_range.value_or(scenario.scene.max_range);
  pattern.range_noise = options.range_noise.value_or(pattern.range_noise);
  pattern.effects = allan_lio::parse_lidar_effects(options.lidar_effects);
  const TimeNs start =
      options.start ? allan_lio::to_ns(*options.start) : scenario.start.value_or(allan_lio::to_ns(kDefaultStart));
  const auto seed = static_cast<std::uint64_t>(options.seed);

  const double duration = std::min(options.duration.value_or(trajectory.duration()), trajectory.duration());
  const allan_lio::SimulatedImu imu = make_imu(options, trajectory, duration, start);
  const allan_lio::LidarSimulator lidar(pattern, transform_of(options.extrinsics), trajectory, *scenario.caster, start,
                                        seed, options.threads);

  // Under another name until it is whole, so that a run that is cut short does not leave half a bag behind.
  const std::string unfinished = options.out + ".part";
  allan_lio::BagWriter bag(unfinished);
  allan_lio::write_tum(tum, truth_at(imu, trajectory, start));
  write_truth_states(tum.substr(0, tum.size() - 4) + "_truth.csv", imu, trajectory, start);
  write_sensor_report(tum, pattern, options);
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
  if (!scenario.remark.empty()) std::printf("%s\n", scenario.remark.c_str());
  std::printf(
      "LiDAR effects: %s\nIMU errors besides noise and bias: %s\n", allan_lio::settings_text(pattern.effects).c_str(),
      options.imu_csv.empty() ? allan_lio::settings_text(options.errors.defects).c_str() : "those of the record");
}

void declare_scenario(CLI::App& app, allan_lio::ScenarioOptions& options) {
  app.add_option("--scene", options.scene,
                 "one of " + join(allan_lio::scene_names()) + ", or mesh:FILE (STL, OBJ, PLY; metres, z up)")
      ->required();
  app.add_option(
      "--path", options.path,
      "a way of one's own: CSV of x,y,z[,speed] in the scene's drawing, which for a mesh is its file's frame");
  app.add_option("--speed", options.speed, "where --path tells none [m/s] (default 1)");
  app.add_option("--profile", options.profile,
                 "sway, lean and vibration on the way: scene, " + join(allan_lio::motion_profile_names()) +
                     " (default scene: the scene's own); way and speeds stay");
  app.add_option("--trajectory", options.trajectory,
                 "a recorded motion of the IMU (TUM, z up), fitted by a spline; its stamps are kept");
  app.add_option("--place", options.place,
                 "x,y,z,yaw [m, deg] of the record's begin in the drawing (default: its middle on the scene's axis)")
      ->delimiter(',')
      ->expected(4);
  app.add_option("--standstill", options.standstill,
                 "rest at the beginning [s] (default: the scene's; 3 before a record, 0 with --imu-csv)");
}

void declare(CLI::App& app, Options& options) {
  declare_scenario(app, options.scenario);
  app.add_option("--imu", options.imu, "IMU whose noise is simulated: a name in config/imu or a file (default mti600)");
  app.add_option("--lidar", options.lidar,
                 "one of " + join(allan_lio::lidar_pattern_names()) + " (default velodyne16)");
  app.add_option("--seed", options.seed, "of all random numbers (default 1)");
  app.add_option("--out", options.out,
                 "F.bag; the truth goes beside it: F.tum, and F_truth.csv with velocity and biases")
      ->required();
  app.add_option("--duration", options.duration, "stop after this time [s] (default: the whole way)");
  app.add_option("--imu-rate", options.imu_rate, "[Hz] (default 200)");
  app.add_option("--max-range", options.max_range,
                 "how far the LiDAR sees [m] (default: the scene's: corridor and bridge 60, hall 30, corridor_turn 20, "
                 "others 100)");
  app.add_option("--range-noise", options.range_noise, "1 sigma of a range [m] (default 0.02)");
  app.add_option("--extrinsics", options.extrinsics,
                 "T_imu_lidar as x y z [m] qx qy qz qw (default" + default_extrinsics_text() + ")")
      ->expected(7);
  app.add_option("--start", options.start,
                 "stamp of the first sample [s since 1970] (default 1700000000, or the record's own)");
  app.add_flag("!--no-white-noise", options.errors.white, "leave out the IMU's white noise");
  app.add_flag("!--no-bias-walk", options.errors.bias_walk, "leave out the wandering of the IMU's biases");
  app.add_flag("!--no-turn-on-bias", options.errors.turn_on, "leave out the constant part of the IMU's biases");
  app.add_option("--imu-errors", options.imu_errors,
                 "comma-separated errors besides these: real (an MTi-600 on a machine that vibrates), " +
                     allan_lio::imu_error_keys() + "; later words win: real,accel_vibration=0 (default none)")
      ->delimiter(',');
  app.add_option("--lidar-effects", options.lidar_effects,
                 "comma-separated: real, " + allan_lio::lidar_effect_keys() + " (default none)")
      ->delimiter(',');
  app.add_option("--imu-csv", options.imu_csv,
                 "a real IMU's log (EuRoC's layout or any with a header) in place of the simulated IMU");
  app.add_option("--threads", options.threads, "does not change the result (default: all cores)")
      ->check(CLI::Range(1, 1024));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates a spinning LiDAR and an IMU on a way through a scene and writes them to a bag: /points (Velodyne\n"
      "layout, every beam from the pose at its own time), /imu/data, /ground_truth/odometry (100 Hz).\n"
      "Exit status: 0, or 2 after one line that says what is wrong.");
  Options options;
  options.extrinsics = numbers_of(allan_lio::default_T_imu_lidar());
  declare(app, options);
  constexpr int kBadInput = 2;
  try {
    app.parse(argc, argv);
    simulate(options);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "simulate_bag: " << error.what() << '\n';
  } catch (const std::exception& error) {
    std::cerr << "simulate_bag: " << error.what() << '\n';
  }
  return kBadInput;
}
