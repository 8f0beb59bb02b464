// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "allan_lio/lidar/deskew.h"
#include "allan_lio/math/so3.h"
#include "child_process.h"
#include "shared_data.h"

namespace allan_lio {
namespace {

// The data's README: the reference is held at both ends of a sweep, so only these times compare. Rebuilt from the
// 1 ms bins of motion it differs by 0.3 to 1.0 mm in the median; the points move by 0.9 to 2.8 m in the mean.
constexpr double kFirst = 0.005, kLast = 0.088;  // [s]
constexpr double kMedianBound = 0.003;           // [m]
constexpr double kBetter = 100.0;                // times better than without deskew, in the median

std::vector<std::vector<double>> read_csv(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);  // header
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    rows.emplace_back();
    for (double value; fields >> value;) rows.back().push_back(value);
  }
  return rows;
}

RigidTransform pose_of(const std::vector<double>& row) {
  return {exp_so3({row[1], row[2], row[3]}), {row[4], row[5], row[6]}};
}

/// Constant rate and velocity from row to row. Without gravity, zero specific force is a constant velocity.
std::vector<TrackSegment> track_of(const std::vector<std::vector<double>>& motion) {
  std::vector<TrackSegment> track;
  for (std::size_t i = 0; i + 1 < motion.size(); ++i) {
    const RigidTransform from = pose_of(motion[i]), to = pose_of(motion[i + 1]);
    TrackSegment segment;
    segment.interval.dt = motion[i + 1][0] - motion[i][0];
    segment.interval.gyro = log_so3(from.rotation.conjugate() * to.rotation) / segment.interval.dt;
    segment.start.stamp = to_ns(motion[i][0]);
    segment.start.T_world_imu = from;
    segment.start.velocity_world = (to.translation - from.translation) / segment.interval.dt;
    segment.start.gravity_world.setZero();
    track.push_back(segment);
  }
  return track;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class RealDeskew : public ::testing::TestWithParam<std::string> {};

TEST_P(RealDeskew, FastOusterSweepsComeOutAsTheReferencesSoftwareMadeThem) {
  const std::string data = shared_data("deskew_newer_06");
  if (data.empty()) GTEST_SKIP() << "no folder deskew_newer_06 in $ALLAN_LIO_DATA";
  const Outcome unpacked = run_command("xz -dc " + data + "/scan_" + GetParam() + ".csv.xz");
  if (unpacked.status == 127) GTEST_SKIP() << "no xz: install xz-utils";
  ASSERT_EQ(unpacked.status, 0);
  const auto rows = read_csv(unpacked.text), motion = read_csv(contents_of(data + "/motion_" + GetParam() + ".csv"));
  ASSERT_GT(rows.size(), 20000U);

  Scan scan;
  for (const auto& row : rows)  // raw and reference axes differ by half a turn about z
    scan.points.push_back({static_cast<float>(-row[1]), static_cast<float>(-row[2]), static_cast<float>(row[3]), 0.0F,
                           static_cast<std::int32_t>(std::lround(1e9 * row[0]))});
  scan.first_offset_ns = scan.points.front().offset_ns;
  scan.last_offset_ns = scan.points.back().offset_ns;
  NavState reference;
  reference.stamp = scan.end();
  reference.T_world_imu = pose_of(motion.back());
  const Deskewer deskewer(scan, track_of(motion), reference, {}, {});

  std::vector<double> deskewed, raw;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i][0] < kFirst || rows[i][0] > kLast) continue;
    const Eigen::Vector3d expected(rows[i][4], rows[i][5], rows[i][6]);
    const ScanPoint& p = scan.points[i];
    deskewed.push_back((reference.T_world_imu * deskewer(p).cast<double>() - expected).norm());
    raw.push_back((pose_of(motion.front()) * Eigen::Vector3d(p.x, p.y, p.z) - expected).norm());
  }
  ASSERT_GT(deskewed.size(), 15000U);
  EXPECT_LT(median(deskewed), kMedianBound);
  EXPECT_LT(kBetter * median(deskewed), median(raw));
}

INSTANTIATE_TEST_SUITE_P(Newer06, RealDeskew, ::testing::Values("00", "01", "02"),
                         [](const auto& info) { return "scan_" + info.param; });

}  // namespace
}  // namespace allan_lio
