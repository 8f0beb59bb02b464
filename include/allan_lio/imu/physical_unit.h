// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace allan_lio {

/// A factor to SI with the exponents of length, time and angle. Angle counts as a dimension of its own, so that
/// deg/s cannot pass for 1/s. Square roots of square roots stay exact: exponents are binary fractions.
struct PhysicalUnit {
  double factor = 1.0;
  std::array<double, 3> exponents = {{0.0, 0.0, 0.0}};
};

/// Reads products, quotients, powers and square roots of rad, deg, dps, mdps, m, s, ms, us, min, h, hr, Hz,
/// g (9.80665 m/s^2), mg, ug, Gal and mGal. Blanks are ignored; the signs µ, √, ², · and ° are understood.
/// Throws std::invalid_argument with the reason if `text` is not such a unit.
PhysicalUnit parse_unit(const std::string& text);

}  // namespace allan_lio
