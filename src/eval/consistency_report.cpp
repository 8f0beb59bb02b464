// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/consistency_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>

namespace allan_lio {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMeanWidth = 10;

/// JSON has no NaN: what has no value is null.
std::string json(double value) {
  if (!std::isfinite(value)) return "null";
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(9);
  out << value;
  return out.str();
}

/// With so many decimals, and a point whatever the locale.
std::string fixed(double value, int decimals) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(decimals);
  out << std::fixed << value;
  return out.str();
}

/// At least one blank follows.
std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(std::max(width, text.size() + 1) - text.size(), ' ');
}

/// "" if it was not asked for.
std::string bound_text(const std::optional<StretchBound>& bound) {
  if (!bound) return "";
  std::string text = ", what an ideal filter could know ";
  text += std::isfinite(bound->ideal) ? fixed(bound->ideal, 3) + " m" : "not told: the truth has a gap or is too short";
  if (std::isfinite(bound->known_tilt)) text += " (with the tilt known " + fixed(bound->known_tilt, 3) + " m)";
  return text;
}

std::string stretch_text(const BlindStretch& stretch) {
  return "without support      " + fixed(stretch.seconds, 1) + " s: error gained along the axis " +
         fixed(stretch.error, 3) + " m, the filter's sigma of it " + fixed(stretch.sigma, 3) + " m" +
         bound_text(stretch.bound) + "\n";
}

std::string stretch_json(const BlindStretch& stretch) {
  const StretchBound bound = stretch.bound.value_or(StretchBound{kNaN, kNaN});
  return "{\"seconds\": " + json(stretch.seconds) + ", \"error\": " + json(stretch.error) +
         ", \"sigma\": " + json(stretch.sigma) + ", \"bound\": " + json(bound.ideal) +
         ", \"known_tilt\": " + json(bound.known_tilt) + "}";
}

std::string json_list(const std::array<double, 6>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + json(value);
  return text + "]";
}

std::string verdict(const NeesSummary& nees) {
  return nees.mean > nees.high ? "too sure" : nees.mean < nees.low ? "too cautious" : "in the band";
}

}  // namespace

std::string consistency_table(const ConsistencySummary& summary) {
  std::string text = "consistency          " + std::to_string(summary.runs) +
                     (summary.runs == 1 ? " run, " : " runs, ") + std::to_string(summary.times) +
                     " scans; first poses coincide (6 dof)\n";
  text += "NEES / dof           mean      95 % band       times inside\n";
  for (const NeesSummary& nees : summary.nees) {
    text += "  " + padded(nees_block_name(nees.block), 19);
    if (nees.samples == 0) {
      text += "not recorded\n";
      continue;
    }
    text += padded(fixed(nees.mean, 2), kMeanWidth) + padded(fixed(nees.low, 2) + " to " + fixed(nees.high, 2), 16) +
            padded(fixed(100.0 * nees.inside, 1) + " %", 9) + verdict(nees) + "\n";
  }
  text +=
      "along-axis 3 sigma   holds the error in " + fixed(100.0 * summary.three_sigma_share, 1) + " % of the scans\n";
  for (const BlindStretch& stretch : summary.blind) text += stretch_text(stretch);
  const Whiteness& w = summary.whiteness;
  if (w.samples > 0) {
    text += "innovation           correlation from scan to scan (white within +-" + fixed(w.band, 3) + "):";
    for (const double value : w.correlation) text += " " + fixed(value, 2);
    text += "\n                     deviation (1 is honest):";
    for (const double value : w.deviation) text += " " + fixed(value, 2);
    text += "\n";
  }
  return text;
}

std::string consistency_json(const ConsistencySummary& summary) {
  std::string text =
      "{\"runs\": " + std::to_string(summary.runs) + ", \"times\": " + std::to_string(summary.times) +
      ", \"alignment\": \"first pose, 6 dof\", \"three_sigma_share\": " + json(summary.three_sigma_share) +
      ", \"nees_per_dof\": {";
  for (std::size_t b = 0; b < summary.nees.size(); ++b) {
    const NeesSummary& nees = summary.nees[b];
    text += std::string(b > 0 ? ", \"" : "\"") + nees_block_name(nees.block) + "\": ";
    if (nees.samples == 0) {
      text += "null";
      continue;
    }
    text += "{\"mean\": " + json(nees.mean) + ", \"low\": " + json(nees.low) + ", \"high\": " + json(nees.high) +
            ", \"inside\": " + json(nees.inside) + ", \"samples\": " + std::to_string(nees.samples) + "}";
  }
  text += "}, \"blind\": [";
  for (std::size_t i = 0; i < summary.blind.size(); ++i) text += (i > 0 ? ", " : "") + stretch_json(summary.blind[i]);
  const Whiteness& w = summary.whiteness;
  text += "], \"whiteness\": ";
  if (w.samples == 0) return text + "null}";
  return text + "{\"samples\": " + std::to_string(w.samples) + ", \"mean\": " + json_list(w.mean) +
         ", \"deviation\": " + json_list(w.deviation) + ", \"correlation\": " + json_list(w.correlation) +
         ", \"band\": " + json(w.band) + "}}";
}

}  // namespace allan_lio
