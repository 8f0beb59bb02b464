// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_session.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

BagComparison after(bool diverged) {
  BagComparison comparison;
  comparison.after.result.diverged = diverged;
  return comparison;
}

TEST(TuningSession, ASettingThatDivergesOnAllThatItWasTunedOnIsAFailure) {
  EXPECT_TRUE(every_run_diverges({after(true)}, 1));
  EXPECT_TRUE(every_run_diverges({after(true), after(true), after(false)}, 2)) << "the third was held out";
  EXPECT_FALSE(every_run_diverges({after(true), after(false), after(true)}, 2));
  EXPECT_FALSE(every_run_diverges({after(false), after(true)}, 1));
  EXPECT_FALSE(every_run_diverges({}, 0));
  EXPECT_FALSE(every_run_diverges({}, 2)) << "nothing was compared";
}

TEST(TuningSession, LinearRunsAreForALikelihoodThatIsNotRerun) {
  SessionSettings settings;
  settings.plan.search = TuningSearch::kLikelihood;
  settings.problem.objective = TuningObjective::kNll;
  EXPECT_TRUE(is_linear(settings));
  settings.problem.objective = TuningObjective::kScanNll;
  EXPECT_TRUE(is_linear(settings));
  settings.problem.objective = TuningObjective::kAte;
  EXPECT_FALSE(is_linear(settings)) << "a linear run knows no truth";
  settings.problem.objective = TuningObjective::kNll;
  settings.plan.rerun = true;
  EXPECT_FALSE(is_linear(settings));
  settings.plan.rerun = false;
  settings.plan.search = TuningSearch::kBayes;
  EXPECT_FALSE(is_linear(settings));
}

}  // namespace
}  // namespace allan_lio
