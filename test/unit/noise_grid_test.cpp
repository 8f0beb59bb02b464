// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/calib/noise_evaluator.h"
#include "synthetic_tuning.h"

namespace allan_lio {
namespace {

using P = NoiseParameter;

/// |ln k - ln best| summed over the tuned coefficients.
RunTrials bowl(const NoiseProblem& problem, double best) {
  return engine_of_logs(problem, [best](const Eigen::VectorXd& x) { return (x.array() - std::log(best)).abs().sum(); });
}

std::string error_of(const NoiseProblem& problem) {
  try {
    check_problem(problem);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(NoiseProblem, RefusesWhatCannotBeTunedAndNamesIt) {
  NoiseProblem problem = problem_of({P::kKg, P::kKr});
  EXPECT_EQ(error_of(problem), "");
  problem.start.k_r = 2000.0;
  EXPECT_NE(error_of(problem).find("k_r starts at 2000"), std::string::npos);
  EXPECT_NE(error_of(problem_of({P::kKab, P::kKab})).find("k_ab is given twice"), std::string::npos);
  EXPECT_NE(error_of(problem_of({})).find("no coefficient"), std::string::npos);
  EXPECT_THROW(noise_parameter("k_b"), std::invalid_argument);
  for (const P parameter : {P::kKg, P::kKa, P::kKgb, P::kKab, P::kKr})
    EXPECT_EQ(noise_parameter(name_of(parameter)), parameter);
}

TEST(NoiseProblem, APointAndItsSettingAreTheSameInTheBox) {
  NoiseProblem problem = problem_of({P::kKgb, P::kKa});
  problem.start.imu.k_g = 7.0;
  const NoiseSetting setting = setting_at(problem, Eigen::Vector2d(std::log(20.0), -100.0));
  EXPECT_EQ(setting.imu.k_gb, 20.0);
  EXPECT_EQ(setting.imu.k_a, problem.lowest_k);
  EXPECT_EQ(setting.imu.k_g, 7.0);
  EXPECT_TRUE(same_setting(setting_at(problem, log_point(problem, setting)), setting));
}

TEST(NoiseEvaluator, AveragesAteOverBagsAndRunsAndADivergedOneCountsThePenalty) {
  NoiseProblem problem = problem_of({P::kKg}, TuningObjective::kAte);
  problem.bags = {3, 5};
  problem.runs = 2;
  const RunTrials engine = engine_of([](const NoiseTrial& trial) {
    TrialResult result;
    result.ate = trial.bag + 0.5 * trial.run;
    result.diverged = trial.setting.imu.k_g > 1.0 && trial.run == 1 && trial.bag == 5;
    return result;
  });
  NoiseEvaluator evaluator(problem, engine);
  EXPECT_DOUBLE_EQ(evaluator.evaluations()[evaluator.evaluate(problem.start)].objective, (3.0 + 3.5 + 5.0 + 5.5) / 4);
  start_at(problem, 2.0);
  const ScoredSetting diverged = evaluator.evaluations()[evaluator.evaluate(problem.start)];
  EXPECT_DOUBLE_EQ(diverged.objective, (3.0 + 3.5 + 5.0 + problem.diverged_ate) / 4);
  EXPECT_EQ(diverged.diverged, 1U);
  EXPECT_EQ(ate_range(problem, diverged).max, problem.diverged_ate);
  EXPECT_EQ(ate_range(problem, diverged, 0).max, 3.5);
  EXPECT_EQ(ate_range(problem, diverged, 0).min, 3.0);
  EXPECT_EQ(ate_range(problem, diverged, 0).average, 3.25);
  EXPECT_EQ(score(problem, engine, problem.start, {8}).objective, 8.25);
}

TEST(NoiseEvaluator, SumsTheScaledLikelihoodOverBagsAndAddsThePrior) {
  NoiseProblem problem = problem_of({P::kKg, P::kKr});
  problem.bags = {1, 2};
  problem.runs = 2;
  problem.nll_scale = 0.25;
  problem.prior_sigma = 2.0;
  start_at(problem, std::exp(1.0));
  const auto run = [](const NoiseTrial& trial) {
    TrialResult result;
    result.horizon_nll = 100.0 * trial.bag + 8.0 * trial.run;
    return result;
  };
  NoiseEvaluator evaluator(problem, engine_of(run));
  const ScoredSetting scored = evaluator.evaluations()[evaluator.evaluate(problem.start)];
  EXPECT_DOUBLE_EQ(scored.prior, 2.0 * 1.0 / (2.0 * 4.0));
  EXPECT_DOUBLE_EQ(scored.objective, 0.25 * (104.0 + 204.0) + scored.prior);
  EXPECT_DOUBLE_EQ(scored.run_deviation, 0.25 * 16.0 / std::sqrt(2.0));
}

TEST(NoiseEvaluator, EachLikelihoodIsThatOfItsName) {
  const auto run = [](const NoiseTrial&) {
    TrialResult result;
    result.nll = 7.0;
    result.horizon_nll = 3.0;
    return result;
  };
  for (const auto& [objective, expected] : {std::pair(TuningObjective::kNll, 3.0), {TuningObjective::kScanNll, 7.0}}) {
    NoiseEvaluator evaluator(problem_of({P::kKg}, objective), engine_of(run));
    const NoiseSetting twice{{2.0, 1.0, 1.0, 1.0}, 1.0};
    const ScoredSetting scored = evaluator.evaluations()[evaluator.evaluate(twice)];
    EXPECT_GT(scored.prior, 0.0) << name_of(objective);
    EXPECT_DOUBLE_EQ(scored.objective, expected + scored.prior) << name_of(objective);
  }
}

TEST(NoiseEvaluator, RunsASettingOnceAndKeepsWhatWasDoneWhenTheEngineFails) {
  const NoiseProblem problem = problem_of({P::kKg});
  int trials = 0;
  NoiseEvaluator evaluator(problem, engine_of([&](const NoiseTrial& trial) {
                             if (trial.setting.imu.k_g > 50.0) throw std::runtime_error("disk full");
                             ++trials;
                             return TrialResult();
                           }));
  evaluator.evaluate(std::vector<NoiseSetting>(3, problem.start));
  evaluator.evaluate(problem.start);
  EXPECT_EQ(trials, 1);
  NoiseSetting failing;
  failing.imu.k_g = 100.0;
  EXPECT_THROW(evaluator.evaluate(failing), std::runtime_error);
  EXPECT_EQ(evaluator.evaluations().size(), 1U);
}

TEST(NoiseEvaluator, SaysThatThereIsNoTruthInsteadOfPenalisingAll) {
  const NoiseProblem problem = problem_of({P::kKg}, TuningObjective::kAte);
  NoiseEvaluator evaluator(problem, engine_of([](const NoiseTrial&) { return TrialResult(); }));
  EXPECT_THROW(evaluator.evaluate(problem.start), std::runtime_error);
}

TEST(NoiseGrid, RunsThePapersGridInOneBatchAndFindsItsBest) {
  const NoiseProblem problem = problem_of({P::kKgb, P::kKab}, TuningObjective::kAte);
  int batches = 0;
  const RunTrials engine = bowl(problem, 27.0);
  NoiseEvaluator evaluator(problem, [&](const std::vector<NoiseTrial>& trials) {
    ++batches;
    return engine(trials);
  });
  const GridResult result = search_grid(evaluator, {paper_grid()});
  EXPECT_EQ(batches, 1);
  ASSERT_EQ(result.table.size(), 64U);
  EXPECT_EQ(evaluator.evaluations()[result.table[1]].setting.imu.k_gb, 10.0);
  EXPECT_EQ(evaluator.evaluations()[result.table[1]].setting.imu.k_ab, 15.0);
  EXPECT_EQ(evaluator.evaluations()[result.best].setting.imu.k_gb, 25.0);
  EXPECT_EQ(evaluator.evaluations()[result.best].setting.imu.k_ab, 25.0);
}

TEST(NoiseGrid, RefusesListsThatDoNotFit) {
  NoiseEvaluator evaluator(problem_of({P::kKgb, P::kKab}), bowl(problem_of({P::kKgb, P::kKab}), 1.0));
  EXPECT_THROW(search_grid(evaluator, {}), std::invalid_argument);
  EXPECT_THROW(search_grid(evaluator, {{1.0}, {1.0}, {1.0}}), std::invalid_argument);
  EXPECT_THROW(search_grid(evaluator, {{1.0}, {}}), std::invalid_argument);
  EXPECT_THROW(search_grid(evaluator, {{1.0, -2.0}}), std::invalid_argument);
  EXPECT_THROW(search_sequentially(evaluator, {P::kKgb, P::kKgb}, {{1.0}}), std::invalid_argument);
}

TEST(NoiseSequential, TakesThePapersOrderAndKeepsTheBestOfEach) {
  NoiseProblem problem = problem_of({P::kKg, P::kKa, P::kKgb, P::kKab}, TuningObjective::kAte);
  EXPECT_EQ(paper_order(problem), (std::vector<P>{P::kKa, P::kKg, P::kKab, P::kKgb}));
  EXPECT_EQ(paper_order(problem_of({P::kKgb, P::kKa})), (std::vector<P>{P::kKa, P::kKgb}));
  NoiseEvaluator evaluator(problem, bowl(problem, 9.0));
  const std::vector<SequentialStep> steps = search_sequentially(evaluator, paper_order(problem), {{10.0, 50.0}});
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(evaluator.evaluations().size(), 1U + 4U * 2U);
  const NoiseSetting& after_two = evaluator.evaluations()[steps[1].best].setting;
  EXPECT_EQ(after_two.imu.k_a, 10.0);
  EXPECT_EQ(after_two.imu.k_g, 10.0);
  EXPECT_EQ(after_two.imu.k_ab, 1.0);
  EXPECT_EQ(evaluator.evaluations()[steps[3].best].setting.imu.k_gb, 10.0);
}

TEST(NoiseSequential, KeepsTheValueBeforeIfNoneOfTheListIsBetter) {
  const NoiseProblem problem = problem_of({P::kKr}, TuningObjective::kAte);
  NoiseEvaluator evaluator(problem, bowl(problem, 1.0));
  const std::vector<SequentialStep> steps = search_sequentially(evaluator, {P::kKr}, {{10.0, 50.0}});
  EXPECT_EQ(evaluator.evaluations()[steps[0].best].setting.k_r, 1.0);
}

}  // namespace
}  // namespace allan_lio
