// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A robot's configuration. What is accepted must print to a text that is read to the same.
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/yaml_source.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  const std::string text = FuzzInput(data, size).text();
  std::string printed;
  try {
    printed = print_config(read_config(parse_yaml(text, "fuzz.yaml")));
  } catch (const ConfigError& error) {
    must(*error.what() != '\0');
    return 0;
  }
  must(print_config(read_config(parse_yaml(printed, "printed.yaml"))) == printed);
  return 0;
}
