// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "allan_lio/io/time_statistics.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// What is known of a run only at its end.
struct RunSummary {
  LioCounters counters;
  double map_megabytes = 0;
  std::size_t map_voxels = 0;
  std::vector<std::string> notes;   ///< e.g. the point-time verdict, "bag cut off: ..."
  std::vector<std::string> inputs;  ///< the bags that were read
  std::string status = "complete";  ///< or "interrupted", "incomplete: ..."
};

/// Writes a run's results as they come: DIR/trajectory.tum, DIR/states.csv and, at the end, DIR/summary.yaml.
class RunWriter {
 public:
  /// Creates the directory and opens trajectory.tum and states.csv, replacing those of an earlier run and removing
  /// its summary.yaml. Throws std::runtime_error naming the path if it cannot.
  RunWriter(const std::string& directory, const LioConfig& config);

  /// Writes summary.yaml with status "interrupted" ("incomplete: ..." if rows are lost) if finish() was never called.
  /// Never throws.
  ~RunWriter();

  RunWriter(const RunWriter&) = delete;
  RunWriter& operator=(const RunWriter&) = delete;

  /// One row each, flushed at least every second of data. `cpu_seconds`: what the scan took [s]. Never throws for a
  /// file that cannot be written: trouble() says it, and the other file goes on.
  void add(const LioResult& result, double cpu_seconds);

  /// The parameters in force from now on. The summary has those at the end, and those at the start where they differ.
  void reconfigure(const LioConfig& config) { in_force_ = config; }

  /// Why rows are lost, known at the latest a second of data after; empty as long as all are written.
  const std::string& trouble() const { return trouble_; }

  /// Closes both files and writes summary.yaml. Throws std::runtime_error naming the file if any write failed.
  void finish(const RunSummary& summary);

 private:
  void flush();
  void write_summary(const RunSummary& summary) const;

  std::string directory_;
  LioConfig at_start_, in_force_;
  std::ofstream trajectory_, states_;
  TimeStatistics scan_seconds_;  ///< CPU time of the scans so far [s]
  TimeNs last_flush_ = 0;
  std::string trouble_;
  bool finished_ = false;
};

}  // namespace allan_lio
