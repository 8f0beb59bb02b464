// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allocation_count.h"

// The sanitizers have an operator new of their own, and compare it with the operator delete that is called.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

namespace allan_lio {
std::optional<std::size_t> bytes_allocated() { return std::nullopt; }
}  // namespace allan_lio

#else

#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t allocated = 0;
}

namespace allan_lio {
std::optional<std::size_t> bytes_allocated() { return allocated; }
}  // namespace allan_lio

// The library's other forms without an alignment call these.
void* operator new(std::size_t size) {
  allocated += size;
  if (void* const memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

#endif
