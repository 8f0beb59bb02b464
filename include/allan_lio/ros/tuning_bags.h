// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "allan_lio/calib/trial_problem.h"

namespace allan_lio {

/// A recording to tune on before it is read.
struct TuningSource {
  std::string name;
  std::vector<std::string> files;  ///< merged by time
  std::string reference;           ///< TUM file; empty: none
  LioConfig config;
  std::vector<std::string> simulation;  ///< words for simulate_bag; then files and reference are what it writes
};

/// "drive_0.bag,drive_1.bag" are the files of one recording.
TuningSource bag_source(const std::string& files, const std::string& reference, const LioConfig& config);

/// How the configurations of bags are read: `name` (empty: the suite's own) and `overrides` over it.
struct ConfigChoice {
  std::string name;
  std::vector<std::string> overrides;  ///< "key=value"
};

/// Throws ConfigError.
LioConfig read_choice(const ConfigChoice& choice);

/// The bags of a suite of config/suites (scripts/bench --list reads it), each with its sequence's configuration and
/// parameters. `only`: names of sequences parted by commas, empty for all. Throws std::invalid_argument with what the
/// script says of a mistake.
std::vector<TuningSource> suite_sources(const std::string& suite, const std::string& seeds, const std::string& only,
                                        const ConfigChoice& choice);

/// Where suites' prepared records are kept, and what is told on the way.
struct PreparationOptions {
  std::string records;                      ///< directory; one that lies there, made of the same, is not made again
  const std::atomic<bool>* stop = nullptr;  ///< may be null
  std::function<void(const std::string& what, double part)> on_progress;  ///< part: 0 to 1; may be empty
  std::function<void(const std::string& note)> on_note;                   ///< about a bag; may be empty
};

/// Reads a bag, or makes, reads and removes a simulated one. Throws as prepare_bag, and std::runtime_error with
/// simulate_bag's words where that fails. Throws TrialsStopped where it was stopped.
TuningBag prepare(const TuningSource& source, const PreparationOptions& options);

}  // namespace allan_lio
