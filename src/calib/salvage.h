// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "allan_lio/calib/noise_problem.h"
#include "allan_lio/io/tuning_report.h"

namespace allan_lio {

/// Looks results up among those that are there; settings without all of theirs are left out.
class Salvage {
 public:
  explicit Salvage(const std::vector<TrialRow>& rows) : rows_(rows) {}

  const TrialResult* find(const NoiseTrial& trial) const {
    const auto same = [&](const TrialRow& row) {
      return row.first.bag == trial.bag && row.first.run == trial.run && same_setting(row.first.setting, trial.setting);
    };
    const auto found = std::find_if(rows_.begin(), rows_.end(), same);
    return found == rows_.end() ? nullptr : &found->second;
  }

  /// In the order in which their first trial ended.
  std::vector<NoiseSetting> complete_settings(const NoiseProblem& problem) const {
    std::vector<NoiseSetting> settings;
    for (const TrialRow& row : rows_) {
      const NoiseSetting& setting = row.first.setting;
      const auto known = [&](const NoiseSetting& other) { return same_setting(other, setting); };
      if (std::none_of(settings.begin(), settings.end(), known) && complete(problem, setting))
        settings.push_back(setting);
    }
    return settings;
  }

 private:
  bool complete(const NoiseProblem& problem, const NoiseSetting& setting) const {
    for (const std::uint32_t bag : problem.bags)
      for (std::uint32_t run = 0; run < problem.runs; ++run)
        if (find({bag, setting, run}) == nullptr) return false;
    return true;
  }

  const std::vector<TrialRow>& rows_;
};

}  // namespace allan_lio
