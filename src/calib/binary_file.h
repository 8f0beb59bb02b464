// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "number_hash.h"

namespace allan_lio {

/// Numbers one after the other, as they lie in memory: the format's word at the beginning tells a machine of the other
/// byte order. The file is there in one piece when finish() returns, or not at all.
class BinaryWriter {
 public:
  BinaryWriter(std::string path, std::uint64_t format)
      : path_(std::move(path)), part_(path_ + ".part" + std::to_string(getpid())), out_(part_, std::ios::binary) {
    number(format);
  }
  ~BinaryWriter() {
    if (!finished_) std::remove(part_.c_str());
  }
  BinaryWriter(const BinaryWriter&) = delete;
  BinaryWriter& operator=(const BinaryWriter&) = delete;

  template <class T>
  void number(const T& value) {
    static_assert(std::is_arithmetic<T>::value, "a number");
    out_.write(reinterpret_cast<const char*>(&value), sizeof value);
    sum_.add(value);
  }
  template <class Items, class OnItem>
  void each(const Items& items, const OnItem& on_item, std::uint64_t /*least*/ = 1) {
    number(static_cast<std::uint64_t>(items.size()));
    for (const auto& item : items) on_item(item);
  }
  /// Of all that was written before.
  void checksum() { number(std::uint64_t{sum_.value()}); }

  /// Throws std::runtime_error naming the file if it cannot be written.
  void finish() {
    out_.close();
    if (!out_ || std::rename(part_.c_str(), path_.c_str()) != 0)
      throw std::runtime_error(path_ + ": cannot be written");
    finished_ = true;
  }

 private:
  const std::string path_, part_;
  std::ofstream out_;
  NumberHash sum_;
  bool finished_ = false;
};

/// What a BinaryWriter wrote. Throws std::runtime_error naming the file, and what is wrong with it.
class BinaryReader {
 public:
  BinaryReader(std::string path, std::uint64_t format, const char* what)
      : path_(std::move(path)), in_(path_, std::ios::binary | std::ios::ate) {
    if (!in_) throw std::runtime_error(path_ + ": cannot be opened");
    left_ = static_cast<std::uint64_t>(in_.tellg());
    in_.seekg(0);
    std::uint64_t found = 0;
    number(found);
    if (found != format) throw std::runtime_error(path_ + ": is not " + what + " of this version");
  }

  template <class T>
  void number(T& value) {
    static_assert(std::is_arithmetic<T>::value, "a number");
    if (left_ < sizeof value || !in_.read(reinterpret_cast<char*>(&value), sizeof value)) fail("is cut off");
    left_ -= sizeof value;
    sum_.add(value);
  }
  /// No memory is asked for what is not there: an item takes `least` bytes in the file.
  template <class Items, class OnItem>
  void each(Items& items, const OnItem& on_item, std::uint64_t least = 1) {
    std::uint64_t size = 0;
    number(size);
    if (size > left_ / least) fail("is damaged");
    items.resize(size);
    for (auto& item : items) on_item(item);
  }
  void checksum() {
    const std::uint64_t expected = sum_.value();
    std::uint64_t found = 0;
    number(found);
    if (found != expected) fail("is damaged");
  }
  void end() const {
    if (left_ != 0) fail("goes on after its end");
  }
  [[noreturn]] void fail(const char* what) const { throw std::runtime_error(path_ + ": " + what); }

 private:
  const std::string path_;
  std::ifstream in_;
  NumberHash sum_;
  std::uint64_t left_ = 0;
};

}  // namespace allan_lio
