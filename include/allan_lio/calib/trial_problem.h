// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/calib/prepared_record.h"
#include "allan_lio/io/trial_store.h"
#include "allan_lio/lio/lio_config.h"

namespace allan_lio {

/// A recording to tune on and what runs on it are configured by.
struct TuningBag {
  std::string name;  ///< for messages
  LioConfig config;  ///< whose multipliers a trial replaces
  PreparedRecord record;
};

/// All that trials share. Set up once, then only read.
class TrialProblem {
 public:
  /// NoiseTrial::bag counts in the order of `bags`; `seed` is of the perturbed runs. Throws std::runtime_error if the
  /// program's own file cannot be read for its hash.
  TrialProblem(std::vector<TuningBag> bags, std::uint64_t seed);

  const std::vector<TuningBag>& bags() const { return bags_; }
  std::uint64_t seed() const { return seed_; }

  /// Throws std::invalid_argument for a bag that is not there.
  const TuningBag& bag_of(const NoiseTrial& trial) const;

  /// Runs it on the calling thread. Throws std::runtime_error with describe(trial) before what went wrong.
  TrialResult run(const NoiseTrial& trial) const;

  /// The same with its linear run.
  LinearisedTrial run_linearised(const NoiseTrial& trial) const;

  /// Under what the result is stored: hashes of the build and of the configuration (multipliers and threads aside), of
  /// the recording's content, the setting, run and seed.
  TrialKey key(const NoiseTrial& trial) const;

  /// "corridor.bag, run 3, k_g 1, k_a 1, k_gb 10, k_ab 50, k_r 1".
  std::string describe(const NoiseTrial& trial) const;

 private:
  std::vector<TuningBag> bags_;
  std::uint64_t seed_;
  std::vector<std::uint64_t> digests_;       ///< of the records
  std::vector<std::string> problem_hashes_;  ///< one a bag
};

}  // namespace allan_lio
