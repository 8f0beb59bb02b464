// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A sensor that stands in a synthetic room, and falls silent for a while: IMU, LiDAR or both.
#include <gtest/gtest.h>

#include "room_stand.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

bool in_gap(TimeNs t) { return t >= kStart + 2'000'000'000 && t <= kStart + 4'000'000'000; }

double position_sigma(const LioResult& r) { return std::sqrt(r.covariance(kPosition, kPosition)); }

TEST(OdometryFaults, AGapInTheImuIsSeenAndTheScansInItCarryTheMotion) {
  const Drive run = stand(default_config(mti600_spec()), 60, room, [](ImuSample& s) { return !in_gap(s.stamp); });
  EXPECT_EQ(run.counters.imu_gaps, 1u);
  EXPECT_EQ(run.counters.scans_used, 60u);
  EXPECT_EQ(run.counters.starts_in_place, 0u);
  EXPECT_LT(strayed(run.results.back()), 0.05);
  EXPECT_LT(position_sigma(run.results.back()), 0.1);
}

/// The sigmas after the scan that begins at kStart + `i` kScanStep.
LioVector sigma_after(const Drive& run, int i) {
  for (const LioResult& r : run.results)
    if (r.scan_begin == kStart + i * kScanStep) return r.covariance.diagonal().cwiseSqrt();
  ADD_FAILURE() << "no result of scan " << i;
  return LioVector::Constant(-1.0);
}

constexpr int kGapScan = 20;  // the first scan that a gap meets

/// Standing, IMU readings missing for `seconds` from shortly after the begin of scan kGapScan on. The scans up to the
/// gap's end are empty, so that the covariance at their end is the one that propagation gives.
Drive stand_through_imu_gap(const LioConfig& config, double seconds) {
  const TimeNs from = kStart + kGapScan * kScanStep + kImuStep, to = from + to_ns(seconds);
  return stand(
      config, 40, [&](int i) { return i >= kGapScan && i < kGapScan + 6 ? std::vector<Eigen::Vector3d>{} : room(i); },
      [=](ImuSample& s) { return s.stamp <= from || s.stamp >= to; });
}

TEST(OdometryFaults, AShortGapInTheImuIsBridgedWithTheNoiseOfItsTrueLength) {
  LioConfig config = default_config(mti600_spec());
  config.imu.scale.k_g = config.imu.scale.k_a = 30.0;  // so that one scan's noise stands out of what was there before
  const Drive whole = stand_through_imu_gap(config, 0.0), gap = stand_through_imu_gap(config, 0.08);
  EXPECT_EQ(gap.counters.imu_gaps, 0u);
  const LioVector before = sigma_after(whole, kGapScan - 1);
  const LioVector of_whole = sigma_after(whole, kGapScan), of_gap = sigma_after(gap, kGapScan);
  for (const int block : {int{kTheta}, int{kVelocity}}) {
    for (int i = block; i < block + 3; ++i) {
      EXPECT_GT(of_whole[i], 1.15 * before[i]) << "the noise of one scan is to be seen at " << i;
      EXPECT_NEAR(of_gap[i], of_whole[i], 0.01 * of_whole[i]) << i;
    }
  }
}

TEST(OdometryFaults, ALongerGapInTheImuIsBridgedWithTheNoiseOfWhatItMayHide) {
  const LioConfig config = default_config(mti600_spec());
  constexpr double kGap = 0.59;  // [s]
  const Drive whole = stand_through_imu_gap(config, 0.0), gap = stand_through_imu_gap(config, kGap);
  EXPECT_EQ(gap.counters.starts_in_place, 0u);
  EXPECT_EQ(gap.counters.imu_gaps, 1u);
  const LioVector of_whole = sigma_after(whole, kGapScan + 5), of_gap = sigma_after(gap, kGapScan + 5);
  // 0.5 rad/s and 2 m/s^2 in one direction for half a second at a time.
  const double together = std::sqrt(0.5 * kGap);
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(of_gap[kTheta + i], 0.9 * 0.5 * together) << i;
    EXPECT_GT(of_gap[kVelocity + i], 0.9 * 2.0 * together) << i;
    EXPECT_LT(of_whole[kTheta + i], 0.05 * of_gap[kTheta + i]) << i;
    EXPECT_LT(of_whole[kVelocity + i], 0.05 * of_gap[kVelocity + i]) << i;
  }
  const LioVector settled = sigma_after(gap, 39);
  for (int i = 0; i < 3; ++i) EXPECT_LT(settled[kPosition + i], 0.1) << "and the scans after it end that";
}

TEST(OdometryFaults, AGapInTheScansGrowsTheCovarianceUntilAScanEndsIt) {
  LioVector before = LioVector::Zero();
  for (const int lost : {0, 10, 20, 30}) {
    SCOPED_TRACE(std::to_string(lost) + " scans lost");
    const int ends = kGapScan + lost;  // an empty scan, whose covariance is the one that propagation gives
    const Drive run =
        stand(default_config(mti600_spec()), 60, [&](int i) -> std::optional<std::vector<Eigen::Vector3d>> {
          if (i >= kGapScan && i < ends) return std::nullopt;
          return i == ends ? std::vector<Eigen::Vector3d>{} : room(i);
        });
    EXPECT_EQ(run.counters.scans_used, 60u - static_cast<unsigned>(lost) - 1u);
    const LioVector across = sigma_after(run, ends), after = sigma_after(run, ends + 1);
    for (const int block : {int{kTheta}, int{kPosition}, int{kVelocity}}) {
      EXPECT_GT(across.segment<3>(block).norm(), 1.1 * before.segment<3>(block).norm()) << "block " << block;
      EXPECT_GT(across.segment<3>(block).norm(), sigma_after(run, kGapScan - 1).segment<3>(block).norm());
      EXPECT_LT(after.segment<3>(block).norm(), across.segment<3>(block).norm());
    }
    EXPECT_LT(strayed(run.results.back()), 0.05);
    before = across;
  }
}

TEST(OdometryFaults, ASilenceOfBothSensorsStartsAgainInPlaceWithAnHonestCovariance) {
  const Drive run = stand(
      default_config(mti600_spec()), 60,
      [](int i) { return in_gap(kStart + i * kScanStep) ? std::vector<Eigen::Vector3d>{} : room(i); },
      [](ImuSample& s) { return !in_gap(s.stamp); });
  EXPECT_EQ(run.counters.starts_in_place, 1u);
  EXPECT_EQ(run.counters.map_restarts, 1u);
  EXPECT_EQ(run.results.back().outcome, ScanOutcome::kUpdated);
  EXPECT_LT(strayed(run.results.back()), 0.05) << "the pose is kept";
  // 2 s at init/velocity_sigma, 10 m/s: nobody saw where it went.
  EXPECT_NEAR(position_sigma(run.results.back()), 20.0, 2.0);
  const LioVector sigma = run.results.back().covariance.diagonal().cwiseSqrt();
  EXPECT_GT(sigma[kTheta + 2], 0.9) << "nor how it turned";
  EXPECT_LT(sigma[kVelocity], 0.1) << "but how it moves is seen again";
  for (const LioResult& r : run.results) EXPECT_TRUE(is_finite(r));
}

TEST(OdometryFaults, AfterASilenceOfBothSensorsTheConstantPartOfTheBiasesIsStillKnown) {
  LioConfig config = default_config(mti600_spec());
  config.imu.bias_model = BiasModel::kGaussMarkov;
  const Eigen::Vector3d added(2e-3, -1e-3, 1.5e-3);  // [rad/s]
  const Drive run = stand(
      config, 60, [](int i) { return in_gap(kStart + i * kScanStep) ? std::vector<Eigen::Vector3d>{} : room(i); },
      [&](ImuSample& s) {
        s.gyro += added;
        return !in_gap(s.stamp);
      });
  ASSERT_EQ(run.counters.starts_in_place, 1u);
  const LioResult& last = run.results.back();
  EXPECT_LT((last.state.nav.gyro_bias_mean - added).norm(), 0.1 * added.norm());
  // The run's covariance grows by the new start's unknown heading, for the mean as for the bias itself.
  const auto sigma = [&last](int index) {
    return Eigen::Vector3d(last.covariance.diagonal().segment<3>(index)).cwiseSqrt().eval();
  };
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(sigma(kGyroBiasMean)[axis], sigma(kGyroBias)[axis]) << "not as after switch-on";
    EXPECT_GT(sigma(kGyroBiasMean)[axis], 0.0);
  }
}

TEST(OdometryFaults, TheLongestSilenceThatIsBridgedIsTheConfigurations) {
  LioConfig config = default_config(mti600_spec());
  config.imu.max_gap = 5.0;
  const Drive run = stand(
      config, 60, [](int i) { return in_gap(kStart + i * kScanStep) ? std::vector<Eigen::Vector3d>{} : room(i); },
      [](ImuSample& s) { return !in_gap(s.stamp); });
  EXPECT_EQ(run.counters.starts_in_place, 0u);
  // Of 5.5 m that it may have gone in the meantime; the map is found again, with a caution that lasts for seconds.
  EXPECT_LT(strayed(run.results.back()), 0.06)
      << "0.075 where the leans' part of the view's error is taken for all looks";
  EXPECT_LT(strayed(run.results.back()), 3.0 * position_sigma(run.results.back()));
}

}  // namespace
}  // namespace allan_lio
