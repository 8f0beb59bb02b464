// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "allan_lio/calib/linear_run.h"
#include "allan_lio/calib/noise_trial.h"
#include "allan_lio/calib/prepared_record.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

// How a run scores in TrialResult::nll [1]; of horizon_nll horizon_likelihood.h tells, and the last sentence holds too.
// A scan's innovation z, of `dof` components with the covariance S, adds -log p(z) = (nis + log det S + dof log 2
// pi)/2, at most kWorstScanNll; one without a match adds kUnmatchedNll, a hundred nats or so worse than a matched one,
// so that refusing the LiDAR does not pay. A run that diverged adds kWorstScanNll for every scan, for every one that it
// never came to, and for one more: worse than any that did not diverge, and the worse the earlier it did.
constexpr double kUnmatchedNll = 100.0;
constexpr double kWorstScanNll = 1e5;

/// A run has diverged when a state is not finite, when it is farther from its start than 100 times the true path (at
/// least kNearestDivergence, at most kFarthestDivergence, which holds without a truth), when its map was started
/// anew, or when less than half of the scans that it could have used were used. It ends there, unless it is the last.
constexpr double kNearestDivergence = 1e3, kFarthestDivergence = 1e5;  // [m]

/// The configuration with its multipliers replaced.
LioConfig with_setting(LioConfig config, const NoiseSetting& setting);

/// One run, on one thread, without touching a disk; the same arguments give the same bits. `record` must have been
/// thinned by this configuration's leaves. If the run diverged, ate and end_error are infinite where there is a truth.
/// `on_result` gets every state as it comes, if it is not empty. Of `trial` the bag's number plays no part.
TrialResult run_trial(const PreparedRecord& record, const LioConfig& config, const NoiseTrial& trial,
                      std::uint64_t seed, const std::function<void(const LioResult&)>& on_result = {});

/// The same, if the digest is at hand: to make it takes some tenths of a second for a long recording.
TrialResult run_trial(const PreparedRecord& record, std::uint64_t digest, const LioConfig& config,
                      const NoiseTrial& trial, std::uint64_t seed,
                      const std::function<void(const LioResult&)>& on_result = {});

/// A run and its linear run, which has no scans if it diverged.
struct LinearisedTrial {
  NoiseTrial trial;
  TrialResult result;
  LinearRun run;
};

/// run_trial() that keeps what a linear filter needs. `digest` is record.digest().
LinearisedTrial run_linearised(const PreparedRecord& record, std::uint64_t digest, const LioConfig& config,
                               const NoiseTrial& trial, std::uint64_t seed);

}  // namespace allan_lio
