// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The format: http://wiki.ros.org/Bags/Format/2.0
#include "allan_lio/ros/bag_salvage.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <cstring>

namespace allan_lio {
namespace {

enum Op : char { kMessageOp = 2, kChunkOp = 5, kConnectionOp = 7 };

constexpr std::size_t kMagicLength = 13;            // "#ROSBAG V2.0\n"
constexpr std::uint32_t kLongestHeader = 1U << 24;  // a record's header is some hundred bytes
constexpr std::uint32_t kLargestChunk = 1U << 30;   // rosbag's chunks are 768 kB and one message
constexpr std::size_t kCachedChunks = 4;            // neighbours in time overlap a little

std::uint32_t load_length(const char* from) {
  std::uint32_t value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// Value of a field of a record header ("length name=value" in a row); false if it is not there.
bool find_header(const std::string& header, const std::string& name, std::string& value) {
  std::size_t at = 0;
  while (at + 4 <= header.size()) {
    const std::uint32_t length = load_length(header.data() + at);
    at += 4;
    if (length > header.size() - at) return false;
    const std::size_t equals = header.find('=', at);
    if (equals < at + length && header.compare(at, equals - at, name) == 0) {
      value = header.substr(equals + 1, at + length - equals - 1);
      return true;
    }
    at += length;
  }
  return false;
}

char op_of(const std::string& header) {
  std::string value;
  return find_header(header, "op", value) && value.size() == 1 ? value[0] : 0;
}

bool find_number(const std::string& header, const std::string& name, std::uint32_t& number) {
  std::string value;
  if (!find_header(header, name, value) || value.size() != 4) return false;
  number = load_length(value.data());
  return true;
}

std::vector<char> unpack_bz2(std::vector<char>& packed, std::size_t size) {
  std::vector<char> bytes(size);
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {};
  stream.next_in = packed.data();
  stream.avail_in = static_cast<unsigned>(packed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<unsigned>(size);
  unsigned before = 0;
  do {
    before = stream.avail_in + stream.avail_out;
  } while (BZ2_bzDecompress(&stream) == BZ_OK && stream.avail_in + stream.avail_out < before);
  bytes.resize(size - stream.avail_out);
  BZ2_bzDecompressEnd(&stream);
  return bytes;
}

std::vector<char> unpack_lz4(std::vector<char>& packed, std::size_t size) {
  std::vector<char> bytes(size);
  roslz4_stream stream{};
  if (roslz4_decompressStart(&stream) != ROSLZ4_OK) return {};
  stream.input_next = packed.data();
  stream.input_left = static_cast<int>(packed.size());
  stream.output_next = bytes.data();
  stream.output_left = static_cast<int>(size);
  int before = 0;
  do {
    before = stream.input_left + stream.output_left;
  } while (roslz4_decompress(&stream) == ROSLZ4_OK && stream.input_left + stream.output_left < before);
  bytes.resize(size - static_cast<std::size_t>(stream.output_left));
  roslz4_decompressEnd(&stream);
  return bytes;
}

}  // namespace

BagSalvage::BagSalvage(const std::string& file, const std::string& why) : file_(file), stream_(file, std::ios::binary) {
  if (!stream_) throw BagError("cannot open " + file);
  stream_.seekg(0, std::ios::end);
  file_size_ = static_cast<std::uint64_t>(stream_.tellg());
  walk_file();
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const Message& a, const Message& b) { return a.time < b.time; });
  trouble_ = file + " has no usable index (" + why + "): " + std::to_string(messages_.size()) +
             " messages found by reading through it";
  if (readable_ < file_size_)
    trouble_ += ", " + std::to_string(file_size_ - readable_) + " bytes at its end are cut off or damaged";
}

void BagSalvage::walk_file() {
  readable_ = kMagicLength;
  while (readable_ + 8 <= file_size_) {
    char length[4];
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(readable_));
    if (!stream_.read(length, 4)) return;
    const std::uint32_t header_length = load_length(length);
    if (header_length > kLongestHeader || readable_ + 8 + header_length > file_size_) return;
    std::string header(header_length, '\0');
    if (!stream_.read(&header[0], header_length) || !stream_.read(length, 4)) return;
    const char op = op_of(header);
    if (op == 0) return;
    const std::uint64_t data = readable_ + 8 + header_length;
    const std::uint32_t size = load_length(length);
    const auto stored = static_cast<std::uint32_t>(std::min<std::uint64_t>(size, file_size_ - data));

    bool whole = stored == size;
    if (op == kChunkOp) {
      Chunk chunk{data, stored, 0, ""};
      if (!find_number(header, "size", chunk.unpacked_size) || chunk.unpacked_size > kLargestChunk ||
          !find_header(header, "compression", chunk.compression))
        return;
      chunks_.push_back(chunk);
      whole = walk_chunk(chunks_.size() - 1) && whole;
    } else if (op == kConnectionOp && whole) {
      std::vector<char> bytes(size);
      stream_.read(bytes.data(), size);
      add_connection(header, bytes.data(), bytes.size());
    }
    if (stored < size) return;
    readable_ = data + size;
  }
}

bool BagSalvage::walk_chunk(std::size_t chunk) {
  const std::vector<char>& bytes = unpacked(chunk);
  std::size_t at = 0;
  while (bytes.size() - at >= 8) {
    const std::uint32_t header_length = load_length(bytes.data() + at);
    if (header_length > bytes.size() - at - 8) return false;
    const std::string header(bytes.data() + at + 4, header_length);
    const std::uint32_t size = load_length(bytes.data() + at + 4 + header_length);
    at += 8 + std::size_t{header_length};
    if (size > bytes.size() - at) return false;
    const char op = op_of(header);
    Message message{ros::Time(), chunk, static_cast<std::uint32_t>(at), size, 0};
    std::string time;
    if (op == kConnectionOp) {
      add_connection(header, bytes.data() + at, size);
    } else if (op == kMessageOp && find_number(header, "conn", message.connection) &&
               find_header(header, "time", time) && time.size() == 8) {
      message.time = ros::Time(load_length(time.data()), load_length(time.data() + 4));
      messages_.push_back(message);
    }
    at += size;
  }
  return at == bytes.size() && bytes.size() == chunks_[chunk].unpacked_size;
}

void BagSalvage::add_connection(const std::string& header, const char* data, std::size_t size) {
  std::uint32_t id = 0;
  if (!find_number(header, "conn", id) || by_id_.count(id) > 0) return;
  const std::string fields(data, size);
  auto connection = std::make_shared<BagConnection>();
  std::string latching;
  find_header(header, "topic", connection->topic);
  find_header(fields, "type", connection->datatype);
  find_header(fields, "md5sum", connection->md5sum);
  find_header(fields, "message_definition", connection->definition);
  connection->latching = find_header(fields, "latching", latching) && latching == "1";
  by_id_[id] = connection;
  connections_.push_back(connection);
}

std::vector<char> BagSalvage::unpack(const Chunk& chunk) {
  std::vector<char> stored(chunk.stored_size);
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(chunk.position));
  stream_.read(stored.data(), chunk.stored_size);
  stored.resize(static_cast<std::size_t>(stream_.gcount()));
  if (chunk.compression == "none") return stored;
  if (chunk.compression == "bz2") return unpack_bz2(stored, chunk.unpacked_size);
  if (chunk.compression == "lz4") return unpack_lz4(stored, chunk.unpacked_size);
  return {};
}

const std::vector<char>& BagSalvage::unpacked(std::size_t chunk) {
  const auto found =
      std::find_if(cache_.begin(), cache_.end(), [&](const Unpacked& entry) { return entry.chunk == chunk; });
  if (found != cache_.end()) return found->bytes;
  if (cache_.size() >= kCachedChunks) cache_.pop_front();
  cache_.push_back({chunk, unpack(chunks_[chunk])});
  return cache_.back().bytes;
}

bool BagSalvage::next(BagMessage& message) {
  while (position_ < messages_.size()) {
    const Message& found = messages_[position_++];
    const auto connection = by_id_.find(found.connection);
    if (connection == by_id_.end()) continue;
    if (!topics_.empty() && topics_.count(connection->second->topic) == 0) continue;
    const std::vector<char>& bytes = unpacked(found.chunk);
    if (bytes.size() < std::size_t{found.offset} + found.size) continue;
    message.time = found.time;
    message.connection = connection->second;
    message.bytes.assign(bytes.begin() + found.offset, bytes.begin() + found.offset + found.size);
    return true;
  }
  return false;
}

}  // namespace allan_lio
