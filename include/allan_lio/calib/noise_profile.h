// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "allan_lio/calib/noise_evaluator.h"

namespace allan_lio {

/// What the other coefficients do while one is moved.
enum class ProfileKind {
  kSlice,        ///< they stay
  kFollowed,     ///< they go where the objective's curvature at the optimum puts their best
  kReoptimised,  ///< from there they are searched anew at every point: the profile likelihood itself
};

enum class ProfileVerdict {
  kTold,            ///< bounded on both sides
  kOnlyUpperBound,  ///< flat towards zero
  kOnlyLowerBound,  ///< flat upwards
  kCannotBeTold,    ///< flat both ways: "cannot be told from this data"
  kNotJudged,       ///< kAte with one run a setting: nothing says what chance does
};

struct ProfilePoint {
  double k = 1.0;
  double rise = 0.0;           ///< of the data's part of the objective (without prior) above the profile's lowest
  std::size_t evaluation = 0;  ///< place in NoiseEvaluator::evaluations()
};

/// The objective along one coefficient.
struct NoiseProfile {
  NoiseParameter parameter = NoiseParameter::kKg;
  std::vector<ProfilePoint> points;  ///< k ascending, the optimum among them
  /// A likelihood: 95 %, where the profile is kProfileLevel above its lowest; 0 and infinite where it is not that high
  /// within the reach or the box. kAte: open.
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  /// A likelihood: 95 % by the curvature of the objective with its prior at the optimum. kAte: open.
  double curvature_low = 0.0, curvature_high = std::numeric_limits<double>::infinity();
  /// LinearTuning: 95 % by the likelihood of the innovations from scan to scan, whatever the objective; NaN of others.
  /// An IMU that keeps to its specification lies in the hull of both; where they lie apart, it does not keep to it.
  double scan_low = std::numeric_limits<double>::quiet_NaN(), scan_high = std::numeric_limits<double>::quiet_NaN();
  ProfileVerdict verdict = ProfileVerdict::kCannotBeTold;
};

/// Half the 95 % quantile of chi^2 with one degree of freedom [nats] (Wilks 1938).
constexpr double kProfileLevel = 1.920729410347062;

struct ProfileOptions {
  ProfileKind kind = ProfileKind::kFollowed;  ///< A likelihood; of kAte there are slices only
  double reach = 10.0;                        ///< the farthest point's factor on either side
  int points_a_side = 3;                      ///< evenly in ln k
  int refinements = 3;                        ///< further points at each end of the interval
  std::size_t settings_a_point = 20;          ///< kReoptimised: budget of each search
};

/// The profiles of all tuned coefficients about the optimum, evaluations()[best]. Settings known already are reused
/// and each round of points goes out as one batch: some 11 for one coefficient, 45 for two, 70 for three, 100 for four
/// (kFollowed), two thirds of it for slices. The interval knows of chance in the innovations and not of an objective
/// that is rugged beyond the level itself: then its ends are those of the ripples. kAte: flat is what rises less than
/// the range that chance gives the averages of the runs (5 standard errors, about Tukey's 95 % range of a dozen). If a
/// setting better than the optimum turns up, NoiseEvaluator::best() says so: search on from there. Throws
/// std::invalid_argument unless reach > 1 and points_a_side > 0.
std::vector<NoiseProfile> profile_noise(NoiseEvaluator& evaluator, std::size_t best,
                                        const ProfileOptions& options = {});

}  // namespace allan_lio
