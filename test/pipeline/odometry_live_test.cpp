// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// What a field engineer does to a filter that runs: other parameters, another
// pose, a new start.
#include <gtest/gtest.h>

#include <functional>

#include "allan_lio/io/live_parameters.h"
#include "allan_lio/lio/odometry.h"
#include "allan_lio/math/so3.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr std::size_t kIntervention = 60;  // scan after which it happens
constexpr double kSamePlace = 0.02;        // [m], [m/s], of a map begun anew against one that was not; 0.003 measured
constexpr double kSameHeading = 0.002;     // [rad]; 0.0003 measured
constexpr double kSameSigma = 0.01;        // relative; 0.0003 measured

const SimulatedDrive& drive() {
  static const SimulatedDrive simulated = simulate_drive("rooms", 10.0, 1);
  return simulated;
}

/// Runs the whole drive and calls `act` after so many results.
std::vector<LioResult> run(std::size_t after, const std::function<void(Odometry&)>& act) {
  Odometry odometry(simulated_robot());
  std::vector<LioResult> results;
  if (after == 0) act(odometry);
  std::size_t next_imu = 0;
  const auto drain = [&] {
    while (auto result = odometry.next()) {
      results.push_back(*result);
      if (results.size() == after) act(odometry);
    }
  };
  for (const Scan& scan : drive().scans) {
    odometry.add_scan(scan);
    for (; next_imu < drive().imu.size() && drive().imu[next_imu].stamp <= scan.end(); ++next_imu) {
      odometry.add_imu(drive().imu[next_imu]);
      drain();
    }
  }
  odometry.end_of_data();
  drain();
  return results;
}

const std::vector<LioResult>& undisturbed() {
  static const std::vector<LioResult> results = run(1000000, [](Odometry&) {});
  return results;
}

double sigma(const LioResult& result, int index) { return std::sqrt(result.covariance(index, index)); }

PoseAnchor elsewhere() {
  PoseAnchor anchor;
  anchor.T_world_imu = {exp_so3({0.1, -0.05, 2.0}), {100.0, -50.0, 7.0}};
  anchor.position_covariance.diagonal() << 0.04, 0.09, 0.01;
  anchor.heading_variance = 0.0025;
  return anchor;
}

double heading_of(const Eigen::Quaterniond& q) {
  const Eigen::Vector3d x = q * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

/// Turn about z and shift that take the world of before to that of `anchor`,
/// where `at` is the estimate of before.
RigidTransform move_of_the_world(const PoseAnchor& anchor, const LioResult& at) {
  const double turn = heading_of(anchor.T_world_imu.rotation) - heading_of(at.state.nav.T_world_imu.rotation);
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  return {rotation, anchor.T_world_imu.translation - rotation * at.state.nav.T_world_imu.translation};
}

TEST(OdometryLive, another_k_gb_is_in_force_with_the_next_scan_and_not_before) {
  const auto results = run(kIntervention, [](Odometry& odometry) {
    odometry.reconfigure(change_live(odometry.config(), "imu/k_gb", {{"25"}, false, "a test"}));
    EXPECT_EQ(odometry.config().imu.scale.k_gb, 25.0);
  });
  ASSERT_EQ(results.size(), undisturbed().size());
  EXPECT_EQ(results[kIntervention - 1].covariance, undisturbed()[kIntervention - 1].covariance);
  EXPECT_GT(sigma(results[kIntervention], kGyroBias), sigma(undisturbed()[kIntervention], kGyroBias));
  EXPECT_GT(sigma(results.back(), kGyroBias), 2.0 * sigma(undisturbed().back(), kGyroBias));
}

TEST(OdometryLive, another_k_r_changes_the_weight_of_the_next_scan) {
  const auto results = run(kIntervention, [](Odometry& odometry) {
    odometry.reconfigure(change_live(odometry.config(), "lidar/k_r", {{"5"}, false, "a test"}));
  });
  EXPECT_EQ(results[kIntervention - 1].covariance, undisturbed()[kIntervention - 1].covariance);
  EXPECT_GT(sigma(results[kIntervention], kVelocity), sigma(undisturbed()[kIntervention], kVelocity));
}

TEST(OdometryLive, a_pose_that_is_set_moves_the_world_and_the_filter_goes_on_in_it) {
  const auto results = run(kIntervention, [](Odometry& odometry) { odometry.set_pose(elsewhere()); });
  ASSERT_EQ(results.size(), undisturbed().size());
  const RigidTransform move = move_of_the_world(elsewhere(), undisturbed()[kIntervention - 1]);
  for (std::size_t i = kIntervention; i < results.size(); ++i) {
    const RigidTransform expected = move * undisturbed()[i].state.nav.T_world_imu;
    EXPECT_EQ(results[i].outcome, ScanOutcome::kUpdated) << i;
    EXPECT_LT((results[i].state.nav.T_world_imu.translation - expected.translation).norm(), kSamePlace) << i;
    EXPECT_LT(log_so3(results[i].state.nav.T_world_imu.rotation.conjugate() * expected.rotation).norm(), kSameHeading);
    const Eigen::Vector3d velocity = move.rotation * undisturbed()[i].state.nav.velocity_world;
    EXPECT_LT((results[i].state.nav.velocity_world - velocity).norm(), kSamePlace) << i;
  }
}

TEST(OdometryLive, the_covariance_of_a_pose_that_is_set_is_the_one_given_and_grows_from_there) {
  const auto results = run(kIntervention, [](Odometry& odometry) { odometry.set_pose(elsewhere()); });
  const LioResult& first = results[kIntervention];
  for (int k = 0; k < 3; ++k) {
    const double given = std::sqrt(elsewhere().position_covariance(k, k));
    EXPECT_NEAR(sigma(first, kPosition + k), given, kSameSigma * given);
    EXPECT_GE(sigma(results.back(), kPosition + k), (1.0 - kSameSigma) * given);
  }
  const Eigen::Matrix3d theta = first.covariance.block<3, 3>(kTheta, kTheta);
  const Eigen::Vector3d up = first.state.nav.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(up.dot(theta * up), elsewhere().heading_variance, kSameSigma * elsewhere().heading_variance);
  // What is known of velocity and biases is not lost.
  EXPECT_LT(sigma(first, kGyroBias), 1.5 * sigma(undisturbed()[kIntervention], kGyroBias));
}

TEST(OdometryLive, a_pose_that_is_set_before_the_first_scan_is_where_the_run_begins) {
  const auto results = run(0, [](Odometry& odometry) { odometry.set_pose(elsewhere()); });
  ASSERT_FALSE(results.empty());
  const RigidTransform& first = results.front().state.nav.T_world_imu;
  EXPECT_LT((first.translation - elsewhere().T_world_imu.translation).norm(), kSamePlace);
  EXPECT_NEAR(heading_of(first.rotation), heading_of(elsewhere().T_world_imu.rotation), kSameHeading);
}

}  // namespace
}  // namespace allan_lio
