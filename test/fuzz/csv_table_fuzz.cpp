// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// states.csv and its like.
#include <cmath>
#include <stdexcept>

#include "allan_lio/io/csv_table.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  const MemoryFile file(data, size);
  try {
    const CsvTable table(file.path());
    must(table.rows() > 0 && table.stamps().size() == table.rows());
    for (const std::string& name : table.names_with("")) {
      must(table.numbers_or_nan(name).size() == table.rows());
      for (const double number : table.numbers(name)) must(std::isfinite(number));
    }
  } catch (const std::runtime_error& error) {
    must(*error.what() != '\0');
  }
  return 0;
}
