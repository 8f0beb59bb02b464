// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_format.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>

namespace allan_lio {
namespace bag_format {
namespace {

constexpr std::size_t kLz4Ratio = 255;    // of a block at most: a byte of a match's length stands for 255
constexpr std::size_t kBz2Ratio = 16;     // of the first guess; of noughts it can be a million
constexpr std::size_t kSmallest = 65536;  // [bytes]

bool unpack_bz2(std::vector<char>& packed, std::size_t size, std::vector<char>& bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  stream.next_in = packed.data();
  stream.avail_in = static_cast<unsigned>(packed.size());
  bytes.resize(std::min(size, kSmallest + kBz2Ratio * packed.size()));
  std::size_t done = 0;
  int result = BZ_OK;
  for (bool goes_on = true; goes_on;) {
    if (done == bytes.size()) bytes.resize(std::min(size, 2 * done));
    const unsigned in = stream.avail_in, out = static_cast<unsigned>(bytes.size() - done);
    stream.next_out = bytes.data() + done;
    stream.avail_out = out;
    result = BZ2_bzDecompress(&stream);
    done += out - stream.avail_out;
    goes_on = result == BZ_OK && stream.avail_in + stream.avail_out < in + out;
  }
  BZ2_bzDecompressEnd(&stream);
  bytes.resize(done);
  return result == BZ_STREAM_END && done == size;
}

bool unpack_lz4(std::vector<char>& packed, std::size_t size, std::vector<char>& bytes) {
  roslz4_stream stream{};
  if (roslz4_decompressStart(&stream) != ROSLZ4_OK) return false;
  const std::size_t room = std::min(size, kLz4Ratio * packed.size());
  bytes.resize(room);
  stream.input_next = packed.data();
  stream.input_left = static_cast<int>(packed.size());
  stream.output_next = bytes.data();
  stream.output_left = static_cast<int>(room);
  int before = 0, result = ROSLZ4_OK;
  do {
    before = stream.input_left + stream.output_left;
    result = roslz4_decompress(&stream);
  } while (result == ROSLZ4_OK && stream.input_left + stream.output_left < before);
  bytes.resize(room - static_cast<std::size_t>(stream.output_left));
  roslz4_decompressEnd(&stream);
  return result == ROSLZ4_STREAM_END && bytes.size() == size;
}

}  // namespace

Field find_field(const char* header, std::size_t size, const char* name) {
  const std::size_t name_length = std::strlen(name);
  for (std::size_t at = 0; size - at >= 4;) {
    const std::size_t length = load_number<std::uint32_t>(header + at);
    at += 4;
    if (length > size - at) break;
    if (length > name_length && header[at + name_length] == '=' && std::memcmp(header + at, name, name_length) == 0)
      return {header + at + name_length + 1, length - name_length - 1};
    at += length;
  }
  return {};
}

Field find_field(const std::string& header, const char* name) { return find_field(header.data(), header.size(), name); }

char op_of(const char* header, std::size_t size) {
  char op = 0;
  find_field(header, size, "op").get(&op);
  return op;
}

std::shared_ptr<BagConnection> read_connection(const char* header, std::size_t header_size, const char* data,
                                               std::size_t size) {
  auto connection = std::make_shared<BagConnection>();
  connection->topic = find_field(header, header_size, "topic").text();
  connection->datatype = find_field(data, size, "type").text();
  connection->md5sum = find_field(data, size, "md5sum").text();
  connection->definition = find_field(data, size, "message_definition").text();
  connection->latching = find_field(data, size, "latching").text() == "1";
  return connection;
}

bool unpack_chunk(const std::string& compression, std::vector<char>& packed, std::size_t size,
                  std::vector<char>& bytes) {
  bytes.clear();
  if (compression == "bz2") return unpack_bz2(packed, size, bytes);
  if (compression == "lz4") return unpack_lz4(packed, size, bytes);
  return false;
}

}  // namespace bag_format
}  // namespace allan_lio
