// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace allan_lio {

/// Runs work by blocks of a fixed size on some threads. What a block computes must not depend on the others, so
/// that sums taken block by block in order are the same for any number of threads.
class TaskPool {
 public:
  static constexpr std::size_t kBlock = 256;

  explicit TaskPool(int threads);
  ~TaskPool();

  static std::size_t blocks(std::size_t count) { return (count + kBlock - 1) / kBlock; }

  /// Calls work(block, begin, end) for every block of [0, count).
  void run(std::size_t count, const std::function<void(std::size_t, std::size_t, std::size_t)>& work);

 private:
  class Arena;
  std::unique_ptr<Arena> arena_;  ///< null for one thread
};

}  // namespace allan_lio
