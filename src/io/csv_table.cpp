// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/csv_table.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "allan_lio/io/line_reader.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/tum.h"

namespace allan_lio {
namespace {

std::vector<std::string> split(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (std::size_t comma; (comma = line.find(',', begin)) != std::string::npos; begin = comma + 1)
    cells.push_back(line.substr(begin, comma - begin));
  cells.push_back(line.substr(begin));
  return cells;
}

}  // namespace

CsvTable::CsvTable(const std::string& path) : path_(path) {
  LineReader reader(path);
  TextLine line;
  if (!reader.next(line)) throw std::runtime_error(path + ": is empty");
  names_ = split(line.text());
  const auto t = std::find(names_.begin(), names_.end(), "t") - names_.begin();
  if (static_cast<std::size_t>(t) == names_.size()) throw std::runtime_error(path + ":1: has no column t");
  while (reader.next(line)) {
    std::vector<std::string> cells = split(line.text());
    const std::string place = path + ":" + std::to_string(line.number) + ": ";
    if (!line.closed && cells.size() <= names_.size()) break;  // what a crash cut off, perhaps inside a number
    if (cells.size() != names_.size())
      throw std::runtime_error(place + std::to_string(cells.size()) + " cells, but the header names " +
                               std::to_string(names_.size()));
    TimeNs stamp = 0;
    if (!parse_seconds(cells[t], &stamp)) throw std::runtime_error(place + "'" + cells[t] + "' is not a time");
    if (!stamps_.empty() && stamp <= stamps_.back())
      throw std::runtime_error(place + "the stamp " + cells[t] + " is not later than the one before");
    stamps_.push_back(stamp);
    lines_.push_back(line.number);
    std::move(cells.begin(), cells.end(), std::back_inserter(cells_));
  }
  if (stamps_.empty()) throw std::runtime_error(path + ": holds no row");
}

bool CsvTable::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

bool CsvTable::has_all(const std::vector<std::string>& names) const {
  return std::all_of(names.begin(), names.end(), [this](const std::string& name) { return has(name); });
}

std::vector<double> CsvTable::numbers(const std::string& name) const { return parse(name, false); }

std::vector<double> CsvTable::numbers_or_nan(const std::string& name) const { return parse(name, true); }

std::vector<std::string> CsvTable::names_with(const std::string& prefix) const {
  std::vector<std::string> found;
  for (const std::string& name : names_)
    if (name.compare(0, prefix.size(), prefix) == 0) found.push_back(name);
  return found;
}

std::vector<double> CsvTable::parse(const std::string& name, bool gaps) const {
  const auto column = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  if (column == names_.size()) throw std::runtime_error(path_ + ": has no column " + name);
  std::vector<double> values(rows());
  for (std::size_t i = 0; i < rows(); ++i) {
    const std::string& cell = cells_[i * names_.size() + column];
    if (gaps && (cell.empty() || cell == "nan" || cell == "-nan")) {
      values[i] = std::numeric_limits<double>::quiet_NaN();
    } else if (!parse_number(cell, &values[i])) {
      throw std::runtime_error(path_ + ":" + std::to_string(lines_[i]) + ": column " + name + ": '" + cell +
                               "' is not a finite number");
    }
  }
  return values;
}

}  // namespace allan_lio
