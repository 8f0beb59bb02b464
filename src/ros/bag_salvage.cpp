// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The format: http://wiki.ros.org/Bags/Format/2.0
#include "allan_lio/ros/bag_salvage.h"

#include <algorithm>
#include <cstring>

#include "allan_lio/ros/bag_format.h"
#include "allan_lio/ros/conversions.h"

namespace allan_lio {

using namespace bag_format;

namespace {

constexpr std::size_t kCachedChunks = 4;  // neighbours in time overlap a little

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
    const std::uint32_t header_length = load_number<std::uint32_t>(length);
    if (header_length > kLongestHeader || readable_ + 8 + header_length > file_size_) return;
    std::string header(header_length, '\0');
    if (!stream_.read(&header[0], header_length) || !stream_.read(length, 4)) return;
    const char op = op_of(header.data(), header.size());
    if (op == 0) return;
    const std::uint64_t data = readable_ + 8 + header_length;
    const std::uint32_t size = load_number<std::uint32_t>(length);
    const auto stored = static_cast<std::uint32_t>(std::min<std::uint64_t>(size, file_size_ - data));

    bool whole = stored == size;
    if (op == kChunkOp) {
      Chunk chunk{data, stored, 0, ""};
      const Field compression = find_field(header, "compression");
      if (!find_field(header, "size").get(&chunk.unpacked_size) || chunk.unpacked_size > kLargestChunk ||
          compression.data == nullptr)
        return;
      chunk.compression = compression.text();
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
    const std::uint32_t header_length = load_number<std::uint32_t>(bytes.data() + at);
    if (header_length > bytes.size() - at - 8) return false;
    const std::string header(bytes.data() + at + 4, header_length);
    const std::uint32_t size = load_number<std::uint32_t>(bytes.data() + at + 4 + header_length);
    at += 8 + std::size_t{header_length};
    if (size > bytes.size() - at) return false;
    const char op = op_of(header.data(), header.size());
    Message message{ros::Time(), chunk, static_cast<std::uint32_t>(at), size, 0};
    const Field time = find_field(header, "time");
    if (op == kConnectionOp) {
      add_connection(header, bytes.data() + at, size);
    } else if (op == kMessageOp && find_field(header, "conn").get(&message.connection) && time.size == 8) {
      // Whatever stands there: ros::Time's constructor throws if the nanoseconds take it beyond the last second.
      message.time = to_ros_time(TimeNs{load_number<std::uint32_t>(time.data)} * kNsPerSecond +
                                 load_number<std::uint32_t>(time.data + 4));
      messages_.push_back(message);
    }
    at += size;
  }
  return at == bytes.size() && bytes.size() == chunks_[chunk].unpacked_size;
}

void BagSalvage::add_connection(const std::string& header, const char* data, std::size_t size) {
  std::uint32_t id = 0;
  if (!find_field(header, "conn").get(&id) || by_id_.count(id) > 0) return;
  const auto connection = read_connection(header.data(), header.size(), data, size);
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
  std::vector<char> bytes;
  unpack_chunk(chunk.compression, stored, chunk.unpacked_size, bytes);
  return bytes;
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
