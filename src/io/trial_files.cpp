// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/trial_files.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "allan_lio/io/line_reader.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/whole_file.h"

namespace allan_lio {
namespace {

constexpr char kTrialsFormat[] = "allan_lio trials 1";
constexpr char kTrialsColumns[] = "bag,run,k_g,k_a,k_gb,k_ab,k_r";
constexpr char kResultsFormat[] = "allan_lio results 2";
constexpr char kResultsColumns[] =
    "ate,end_error,nll,nis,nis_dof,horizon_nll,horizon_nis,horizon_dof,horizon_share,scans,diverged";

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return number_text(value);
}

double to_real(const std::string& text) {
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-inf") return -std::numeric_limits<double>::infinity();
  double value = 0.0;
  if (!parse_number(text, &value)) throw std::runtime_error("'" + text + "' is not a number");
  return value;
}

template <typename Integer>
Integer to_whole(const std::string& text, Integer largest = std::numeric_limits<Integer>::max()) {
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || text.size() > 20) throw std::runtime_error("'" + text + "' is not a whole number");
  Integer value = 0;
  for (const char c : text) {
    const Integer digit = static_cast<Integer>(c - '0');
    if (digit > largest || value > (largest - digit) / 10) throw std::runtime_error("'" + text + "' is too large");
    value = value * 10 + digit;
  }
  return value;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::string row_of(const NoiseTrial& trial) {
  std::string row = std::to_string(trial.bag) + "," + std::to_string(trial.run);
  const NoiseSetting& k = trial.setting;
  for (const double value : {k.imu.k_g, k.imu.k_a, k.imu.k_gb, k.imu.k_ab, k.k_r}) row += "," + real_text(value);
  return row;
}

NoiseTrial trial_of(const std::vector<std::string>& cells) {
  NoiseTrial trial;
  trial.bag = to_whole<std::uint32_t>(cells[0]);
  trial.run = to_whole<std::uint32_t>(cells[1]);
  trial.setting.imu.k_g = to_real(cells[2]);
  trial.setting.imu.k_a = to_real(cells[3]);
  trial.setting.imu.k_gb = to_real(cells[4]);
  trial.setting.imu.k_ab = to_real(cells[5]);
  trial.setting.k_r = to_real(cells[6]);
  return trial;
}

std::string row_of(const TrialResult& result) {
  std::string row;
  for (const double value : {result.ate, result.end_error, result.nll, result.nis}) row += real_text(value) + ",";
  row += std::to_string(result.nis_dof) + ",";
  for (const double value : {result.horizon_nll, result.horizon_nis, result.horizon_dof, result.horizon_share})
    row += real_text(value) + ",";
  return row + std::to_string(result.scans) + (result.diverged ? ",1" : ",0");
}

TrialResult result_of(const std::vector<std::string>& cells) {
  TrialResult result;
  result.ate = to_real(cells[0]);
  result.end_error = to_real(cells[1]);
  result.nll = to_real(cells[2]);
  result.nis = to_real(cells[3]);
  result.nis_dof = to_whole<std::uint64_t>(cells[4]);
  result.horizon_nll = to_real(cells[5]);
  result.horizon_nis = to_real(cells[6]);
  result.horizon_dof = to_real(cells[7]);
  result.horizon_share = to_real(cells[8]);
  result.scans = to_whole<std::uint32_t>(cells[9]);
  result.diverged = to_whole<std::uint32_t>(cells[10], 1) == 1;
  return result;
}

template <typename Row>
void write_rows(const std::string& path, const std::string& format, const char* columns, const std::vector<Row>& rows) {
  std::string text = format + ", " + std::to_string(rows.size()) + " rows\n" + columns + "\n";
  for (const Row& row : rows) text += row_of(row) + "\n";
  write_whole(path, text);
}

/// Takes the lines of the file one after the other; the columns' names stand in the second.
template <typename Row>
std::vector<Row> read_rows(const std::string& path, const std::string& format, const char* columns,
                           Row (*row)(const std::vector<std::string>&)) {
  LineReader reader(path);
  TextLine line;
  const std::string first = reader.next(line) ? line.text() : "";
  if (!reader.next(line) || line.text() != columns || first.compare(0, format.size() + 2, format + ", ") != 0)
    throw std::runtime_error(path + ": is no file of '" + format + "'");
  std::vector<Row> rows;
  const std::size_t width = cells_of(columns).size();
  while (reader.next(line)) try {
      const std::vector<std::string> cells = cells_of(line.text());
      if (!line.closed || cells.size() != width) throw std::runtime_error("is cut off or of another length");
      rows.push_back(row(cells));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(path + ":" + std::to_string(line.number) + ": " + error.what());
    }
  if (first != format + ", " + std::to_string(rows.size()) + " rows")
    throw std::runtime_error(path + ": is cut off: holds " + std::to_string(rows.size()) + " rows and says '" + first +
                             "'");
  return rows;
}

}  // namespace

void write_trials(const std::string& path, const std::vector<NoiseTrial>& trials) {
  write_rows(path, kTrialsFormat, kTrialsColumns, trials);
}

std::vector<NoiseTrial> read_trials(const std::string& path) {
  return read_rows<NoiseTrial>(path, kTrialsFormat, kTrialsColumns, trial_of);
}

void write_results(const std::string& path, const std::vector<TrialResult>& results) {
  write_rows(path, kResultsFormat, kResultsColumns, results);
}

std::vector<TrialResult> read_results(const std::string& path) {
  return read_rows<TrialResult>(path, kResultsFormat, kResultsColumns, result_of);
}

}  // namespace allan_lio
