// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The format: http://wiki.ros.org/Bags/Format/2.0
#include "allan_lio/ros/bag_stream.h"

#include <algorithm>
#include <cstring>

#include "allan_lio/ros/bag_format.h"

namespace allan_lio {

using namespace bag_format;

BagStream::BagStream(const std::string& file) : file_(file), stream_(file, std::ios::binary) {
  if (!stream_) throw BagError("cannot open the bag " + file);
  char magic[kMagicLength];
  if (!stream_.read(magic, kMagicLength)) throw BagError(file + " is not a bag: it is shorter than a bag's first line");
  if (std::memcmp(magic, kMagic, 9) != 0) throw BagError(file + " is not a bag: it does not begin with #ROSBAG");
  if (std::memcmp(magic, kMagic, kMagicLength) != 0)
    throw BagError(file + " is not a bag of format 2.0, the only one that is read: rosbag fix converts it");
  stream_.seekg(0, std::ios::end);
  file_size_ = static_cast<std::uint64_t>(stream_.tellg());
  position_ = kMagicLength;
  Record record;
  if (read_record(record) && op_of(record.header.data(), record.header.size()) == kBagHeaderOp)
    find_field(record.header, "index_pos").get(&index_);
  if (index_ >= file_size_) index_ = 0;
}

void BagStream::fail(const std::string& what) {
  if (trouble_.empty())
    trouble_ = file_ + " is damaged or cut off after " + std::to_string(position_) + " of " +
               std::to_string(file_size_) + " bytes (" + what + "): what lies before was read";
}

/// The record at position_, which moves behind it. False at the end of what makes sense.
bool BagStream::read_record(Record& record) {
  if (position_ >= file_size_) return false;
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(position_));
  char length[4];
  if (!stream_.read(length, 4)) return fail("a header"), false;
  const std::uint32_t header_length = load_number<std::uint32_t>(length);
  if (header_length > kLongestHeader || header_length > file_size_ - position_) return fail("a header"), false;
  record.header.resize(header_length);
  if (!stream_.read(&record.header[0], static_cast<std::streamsize>(record.header.size())) || !stream_.read(length, 4))
    return fail("a header"), false;
  record.data = position_ + 8 + record.header.size();
  record.size = load_number<std::uint32_t>(length);
  position_ = record.data + record.size;
  return true;
}

bool BagStream::load(const Record& record, std::vector<char>& bytes) {
  if (record.data + record.size > file_size_)
    bytes.resize(file_size_ - std::min(file_size_, record.data));
  else
    bytes.resize(record.size);
  stream_.clear();
  stream_.seekg(static_cast<std::streamoff>(record.data));
  stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes.size() == record.size && stream_.good();
}

/// The chunk's messages into chunk_: all of them, or of one that is cut off and not compressed as many as there are.
bool BagStream::unpack(const Record& record) {
  const std::string compression = find_field(record.header, "compression").text();
  std::uint32_t size = 0;
  if (!find_field(record.header, "size").get(&size) || size > kLargestChunk) return chunk_.clear(), false;
  if (compression == "none") return load(record, chunk_) && chunk_.size() == size;
  chunk_.clear();
  if (!load(record, stored_)) return false;
  if (!unpack_chunk(compression, stored_, size, chunk_)) chunk_.clear();
  return !chunk_.empty();
}

/// Every chunk from the beginning on into chunk_, until on_chunk gives false.
void BagStream::walk(const std::function<bool()>& on_chunk) {
  position_ = kMagicLength;
  for (Record record; read_record(record);) {
    const char op = op_of(record.header.data(), record.header.size());
    if (op == kChunkOp) {
      const std::uint64_t next = position_;
      position_ = record.data;
      const bool whole = unpack(record);
      if (!whole) fail("a chunk of messages");
      const bool sound = on_chunk();
      if (!sound) fail("messages of a chunk");
      if (!whole || !sound) return;
      position_ = next;
    } else if (op == kConnectionOp && load(record, stored_)) {
      add_connection(record.header.data(), record.header.size(), stored_.data(), stored_.size());
    }
  }
}

bool BagStream::walk_chunk(const std::set<std::string>& topics, const std::function<void(const Message&)>& take) {
  const char* at = chunk_.data();
  const char* const end = at + chunk_.size();
  while (end - at >= 8) {
    const auto header_size = load_number<std::uint32_t>(at);
    if (header_size > static_cast<std::size_t>(end - at) - 8) return false;
    const char* const header = at + 4;
    const auto size = load_number<std::uint32_t>(header + header_size);
    const char* const data = header + header_size + 4;
    if (size > static_cast<std::size_t>(end - data)) return false;
    const char op = op_of(header, header_size);
    if (op == kConnectionOp) {
      add_connection(header, header_size, data, size);
    } else if (op == kMessageOp && !topics.empty()) {
      std::uint32_t id = 0;
      find_field(header, header_size, "conn").get(&id);
      const auto connection = by_id_.find(id);
      if (connection != by_id_.end() && topics.count(connection->second->topic) > 0)
        take({*connection->second, reinterpret_cast<const std::uint8_t*>(data), size});
    }
    at = data + size;
  }
  return at == end;
}

void BagStream::add_connection(const char* header, std::size_t header_size, const char* data, std::size_t size) {
  std::uint32_t id = 0;
  if (!find_field(header, header_size, "conn").get(&id) || by_id_.count(id) > 0) return;
  const auto connection = read_connection(header, header_size, data, size);
  by_id_[id] = connection;
  connections_.push_back(connection);
}

std::vector<std::shared_ptr<const BagConnection>> BagStream::connections() {
  if (!connections_.empty()) return connections_;
  if (index_ != 0) {
    position_ = index_;
    for (Record record; read_record(record) && op_of(record.header.data(), record.header.size()) == kConnectionOp;)
      if (load(record, stored_))
        add_connection(record.header.data(), record.header.size(), stored_.data(), stored_.size());
    trouble_.clear();  // a damaged index matters only if the messages are
  }
  if (connections_.empty()) walk([this] { return walk_chunk({}, {}); });
  return connections_;
}

void BagStream::read(const std::set<std::string>& topics, const std::function<void(const Message&)>& take) {
  trouble_.clear();
  if (index_ == 0) trouble_ = file_ + " was not closed by its recorder: it was read as far as it goes";
  walk([&] { return walk_chunk(topics, take); });
}

}  // namespace allan_lio
