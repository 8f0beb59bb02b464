// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/imu/physical_unit.h"
#include "allan_lio/io/allan_report.h"

namespace allan_lio {
namespace {

constexpr int kDigits = 4, kBoundDigits = 3;

/// A coefficient's SI unit and, where data sheets have another, that one; both as parse_unit() reads them.
struct Units {
  std::string si, sheet;
};

struct Row {
  std::string name;
  Units gyro, accel;
  const Estimate& (*pick)(const AxisAnalysis&);
};

const Row kRows[] = {
    {"Q", {"rad", "deg"}, {"m/s", ""}, [](const AxisAnalysis& a) -> const Estimate& { return a.best().quantization; }},
    {"N",
     {"rad/s/sqrt(Hz)", "deg/sqrt(h)"},
     {"m/s^2/sqrt(Hz)", "ug/sqrt(Hz)"},
     [](const AxisAnalysis& a) -> const Estimate& { return a.best().white; }},
    {"B",
     {"rad/s", "deg/h"},
     {"m/s^2", "ug"},
     [](const AxisAnalysis& a) -> const Estimate& { return a.flicker.instability; }},
    {"Gauss-Markov sigma_b",
     {"rad/s", "deg/h"},
     {"m/s^2", "ug"},
     [](const AxisAnalysis& a) -> const Estimate& { return a.markov.markov_flat; }},
    {"Gauss-Markov T_b",
     {"s", ""},
     {"s", ""},
     [](const AxisAnalysis& a) -> const Estimate& { return a.markov.markov_time; }},
    {"K",
     {"rad/s^2/sqrt(Hz)", "deg/h/sqrt(h)"},
     {"m/s^3/sqrt(Hz)", "ug/sqrt(h)"},
     [](const AxisAnalysis& a) -> const Estimate& { return a.best().random_walk; }},
    {"flat part sigma_b",
     {"rad/s", "deg/h"},
     {"m/s^2", "ug"},
     [](const AxisAnalysis& a) -> const Estimate& { return a.flat.deviation; }},
    {"flat part tau_flat", {"s", ""}, {"s", ""}, [](const AxisAnalysis& a) -> const Estimate& { return a.flat.tau; }},
    {"flat part T_b", {"s", ""}, {"s", ""}, [](const AxisAnalysis& a) -> const Estimate& { return a.flat.bias_time; }}};

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

/// "1.234 [1.2, 1.3] unit".
std::string value_text(const Estimate& e, const std::string& unit, double factor) {
  return rounded_text(e.value / factor, kDigits) + " [" + rounded_text(e.low / factor, kBoundDigits) + ", " +
         (std::isfinite(e.high) ? rounded_text(e.high / factor, kBoundDigits) : "inf") + "] " + unit;
}

/// "below 1.3 unit", "above 200 unit", or nothing.
std::string bound_text(const Estimate& e, const std::string& unit, double factor) {
  if (std::isfinite(e.high)) return "below " + rounded_text(e.high / factor, kBoundDigits) + " " + unit;
  if (e.low > 0.0) return "above " + rounded_text(e.low / factor, kBoundDigits) + " " + unit;
  return "";
}

std::string row_text(const Row& row, bool gyro, const AxisAnalysis& analysis) {
  const Estimate& e = row.pick(analysis);
  const Units& units = gyro ? row.gyro : row.accel;
  const auto factor = [](const std::string& unit) { return parse_unit(unit).factor; };
  std::string text = "  " + padded(row.name, 22);
  if (e.observable) {
    text += units.sheet.empty()
                ? value_text(e, units.si, 1.0)
                : padded(value_text(e, units.si, 1.0), 54) + value_text(e, units.sheet, factor(units.sheet));
  } else {
    const std::string si = bound_text(e, units.si, 1.0);
    text += "not observable in this record";
    if (!si.empty()) text += " (" + si;
    if (!si.empty() && !units.sheet.empty()) text += ", " + bound_text(e, units.sheet, factor(units.sheet));
    if (!si.empty()) text += ")";
  }
  return text + "\n";
}

}  // namespace

std::string record_text(const StaticRecord& record, const RecordOrigin& origin) {
  std::string text = "record       " + origin.name + "\nlength       " + rounded_text(record.duration(), 6) + " s, " +
                     std::to_string(record.samples()) + " samples at " + rounded_text(1.0 / record.tau0(), 6) + " Hz";
  text += record.pieces() > 1 ? ", in " + std::to_string(record.pieces()) + " pieces\n" : "\n";
  text += "jitter       ";
  text += record.stamped() ? rounded_text(1e3 * record.jitter(), 3) + " ms rms\n" : "not known: the rate was given\n";
  text += "temperature  ";
  text += origin.temperature.known()
              ? rounded_text(origin.temperature.low, 4) + " to " + rounded_text(origin.temperature.high, 4) + " degC\n"
              : "not recorded\n";
  for (const std::string& remark : origin.remarks) text += "note         " + remark + "\n";
  return text;
}

std::string fits_text(const RecordAnalysis& analysis) {
  std::string text;
  for (int axis = 0; axis < StaticRecord::kAxes; ++axis) {
    const AxisAnalysis& a = analysis.axes[static_cast<std::size_t>(axis)].analysis;
    text += "\n" + axis_name(axis) + "   ";
    text += analysis.method == FitMethod::kLikelihood ? "Gauss-Markov bias by maximum likelihood"
            : a.markov_fits_better                    ? "a Gauss-Markov bias fits better"
                                                      : "flicker noise fits better";
    text += ", from " + rounded_text(a.shortest, 2) + " s on; 95 % intervals in brackets\n";
    if (a.best().model_error > 0.0) {
      text += "  the variances depart from the model by " + rounded_text(100.0 * a.best().model_error, 2) +
              " %, for which the intervals allow\n";
    }
    for (const Row& row : kRows) text += row_text(row, axis < 3, a);
  }
  return text;
}

}  // namespace allan_lio
