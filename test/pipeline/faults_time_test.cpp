// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Silence, and clocks that are wrong, injected into a bag.
#include <gtest/gtest.h>

#include "faulty_run.h"

namespace allan_lio {
namespace {

constexpr int kScans = SimulatedBag::kScans;
constexpr double kAteBound = 0.015;     // [m]
constexpr double kBridgedBound = 0.03;  // [m], with half a second or more without IMU; 0.005 and 0.012 measured

/// From the row `first` on.
Trajectory tail(const Trajectory& whole, std::size_t first) {
  return {whole.begin() + static_cast<std::ptrdiff_t>(first), whole.end()};
}

TEST(FaultyTime, AShortGapInTheImuIsBridgedWithoutAWord) {
  const FaultyRun run({"imu_gap_short"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("gaps"), 0);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyTime, ALongerGapInTheImuIsCountedAndTheScansCarryOn) {
  for (const char* gap : {"imu_gap_bridged", "imu_gap_long"}) {
    const FaultyRun run({gap});
    run.expect_in_order();
    EXPECT_EQ(run.imu("gaps"), 1) << gap;
    EXPECT_EQ(run.imu("starts_in_place"), 0) << gap;
    EXPECT_EQ(run.scans("used"), kScans) << gap;
    EXPECT_LT(ate_of(run.trajectory()), kBridgedBound) << gap;
  }
}

TEST(FaultyTime, AGapInTheScansIsCrossedByTheImu) {
  const FaultyRun run({"lidar_gap"});
  run.expect_in_order();
  EXPECT_EQ(run.scans("used"), kScans - 20);
  EXPECT_EQ(run.scans("map_restarts"), 0);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyTime, ALongSilenceOfBothStartsAgainInPlaceAndSaysSo) {
  const FaultyRun run({"imu_gap_long", "lidar_gap_long"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("starts_in_place"), 1);
  EXPECT_EQ(run.scans("map_restarts"), 1);
  EXPECT_NE(run.notes().find("started again where it stood"), std::string::npos) << run.notes();
  const Trajectory trajectory = run.trajectory();
  const auto after = std::find_if(trajectory.begin(), trajectory.end(), [&](const StampedPose& pose) {
    return seconds_between(trajectory.front().stamp, pose.stamp) > 9.0;
  });
  ASSERT_NE(after, trajectory.end());
  const std::size_t first = static_cast<std::size_t>(after - trajectory.begin());
  EXPECT_LT((after->pose.translation - (after - 1)->pose.translation).norm(), 0.5) << "the pose is kept";
  EXPECT_LT(ate_of(tail(trajectory, first)), kBridgedBound) << "and from there it goes on as well as before";
}

TEST(FaultyTime, AClockThatIsSetForwardStartsAgainInPlace) {
  const FaultyRun run({"clock_set_forward"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("starts_in_place"), 1);
  EXPECT_GE(run.scans("used"), kScans - 2);
  EXPECT_NE(run.notes().find("started again where it stood"), std::string::npos) << run.notes();
}

TEST(FaultyTime, ABagThatIsPlayedInALoopStartsAgainOnceAndIsAsGoodTheSecondTime) {
  const FaultyRun run({"looped"});
  run.expect_in_order();
  EXPECT_NE(run.notes().find("went back by 19.955 s: the estimator has started again, with a new map (1 times"),
            std::string::npos)
      << run.notes();
  EXPECT_GE(run.scans("used"), 2 * kScans - 2);
  // Not read_tum(): it refuses stamps that go back.
  std::istringstream in(contents_of(run.file("trajectory.tum")));
  std::string rounds[2];
  std::string before;
  int round = 0;
  for (std::string line; std::getline(in, line); before = line) {
    if (!before.empty() && std::stod(line) < std::stod(before)) ++round;
    ASSERT_LT(round, 2);
    rounds[round] += line + "\n";
  }
  for (const std::string& text : rounds) {
    std::istringstream rows(text);
    EXPECT_LT(ate_of(read_tum(rows, "round")), kAteBound);
  }
}

TEST(FaultyTime, ClocksThatLieApartAreRefusedSoonWithBothRanges) {
  const FaultyRun run({"lidar_clock_off"});
  EXPECT_EQ(run.outcome().status, 1);
  for (const char* words : {"the IMU's stamps run from 1700000000.0", "the LiDAR's from 100000000.0"})
    EXPECT_NE(run.outcome().text.find(words), std::string::npos) << run.outcome().text;
  EXPECT_EQ(run.status().rfind("incomplete: LiDAR and IMU go by different clocks", 0), 0U) << run.status();
  EXPECT_LT(run.scans("read"), 40) << "a few seconds are enough to tell";
}

}  // namespace
}  // namespace allan_lio
