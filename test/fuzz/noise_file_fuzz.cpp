// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Noise files of kalibr, imu_utils and the others. First byte: whose it is, or that it is to be told by the keys, and
// whether the rate is known.
#include <cmath>

#include "allan_lio/io/imu_yaml.h"
#include "allan_lio/io/noise_lint.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  FuzzInput input(data, size);
  const std::uint8_t choices = input.take<std::uint8_t>(), choice = choices % 12;
  const double rate = choices / 12 % 2 == 0 ? 200.0 : 0.0;
  const std::string text = input.text();
  try {
    const NoiseFormat format = choice < 10 ? static_cast<NoiseFormat>(choice) : detect_noise_format(text, "fuzz.yaml");
    const NoiseFile file = read_noise_file(text, "fuzz.yaml", format, rate);
    for (const NoiseFigure& figure : file.figures) must(figure.value.allFinite() && figure.value.minCoeff() >= 0.0);
    lint_noise(file, {});
    std::vector<std::string> notes;
    for (int to = 0; to < 10; ++to) {
      try {
        write_noise(file.spec, static_cast<NoiseFormat>(to), {file.rate, 100.0}, &notes);
      } catch (const ConfigError& error) {
        must(*error.what() != '\0');
      }
    }
  } catch (const ConfigError& error) {
    must(*error.what() != '\0');
  }
  return 0;
}
