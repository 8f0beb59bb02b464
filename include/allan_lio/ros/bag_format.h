// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// The parts of a bag of format 2.0 (http://wiki.ros.org/Bags/Format/2.0) that the readers without an index share.
namespace bag_format {

constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr std::size_t kMagicLength = sizeof kMagic - 1;
constexpr std::uint32_t kLongestHeader = 1U << 24U;  ///< a record's header is some hundred bytes
constexpr std::uint32_t kLargestChunk = 1U << 30U;   ///< rosbag's chunks are 768 kB and one message

enum Op : char { kMessageOp = 2, kBagHeaderOp = 3, kChunkOp = 5, kConnectionOp = 7 };

/// Little endian, as bags are.
template <class T>
T load_number(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The value of a field of a record's header.
struct Field {
  const char* data = nullptr;  ///< null: there is no such field
  std::size_t size = 0;        ///< [bytes]

  std::string text() const { return data == nullptr ? "" : std::string(data, size); }
  /// False, and `value` as it was, if there is no such field or it is not of this size.
  template <class T>
  bool get(T* value) const {
    if (data == nullptr || size != sizeof(T)) return false;
    *value = load_number<T>(data);
    return true;
  }
};

/// In a header of `size` bytes, "length name=value" in a row.
Field find_field(const char* header, std::size_t size, const char* name);
Field find_field(const std::string& header, const char* name);

/// What kind of record it is; 0 if its header does not say.
char op_of(const char* header, std::size_t size);

/// A connection by its record: the header, and the data, which are another header.
std::shared_ptr<BagConnection> read_connection(const char* header, std::size_t header_size, const char* data,
                                               std::size_t size);

/// Unpacks a chunk that is compressed by bz2 or lz4 into `bytes`: as much as can be unpacked, and at most `size`. True
/// if that is all of `size` and the packed data end there. Memory follows what is there, not what `size` announces.
bool unpack_chunk(const std::string& compression, std::vector<char>& packed, std::size_t size,
                  std::vector<char>& bytes);

}  // namespace bag_format
}  // namespace allan_lio
