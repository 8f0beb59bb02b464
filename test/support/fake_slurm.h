// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "temporary_directory.h"

namespace allan_lio {

/// An environment variable for as long as this lives.
class ScopedVariable {
 public:
  ScopedVariable(const std::string& name, const std::string& value) : name_(name) {
    const char* before = getenv(name.c_str());
    if (before != nullptr) before_ = before;
    was_set_ = before != nullptr;
    setenv(name.c_str(), value.c_str(), 1);
  }
  ~ScopedVariable() {
    if (was_set_) {
      setenv(name_.c_str(), before_.c_str(), 1);
    } else {
      unsetenv(name_.c_str());
    }
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  std::string name_, before_;
  bool was_set_ = false;
};

/// sbatch, squeue and scancel as shell scripts in front of PATH, which run tasks in the background. Their state is
/// files: queue/N while task N is in the queue, holding its reason; calls, the commands' lines as they came; and what
/// a test may put there: lose_N, task N gets lost once; hold_N, it is held once; sbatch_fails, squeue_fails.
class FakeSlurm {
 public:
  FakeSlurm() {
    std::filesystem::create_directories(state("queue"));
    std::filesystem::create_directories(state("bin"));
    write("sbatch", kSbatch);
    write("squeue", kSqueue);
    write("scancel", kScancel);
  }

  std::string state(const std::string& name) const { return directory_.file(name); }
  void set(const std::string& name) const { std::ofstream(state(name)).put('\n'); }
  bool has(const std::string& name) const { return std::filesystem::exists(state(name)); }

 private:
  static constexpr const char* kSbatch = R"sh(
echo "sbatch $*" >>$F/calls
if [ -e $F/sbatch_fails ]; then echo "sbatch: error: invalid partition specified: moon" >&2; exit 1; fi
for a; do case $a in --array=*) array=${a#*=};; --output=*) log=${a#*=};; esac; script=$a; done
for range in $(echo $array | tr , ' '); do
  for n in $(seq ${range%-*} ${range#*-}); do
    if [ -e $F/lose_$n ]; then rm $F/lose_$n; continue; fi
    if [ -e $F/hold_$n ]; then rm $F/hold_$n; echo "launch failed requeued held" >$F/queue/$n; continue; fi
    echo None >$F/queue/$n
    (
      SLURM_ARRAY_TASK_ID=$n sh "$script" >"$(echo "$log" | sed "s/%a/$n/")" 2>&1
      rm -f $F/queue/$n
    ) >/dev/null 2>&1 &
  done
done
echo "sbatch: a warning" >&2
echo 77
)sh";
  static constexpr const char* kSqueue = R"sh(
if [ -e $F/squeue_fails ]; then echo "slurm_load_jobs error: Unable to contact slurm controller" >&2; exit 1; fi
cd $F/queue
for n in *; do [ -e $n ] && echo "task $n 10_$n $(cat $n)"; done
echo "squeue: a warning" >&2
exit 0
)sh";
  static constexpr const char* kScancel = R"sh(
echo "scancel $*" >>$F/calls
case $1 in --name=*) touch $F/cancelled; rm -f $F/queue/*;; 10_*) rm -f $F/queue/${1#10_};; esac
)sh";

  void write(const std::string& name, const std::string& body) const {
    const std::string path = state("bin/" + name);
    std::ofstream(path) << "#!/bin/sh\nF=" << directory_.path() << body;
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }

  TemporaryDirectory directory_;
  ScopedVariable path_{"PATH", directory_.file("bin") + ":" + getenv("PATH")};
};

}  // namespace allan_lio
