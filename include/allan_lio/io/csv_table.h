// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// A CSV file whose first line names the columns and whose column `t` holds stamps in seconds. Every mistake is a
/// std::runtime_error "file:line: sentence".
class CsvTable {
 public:
  /// A last line that a crash cut off is left out. Throws if the file cannot be read, has no column t, no row, a row
  /// of another length, or a stamp that is not later than the one before.
  explicit CsvTable(const std::string& path);

  std::size_t rows() const { return stamps_.size(); }
  const std::vector<TimeNs>& stamps() const { return stamps_; }
  bool has(const std::string& name) const;
  bool has_all(const std::vector<std::string>& names) const;

  /// Throws naming file and column if there is none of that name, and the line where a cell is not a finite number.
  std::vector<double> numbers(const std::string& name) const;

  /// The same, an empty cell or "nan" being NaN.
  std::vector<double> numbers_or_nan(const std::string& name) const;

  /// Every column whose name begins so.
  std::vector<std::string> names_with(const std::string& prefix) const;

 private:
  std::vector<double> parse(const std::string& name, bool gaps) const;

  std::string path_;
  std::vector<std::string> names_;
  std::vector<std::string> cells_;  ///< row by row
  std::vector<std::size_t> lines_;  ///< of the rows in the file, from 1
  std::vector<TimeNs> stamps_;
};

}  // namespace allan_lio
