// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/deskew.h"

#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

const RigidTransform kExtrinsics{exp_so3({0.02, -0.3, 0.5}), {0.1, -0.2, 0.3}};

/// A body that spins and is pushed: constant rate and specific force for each of the given intervals.
std::vector<TrackSegment> spinning_track(TimeNs start, double step, int count, NavState& end) {
  NavState state;
  state.stamp = start;
  state.velocity_world = {3.0, -1.0, 0.5};
  std::vector<TrackSegment> track;
  for (int i = 0; i < count; ++i) {
    const ImuInterval interval{step, {1.0, -2.0 + 0.1 * i, 4.0}, {2.0, 1.0 + 0.05 * i, 9.0}};
    track.push_back({state, interval});
    state = propagate_mean(state, interval, ImuNoise{});
  }
  end = state;
  return track;
}

TEST(Deskew, ASweepOfAPlaneUnderSpinAndTranslationIsFlatToAMillimetre) {
  constexpr double kFlat = 1e-3;  // [m]
  NavState end;
  const TimeNs start = 1'700'000'000'000'000'000;
  const auto track = spinning_track(start, 0.005, 20, end);
  Scan scan;
  scan.stamp = start;
  scan.last_offset_ns = 100'000'000;
  // The wall x = 20 m of the world, seen from the LiDAR at each point's own time.
  for (int i = 0; i <= 1000; ++i) {
    const std::int32_t offset = i * 100'000;
    const auto& segment = track[std::min<std::size_t>(track.size() - 1, static_cast<std::size_t>(offset / 5'000'000))];
    ImuInterval part = segment.interval;
    part.dt = seconds_between(segment.start.stamp, start + offset);
    const RigidTransform T_world_lidar = propagate_mean(segment.start, part, ImuNoise{}).T_world_imu * kExtrinsics;
    const Eigen::Vector3f p =
        (T_world_lidar.inverse() * Eigen::Vector3d(20.0, 10 * std::sin(0.1 * i), 5 * std::cos(0.07 * i))).cast<float>();
    scan.points.push_back({p.x(), p.y(), p.z(), 0.0F, offset});
  }
  const Deskewer deskew(scan, track, end, kExtrinsics, ImuNoise{});
  double skewed = 0.0;
  for (const ScanPoint& point : scan.points) {
    EXPECT_NEAR((end.T_world_imu * deskew(point).cast<double>()).x(), 20.0, kFlat);
    const Eigen::Vector3d raw = end.T_world_imu * (kExtrinsics * Eigen::Vector3d(point.x, point.y, point.z));
    skewed = std::max(skewed, std::abs(raw.x() - 20.0));
  }
  EXPECT_GT(skewed, 1.0) << "the motion must be fast enough for the test to mean something";
}

TEST(Deskew, AScanThatBeginsBeforeTheTrackIsExtrapolatedBackwards) {
  NavState end;
  const auto track = spinning_track(0, 0.005, 20, end);
  const std::vector<TrackSegment> late(track.begin() + 1, track.end());
  Scan scan;
  scan.last_offset_ns = 100'000'000;
  const ScanPoint point{1.0F, 2.0F, 3.0F, 0.0F, 4'000'000};
  const Eigen::Vector3f whole = Deskewer(scan, track, end, kExtrinsics, ImuNoise{})(point);
  const Eigen::Vector3f extrapolated = Deskewer(scan, late, end, kExtrinsics, ImuNoise{})(point);
  // One interval back with the next one's rate: 0.1 rad/s x 1 ms of difference at 4 m, and the push.
  constexpr double kExtrapolated = 1e-3;  // [m]
  EXPECT_LT((whole - extrapolated).norm(), kExtrapolated);
}

TEST(Deskew, WithoutMotionCompensationOnlyTheExtrinsicsApply) {
  const Deskewer deskew(kExtrinsics);
  const Eigen::Vector3d expected = kExtrinsics * Eigen::Vector3d(1, 2, 3);
  EXPECT_LT((deskew({1, 2, 3, 0, 55'000'000}).cast<double>() - expected).norm(), 1e-6);
}

}  // namespace
}  // namespace allan_lio
