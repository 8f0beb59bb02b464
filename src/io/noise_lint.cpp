// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/noise_lint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "allan_lio/io/yaml_source.h"
#include "noise_slips.h"

namespace allan_lio {
namespace {

/// The spec with one axis on all three.
NoiseSpec axis_of(const NoiseSpec& spec, int axis) {
  const auto spread = [axis](const SensorNoise& sensor) {
    SensorNoise result;
    result.white.setConstant(sensor.white[axis]);
    result.bias_instability.setConstant(sensor.bias_instability[axis]);
    result.bias_random_walk.setConstant(sensor.bias_random_walk[axis]);
    result.bias_sigma.setConstant(sensor.bias_sigma[axis]);
    result.bias_time.setConstant(sensor.bias_time[axis]);
    return result;
  };
  return {spread(spec.gyro), spread(spec.accel)};
}

std::array<double*, 4> fields(NoiseScale& k) { return {{&k.k_g, &k.k_a, &k.k_gb, &k.k_ab}}; }

ImpliedScale implied_by(const NoiseFile& file, const KnownImu& known) {
  const NoiseSpec asked = with_bias_time_of(file.spec, known.spec);
  ImpliedScale implied;
  implied.name = known.name;
  implied.k = implied_scale(asked, known.spec);
  implied.low = implied.high = implied_scale(axis_of(asked, 0), axis_of(known.spec, 0));
  const std::array<double*, 4> low = fields(implied.low), high = fields(implied.high);
  for (int axis = 1; axis < 3; ++axis) {
    NoiseScale scale = implied_scale(axis_of(asked, axis), axis_of(known.spec, axis));
    const std::array<double*, 4> one = fields(scale);
    for (std::size_t i = 0; i < 4; ++i) {
      *low[i] = std::min(*low[i], *one[i]);
      *high[i] = std::max(*high[i], *one[i]);
    }
  }
  for (const double* k : fields(implied.k))
    if (*k > 0.0) implied.distance += std::log(*k) * std::log(*k);
  return implied;
}

const char* symbol(const NoiseFigure& figure) {
  if (is_white(figure.kind)) return figure.gyro ? "k_g" : "k_a";
  return figure.gyro ? "k_gb" : "k_ab";
}

std::string where(const NoiseFigure& figure) { return figure.key + " (" + figure.origin + ")"; }

void find_zeros(const NoiseFile& file, std::vector<LintFinding>& findings) {
  for (const NoiseFigure& figure : file.figures) {
    if (figure.value.minCoeff() > 0.0) continue;
    findings.push_back({Slip::kZero, true,
                        where(figure) + " is 0: a filter that believes it never corrects what it stands for" +
                            (is_white(figure.kind) ? "" : ", here the bias")});
  }
}

bool has_values(const NoiseFile& file, double gyro, double accel, double gyro_bias, double accel_bias) {
  const double values[] = {gyro, accel, gyro_bias, accel_bias};
  for (std::size_t i = 0; i < 4; ++i)
    if (!(file.figures[i].value.array() == values[i]).all()) return false;
  return true;
}

/// "k_ab = 12.5", or "12.5 to 17.7" where the axes differ.
std::string k_range(const char* name, double low, double high) {
  const std::string from = k_text(low), to = k_text(high);
  return std::string(name) + " = " + from + (from == to ? "" : " to " + to);
}

std::string all_k(const ImpliedScale& implied) {
  return k_range("k_g", implied.low.k_g, implied.high.k_g) + ", " + k_range("k_a", implied.low.k_a, implied.high.k_a) +
         ", " + k_range("k_gb", implied.low.k_gb, implied.high.k_gb) + ", " +
         k_range("k_ab", implied.low.k_ab, implied.high.k_ab);
}

/// Whether the figures are those that a package ships with, which are told against the IMU that was asked for, else
/// the one of the paper, else the nearest.
bool find_defaults(const LintReport& report, bool asked, std::vector<LintFinding>& findings) {
  const NoiseFile& file = report.file;
  const bool fast = file.format == NoiseFormat::kFastLio && has_values(file, 0.1, 0.1, 1e-4, 1e-4);
  const bool point = file.format == NoiseFormat::kPointLio &&
                     (has_values(file, 0.1, 0.1, 1e-4, 1e-4) || has_values(file, 0.01, 0.01, 1e-4, 1e-4));
  if (!fast && !point) return false;
  std::string sentence = fast ? "FAST-LIO2's" : "Point-LIO's";
  sentence += " shipped defaults, not a calibration";
  int reference = report.reference;
  for (std::size_t i = 0; !asked && i < report.implied.size(); ++i)
    if (report.implied[i].name == "imu/mti600") reference = static_cast<int>(i);
  if (reference >= 0) {
    const ImpliedScale& implied = report.implied[static_cast<std::size_t>(reference)];
    sentence += ": " + all_k(implied) + " at " + short_text(file.rate) + " Hz against " + implied.name;
  }
  findings.push_back({Slip::kShippedDefaults, true, sentence});
  return true;
}

/// White noise that no slip explains, beyond ten times the noisiest IMU.
void find_far(const NoiseFile& file, const std::vector<KnownImu>& known, std::vector<LintFinding>& findings) {
  constexpr double kFar = 10.0;
  for (std::size_t i = 0; i < 2 && !known.empty(); ++i) {
    const bool gyro = file.figures[i].gyro;
    const auto white = [gyro](const NoiseSpec& spec) { return (gyro ? spec.gyro : spec.accel).white.norm(); };
    double least = std::numeric_limits<double>::infinity();
    for (const KnownImu& imu : known) least = std::min(least, white(file.spec) / white(imu.spec));
    if (least <= kFar) continue;
    findings.push_back({Slip::kFarFromAll, true,
                        where(file.figures[i]) + " is " + k_text(least) +
                            " times the white noise of the noisiest IMU that is known: inflated on purpose, or in a "
                            "unit that is not this format's"});
  }
}

void find_inflated_biases(const LintReport& report, std::vector<LintFinding>& findings) {
  constexpr double kLarge = 3.0;
  if (report.reference < 0) return;
  const ImpliedScale& implied = report.implied[static_cast<std::size_t>(report.reference)];
  for (std::size_t i = 2; i < 4; ++i) {
    const NoiseFigure& figure = report.file.figures[i];
    const double k = figure.gyro ? implied.k.k_gb : implied.k.k_ab;
    if (k <= kLarge) continue;
    const char* const why = is_shipped_bias(figure) ? "the value that FAST-LIO2 and Point-LIO ship with"
                                                    : "inflated, as many filters are given it on purpose";
    findings.push_back(
        {Slip::kInflatedBias, false,
         where(figure) + ": " + symbol(figure) + " = " + k_text(k) + " against " + implied.name + ", " + why});
  }
}

}  // namespace

std::vector<KnownImu> load_known_imus(const std::vector<std::string>& search_dirs) {
  namespace fs = std::filesystem;
  std::vector<KnownImu> known;
  for (const std::string& dir : search_dirs) {
    std::error_code none;
    for (fs::directory_iterator at(dir + "/imu", none), end; !none && at != end; at.increment(none)) {
      const std::string stem = at->path().stem().string();
      if (at->path().extension() != ".yaml" || stem == "ideal" || stem == "pseudo_imu") continue;
      const std::string path = at->path().string();
      known.push_back({"imu/" + stem, read_noise_config(load_yaml(path, search_dirs), path).spec});
    }
  }
  std::sort(known.begin(), known.end(), [](const KnownImu& a, const KnownImu& b) { return a.name < b.name; });
  return known;
}

bool LintReport::suspicious() const {
  return std::any_of(findings.begin(), findings.end(), [](const LintFinding& finding) { return finding.suspicious; });
}

LintReport lint_noise(const NoiseFile& file, const std::vector<KnownImu>& known, const std::string& against) {
  LintReport report;
  report.file = file;
  report.known = known;
  for (std::size_t i = 0; i < known.size(); ++i) {
    report.implied.push_back(implied_by(file, known[i]));
    if (report.nearest < 0 ||
        report.implied[i].distance < report.implied[static_cast<std::size_t>(report.nearest)].distance)
      report.nearest = static_cast<int>(i);
    if (known[i].name == against) report.reference = static_cast<int>(i);
  }
  if (against.empty()) report.reference = report.nearest;
  if (!against.empty() && report.reference < 0) throw std::invalid_argument("'" + against + "' is not a known IMU");

  find_zeros(file, report.findings);
  if (find_defaults(report, !against.empty(), report.findings)) return report;
  const std::vector<LintFinding> white = find_white_slip(file, known);
  report.findings.insert(report.findings.end(), white.begin(), white.end());
  if (white.empty()) find_far(file, known, report.findings);
  const std::vector<LintFinding> bias = find_bias_slips(file, known);
  report.findings.insert(report.findings.end(), bias.begin(), bias.end());
  if (white.empty() && bias.empty()) find_inflated_biases(report, report.findings);
  return report;
}

}  // namespace allan_lio
