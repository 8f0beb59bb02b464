// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The format: http://wiki.ros.org/Bags/Format/2.0
#include "allan_lio/ros/bag_stream.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <cstring>

namespace allan_lio {
namespace {

enum Op : char { kMessageOp = 2, kBagHeaderOp = 3, kChunkOp = 5, kConnectionOp = 7 };

constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr std::size_t kMagicLength = sizeof kMagic - 1;
constexpr std::uint32_t kLongestHeader = 1U << 24U;  // a record's header is some hundred bytes
constexpr std::uint32_t kLargestChunk = 1U << 30U;   // rosbag's chunks are 768 kB and one message

template <class T>
T load_number(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// A field of a record's header, "length name=value" in a row.
struct Field {
  const char* data = nullptr;
  std::size_t size = 0;

  std::string text() const { return data == nullptr ? "" : std::string(data, size); }
  template <class T>
  bool get(T* value) const {
    if (data == nullptr || size != sizeof(T)) return false;
    *value = load_number<T>(data);
    return true;
  }
};

Field find_field(const char* header, std::size_t header_size, const char* name) {
  const std::size_t name_length = std::strlen(name);
  for (std::size_t at = 0; header_size - at >= 4;) {
    const std::size_t length = load_number<std::uint32_t>(header + at);
    at += 4;
    if (length > header_size - at) break;
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

}  // namespace

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
  if (!stream_.read(length, 4) || load_number<std::uint32_t>(length) > kLongestHeader) return fail("a header"), false;
  record.header.resize(load_number<std::uint32_t>(length));
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
  chunk_.resize(size);
  unsigned unpacked = size;
  const bool good =
      compression == "bz2"
          ? BZ2_bzBuffToBuffDecompress(chunk_.data(), &unpacked, stored_.data(), record.size, 0, 0) == BZ_OK
      : compression == "lz4"
          ? roslz4_buffToBuffDecompress(stored_.data(), record.size, chunk_.data(), &unpacked) == ROSLZ4_OK
          : false;
  if (!good || unpacked != size) chunk_.clear();
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
  const auto connection = std::make_shared<BagConnection>();
  connection->topic = find_field(header, header_size, "topic").text();
  connection->datatype = find_field(data, size, "type").text();
  connection->md5sum = find_field(data, size, "md5sum").text();
  connection->definition = find_field(data, size, "message_definition").text();
  connection->latching = find_field(data, size, "latching").text() == "1";
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
