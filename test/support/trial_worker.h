// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

/// A worker in the shell whose results are the trials' own figures, digit by digit.
inline std::string echo_worker() {
  return "awk -F, 'NR == 1 { sub(\"trials 1\", \"results 2\"); print; next }\n"
         "NR == 2 { print "
         "\"ate,end_error,nll,nis,nis_dof,horizon_nll,horizon_nis,horizon_dof,horizon_share,scans,diverged\"; next }\n"
         "{ print $3 \",\" $4 \",\" $5 \",\" $6 \",\" $1 \",\" $3 \",\" $4 \",\" $5 \",\" $6 \",\" $2 \",0\" }' "
         "\"$TRIALS\" >\"$RESULTS.part\" &&\n"
         "mv \"$RESULTS.part\" \"$RESULTS\"";
}

/// Trials that differ from each other in every figure, none of them short in decimals.
inline std::vector<NoiseTrial> different_trials(std::uint32_t count) {
  std::vector<NoiseTrial> trials(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    trials[i].bag = i;
    trials[i].run = 1000 + i;
    trials[i].setting.imu = {1.0 / (3 + i), 10.0 / (7 + i), 100.0 / (9 + i), 1e-9 / (11 + i)};
  }
  return trials;
}

inline void expect_echo(const std::vector<TrialResult>& results, const std::vector<NoiseTrial>& trials) {
  ASSERT_EQ(results.size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(results[i].ate, trials[i].setting.imu.k_g) << i;
    EXPECT_EQ(results[i].end_error, trials[i].setting.imu.k_a) << i;
    EXPECT_EQ(results[i].nll, trials[i].setting.imu.k_gb) << i;
    EXPECT_EQ(results[i].nis, trials[i].setting.imu.k_ab) << i;
    EXPECT_EQ(results[i].nis_dof, trials[i].bag) << i;
    EXPECT_EQ(results[i].horizon_nll, trials[i].setting.imu.k_g) << i;
    EXPECT_EQ(results[i].horizon_nis, trials[i].setting.imu.k_a) << i;
    EXPECT_EQ(results[i].horizon_dof, trials[i].setting.imu.k_gb) << i;
    EXPECT_EQ(results[i].horizon_share, trials[i].setting.imu.k_ab) << i;
    EXPECT_EQ(results[i].scans, trials[i].run) << i;
  }
}

}  // namespace allan_lio
