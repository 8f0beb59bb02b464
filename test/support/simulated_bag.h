// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {

/// 20 s of the rooms, made by simulate_bag when first asked for and removed at the process's end.
class SimulatedBag {
 public:
  static constexpr int kScans = 200, kImuSamples = 4001;

  static const SimulatedBag& get() {
    static const SimulatedBag bag;
    return bag;
  }
  std::string bag() const { return directory_.file("rooms.bag"); }
  std::string truth() const { return directory_.file("rooms.tum"); }

 private:
  SimulatedBag() {
    const Outcome made =
        run_tool("simulate_bag --scene rooms --imu mti600 --lidar velodyne16 --seed 1 --duration 20 --out " + bag());
    if (made.status != 0) throw std::runtime_error("simulate_bag failed: " + made.text);
  }

  TemporaryDirectory directory_;
};

/// lio_offline with the simulated robot's configuration.
inline Outcome run_lio_offline(const std::string& bag, const std::string& out, const std::string& more = "") {
  return run_tool("lio_offline --bag " + bag + " --config simulated --out " + out + " " + more);
}

}  // namespace allan_lio
