// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "allan_lio/io/allan_report.h"

namespace allan_lio {
namespace {

constexpr int kDigits = 9;

/// JSON has no infinity: what has no bound is null.
std::string json_number(double value) { return std::isfinite(value) ? rounded_text(value, kDigits) : "null"; }

std::string json_estimate(const Estimate& e) {
  return "{\"value\": " + json_number(e.value) + ", \"low\": " + json_number(e.low) +
         ", \"high\": " + json_number(e.high) + ", \"observable\": " + (e.observable ? "true" : "false") + "}";
}

std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + "\"";
}

std::string json_axis(int axis, const AxisAnalysis& a) {
  const std::pair<const char*, const Estimate*> estimates[] = {
      {"quantization", &a.best().quantization}, {"white", &a.best().white},
      {"instability", &a.flicker.instability},  {"random_walk", &a.best().random_walk},
      {"markov_flat", &a.markov.markov_flat},   {"markov_time", &a.markov.markov_time},
      {"flat_deviation", &a.flat.deviation},    {"flat_tau", &a.flat.tau},
      {"bias_time", &a.flat.bias_time}};
  std::string text = "    {\"name\": " + json_text(axis_name(axis)) +
                     ", \"better\": " + (a.markov_fits_better ? "\"gauss_markov\"" : "\"flicker\"") +
                     ", \"misfit\": " + json_number(a.best().misfit);
  for (const auto& entry : estimates)
    text += ",\n     \"" + std::string(entry.first) + "\": " + json_estimate(*entry.second);
  return text + "}";
}

}  // namespace

std::string rounded_text(double value, int digits) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(digits);
  out << value;
  return out.str();
}

std::string deviation_table(const RecordAnalysis& analysis) {
  std::string text = "tau";
  for (int axis = 0; axis < StaticRecord::kAxes; ++axis) {
    std::string name = axis_name(axis);
    name[name.find(' ')] = '_';
    text += "," + name + "," + name + "_low," + name + "_high," + name + "_fitted";
  }
  text += '\n';
  for (std::size_t i = 0; i < analysis.axes[0].curve.size(); ++i) {
    text += rounded_text(analysis.axes[0].curve[i].tau, kDigits);
    for (const AxisReport& axis : analysis.axes)
      for (const double value :
           {std::sqrt(axis.curve[i].variance), axis.bands[i].low, axis.bands[i].high, axis.fitted[i]})
        text += "," + rounded_text(value, kDigits);
    text += '\n';
  }
  return text;
}

std::string fits_json(const RecordAnalysis& analysis, const RecordOrigin& origin) {
  std::string text = "{\"record\": " + json_text(origin.name) + ", \"duration\": " + json_number(analysis.duration) +
                     ", \"rate\": " + json_number(1.0 / analysis.tau0) + ", \"method\": " +
                     (analysis.method == FitMethod::kLeastSquares ? "\"least squares\"" : "\"maximum likelihood\"") +
                     ",\n  \"axes\": [\n";
  for (int axis = 0; axis < StaticRecord::kAxes; ++axis)
    text += json_axis(axis, analysis.axes[static_cast<std::size_t>(axis)].analysis) +
            (axis + 1 < StaticRecord::kAxes ? ",\n" : "\n");
  return text + "  ]}\n";
}

}  // namespace allan_lio
