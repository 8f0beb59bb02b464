// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "fake_slurm.h"
#include "temporary_directory.h"

namespace allan_lio {

/// A real Slurm of one node on this machine, without privileges, on ports and in a directory of its own. While it lives
/// Slurm's commands talk to it (SLURM_CONF). Its daemons end with it, and with the test if that crashes.
class SlurmCluster {
 public:
  /// Whether slurmctld and slurmd are installed.
  static bool installed();

  /// Throws std::runtime_error with the daemons' logs if the node does not come up.
  SlurmCluster();
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

 private:
  void write_configuration() const;
  void start(const std::vector<std::string>& command, const std::string& log);
  void wait_for_node() const;
  void stop();

  TemporaryDirectory directory_;
  std::unique_ptr<ScopedVariable> conf_, path_;
  std::vector<pid_t> daemons_;
};

}  // namespace allan_lio
