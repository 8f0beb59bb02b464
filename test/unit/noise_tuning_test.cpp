// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_tuning.h"

#include <gtest/gtest.h>

#include "synthetic_tuning.h"

namespace allan_lio {
namespace {

using P = NoiseParameter;

constexpr double kSame = 0.05;  ///< of ln k

double bowl(const Eigen::VectorXd& x) { return 50.0 * (x.array() - 1.3).square().sum(); }

TEST(NoiseTuning, EverySearchIsFollowedByProfilesAboutItsBest) {
  for (const TuningSearch search :
       {TuningSearch::kGrid, TuningSearch::kSequential, TuningSearch::kLikelihood, TuningSearch::kBayes}) {
    const NoiseProblem problem = problem_of({P::kKgb, P::kKab});
    NoiseEvaluator evaluator(problem, engine_of_logs(problem, bowl));
    TuningPlan plan;
    plan.search = search;
    plan.grid = {{1.0, 3.7, 10.0}};
    plan.order = {P::kKab, P::kKgb};
    const TuningOutcome outcome = tune(evaluator, plan, {});
    ASSERT_EQ(outcome.profiles.size(), 2U) << name_of(search);
    for (const NoiseProfile& profile : outcome.profiles) EXPECT_EQ(profile.verdict, ProfileVerdict::kTold);
    const NoiseSetting& best = evaluator.evaluations()[outcome.best].setting;
    EXPECT_NEAR(std::log(best.imu.k_gb), 1.3, search == TuningSearch::kBayes ? 4.0 * kSame : kSame) << name_of(search);
    EXPECT_EQ(outcome.table.size(), search == TuningSearch::kGrid ? 9U : 0U);
    EXPECT_EQ(outcome.steps.size(), search == TuningSearch::kSequential ? 2U : 0U);
  }
}

/// A wide bowl at k = 1, and a deeper pit at 4.64, where the profile's second point is.
double bowl_with_a_pit(const Eigen::VectorXd& x) {
  return x[0] * x[0] - (std::abs(x[0] - 1.535) < 0.03 ? 20.0 * (0.03 - std::abs(x[0] - 1.535)) / 0.03 + 5.0 : 0.0);
}

TEST(NoiseTuning, ABetterSettingThatTheProfileFindsIsSearchedOnFrom) {
  const NoiseProblem problem = problem_of({P::kKg});
  NoiseEvaluator evaluator(problem, engine_of_logs(problem, bowl_with_a_pit));
  TuningPlan plan;
  plan.rounds = 0;
  NoiseEvaluator stays(problem, engine_of_logs(problem, bowl_with_a_pit));
  const TuningOutcome first = tune(stays, plan, {});
  EXPECT_LT(std::abs(std::log(stays.evaluations()[first.best].setting.imu.k_g)), 0.5);
  plan.rounds = 2;
  const TuningOutcome outcome = tune(evaluator, plan, {});
  EXPECT_NEAR(std::log(evaluator.evaluations()[outcome.best].setting.imu.k_g), 1.535, kSame);
  ASSERT_EQ(outcome.profiles.size(), 1U);
  bool about_it = false;
  for (const ProfilePoint& point : outcome.profiles[0].points) about_it |= point.evaluation == outcome.best;
  EXPECT_TRUE(about_it) << "the profile is that of the final best";
}

TEST(NoiseTuning, AGridKeepsToItsListsAndSaysThatThereIsBetter) {
  const NoiseProblem problem = problem_of({P::kKgb});
  NoiseEvaluator evaluator(problem, engine_of_logs(problem, bowl));
  TuningPlan plan;
  plan.search = TuningSearch::kGrid;
  plan.grid = {{1.0, 10.0}};
  const TuningOutcome outcome = tune(evaluator, plan, {});
  EXPECT_EQ(evaluator.evaluations()[outcome.best].setting.imu.k_gb, 10.0);
  EXPECT_TRUE(outcome.better_off_the_lists);
}

TEST(NoiseTuning, WhereEveryRunDivergesThereAreNoProfiles) {
  const NoiseProblem problem = problem_of({P::kKgb});
  NoiseEvaluator evaluator(problem, engine_of([](const NoiseTrial&) {
                             TrialResult result;
                             result.horizon_nll = 1e6;
                             result.diverged = true;
                             return result;
                           }));
  TuningPlan plan;
  plan.budget = 20;
  const TuningOutcome outcome = tune(evaluator, plan, {});
  EXPECT_TRUE(outcome.profiles.empty());
  EXPECT_EQ(outcome.end, "every run of every setting diverged");
}

}  // namespace
}  // namespace allan_lio
