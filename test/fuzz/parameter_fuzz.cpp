// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// "key=value" as it comes after --param.
#include "allan_lio/io/config_source.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  static const ConfigSource base = to_source(default_config([] {
    NoiseSpec spec;
    for (SensorNoise* sensor : {&spec.gyro, &spec.accel}) {
      sensor->white.setConstant(1e-3);
      sensor->bias_instability.setConstant(1e-4);
      sensor->bias_time.setConstant(100.0);
      sensor->turn_on_bias.setConstant(1e-2);
    }
    return spec;
  }()));
  try {
    const ConfigSource override = parse_override(FuzzInput(data, size).text());
    for (const auto& entry : override)
      if (base.count(entry.first) == 0) return 0;  // that unknown keys are refused is config_fuzz's; it takes long
    const LioConfig config = read_config(merge(base, override));
    must(config_hash(config) == config_hash(read_config(to_source(config))));
  } catch (const ConfigError& error) {
    must(*error.what() != '\0');
  }
  return 0;
}
