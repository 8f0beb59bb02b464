// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_profile.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "allan_lio/calib/noise_search.h"
#include "synthetic_tuning.h"

namespace allan_lio {
namespace {

using P = NoiseParameter;
using Value = std::function<double(const Eigen::VectorXd&)>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEndError = 0.02;  ///< of an interval's end, of ln k

/// The profiles of a function about a point.
std::vector<NoiseProfile> profiles_of(const NoiseProblem& problem, const Value& value, const Eigen::VectorXd& optimum,
                                      ProfileKind kind) {
  NoiseEvaluator evaluator(problem, engine_of_logs(problem, value));
  ProfileOptions options;
  options.kind = kind;
  return profile_noise(evaluator, evaluator.evaluate(setting_at(problem, optimum)), options);
}

/// A problem whose prior is too wide to matter.
NoiseProblem without_prior(std::vector<P> tuned) {
  NoiseProblem problem = problem_of(std::move(tuned));
  problem.prior_sigma = 1000.0;
  return problem;
}

TEST(NoiseProfile, OfAParabolaGivesItsConditionalAndItsMarginalInterval) {
  Eigen::Matrix3d curvature;
  curvature << 400.0, -350.0, 20.0, -350.0, 500.0, 0.0, 20.0, 0.0, 50.0;
  const Eigen::Vector3d optimum(0.5, -1.0, 2.0);
  const Value parabola = [&](const Eigen::VectorXd& x) { return 0.5 * (x - optimum).dot(curvature * (x - optimum)); };
  const NoiseProblem problem = without_prior({P::kKg, P::kKr, P::kKgb});
  const Eigen::Matrix3d covariance = curvature.inverse();
  for (const ProfileKind kind : {ProfileKind::kSlice, ProfileKind::kFollowed, ProfileKind::kReoptimised}) {
    const auto profiles = profiles_of(problem, parabola, optimum, kind);
    ASSERT_EQ(profiles.size(), 3U);
    for (int i = 0; i < 3; ++i) {
      const bool slice = kind == ProfileKind::kSlice;
      const double sigma = std::sqrt(slice ? 1.0 / curvature(i, i) : covariance(i, i));
      EXPECT_NEAR(std::log(profiles[i].low), optimum[i] - 1.96 * sigma, kEndError) << i;
      EXPECT_NEAR(std::log(profiles[i].high), optimum[i] + 1.96 * sigma, kEndError) << i;
      EXPECT_NEAR(std::log(profiles[i].curvature_high), optimum[i] + 1.96 * std::sqrt(covariance(i, i)), kEndError);
      EXPECT_EQ(profiles[i].verdict, ProfileVerdict::kTold);
      for (std::size_t n = 1; n < profiles[i].points.size(); ++n)
        EXPECT_LT(profiles[i].points[n - 1].k, profiles[i].points[n].k);
    }
  }
}

TEST(NoiseProfile, SaysWhatCannotBeToldInSpiteOfThePrior) {
  NoiseProblem problem = problem_of({P::kKg, P::kKgb, P::kKab, P::kKa});
  problem.prior_sigma = 0.5;  // alone worth 10 nats at a factor of ten
  const Value value = [](const Eigen::VectorXd& x) {
    return 300.0 * x[0] * x[0] + 40.0 * std::pow(std::max(0.0, x[2]), 2) + 40.0 * std::pow(std::min(0.0, x[3]), 2);
  };
  for (const ProfileKind kind : {ProfileKind::kSlice, ProfileKind::kFollowed}) {
    const auto profiles = profiles_of(problem, value, Eigen::Vector4d::Zero(), kind);
    EXPECT_EQ(profiles[0].verdict, ProfileVerdict::kTold);
    EXPECT_EQ(profiles[1].verdict, ProfileVerdict::kCannotBeTold);
    EXPECT_EQ(profiles[2].verdict, ProfileVerdict::kOnlyUpperBound);
    EXPECT_EQ(profiles[3].verdict, ProfileVerdict::kOnlyLowerBound);
    EXPECT_EQ(profiles[1].low, 0.0);
    EXPECT_EQ(profiles[1].high, kInfinity);
    EXPECT_EQ(profiles[2].low, 0.0);
    EXPECT_NEAR(std::log(profiles[2].high), std::sqrt(kProfileLevel / 40.0), kEndError);
    EXPECT_EQ(profiles[3].high, kInfinity);
  }
}

TEST(NoiseProfile, ASumThatIsToldButNotItsPartsIsFlatOnlyWhenTheOthersFollow) {
  const NoiseProblem problem = without_prior({P::kKg, P::kKr});
  const Value value = [](const Eigen::VectorXd& x) { return 500.0 * std::pow(x[0] + x[1], 2); };
  const Eigen::Vector2d optimum = Eigen::Vector2d::Zero();
  EXPECT_EQ(profiles_of(problem, value, optimum, ProfileKind::kSlice)[0].verdict, ProfileVerdict::kTold);
  for (const ProfileKind kind : {ProfileKind::kFollowed, ProfileKind::kReoptimised})
    for (const NoiseProfile& profile : profiles_of(problem, value, optimum, kind))
      EXPECT_EQ(profile.verdict, ProfileVerdict::kCannotBeTold);
}

TEST(NoiseProfile, TheEndsOfALopsidedIntervalAreSearchedFor) {
  constexpr double kSamples = 30.0;
  // A variance e^2x told by so many samples: rises steeply towards zero and slowly upwards.
  const Value value = [](const Eigen::VectorXd& x) {
    return 0.5 * kSamples * (2.0 * x[0] + std::exp(-2.0 * x[0]) - 1.0);
  };
  const auto profiles = profiles_of(without_prior({P::kKg}), value, Eigen::VectorXd::Zero(1), ProfileKind::kFollowed);
  for (const double k : {profiles[0].low, profiles[0].high})
    EXPECT_NEAR(value(Eigen::VectorXd::Constant(1, std::log(k))), kProfileLevel, 0.1 * kProfileLevel) << k;
  EXPECT_LT(std::abs(std::log(profiles[0].low)), std::log(profiles[0].high));
}

TEST(NoiseProfile, TheBoxEndsTheReachAndACliffBoundsIt) {
  NoiseProblem problem = without_prior({P::kKg});
  problem.lowest_k = 0.5;
  const Value value = [](const Eigen::VectorXd& x) { return x[0] > 1.0 ? 1e6 : 0.1 * x[0] * x[0]; };
  const auto profiles = profiles_of(problem, value, Eigen::VectorXd::Zero(1), ProfileKind::kSlice);
  EXPECT_EQ(profiles[0].points.front().k, problem.lowest_k);
  EXPECT_EQ(profiles[0].verdict, ProfileVerdict::kOnlyUpperBound);
  EXPECT_GT(profiles[0].high, 1.0);
  EXPECT_LE(profiles[0].high, 10.0);
}

TEST(NoiseProfile, FewerIndependentInnovationsWidenTheInterval) {
  NoiseProblem problem = without_prior({P::kKg});
  problem.nll_scale = 0.25;
  const auto profiles = profiles_of(
      problem, [](const Eigen::VectorXd& x) { return 50.0 * x[0] * x[0]; }, Eigen::VectorXd::Zero(1),
      ProfileKind::kFollowed);
  EXPECT_NEAR(std::log(profiles[0].high), 2.0 * 1.96 * 0.1, kEndError);
}

/// Errors against ground truth that vary by `spread` among runs and rise by `slope` with ln k_g.
ProfileVerdict ate_verdict(double slope, double spread, std::uint32_t runs) {
  NoiseProblem problem = problem_of({P::kKg}, TuningObjective::kAte);
  problem.runs = runs;
  NoiseEvaluator evaluator(problem, engine_of([=](const NoiseTrial& trial) {
                             const double x = std::log(trial.setting.imu.k_g);
                             const auto cell = static_cast<std::uint64_t>(std::lround(1e3 * (x + 10.0)));
                             NormalStream normals(cell, trial.run);
                             TrialResult result;
                             result.ate = 5.0 + slope * x * x + spread * normals.next();
                             return result;
                           }));
  const auto profiles = profile_noise(evaluator, evaluator.evaluate(problem.start));
  EXPECT_EQ(profiles[0].high, kInfinity);
  return profiles[0].verdict;
}

TEST(NoiseProfile, OfAteIsFlatUnlessItRisesAboveTheSpreadOfTheRuns) {
  EXPECT_EQ(ate_verdict(0.0, 0.3, 10), ProfileVerdict::kCannotBeTold);
  EXPECT_EQ(ate_verdict(0.5, 0.3, 10), ProfileVerdict::kTold);
  EXPECT_EQ(ate_verdict(0.5, 0.3, 1), ProfileVerdict::kNotJudged);
}

/// The components' negative log-likelihood of samples drawn from the truth, given by their mean squares.
double sampled_nll(const VarianceComponents& model, const Eigen::VectorXd& squares, const Eigen::VectorXd& x) {
  const Eigen::ArrayXd variances = model.variances(x).array();
  return 0.5 * (model.samples.array() * (variances.log() + squares.array() / variances)).sum();
}

Eigen::VectorXd draw_squares(const VarianceComponents& model, std::uint64_t seed) {
  Eigen::VectorXd squares = model.variances(model.truth);
  for (Eigen::Index group = 0; group < squares.size(); ++group) {
    NormalStream normals(seed, static_cast<std::uint64_t>(group));
    const int count = static_cast<int>(model.samples[group]);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += std::pow(normals.next(), 2);
    squares[group] *= sum / count;
  }
  return squares;
}

TEST(NoiseProfile, TheTruthLiesInTheIntervalInNineteenOfTwentyRecords) {
  constexpr int kRecords = 200;
  constexpr double kLeast = 0.90, kMost = 0.98;
  VarianceComponents model = VarianceComponents::random(2, 1);
  model.shares << 4.0, 0.2, 1.0, 1.0, 0.1, 3.0, 2.0, 0.5, 0.3, 0.3, 5.0, 0.1;  // both can be told
  const NoiseProblem problem = problem_of({P::kKg, P::kKr});
  int inside[2] = {0, 0}, inside_curvature[2] = {0, 0};
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    const Eigen::VectorXd squares = draw_squares(model, seed);
    NoiseEvaluator evaluator(
        problem, engine_of_logs(problem, [&](const Eigen::VectorXd& x) { return sampled_nll(model, squares, x); }));
    const auto profiles = profile_noise(evaluator, search_likelihood(evaluator).best);
    for (int i = 0; i < 2; ++i) {
      const double truth = std::exp(model.truth[i]);
      inside[i] += profiles[i].low < truth && truth < profiles[i].high;
      inside_curvature[i] += profiles[i].curvature_low < truth && truth < profiles[i].curvature_high;
    }
  }
  for (int i = 0; i < 2; ++i) {
    for (const int count : {inside[i], inside_curvature[i]}) {
      EXPECT_GE(count, kLeast * kRecords) << i;
      EXPECT_LE(count, kMost * kRecords) << i;
    }
    RecordProperty(i == 0 ? "inside_first" : "inside_second", inside[i]);
    RecordProperty(i == 0 ? "inside_curvature_first" : "inside_curvature_second", inside_curvature[i]);
  }
}

TEST(NoiseProfile, RefusesAReachThatIsNone) {
  NoiseEvaluator evaluator(problem_of({P::kKg}), engine_of([](const NoiseTrial&) { return TrialResult(); }));
  const std::size_t place = evaluator.evaluate(NoiseSetting());
  ProfileOptions options;
  options.reach = 1.0;
  EXPECT_THROW(profile_noise(evaluator, place, options), std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
