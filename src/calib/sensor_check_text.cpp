// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "allan_lio/calib/sensor_check.h"
#include "allan_lio/io/yaml_quoted.h"
#include "sensor_check_words.h"

namespace allan_lio {
namespace {

constexpr double kEnoughForNoise = 2.0;      // [s] of standstill
constexpr double kDegree = 57.295779513082;  // [1/rad]

std::string three(const Eigen::Vector3d& v) { return number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()); }

void put_stream(std::ostream& out, const SensorCheck::Stream& s, const char* sensor) {
  out << sensor << ": " << s.topic << ", " << s.datatype << ", frame " << list(s.frames) << "\n  " << s.stamps.count
      << " messages, " << hertz(s.stamps.rate()) << ", jitter " << milliseconds(s.stamps.jitter);
  if (s.stamps.gaps == 0)
    out << ", no gaps";
  else
    out << ", " << s.stamps.gaps << " gaps, the longest " << seconds(s.stamps.longest_gap) << " after "
        << seconds(seconds_between(s.stamps.first, s.stamps.gap_at)) << ", about " << std::lround(s.stamps.lost)
        << " messages missing";
  out << "\n  stamps " << range(s.stamps) << ", arrival " << milliseconds(s.delay) << " later\n";
}

void put_imu(std::ostream& out, const ImuReport& r) {
  const bool still = r.standstill >= ImuReport::kEnoughStandstill;
  out << "  accelerometer: reads in " << (r.in_g ? "g" : "m/s^2") << ", " << number(r.gravity) << " m/s^2 "
      << (still ? "at rest" : "on average, for want of a standstill") << '\n'
      << "  standstill at the start: " << seconds(r.standstill) << '\n';
  if (still)
    out << "  gyro bias: " << three(kDegree * r.gyro_bias) << " deg/s; scatter at rest: N_g "
        << number(kDegree * r.gyro_noise) << " deg/s/sqrt(Hz), N_a " << number(r.accel_noise) << " m/s^2/sqrt(Hz)\n";
  out << "  largest readings: " << number(r.largest_rate) << " rad/s, " << number(r.largest_accel) << " m/s^2, "
      << (r.gyro_clipping.samples + r.accel_clipping.samples > 0 ? "saturated" : "no saturation seen") << '\n';
}

void put_lidar(std::ostream& out, const SensorCheck::Lidar& lidar) {
  out << "  " << (lidar.verdict.empty() ? "point time: unknown" : lidar.verdict) << '\n'
      << "  " << number(lidar.points) << " valid points a scan, sweep " << seconds(lidar.sweep)
      << ", settings of config/" << lidar.model << '\n';
}

const char* word(PointTime time) {
  const std::array<const char*, 6> words{
      "auto", "start", "end", "absolute", "azimuth_clockwise", "azimuth_counterclockwise"};
  return words[static_cast<std::size_t>(time)];
}

void put_imu_config(std::ostream& out, const ImuReport& r) {
  out << "\nimu:\n  accel_unit: " << (r.in_g ? "g" : "m/s^2") << "\n";
  if (r.gyro_clipping.samples > 0)
    out << "  gyro_range: " << number(r.gyro_clipping.at) << "  # [rad/s] saturates there\n";
  if (r.accel_clipping.samples > 0)
    out << "  accel_range: " << number(r.accel_clipping.at) << "  # [m/s^2] saturates there\n";
  if (r.standstill < kEnoughForNoise || r.gyro_noise <= 0.0 || r.accel_noise <= 0.0) return;
  out << "  noise:  # as the standstill's " << seconds(r.standstill) << " scatter; an Allan deviation knows better\n"
      << "    gyro_white_noise: {value: " << number(r.gyro_noise) << ", unit: rad/s/sqrt(Hz)}\n"
      << "    accel_white_noise: {value: " << number(r.accel_noise) << ", unit: m/s^2/sqrt(Hz)}\n";
}

}  // namespace

std::string number(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(4);
  out << value;
  return out.str();
}

std::string range(const StampReport& stamps) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.setf(std::ios::fixed);
  out.precision(3);
  out << 1e-9 * static_cast<double>(stamps.first) << " to " << 1e-9 * static_cast<double>(stamps.last) << " s";
  return out.str();
}

std::string describe_sensors(const SensorCheck& check) {
  std::ostringstream out;
  out << "topics:\n";
  for (const SensorCheck::Topic& topic : check.topics) out << "  " << topic.name << ": " << topic.datatype << '\n';
  if (check.imu) {
    put_stream(out, *check.imu, "imu");
    put_imu(out, check.imu->readings);
  }
  if (check.lidar) {
    put_stream(out, *check.lidar, "lidar");
    put_lidar(out, *check.lidar);
  }
  if (check.imu && check.lidar)
    out << "clocks: scans arrive " << milliseconds(check.lidar->delay - check.imu->delay)
        << " later after their end than IMU samples after their stamp (from stamps and arrival; motion is not "
           "compared)\n";
  if (!check.other_topics.empty())
    out << "not looked at, name them with --imu or --lidar: " << list(check.other_topics) << '\n';
  return out.str();
}

std::string suggest_config(const SensorCheck& check) {
  if (!check.imu || !check.lidar) return "";
  std::ostringstream out;
  out << "# Suggested by check_bag. Put in your IMU's own file (config/imu) or Allan figures, and T_imu_lidar.\n"
      << "include: [imu/icm20948, " << check.lidar->model << "]  # the IMU's is a cautious guess\n"
      << "\ntopics:\n  imu: " << yaml_quoted(check.imu->topic) << "\n  lidar: " << yaml_quoted(check.lidar->topic)
      << '\n';
  put_imu_config(out, check.imu->readings);
  if (!check.lidar->deskew) out << "\nlidar:\n  deskew: false  # the points' times cannot be used\n";
  if (!check.lidar->deskew && check.lidar->turn != PointTime::kAuto)
    out << "  # point_time: " << word(check.lidar->turn)
        << "  # instead, unless the scans are compensated already: the points come in that order\n";
  if (check.lidar->deskew && check.lidar->point_time != PointTime::kAuto)
    out << "\nlidar:\n  point_time: " << word(check.lidar->point_time) << "  # a guess: the points' clock is another\n";
  out << "\nextrinsics:\n  T_imu_lidar:  # p_imu = T_imu_lidar * p_lidar; not known to check_bag\n"
      << "    translation: [0, 0, 0]  # [m]\n    rotation: [0, 0, 0, 1]  # quaternion x, y, z, w\n";
  return out.str();
}

}  // namespace allan_lio
