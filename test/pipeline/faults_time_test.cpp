// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Silence, and clocks that are wrong, injected into a bag.
#include <gtest/gtest.h>

#include "allan_lio/io/csv_table.h"
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

/// A column of sigmas in states.csv for each of the three axes, by those of the bag without faults: the scans are the
/// same.
std::vector<double> sigmas_by_those_without_faults(const FaultyRun& run, const std::string& name) {
  static const FaultyRun without({});
  const CsvTable table(run.file("states.csv")), reference(without.file("states.csv"));
  EXPECT_EQ(table.stamps(), reference.stamps());
  std::vector<double> ratios;
  for (const std::string& column : table.names_with("sigma_" + name + "_")) {
    const std::vector<double> a = table.numbers(column), b = reference.numbers(column);
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.push_back(a[i] == b[i] ? 1.0 : a[i] / b[i]);
  }
  EXPECT_EQ(ratios.size(), 3U * kScans);
  return ratios;
}

TEST(FaultyTime, AShortGapInTheImuIsBridgedWithoutAWord) {
  const FaultyRun run({"imu_gap_short"});
  for (const char* name : {"theta", "v"})
    for (const double ratio : sigmas_by_those_without_faults(run, name)) EXPECT_NEAR(ratio, 1.0, 0.05) << name;
  run.expect_in_order();
  EXPECT_EQ(run.imu("gaps"), 0);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyTime, ALongerGapInTheImuIsCountedAndTheScansCarryOn) {
  for (const char* gap : {"imu_gap_bridged", "imu_gap_long"}) {
    const FaultyRun run({gap});
    run.expect_in_order();
    // Some 0.3 m/s and 1.5 mrad where every scan sees the pose: the noise of what the gap may hide (0.5 rad/s, 2
    // m/s^2).
    const std::vector<double> theta = sigmas_by_those_without_faults(run, "theta");
    const std::vector<double> velocity = sigmas_by_those_without_faults(run, "v");
    EXPECT_GT(*std::max_element(theta.begin(), theta.end()), 1.3) << gap;
    EXPECT_GT(*std::max_element(velocity.begin(), velocity.end()), 50.0) << gap;
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
