// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

class SqliteFile;

/// What makes the result of a trial: the same key, the same bits.
struct TrialKey {
  std::string problem;  ///< hash of the program and of the configuration without what is tuned (trial_problem.h)
  std::string bag;      ///< digest of the prepared record
  NoiseSetting setting;
  std::uint32_t run = 0;
  std::uint64_t seed = 0;  ///< plays no part in run 0
};

/// Results of trials in an SQLite file, so that a search that was interrupted goes on where it was. A result is on disk
/// when put() returns, and a process that is killed leaves the file whole. Several threads and several processes of
/// one machine may use a file at once (the write-ahead log does not work across a network).
class TrialStore {
 public:
  /// Opens the file or makes it. Throws std::runtime_error naming it if it cannot be opened or written, is not a trial
  /// store, or is of a newer format than this program knows.
  explicit TrialStore(const std::string& path);
  ~TrialStore();

  std::optional<TrialResult> find(const TrialKey& key) const;

  /// Replaces what is there under the key. Doubles come back to the last bit; NaN comes back as NaN.
  void put(const TrialKey& key, const TrialResult& result);

  std::size_t size() const;

 private:
  std::unique_ptr<SqliteFile> file_;
  mutable std::mutex mutex_;
};

}  // namespace allan_lio
