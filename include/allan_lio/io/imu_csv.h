// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/io/imu_csv_columns.h"
#include "allan_lio/io/line_reader.h"

namespace allan_lio {

/// Lowest and highest temperature seen [degC].
struct TemperatureSpan {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool known() const { return low <= high; }
  void add(double value);  ///< what is not finite is left out
};

struct ImuCsvOptions {
  bool ignore_time = false;  ///< the rate is known otherwise; stamps are then 0
  std::string time_unit;     ///< "s", "ms", "us" or "ns"; empty: as the header says, else told by the intervals
};

/// Reads a table of IMU readings row by row: comma, semicolon, blank or tab separated, comments after '#', columns by
/// the names in a header line (imu_csv_columns.h), else 7 columns time, gyro, accelerometer, or 6 without time. Empty,
/// nan and inf fields are NaN. Every mistake is a std::runtime_error that names the file, and the line if it is one's.
class ImuCsvReader {
 public:
  /// Opens `path`, "-" for the standard input, and reads as far as the first rows.
  explicit ImuCsvReader(const std::string& path, const ImuCsvOptions& options = {});

  /// The next row in the units of the file; false at the end.
  bool next(ImuSample& sample);

  bool has_time() const { return columns_.time >= 0 && !options_.ignore_time; }
  const std::string& gyro_unit() const { return columns_.gyro_unit; }    ///< by the header, or empty
  const std::string& accel_unit() const { return columns_.accel_unit; }  ///< by the header, or empty
  const TemperatureSpan& temperature() const { return temperature_; }

  /// A sentence if the last line was cut off and left out; complete after next() has given false.
  const std::string& note() const { return note_; }

 private:
  struct KeptLine {
    std::string text;
    std::size_t number;
    bool closed;
  };

  bool next_row(TextLine& line);
  void find_layout();
  void find_columns(const std::string& names, std::size_t names_line, const KeptLine& row);
  int find_time_shift();
  double mean_interval(const std::deque<KeptLine>& rows) const;
  std::vector<std::string> split(const std::string& text) const;
  const char* field_end(const char* at, const char* end) const;
  bool parse_row(const TextLine& line, ImuSample& sample, std::string& trouble);
  bool parse_field(const char* begin, const char* end, int slot, ImuSample& sample);
  [[noreturn]] void fail(std::size_t line, const std::string& sentence) const;

  ImuCsvOptions options_;
  LineReader lines_;
  std::deque<KeptLine> ahead_;  // rows that were read to learn the layout
  KeptLine current_{};          // keeps the text of a row that comes from ahead_

  char separator_ = ',';  // ' ': blanks and tabs
  ImuCsvColumns columns_;
  std::vector<int> slots_;  // what a column holds: 0 to 5 an axis, 6 time, 7 temperature, -1 something else
  int time_shift_ = 9;      // power of ten from the time's unit to ns
  TemperatureSpan temperature_;
  std::string note_;
};

}  // namespace allan_lio
