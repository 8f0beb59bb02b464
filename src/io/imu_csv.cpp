// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/imu_csv.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "allan_lio/io/decimal.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

constexpr std::size_t kRowsAhead = 33;  // rows whose intervals tell the unit of time
constexpr int kTimeSlot = 6, kTemperatureSlot = 7;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

const char* skip_blanks(const char* at, const char* end) {
  while (at != end && is_blank(*at)) ++at;
  return at;
}

const char* drop_blanks(const char* begin, const char* end) {
  while (end != begin && is_blank(end[-1])) --end;
  return end;
}

/// What a table may hold for a reading that is not there.
bool means_nothing(std::string word) {
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.erase(0, 1);
  return word.empty() || word == "nan" || word == "inf" || word == "infinity" || word == "null" || word == "na";
}

/// The whole of [begin, end) as a number.
bool parse_value(const char* begin, const char* end, double* value) {
  Decimal decimal;
  if (scan_decimal(begin, end, &decimal) != end) return false;
  return to_double(decimal, value) || parse_number(std::string(begin, end), value);
}

/// Power of ten to ns; -1 for an unknown unit.
int shift_of_unit(const std::string& unit) {
  const std::pair<const char*, int> units[] = {{"s", 9},     {"sec", 9}, {"secs", 9}, {"seconds", 9},
                                               {"msec", 6},  {"ms", 6},  {"us", 3},   {"usec", 3},
                                               {"nsecs", 0}, {"ns", 0},  {"nsec", 0}};
  for (const auto& entry : units)
    if (unit == entry.first) return entry.second;
  return -1;
}

/// The unit in which a mean interval is a sensible one, from 0.1 ms to below 1 s; -1: cannot be told.
int shift_of_interval(double interval) {
  if (interval >= 1e5) return 0;
  if (interval >= 100.0) return 3;
  if (interval > 1.0) return 6;
  return interval > 0.0 && interval < 1.0 ? 9 : -1;
}

}  // namespace

void TemperatureSpan::add(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

ImuCsvReader::ImuCsvReader(const std::string& path, const ImuCsvOptions& options) : options_(options), lines_(path) {
  find_layout();
  if (has_time()) time_shift_ = find_time_shift();
}

void ImuCsvReader::fail(std::size_t line, const std::string& sentence) const {
  throw std::runtime_error(lines_.name() + ":" + std::to_string(line) + ": " + sentence);
}

/// The next line that is neither empty nor a comment, blanks around it taken off.
bool ImuCsvReader::next_row(TextLine& line) {
  if (!ahead_.empty()) {
    current_ = std::move(ahead_.front());
    ahead_.pop_front();
    line = {current_.text.data(), current_.text.data() + current_.text.size(), current_.number, current_.closed};
    return true;
  }
  while (lines_.next(line)) {
    line.begin = skip_blanks(line.begin, line.end);
    line.end = drop_blanks(line.begin, line.end);
    if (line.begin != line.end && *line.begin != '#') return true;
  }
  return false;
}

const char* ImuCsvReader::field_end(const char* at, const char* end) const {
  return separator_ == ' ' ? std::find_if(at, end, is_blank) : std::find(at, end, separator_);
}

std::vector<std::string> ImuCsvReader::split(const std::string& text) const {
  std::vector<std::string> fields;
  const char* const end = drop_blanks(text.data(), text.data() + text.size());
  const char* at = skip_blanks(text.data(), end);
  for (;;) {
    const char* const stop = field_end(at, end);
    fields.emplace_back(at, drop_blanks(at, stop));
    if (stop == end) return fields;
    at = skip_blanks(stop + 1, end);
  }
}

/// Reads comments, the header and the first row, and finds the separator and the columns.
void ImuCsvReader::find_layout() {
  TextLine line;
  std::string comment, header;
  std::size_t comment_line = 0, header_line = 0;
  while (ahead_.empty() && lines_.next(line)) {
    line.begin = skip_blanks(line.begin, line.end);
    line.end = drop_blanks(line.begin, line.end);
    if (line.begin == line.end) continue;
    const std::string text = line.text();
    if (text.front() == '#') {
      comment = text.substr(1);
      comment_line = line.number;
      continue;
    }
    separator_ = text.find(';') != std::string::npos ? ';' : text.find(',') != std::string::npos ? ',' : ' ';
    const std::vector<std::string> fields = split(text);
    double ignored = 0.0;
    const bool numbers = std::any_of(fields.begin(), fields.end(), [&](const std::string& field) {
      return parse_value(field.data(), field.data() + field.size(), &ignored);
    });
    if (numbers || !header.empty()) {
      ahead_.push_back({text, line.number, line.closed});
    } else {
      header = text;
      header_line = line.number;
    }
  }
  if (ahead_.empty()) throw std::runtime_error(lines_.name() + ": holds no row of numbers");
  header.empty() ? find_columns(comment, comment_line, ahead_.front())
                 : find_columns(header, header_line, ahead_.front());
}

/// By the names, which count if there is one for every field of the row, or by the number of fields.
void ImuCsvReader::find_columns(const std::string& names, std::size_t names_line, const KeptLine& row) {
  const std::size_t count = split(row.text).size();
  const std::vector<std::string> fields = split(names);
  bool found = false;
  try {
    found = fields.size() == count && find_imu_columns(fields, &columns_);
  } catch (const std::invalid_argument& error) {
    fail(names_line, error.what());
  }
  if (!found && !default_imu_columns(static_cast<int>(count), &columns_))
    fail(row.number, "has " + std::to_string(count) +
                         " fields, and no header tells what they are; understood without one are 7 (time, gyro x y z, "
                         "accelerometer x y z) or 6 (the same without time)");
  slots_.assign(count, -1);
  for (int axis = 0; axis < 6; ++axis)
    slots_[static_cast<std::size_t>(columns_.axes[static_cast<std::size_t>(axis)])] = axis;
  if (has_time()) slots_[static_cast<std::size_t>(columns_.time)] = kTimeSlot;
  if (columns_.temperature >= 0) slots_[static_cast<std::size_t>(columns_.temperature)] = kTemperatureSlot;
}

/// The unit of time: as asked for, as the header says, or told by the intervals of the first rows.
int ImuCsvReader::find_time_shift() {
  const std::string& said = options_.time_unit.empty() ? columns_.time_unit : options_.time_unit;
  if (!said.empty()) {
    if (shift_of_unit(said) < 0)
      throw std::runtime_error(lines_.name() + ": '" + said + "' is no unit of time; accepted are s, ms, us, ns");
    return shift_of_unit(said);
  }
  std::deque<KeptLine> rows;
  for (TextLine line; rows.size() < kRowsAhead && next_row(line);)
    rows.push_back({line.text(), line.number, line.closed});
  ahead_ = std::move(rows);
  const double interval = mean_interval(ahead_);
  const int shift = shift_of_interval(interval);
  if (shift < 0 && ahead_.size() > 1)
    throw std::runtime_error(lines_.name() + ": intervals of " + number_text(interval) +
                             " do not tell the unit of time; name it in the header, as in 't [ms]', or as an option");
  return shift < 0 ? 9 : shift;
}

double ImuCsvReader::mean_interval(const std::deque<KeptLine>& rows) const {
  std::vector<double> times;
  for (const KeptLine& row : rows) {
    const std::vector<std::string> fields = split(row.text);
    if (static_cast<std::size_t>(columns_.time) >= fields.size()) continue;
    const std::string& field = fields[static_cast<std::size_t>(columns_.time)];
    double time = 0.0;
    if (parse_value(field.data(), field.data() + field.size(), &time)) times.push_back(time);
  }
  return times.size() > 1 ? (times.back() - times.front()) / static_cast<double>(times.size() - 1) : 0.0;
}

bool ImuCsvReader::next(ImuSample& sample) {
  TextLine line;
  if (!next_row(line)) return false;
  std::string trouble;
  if (parse_row(line, sample, trouble)) return true;
  if (line.closed) fail(line.number, trouble);
  note_ = lines_.name() + ":" + std::to_string(line.number) + ": the last line is cut off and left out";
  return false;
}

bool ImuCsvReader::parse_row(const TextLine& line, ImuSample& sample, std::string& trouble) {
  const char* at = line.begin;
  std::size_t column = 0;
  for (;; ++column) {
    const char* const stop = field_end(at, line.end);
    if (column < slots_.size() && slots_[column] >= 0 &&
        !parse_field(at, drop_blanks(at, stop), slots_[column], sample)) {
      trouble = "'" + std::string(at, drop_blanks(at, stop)) + "' is not a " +
                (slots_[column] == kTimeSlot ? "time" : "number");
      return false;
    }
    if (stop == line.end) break;
    at = skip_blanks(stop + 1, line.end);
  }
  if (++column == slots_.size()) return true;
  trouble = "has " + std::to_string(column) + " fields instead of " + std::to_string(slots_.size());
  return false;
}

bool ImuCsvReader::parse_field(const char* begin, const char* end, int slot, ImuSample& sample) {
  if (slot == kTimeSlot) {
    Decimal decimal;
    return scan_decimal(begin, end, &decimal) == end && to_time(decimal, time_shift_, &sample.stamp);
  }
  double value = 0.0;
  if (!parse_value(begin, end, &value)) {
    if (!means_nothing(std::string(begin, end))) return false;
    value = std::numeric_limits<double>::quiet_NaN();
  }
  if (slot == kTemperatureSlot) {
    temperature_.add(value);
  } else {
    (slot < 3 ? sample.gyro[slot] : sample.accel[slot - 3]) = value;
  }
  return true;
}

}  // namespace allan_lio
