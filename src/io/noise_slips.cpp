// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "noise_slips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace allan_lio {
namespace {

constexpr double kDegPerRad = 57.295779513082320876798;
constexpr double kStandardGravity = 9.80665;  // [m/s^2]

// How near is near, as factors. The IMUs that are known lie within a decade of each other, so a slip is believed only
// if it explains the file closely, and much better than the file as it stands: by the first pair, or, where what comes
// out is not quite one of the known, by the second; where both figures come out as those of one IMU, the third will
// do. A slip in one figure alone has more ways to fit by chance.
constexpr double kCloseBoth = 1.8, kCloseOne = 1.5, kBetter = 2.0;
constexpr double kNear = 2.2, kMuchBetter = 4.0;
constexpr double kExact = 1.1, kLittleBetter = 1.5;

/// The two amplitudes of white noise [rad/s/sqrt(Hz), m/s^2/sqrt(Hz)], the axes averaged in S.
struct Whites {
  double gyro;
  double accel;
};

double mean_axes(const Eigen::Vector3d& v) { return std::sqrt(v.squaredNorm() / 3.0); }

Whites whites_of(const NoiseSpec& spec) { return {mean_axes(spec.gyro.white), mean_axes(spec.accel.white)}; }

/// By which factor the worse of the two is off.
double misfit(const Whites& a, const Whites& b) {
  return std::exp(std::max(std::abs(std::log(a.gyro / b.gyro)), std::abs(std::log(a.accel / b.accel))));
}

struct Nearest {
  const KnownImu* imu = nullptr;
  double misfit = std::numeric_limits<double>::infinity();
};

Nearest nearest(const Whites& whites, const std::vector<KnownImu>& known) {
  Nearest best;
  for (const KnownImu& imu : known) {
    const double off = misfit(whites, whites_of(imu.spec));
    if (off < best.misfit) best = {&imu, off};
  }
  return best;
}

struct Hypothesis {
  Slip slip;
  bool gyro;          ///< touches the gyro's figure
  bool accel;         ///< touches the accelerometer's
  Whites undone;      ///< what the file would mean without the slip
  const char* looks;  ///< "looks like ..."
};

/// Sigma or density pasted for a covariance: with c as read, N = sqrt(c/rate).
void add_covariance_slips(const Whites& read, double rate, std::vector<Hypothesis>& list) {
  const Whites c = {read.gyro * read.gyro * rate, read.accel * read.accel * rate};
  const double root = std::sqrt(rate);
  const struct {
    Slip slip;
    Whites undone;
    const char* looks;
  } slips[] = {
      {Slip::kSigmaForVariance, {c.gyro / root, c.accel / root}, "a standard deviation where its square belongs"},
      {Slip::kDensityForVariance, c, "a density (N) where the covariance of samples (N^2 rate) belongs"}};
  for (const auto& s : slips) {
    list.push_back({s.slip, true, true, s.undone, s.looks});
    list.push_back({s.slip, true, false, {s.undone.gyro, read.accel}, s.looks});
    list.push_back({s.slip, false, true, {read.gyro, s.undone.accel}, s.looks});
  }
}

/// A figure in a typed unit cannot have a root of the rate too much.
void add_rate_slips(const NoiseFile& file, const Whites& read, std::vector<Hypothesis>& list) {
  if (!(file.rate > 0.0) || file.format == NoiseFormat::kAllanLio || file.format == NoiseFormat::kKfGins) return;
  const double root = std::sqrt(file.rate);
  if (is_discrete(file.figures[0].kind)) {
    list.push_back({Slip::kRootRateTooLittle,
                    true,
                    true,
                    {read.gyro * root, read.accel * root},
                    "the figure at 1 s, with a root of the rate too little"});
    return;
  }
  const char* const looks = "the deviation of single samples, a root of the rate too much for a density";
  list.push_back({Slip::kRootRateTooMuch, true, true, {read.gyro / root, read.accel / root}, looks});
  list.push_back({Slip::kRootRateTooMuch, true, false, {read.gyro / root, read.accel}, looks});
  list.push_back({Slip::kRootRateTooMuch, false, true, {read.gyro, read.accel / root}, looks});
}

/// KF-GINS' figures are in degrees by its own rule.
std::vector<Hypothesis> hypotheses(const NoiseFile& file, const Whites& read) {
  std::vector<Hypothesis> list;
  const Whites degrees = {read.gyro / kDegPerRad, read.accel}, gravities = {read.gyro, read.accel * kStandardGravity};
  if (file.format != NoiseFormat::kKfGins)
    list.push_back({Slip::kDegrees, true, false, degrees, "degrees for radians"});
  list.push_back({Slip::kGravities, false, true, gravities, "g for m/s^2"});
  list.push_back({Slip::kSwapped, true, true, {read.accel, read.gyro}, "gyro and accelerometer swapped"});
  add_rate_slips(file, read, list);
  if (file.figures[0].kind == FigureKind::kSampleVariance) add_covariance_slips(read, file.rate, list);
  return list;
}

bool believed(const Hypothesis& hypothesis, double undone, double stands) {
  const bool both = hypothesis.gyro && hypothesis.accel;
  const double close = both ? kCloseBoth : kCloseOne;
  if (both && undone <= kExact && stands >= kLittleBetter * undone) return true;
  if (undone <= close && stands >= kBetter * undone) return true;
  return undone <= kNear && stands >= kMuchBetter * undone;
}

std::string where(const NoiseFigure& figure) { return figure.key + " (" + figure.origin + ")"; }

std::string told(const NoiseFigure& figure, double read, double undone, double known, const std::string& name) {
  const std::string unit = figure.gyro ? " rad/s/sqrt(Hz)" : " m/s^2/sqrt(Hz)", k = figure.gyro ? "k_g" : "k_a";
  return where(figure) + ": undone it is " + short_text(undone) + unit + ", " + k + " = " + k_text(undone / known) +
         " against " + name + "; as it stands " + short_text(read) + unit + ", " + k + " = " + k_text(read / known);
}

std::string sentence(const Hypothesis& h, const NoiseFile& file, const Whites& read, const KnownImu& imu) {
  const Whites known = whites_of(imu.spec);
  std::string text = std::string("looks like ") + h.looks;
  const char* separator = ": ";
  if (h.gyro) {
    text += separator + told(file.figures[0], read.gyro, h.undone.gyro, known.gyro, imu.name);
    separator = "; ";
  }
  if (h.accel) text += separator + told(file.figures[1], read.accel, h.undone.accel, known.accel, imu.name);
  return text + ". Look at the bias figures as well";
}

// --- the bias ---

/// What a slip in a bias figure would make of the random walk K that is `read`.
struct BiasHypothesis {
  Slip slip;
  double undone;  ///< K [u/s/sqrt(Hz)]
  double within;  ///< factor
  const char* looks;
};

std::vector<BiasHypothesis> bias_hypotheses(const NoiseFigure& figure, double read, double rate,
                                            const SensorNoise& known) {
  constexpr double kTight = 1.15, kLoose = 1.3;
  std::vector<BiasHypothesis> list;
  const double known_walk = std::sqrt(bias_psd(known).mean());
  // The known IMU's ratio of K and sigma_b: what a sigma_b of the file would mean.
  const double per_level = bias_kind(known) == BiasKind::kAllan ? known_walk / mean_axes(known.bias_instability) : 0.0;
  if (figure.kind == FigureKind::kRandomWalk && per_level > 0.0)
    list.push_back(
        {Slip::kLevelForRandomWalk, read * per_level, kTight, "the bias instability in the slot of the random walk"});
  if (figure.kind == FigureKind::kRandomWalk && figure.gyro)
    list.push_back({Slip::kDegrees, read / kDegPerRad, kLoose, "degrees for radians"});
  if (figure.kind == FigureKind::kBiasVariance) {
    const double c = read * read * rate;
    list.push_back(
        {Slip::kSigmaForVariance, c / std::sqrt(rate), kLoose, "a standard deviation where its square belongs"});
    list.push_back({Slip::kDensityForVariance, c, kLoose,
                    "the random walk (K) where the covariance of samples (K^2 rate) belongs"});
    if (per_level > 0.0)
      list.push_back(
          {Slip::kLevelForRandomWalk, c * per_level, kTight, "the bias instability where a covariance belongs"});
  }
  return list;
}

}  // namespace

bool is_shipped_bias(const NoiseFigure& figure) {
  return figure.kind == FigureKind::kBiasVariance && (figure.value.array() == 1e-4).all();
}

std::string short_text(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(4);
  out << value;
  return out.str();
}

std::string k_text(double k) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  if (k >= 20.0 && k < 1e6) {
    out << std::llround(k);
  } else {
    out.precision(3);
    out << k;
  }
  return out.str();
}

NoiseSpec with_bias_time_of(NoiseSpec spec, const NoiseSpec& known) {
  const auto fill = [](SensorNoise& sensor, const SensorNoise& from) {
    if (bias_kind(sensor) == BiasKind::kRandomWalk) return;
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(sensor.bias_time[axis])) sensor.bias_time[axis] = from.bias_time[axis];
  };
  fill(spec.gyro, known.gyro);
  fill(spec.accel, known.accel);
  return spec;
}

std::vector<LintFinding> find_white_slip(const NoiseFile& file, const std::vector<KnownImu>& known) {
  const Whites read = whites_of(file.spec);
  if (known.empty() || !(read.gyro > 0.0 && read.accel > 0.0)) return {};
  const double stands = nearest(read, known).misfit;
  std::vector<LintFinding> found;
  double best = std::numeric_limits<double>::infinity();
  for (const Hypothesis& hypothesis : hypotheses(file, read)) {
    const Nearest near = nearest(hypothesis.undone, known);
    if (near.misfit >= best || !believed(hypothesis, near.misfit, stands)) continue;
    best = near.misfit;
    found = {{hypothesis.slip, true, sentence(hypothesis, file, read, *near.imu)}};
  }
  return found;
}

std::vector<LintFinding> find_bias_slips(const NoiseFile& file, const std::vector<KnownImu>& known) {
  const Whites read = whites_of(file.spec);
  std::vector<LintFinding> findings;
  if (known.empty() || !(read.gyro > 0.0 && read.accel > 0.0)) return findings;
  const Nearest near = nearest(read, known);
  if (near.misfit > kCloseOne) return findings;
  for (std::size_t i = 2; i < 4; ++i) {
    const NoiseFigure& figure = file.figures[i];
    const SensorNoise& imu = figure.gyro ? near.imu->spec.gyro : near.imu->spec.accel;
    const double walk = std::sqrt(bias_psd(figure.gyro ? file.spec.gyro : file.spec.accel).mean());
    const double expected = std::sqrt(bias_psd(imu).mean());
    if (!(walk > 0.0 && expected > 0.0) || is_shipped_bias(figure)) continue;
    for (const BiasHypothesis& h : bias_hypotheses(figure, walk, file.rate, imu)) {
      if (std::max(h.undone / expected, expected / h.undone) > h.within) continue;
      const std::string k = figure.gyro ? "k_gb" : "k_ab";
      findings.push_back({h.slip, true,
                          where(figure) + " looks like " + h.looks + ": undone " + k + " = " +
                              k_text(h.undone / expected) + " against " + near.imu->name +
                              ", whose white noise the file has; as it stands " + k + " = " + k_text(walk / expected)});
      break;
    }
  }
  return findings;
}

}  // namespace allan_lio
