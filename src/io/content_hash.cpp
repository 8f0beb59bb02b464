// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/content_hash.h"

#include <dlfcn.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace allan_lio {

std::string hash_text(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a, 64 bits
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(hash >> shift) & 15];
  return digits;
}

std::string build_hash() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&build_hash), &info) == 0 || info.dli_fname == nullptr)
    throw std::runtime_error("the file that the program was loaded from cannot be told");
  std::ifstream in(info.dli_fname, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in || bytes.str().empty()) throw std::runtime_error(std::string(info.dli_fname) + ": cannot be read");
  return hash_text(bytes.str());
}

}  // namespace allan_lio
