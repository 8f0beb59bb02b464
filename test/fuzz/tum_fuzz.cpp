// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A trajectory. What is read must print to a text that is read to the same stamps.
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "allan_lio/io/tum.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  Trajectory trajectory;
  try {
    std::istringstream in(FuzzInput(data, size).text());
    trajectory = read_tum(in, "fuzz.tum");
  } catch (const std::runtime_error& error) {
    must(*error.what() != '\0');
    return 0;
  }
  must(!trajectory.empty());
  std::string text;
  for (const StampedPose& pose : trajectory) {
    must(std::abs(pose.pose.rotation.norm() - 1.0) < 1e-9 && pose.pose.translation.allFinite());
    text += format_tum_line(pose) + '\n';
  }
  std::istringstream in(text);
  const Trajectory again = read_tum(in, "printed.tum");
  must(again.size() == trajectory.size());
  for (std::size_t i = 0; i < again.size(); ++i) must(again[i].stamp == trajectory[i].stamp);
  return 0;
}
