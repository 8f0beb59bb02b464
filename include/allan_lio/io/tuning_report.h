// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/calib/linear_tuning.h"

namespace allan_lio {

using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// A run of a bag with its trajectory's file in the output directory.
struct ComparedRun {
  std::string trajectory;  ///< empty: the run has none
  TrialResult result;
};

/// A bag with the noise that the configuration had and with the best.
struct BagComparison {
  std::uint32_t bag = 0;
  std::string reference;  ///< file in the output directory; empty: no ground truth
  ComparedRun before, after;
};

/// What tuning.yaml holds besides the evaluator's and the search's own.
struct TuningReport {
  NamedTexts bags, hold_out;  ///< name and hash; numbered as trials number them, held out ones last
  std::string config, command;
  NamedTexts versions, hashes;
  TuningSearch search = TuningSearch::kLikelihood;
  std::uint64_t seed = 1;
  NoiseSetting before;              ///< what the configuration had
  std::vector<LinearRound> rounds;  ///< empty where every setting had runs of its own
  std::vector<BagComparison> comparisons;
};

/// tuning.yaml, as scripts/tune_report_parts/tuning_data.py describes it. The same tuning, the same bytes.
std::string tuning_yaml(const TuningReport& report, const NoiseEvaluator& evaluator, const TuningOutcome& outcome);

/// A file to include: the multipliers under imu and lidar, `comments` above them, one line each.
std::string setting_yaml(const NoiseSetting& setting, const std::vector<std::string>& comments);

/// A run and what it gave.
using TrialRow = std::pair<NoiseTrial, TrialResult>;

/// trials.csv: sorted by bag, setting and run, each once, whatever the order in which they ended.
std::string trials_csv(std::vector<TrialRow> rows);

}  // namespace allan_lio
