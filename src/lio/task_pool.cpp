// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/task_pool.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace allan_lio {

class TaskPool::Arena {
 public:
  explicit Arena(int threads) : arena_(threads) {}

  template <class Body>
  void run(std::size_t blocks, const Body& body) {
    arena_.execute([&] { tbb::parallel_for(std::size_t{0}, blocks, body); });
  }

 private:
  tbb::task_arena arena_;
};

TaskPool::TaskPool(int threads) : arena_(threads > 1 ? std::make_unique<Arena>(threads) : nullptr) {}

TaskPool::~TaskPool() = default;

void TaskPool::run(std::size_t count, const std::function<void(std::size_t, std::size_t, std::size_t)>& work) {
  const auto body = [&](std::size_t block) { work(block, block * kBlock, std::min(count, (block + 1) * kBlock)); };
  if (arena_) {
    arena_->run(blocks(count), body);
    return;
  }
  for (std::size_t block = 0; block < blocks(count); ++block) body(block);
}

}  // namespace allan_lio
