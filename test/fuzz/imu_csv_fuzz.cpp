// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A table of IMU readings. First byte: which of the options.
#include <exception>

#include "allan_lio/io/imu_csv.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  FuzzInput input(data, size);
  const std::uint8_t choice = input.take<std::uint8_t>();
  constexpr const char* kUnits[] = {"", "s", "ms", "us", "ns"};
  ImuCsvOptions options;
  options.ignore_time = (choice & 1U) != 0;
  options.time_unit = kUnits[(choice >> 1U) % 5];
  const MemoryFile file(input.data(), input.size());
  try {
    ImuCsvReader reader(file.path(), options);
    ImuSample sample;
    std::size_t rows = 0;
    while (reader.next(sample)) must(++rows <= input.size());
  } catch (const std::runtime_error& error) {
    must(*error.what() != '\0');
  }
  return 0;
}
