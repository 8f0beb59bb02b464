// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace allan_lio {

/// What a real LiDAR does to a range besides its white noise. Zero switches an effect off, and every effect draws
/// from a random stream of its own, so that one does not change the values of another.
struct LidarEffects {
  double divergence = 0.0;  ///< full opening angle of the beam [rad]
  /// At grazing incidence the beam's spot is long, and the range is that of some place on it: noise of 1 sigma
  /// grazing * divergence * range * tan(incidence). 0.25 is the spot of a Gaussian beam whose divergence is told to
  /// 1/e^2.
  double grazing = 0.0;
  /// Share of the beams split by an edge whose range lies between the two surfaces, evenly distributed; the others
  /// return the surface on their axis.
  double mixed_pixels = 0.0;
  double dropout_rate = 0.0;  ///< share of the returns that are lost whatever they met
  /// A return of range r and incidence a is seen with probability exp(-(r/dropout_range)^2 / cos a): a fixed threshold
  /// under the exponentially distributed echo of a rough surface (speckle) that falls with r^2 and the cosine [m].
  double dropout_range = 0.0;
  double intensity_range = 0.0;  ///< beyond it the intensity falls with the range squared, too [m]
  double quantization = 0.0;     ///< ranges are multiples of it [m]

  /// A beam is split by an edge where its off-axis ray meets something this far off the surface on its axis [m].
  static constexpr double kEdgeStep = 0.1;
};

/// Throws std::invalid_argument for a negative number, a share above 1, or an effect that needs a divergence without
/// one.
void check(const LidarEffects& effects);

/// Probability that a return is seen.
double detection_probability(const LidarEffects& effects, double range, double cos_incidence);

/// 1 sigma of the range noise that grazing incidence adds [m].
double grazing_noise(const LidarEffects& effects, double range, double cos_incidence);

/// 100 at perpendicular incidence within intensity_range.
double intensity_of(const LidarEffects& effects, double range, double cos_incidence);

/// The nearest multiple of the quantum.
double quantized_range(const LidarEffects& effects, double range);

}  // namespace allan_lio
