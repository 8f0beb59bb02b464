// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// For tests in other languages: mutate_bag FROM TO FAULT... writes the bag anew with these faults.
#include <cstdio>
#include <exception>

#include "bag_mutator.h"

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: mutate_bag FROM TO FAULT...\n");
    return 2;
  }
  try {
    std::vector<allan_lio::Mutation> faults;
    for (int i = 3; i < argc; ++i) faults.push_back(allan_lio::fault_by_name(argv[i]));
    allan_lio::mutate_bag(argv[1], argv[2], faults);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mutate_bag: %s\n", error.what());
    return 1;
  }
  return 0;
}
