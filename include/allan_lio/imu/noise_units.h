// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/parameter_visitor.h"

namespace allan_lio {

/// What a unit's text means: `value * to_si` is in si_unit(dimension); or a sentence that says why it is refused.
struct UnitConversion {
  double to_si = 0.0;
  std::string error;  ///< empty: accepted

  bool ok() const { return error.empty(); }
};

/// Reads a unit such as `deg/sqrt(h)`, `ug/sqrt(Hz)` or `m/s^2` (physical_unit.h says what is understood). A unit
/// of another dimension than the one wanted is an error that names both, since that is the slip that costs most:
/// bias instability where white noise is wanted, or a variance for a deviation.
UnitConversion convert_unit(const std::string& text, Dimension wanted);

/// How a figure of white noise or of a random walk becomes a density.
struct NoiseForm {
  double to_si = 0.0;
  bool squared = false;     ///< a PSD or a covariance
  bool of_samples = false;  ///< of single samples: a rate is needed (paper, `Qk_with_S`: S = Q_d dt)
  std::string error;        ///< empty: accepted

  bool ok() const { return error.empty(); }
  /// The density in SI; `rate` [Hz] is not looked at unless of_samples.
  double apply(double value, double rate) const;
};

/// Reads the unit of a noise figure: for white noise of a gyro `rad/s/sqrt(Hz)` and its like (the density itself),
/// `(rad/s)^2/Hz` (PSD), `rad/s` (standard deviation of single samples) and `(rad/s)^2` (their covariance); the unit
/// tells them apart. Dimensions without such forms are as in convert_unit().
NoiseForm convert_noise_unit(const std::string& text, Dimension wanted);

/// The SI unit as convert_unit() reads it, with the factor exactly 1.
std::string si_unit(Dimension dimension);

/// The usual units of the dimension, the SI unit first.
std::vector<std::string> usual_units(Dimension dimension);

/// "a gyro's white noise (angle random walk)" and so on.
std::string describe(Dimension dimension);

}  // namespace allan_lio
