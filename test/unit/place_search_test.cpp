// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/place_search.h"

#include <gtest/gtest.h>

#include <random>

#include "allan_lio/lio/iterated_update.h"
#include "allan_lio/math/so3.h"
#include "scene_points.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr double kNoise = 0.02;  // [m]
constexpr std::uint32_t kOld = 3, kLastOld = 5, kYoung = 20;
constexpr TimeNs kSecond = 1'000'000'000;

PoseMatrix covariance_of(const Eigen::Vector3d& position_sigmas, double heading_sigma) {
  PoseVector sigmas;
  sigmas << 1e-4, 1e-4, heading_sigma, position_sigmas;
  return sigmas.cwiseAbs2().asDiagonal();
}

/// Of a run that has made parts of its map until epoch kLastOld without an error, and has erred by that much since.
AbsoluteCovariance drifted_by(const PoseMatrix& pose) {
  AbsoluteCovariance out;
  out.reset(LioMatrix::Zero());
  for (std::uint32_t i = 0; i <= kLastOld; ++i) out.remember(LioState{}, false);
  LioMatrix covariance = LioMatrix::Zero();
  covariance.topLeftCorner<6, 6>() = pose;
  out.add(covariance);
  return out;
}

/// A run in a room, known since epoch 3, that has come back to its middle and takes itself to be elsewhere.
class CameBack : public ::testing::Test {
 protected:
  CameBack() {
    map_->insert(room_points(90000, kNoise, 1), Eigen::Vector3d::Zero(), kOld);
    state_.nav.stamp = 100 * kSecond;
  }

  void aside(const Eigen::Vector3d& position, double heading = 0.0) {
    state_.nav.T_world_imu = {exp_so3(Eigen::Vector3d(0, 0, heading)), position};
  }

  /// Half a second later.
  std::optional<Place> look(const PoseMatrix& drift, const std::vector<Eigen::Vector3f>& points) {
    state_.nav.stamp += kSecond / 2;
    return search_.look(points, state_, *map_, drifted_by(drift), false);
  }
  std::optional<Place> look(const PoseMatrix& drift) { return look(drift, scan_); }

  /// What is left of the error after the step.
  Eigen::Vector3d position_after(const Place& place) const {
    return state_.nav.T_world_imu.translation + place.step.tail<3>();
  }
  double turn_after(const Place& place, const Eigen::Quaterniond& truth = Eigen::Quaterniond::Identity()) const {
    return log_so3(truth.conjugate() * state_.nav.T_world_imu.rotation * exp_so3(place.step.head<3>())).norm();
  }

  /// Level, and with the world's heading.
  static std::vector<Eigen::Vector3f> seen_from(const Eigen::Vector3d& position, std::vector<Eigen::Vector3d> world) {
    for (Eigen::Vector3d& p : world) p -= position;
    return to_points(world);
  }
  static std::vector<Eigen::Vector3f> to_points(const std::vector<Eigen::Vector3d>& world) {
    std::vector<Eigen::Vector3f> out;
    for (const Eigen::Vector3d& p : world) out.push_back(p.cast<float>());
    return out;
  }

  const std::unique_ptr<VoxelMap> map_ = make_plane_voxel_map({0.5, kNoise, 50.0, 100.0});
  const std::vector<Eigen::Vector3f> scan_ = to_points(room_points(1500, kNoise, 2));
  const PoseMatrix drifted_ = covariance_of({0.2, 0.2, 0.003}, 0.01);
  const PoseMatrix sure_ = covariance_of({0.02, 0.02, 0.003}, 1e-3);
  LioState state_;
  PlaceSearch search_;
};

TEST_F(CameBack, ASearchFindsAPlaceFartherAsideThanAVoxel) {
  aside({0.8, -0.3, 0.0});
  const auto place = look(drifted_);
  ASSERT_TRUE(place);
  EXPECT_LT(position_after(*place).norm(), 0.06);
  EXPECT_LT(turn_after(*place), 0.01);
  EXPECT_EQ(place->last_epoch, kLastOld);
}

TEST_F(CameBack, ASearchFindsItThroughAWrongHeading) {
  aside({-0.4, 0.5, 0.0}, 0.06);
  const auto place = look(drifted_);
  ASSERT_TRUE(place);
  EXPECT_LT(position_after(*place).norm(), 0.08);
  EXPECT_LT(turn_after(*place), 0.015);
}

TEST_F(CameBack, ASearchFindsItWithAnImuThatIsMountedTilted) {
  const Eigen::Quaterniond mounted = exp_so3({0.5, -0.3, 2.0});
  std::vector<Eigen::Vector3f> scan;
  for (const Eigen::Vector3f& p : scan_) scan.push_back(mounted.conjugate().cast<float>() * p);
  aside({-0.4, 0.5, 0.0}, 0.06);
  state_.nav.T_world_imu.rotation = state_.nav.T_world_imu.rotation * mounted;
  PoseMatrix drift = drifted_;
  const Eigen::Matrix3d to_imu = mounted.conjugate().toRotationMatrix();
  drift.topLeftCorner<3, 3>() = (to_imu * drift.topLeftCorner<3, 3>() * to_imu.transpose()).eval();
  const auto place = look(drift, scan);
  ASSERT_TRUE(place);
  EXPECT_LT(position_after(*place).norm(), 0.08);
  EXPECT_LT(turn_after(*place, mounted), 0.015);
}

TEST_F(CameBack, ASearchFindsItAtAnotherHeight) {
  aside({0.0, 0.4, 0.5});
  const auto place = look(covariance_of({0.1, 0.1, 0.1}, 0.001));
  ASSERT_TRUE(place);
  EXPECT_LT(position_after(*place).norm(), 0.06);
}

TEST_F(CameBack, ARunThatIsWhereItTakesItselfToBeIsLeftAlone) {
  aside({0.02, 0.01, 0.0});
  EXPECT_FALSE(look(drifted_));
}

TEST_F(CameBack, OnceItHasDriftedWhatTheCovarianceSaysIsNotReliedOn) {
  // Matches of its own young walls have made it sure; it was in another place when it was not.
  aside({8.0, 0.0, 0.0});
  EXPECT_FALSE(look(drifted_)) << "nothing fits there";
  aside({0.8, 0.0, 0.0});
  const auto place = look(sure_);
  ASSERT_TRUE(place);
  EXPECT_LT(position_after(*place).norm(), 0.06);
}

TEST_F(CameBack, ARunThatNeverDriftedOffByFiveCentimetresIsNotLookedFor) {
  aside({0.3, 0.0, 0.0});
  EXPECT_FALSE(look(covariance_of({0.04, 0.04, 0.003}, 1e-3)));
  EXPECT_TRUE(look(covariance_of({0.06, 0.04, 0.003}, 1e-3)));
}

TEST_F(CameBack, ARunThatIsLostAltogetherIsNotLookedForUntilItIsLessSo) {
  aside({0.8, 0.0, 0.0});
  EXPECT_FALSE(look(covariance_of({3.0, 0.2, 0.003}, 1e-3)));
  EXPECT_TRUE(look(drifted_));
}

TEST_F(CameBack, AMapThatHasBegunAnewHasNoOldPlaces) {
  aside({8.0, 0.0, 0.0});
  EXPECT_FALSE(look(drifted_));
  aside({0.8, 0.0, 0.0});
  search_.forget();
  EXPECT_FALSE(look(sure_)) << "the drift was forgotten with the map";
}

TEST_F(CameBack, WhatWasMadeAsideIsNotTakenForAnOldPlaceOnceTheRunIsSetRight) {
  aside({0.8, 0.0, 0.0});
  AbsoluteCovariance absolute = drifted_by(drifted_);
  for (int i = 0; i < 3; ++i) absolute.remember(state_, false);
  state_.nav.stamp += kSecond;
  const auto place = search_.look(scan_, state_, *map_, absolute, false);
  ASSERT_TRUE(place);
  EXPECT_EQ(place->last_epoch, kLastOld);
  absolute.add_surprise(place->step, state_, place->last_epoch);
  aside(position_after(*place));
  const std::vector<PoseMatrix> parts = absolute.relative_to_parts(state_, false);
  EXPECT_GT(std::sqrt(parts.front()(3, 3)), 0.7) << "the part that fits had the error that was found";
  EXPECT_LT(std::sqrt(parts.back()(3, 3)), 0.01) << "what the run has made since lies aside as it did itself";
  // Set right, it is back among its old planes; what it has made meanwhile is then as far aside as it was.
  std::vector<Eigen::Vector3d> again = room_points(90000, kNoise, 3);
  for (Eigen::Vector3d& p : again) p.x() += 0.8;
  map_->insert(again, {0.8, 0.0, 0.0}, kLastOld + 2);
  aside({0.8, 0.0, 0.0});
  const auto once_more = look(drifted_);
  ASSERT_TRUE(once_more);
  EXPECT_LT(position_after(*once_more).norm(), 0.06);
}

/// Of so many points, a part on the old walls and the others on what was not there before.
class SeesLittle : public CameBack {
 protected:
  /// The i-th look, by a run that errs by that much. It is taken 0.3 m or more from the two before, or from the same
  /// place.
  std::optional<Place> glimpse(int i, const Eigen::Vector3d& error, bool moving = true) {
    const Eigen::Vector3d position(moving ? 0.3 * (i % 3 - 1) : 0.0, 0.0, 0.0);
    const auto seed = static_cast<unsigned>(10 + i);
    std::vector<Eigen::Vector3f> points = seen_from(position, room_points(44, kNoise, seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (int k = 0; k < 30; ++k) points.push_back({unit(random), unit(random), 0.4F * unit(random)});
    aside(position + error);
    return look(drifted_, points);
  }

  /// How many looks it takes, at most so many; the i-th by a run that errs by `error(i)`.
  template <typename Error>
  int looks_until_found(int most, const Error& error) {
    for (int i = 0; i < most; ++i)
      if (glimpse(i, error(i))) return i + 1;
    return 0;
  }
  const Eigen::Vector3d there_{1.1, 0.9, 0.0};
};

TEST_F(SeesLittle, WhatLooksAtTheSamePlaceTellIsAddedUp) {
  const int looks = looks_until_found(10, [&](int) { return there_; });
  EXPECT_GE(looks, 2);
  EXPECT_LE(looks, 6);
  EXPECT_FALSE(glimpse(looks, there_)) << "what was told is used up";
}

TEST_F(SeesLittle, ARobotThatStandsSeesTheSameAgain) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(glimpse(i, there_, false)) << i;
}

TEST_F(SeesLittle, LooksThatContradictEachOtherAreNotAdded) {
  EXPECT_EQ(looks_until_found(20, [&](int i) { return Eigen::Vector3d(i % 2 == 0 ? there_ : -there_); }), 0);
}

TEST_F(SeesLittle, APlaceThatWandersIsNotTheSame) {
  EXPECT_EQ(looks_until_found(8, [&](int i) { return Eigen::Vector3d(0.5 + 0.15 * i, 0.9, 0.0); }), 0);
}

TEST_F(SeesLittle, ALookThatShowsTheRunToBeWhereItTakesItselfToBeBeginsAnew) {
  EXPECT_EQ(
      looks_until_found(20, [&](int i) { return Eigen::Vector3d(i % 2 == 0 ? there_ : Eigen::Vector3d::Zero()); }), 0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(glimpse(i, there_)) << i;
    aside(Eigen::Vector3d::Zero());
    EXPECT_FALSE(look(drifted_, scan_)) << "most of its points fit here";
  }
}

TEST_F(SeesLittle, LooksThatLieFarApartInTimeAreNotAdded) {
  EXPECT_EQ(looks_until_found(20,
                              [&](int) {
                                state_.nav.stamp += 4 * kSecond;
                                return there_;
                              }),
            0);
}

TEST_F(SeesLittle, AMapThatHasBegunAnewForgetsTheLooks) {
  const int looks = looks_until_found(10, [&](int) { return there_; });
  search_ = PlaceSearch();
  for (int i = 0; i < looks; ++i) {
    if (i + 1 == looks) search_.forget();
    EXPECT_FALSE(glimpse(i, there_)) << i;
  }
}

TEST_F(CameBack, NotEveryScanIsTried) {
  aside({8.0, 0.0, 0.0});
  EXPECT_FALSE(look(drifted_));
  aside({0.8, 0.0, 0.0});
  state_.nav.stamp += kSecond / 10 - kSecond / 2;
  EXPECT_FALSE(look(drifted_)) << "0.1 s later";
  EXPECT_TRUE(look(drifted_));
}

/// Finds nothing, and counts how often it was asked.
class EmptyMap : public VoxelMap {
 public:
  explicit EmptyMap(bool gathers) : gathers_(gathers) {}

  void insert(const std::vector<Eigen::Vector3d>&, const Eigen::Vector3d&, std::uint32_t) override {}
  const Plane* find(const Eigen::Vector3d&, Plane&) const override { return nullptr; }
  const Plane* find_old(const Eigen::Vector3d&, const Eigen::Vector3d&, const OldPlanes&) const override {
    ++asked;
    return nullptr;
  }
  bool gather_old(const Eigen::AlignedBox3d&, std::uint32_t, OldPlaneBox&) const override {
    ++gathered;
    return gathers_;
  }
  void clear() override {}
  std::size_t voxels() const override { return 1; }
  std::size_t bytes() const override { return 0; }
  std::vector<Eigen::Vector3d> points() const override { return {}; }

  mutable int asked = 0, gathered = 0;

 private:
  bool gathers_;
};

TEST_F(CameBack, ALookIsBoundedHoweverUncertainThePose) {
  const AbsoluteCovariance lost = drifted_by(covariance_of({1.9, 1.9, 1.9}, 1.0));
  const EmptyMap map(false);
  EXPECT_FALSE(search_.look(scan_, state_, map, lost, false));
  EXPECT_GT(map.asked, 150'000);
  EXPECT_LT(map.asked, 300'000);
  const EmptyMap gathers(true);
  search_ = PlaceSearch();
  EXPECT_FALSE(search_.look(scan_, state_, gathers, lost, false));
  EXPECT_EQ(gathers.gathered, 50) << "once for a third of the points";
  EXPECT_LT(gathers.asked, 1000);
}

TEST_F(CameBack, PlacesThatFitAlikeAreNotChosenBetween) {
  // Walls a metre apart: half a metre off, the next one is as near as the right one.
  map_->clear();
  const auto shelves = [](int count, unsigned seed, double from, double to) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::normal_distribution<double> noise(0.0, kNoise);
    std::vector<Eigen::Vector3d> points;
    while (static_cast<int>(points.size()) < count)
      for (double x = -7.75; x < 8.0; x += 1.0)
        if (std::abs(x) > from && std::abs(x) < to)
          points.push_back({x + noise(random), 3.0 * unit(random), 1.5 * unit(random)});
    return points;
  };
  map_->insert(shelves(150000, 1, 0.0, 8.0), Eigen::Vector3d::Zero(), kOld);
  const auto look_along = [&](int i, double x, double sigma) {
    const Eigen::Vector3d position(0.0, i % 2 == 0 ? 0.15 : -0.15, 0.0);
    aside(position + Eigen::Vector3d(x, 0.0, 0.0));
    const auto seed = static_cast<unsigned>(2 + i);
    return look(covariance_of({sigma, 0.003, 0.003}, 1e-4),
                seen_from(position, shelves(1500, seed, 2.0, 5.5)));  // their ends would tell
  };
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(look_along(i, 0.5, 0.3)) << i;
  const auto place = look_along(0, 0.2, 0.05);
  EXPECT_TRUE(!place || std::abs(position_after(*place).x()) < 0.06)
      << "3 m are remembered; if it is one, then the nearest";
  search_ = PlaceSearch();
  for (int i = 0; i < 20; ++i)
    EXPECT_FALSE(look_along(i, 0.42, 0.1)) << "the prior alone would choose, counted at each look; " << i;
}

TEST_F(CameBack, AlongACorridorNothingIsFoundButAcrossIt) {
  map_->clear();
  map_->insert(corridor_points(150000, kNoise, 1, 2.0), Eigen::Vector3d::Zero(), kOld);
  const std::vector<Eigen::Vector3f> scan = to_points(corridor_points(1500, kNoise, 2, 1.0));
  const PoseMatrix drift = covariance_of({0.3, 0.2, 0.003}, 1e-4);
  aside({0.7, 0.0, 0.0});
  EXPECT_FALSE(look(drift, scan));
  aside({0.7, 0.5, 0.0});
  const auto place = look(drift, scan);
  ASSERT_TRUE(place);
  EXPECT_NEAR(position_after(*place).y(), 0.0, 0.06);
  EXPECT_NEAR(place->step[3], 0.0, 0.1);
}

TEST_F(CameBack, AnUpdateThatBeginsAtThePlaceGetsThereThoughTheRunHasMadeItsWallsAnewAndIsSureOfThem) {
  const Eigen::Vector3d off(0.8, -0.3, 0.0);
  std::vector<Eigen::Vector3d> again = room_points(90000, kNoise, 3);
  for (Eigen::Vector3d& p : again) p += off;
  map_->insert(again, off, kYoung);
  aside(off);
  const auto place = look(drifted_);
  ASSERT_TRUE(place);
  const LioConfig config = default_config(mti600_spec());
  TaskPool pool(1);
  PointToPlane residuals(pool);
  for (const bool relocalized : {false, true}) {
    ScanConditions conditions{0.1};
    if (relocalized) conditions.place = place;
    LioState state = state_;
    Belief belief{1e-6 * LioMatrix::Identity(), {}};
    AbsoluteCovariance absolute = drifted_by(sure_);
    while (absolute.remember(state, false) < kYoung) continue;
    const UpdateReport report = iterated_update(scan_, *map_, config, conditions, residuals, state, belief, absolute);
    ASSERT_TRUE(report.applied);
    EXPECT_EQ(report.relocated, relocalized);
    const double left = state.nav.T_world_imu.translation.norm();
    if (!relocalized) {
      EXPECT_NEAR(left, off.norm(), 0.05) << "it matches the walls that it has made there";
      EXPECT_GT(report.innovation.dof, 0);
      continue;
    }
    EXPECT_LT(left, 0.02);
    EXPECT_EQ(report.innovation.dof, 0) << "the covariances did not know of this";
    EXPECT_LT(std::sqrt(absolute.state()(kPosition, kPosition)), 0.03);
    EXPECT_GT(std::sqrt(absolute.relative_to_parts(state, false).back()(3, 3)), 0.7) << "its own walls lie aside";
    EXPECT_LT(std::sqrt(belief.covariance(kPosition, kPosition)), 0.02);
    EXPECT_NEAR(state.nav.velocity_world.norm(), 0.0, 0.05) << "a jump of the pose is no motion";
  }
}

TEST_F(CameBack, AnUpdateWithoutMatchesAtThePlaceLeavesBothCovariancesAlone) {
  LioState state = state_;
  Belief belief{0.01 * LioMatrix::Identity(), {}};
  AbsoluteCovariance absolute = drifted_by(drifted_);
  const LioMatrix before = absolute.state();
  const std::vector<PoseMatrix> parts = absolute.relative_to_parts(state, false);
  const LioConfig config = default_config(mti600_spec());
  TaskPool pool(1);
  PointToPlane residuals(pool);
  ScanConditions conditions{0.1};
  conditions.place = Place{PoseVector::Constant(100.0), 2};
  ASSERT_FALSE(iterated_update(scan_, *map_, config, conditions, residuals, state, belief, absolute).applied);
  EXPECT_EQ(belief.covariance, LioMatrix(0.01 * LioMatrix::Identity()));
  EXPECT_EQ(absolute.state(), before);
  EXPECT_EQ(absolute.relative_to_parts(state, false).back(), parts.back());
  EXPECT_EQ(state.nav.T_world_imu.translation, state_.nav.T_world_imu.translation);
}

}  // namespace
}  // namespace allan_lio
