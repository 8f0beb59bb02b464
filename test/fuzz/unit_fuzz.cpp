// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The text of a unit, for the dimension that its bytes add up to.
#include <cmath>
#include <numeric>

#include "allan_lio/imu/noise_units.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  const std::string text = FuzzInput(data, size).text();
  constexpr unsigned kDimensions = static_cast<unsigned>(Dimension::kFrequency) + 1;
  const auto dimension = static_cast<Dimension>(std::accumulate(data, data + size, 0U) % kDimensions);
  const UnitConversion conversion = convert_unit(text, dimension);
  must(!conversion.ok() || (std::isfinite(conversion.to_si) && conversion.to_si > 0.0));
  const NoiseForm form = convert_noise_unit(text, dimension);
  must(!form.ok() || (std::isfinite(form.to_si) && form.to_si > 0.0));
  return 0;
}
