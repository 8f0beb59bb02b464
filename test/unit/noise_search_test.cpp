// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_search.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "synthetic_tuning.h"

namespace allan_lio {
namespace {

using P = NoiseParameter;
using Value = std::function<double(const Eigen::VectorXd&)>;

constexpr double kSameAnswer = 0.05;  ///< of ln k, from any start
constexpr double kNearTop = 0.5;      ///< nats that are left at most where the objective is smooth
constexpr double kPenalty = 1e6;      ///< nats, diverged

const std::vector<P> kFour = {P::kKgb, P::kKab, P::kKg, P::kKa};

/// The engine of a value, diverged where that is the penalty.
RunTrials engine_with_cliff(const NoiseProblem& problem, const Value& value) {
  return engine_of([problem, value](const NoiseTrial& trial) {
    TrialResult result;
    result.nll = result.horizon_nll = value(log_point(problem, trial.setting));
    result.diverged = result.nll >= kPenalty;
    return result;
  });
}

/// What the likelihood search says from starts at 0.1, 1, 30 and from the box's corners by turns.
std::vector<Eigen::VectorXd> answers(int coefficients, const Value& value) {
  NoiseProblem problem = problem_of({kFour.begin(), kFour.begin() + coefficients});
  std::vector<Eigen::VectorXd> found;
  for (const double k : {0.1, 1.0, 30.0, -1.0}) {
    start_at(problem, k > 0.0 ? k : 0.02);
    if (k < 0.0) multiplier(problem.start, problem.tuned[0]) = 800.0;
    NoiseEvaluator evaluator(problem, engine_with_cliff(problem, value));
    const SearchResult result = search_likelihood(evaluator);
    EXPECT_LE(evaluator.evaluations().size(), LikelihoodSearchOptions().most_settings);
    found.push_back(log_point(problem, evaluator.evaluations()[result.best].setting));
  }
  return found;
}

void expect_one_answer(const std::vector<Eigen::VectorXd>& found) {
  for (const Eigen::VectorXd& x : found)
    EXPECT_LT((x - found[0]).lpNorm<Eigen::Infinity>(), kSameAnswer) << x.transpose() << " / " << found[0].transpose();
}

TEST(NoiseSearch, FindsTheBowlsBottomFromFourStarts) {
  const Eigen::Vector3d bottom(0.7, -1.2, 2.5);
  const auto found = answers(
      3, [&](const Eigen::VectorXd& x) { return Eigen::Vector3d(500.0, 20.0, 100.0).dot((x - bottom).cwiseAbs2()); });
  expect_one_answer(found);
  EXPECT_LT((found[0] - bottom).lpNorm<Eigen::Infinity>(), 2.0 * kSameAnswer);  // the prior pulls a little
}

TEST(NoiseSearch, TakesOneCoefficientAloneAndABoxSmallerThanItsFirstStep) {
  NoiseProblem problem = problem_of({P::kKr});
  problem.lowest_k = 0.5;
  problem.highest_k = 2.0;
  constexpr double kBottom = 0.37;  // ln k
  const RunTrials engine =
      engine_of_logs(problem, [](const Eigen::VectorXd& x) { return 500.0 * std::pow(x[0] - kBottom, 2); });
  NoiseEvaluator evaluator(problem, engine);
  const SearchResult result = search_likelihood(evaluator);
  EXPECT_EQ(result.end, SearchEnd::kConverged);
  EXPECT_NEAR(std::log(evaluator.evaluations()[result.best].setting.k_r), kBottom, kSameAnswer);
  NoiseEvaluator other(problem, engine);
  EXPECT_NEAR(std::log(other.evaluations()[search_bayes(other).best].setting.k_r), kBottom, kSameAnswer);
}

TEST(NoiseSearch, FollowsACorrelatedValley) {
  const auto found = answers(2, [](const Eigen::VectorXd& x) {
    return 400.0 * std::pow(x[0] + x[1] - 1.0, 2) + 10.0 * std::pow(x[0] - x[1] - 3.0, 2);
  });
  expect_one_answer(found);
  EXPECT_NEAR(found[0][0], 2.0, kSameAnswer);
  EXPECT_NEAR(found[0][1], -1.0, kSameAnswer);
}

TEST(NoiseSearch, FindsVarianceComponentsSmoothAndRugged) {
  constexpr double kRipple = 1.0, kNearRuggedTop = 4.0;  // nats
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto model = VarianceComponents::random(3, seed);
    const auto smooth = answers(3, [&](const Eigen::VectorXd& x) { return model.nll(x); });
    expect_one_answer(smooth);
    EXPECT_LT(model.nll(smooth[0]), kNearTop) << seed;
    const auto rough = answers(3, [&](const Eigen::VectorXd& x) { return model.nll(x) + rugged(x, kRipple); });
    expect_one_answer(rough);
    EXPECT_LT(model.nll(rough[0]), kNearRuggedTop) << seed;
  }
}

TEST(NoiseSearch, IsNotHeldByACliffThatTheStartLiesBehind) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto model = VarianceComponents::random(2, seed);
    const auto found = answers(2, [&](const Eigen::VectorXd& x) {
      const bool off = (model.truth - x).maxCoeff() > 1.0 || (x - model.truth).maxCoeff() > 1.5;
      return off ? kPenalty : model.nll(x);
    });
    expect_one_answer(found);
    EXPECT_LT(model.nll(found[0]), kNearTop) << seed;
  }
}

TEST(NoiseSearch, SaysSoWhereEverythingDiverges) {
  const NoiseProblem problem = problem_of({P::kKg, P::kKa});
  NoiseEvaluator evaluator(problem, engine_with_cliff(problem, [](const Eigen::VectorXd&) { return kPenalty; }));
  EXPECT_EQ(search_likelihood(evaluator).end, SearchEnd::kAllDiverged);
}

TEST(NoiseSearch, KeepsToItsBudget) {
  constexpr std::size_t kBudget = 17;
  const auto model = VarianceComponents::random(4, 1);
  const NoiseProblem problem = problem_of(kFour);
  NoiseEvaluator evaluator(problem, engine_of_logs(problem, [&](const Eigen::VectorXd& x) { return model.nll(x); }));
  LikelihoodSearchOptions options;
  options.most_settings = kBudget;
  const SearchResult result = search_likelihood(evaluator, options);
  EXPECT_EQ(result.end, SearchEnd::kBudgetSpent);
  EXPECT_EQ(evaluator.evaluations().size(), kBudget);
  EXPECT_EQ(result.best, evaluator.best());
}

TEST(NoiseSearch, AnEnginesErrorComesThroughTheOptimiser) {
  const NoiseProblem problem = problem_of({P::kKg, P::kKa});
  int left = 12;
  const RunTrials engine = engine_of_logs(problem, [](const Eigen::VectorXd& x) { return x.squaredNorm(); });
  NoiseEvaluator evaluator(problem, [&](const std::vector<NoiseTrial>& trials) {
    if (left < static_cast<int>(trials.size())) throw std::runtime_error("disk full");
    left -= static_cast<int>(trials.size());
    return engine(trials);
  });
  EXPECT_THROW(search_likelihood(evaluator), std::runtime_error);
  EXPECT_EQ(evaluator.evaluations().size(), 12U);
}

/// What the Bayesian search leaves of the model's nll with a seed.
double left_by_bayes(const VarianceComponents& model, const Value& value, std::uint64_t seed) {
  const NoiseProblem problem = problem_of({P::kKgb, P::kKab});
  NoiseEvaluator evaluator(problem, engine_with_cliff(problem, value));
  BayesSearchOptions options;
  options.seed = seed;
  const SearchResult result = search_bayes(evaluator, options);
  EXPECT_LE(evaluator.evaluations().size(), options.most_settings);
  return model.nll(log_point(problem, evaluator.evaluations()[result.best].setting));
}

TEST(NoiseSearch, BayesFindsARuggedBottomBesideACliffInFortySettings) {
  constexpr double kLeft = 3.0;  // nats, three times the ripple
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto model = VarianceComponents::random(2, seed);
    const Value value = [&](const Eigen::VectorXd& x) {
      const bool off = (x - model.truth).maxCoeff() > 1.5;
      return off ? kPenalty : model.nll(x) + rugged(x, 1.0);
    };
    EXPECT_LT(left_by_bayes(model, value, seed), kLeft) << seed;
  }
}

TEST(NoiseSearch, BayesGivesTheSameSettingsForTheSameSeed) {
  const auto model = VarianceComponents::random(2, 3);
  const NoiseProblem problem = problem_of({P::kKgb, P::kKab});
  const RunTrials engine = engine_of_logs(problem, [&](const Eigen::VectorXd& x) { return model.nll(x); });
  BayesSearchOptions options;
  options.most_settings = 16;
  const auto settings_of = [&](std::uint64_t seed) {
    NoiseEvaluator evaluator(problem, engine);
    options.seed = seed;
    search_bayes(evaluator, options);
    std::vector<double> all;
    for (const ScoredSetting& scored : evaluator.evaluations()) all.push_back(scored.setting.imu.k_gb);
    return all;
  };
  EXPECT_EQ(settings_of(1), settings_of(1));
  EXPECT_NE(settings_of(1), settings_of(2));
}

}  // namespace
}  // namespace allan_lio
