// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/lidar_effects.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace allan_lio {
namespace {

constexpr double kLeastCosine = 1e-3;  // the beam is in the surface; the spot has some end

void require(bool good, const char* name, const char* rule) {
  if (!good) throw std::invalid_argument(std::string("the LiDAR effect '") + name + "' " + rule);
}

}  // namespace

void check(const LidarEffects& e) {
  require(e.divergence >= 0 && e.divergence < 0.2, "divergence", "must lie between 0 and 0.2 rad");
  require(e.grazing >= 0 && std::isfinite(e.grazing), "grazing", "must not be negative");
  require(e.mixed_pixels >= 0 && e.mixed_pixels <= 1, "mixed_pixels", "is a share between 0 and 1");
  require(e.dropout_rate >= 0 && e.dropout_rate <= 1, "dropout_rate", "is a share between 0 and 1");
  require(e.dropout_range >= 0 && std::isfinite(e.dropout_range), "dropout_range", "must not be negative");
  require(e.intensity_range >= 0 && std::isfinite(e.intensity_range), "intensity_range", "must not be negative");
  require(e.quantization >= 0 && e.quantization < 1, "quantization", "must lie between 0 and 1 m");
  require(e.divergence > 0 || e.grazing == 0, "grazing", "needs a divergence");
  require(e.divergence > 0 || e.mixed_pixels == 0, "mixed_pixels", "needs a divergence");
}

double detection_probability(const LidarEffects& effects, double range, double cos_incidence) {
  const double seen = 1.0 - effects.dropout_rate;
  if (effects.dropout_range == 0) return seen;
  const double ratio = range / effects.dropout_range;
  return seen * std::exp(-ratio * ratio / std::max(cos_incidence, kLeastCosine));
}

double grazing_noise(const LidarEffects& effects, double range, double cos_incidence) {
  const double cosine = std::min(std::max(cos_incidence, kLeastCosine), 1.0);
  return effects.grazing * effects.divergence * range * std::sqrt(1.0 - cosine * cosine) / cosine;
}

double intensity_of(const LidarEffects& effects, double range, double cos_incidence) {
  const double intensity = 100.0 * cos_incidence;
  if (effects.intensity_range == 0 || range <= effects.intensity_range) return intensity;
  const double ratio = effects.intensity_range / range;
  return intensity * ratio * ratio;
}

double quantized_range(const LidarEffects& effects, double range) {
  return effects.quantization > 0 ? effects.quantization * std::round(range / effects.quantization) : range;
}

}  // namespace allan_lio
