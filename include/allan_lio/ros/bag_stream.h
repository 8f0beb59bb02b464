// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// Messages of one bag in the order in which they were written, chunk by chunk: unlike BagReader it needs memory for
/// one chunk only, however long the bag is, and no index.
class BagStream {
 public:
  struct Message {
    const BagConnection& connection;
    const std::uint8_t* data;
    std::size_t size;
  };

  /// Throws BagError if the file cannot be opened or is not a bag.
  explicit BagStream(const std::string& file);

  /// What the bag says it holds: by its index, or by reading through it if that is missing.
  std::vector<std::shared_ptr<const BagConnection>> connections();

  /// Hands over every message of these topics, as the bag writes their names. Damaged parts end it, see trouble().
  void read(const std::set<std::string>& topics, const std::function<void(const Message&)>& take);

  /// What is wrong with the bag: a sentence, empty if nothing is known to be.
  const std::string& trouble() const { return trouble_; }

 private:
  struct Record {
    std::string header;
    std::uint64_t data = 0;  // position in the file [bytes]
    std::uint32_t size = 0;  // [bytes]
  };

  bool read_record(Record& record);
  bool load(const Record& record, std::vector<char>& bytes);
  bool unpack(const Record& record);
  void walk(const std::function<bool()>& on_chunk);
  bool walk_chunk(const std::set<std::string>& topics, const std::function<void(const Message&)>& take);
  void add_connection(const char* header, std::size_t header_size, const char* data, std::size_t size);
  void fail(const std::string& what);

  std::string file_;
  std::ifstream stream_;
  std::uint64_t position_ = 0;  // of the next record [bytes]
  std::uint64_t file_size_ = 0;
  std::uint64_t index_ = 0;  // position of the connection records at the end; 0: none
  std::vector<char> stored_, chunk_;
  std::vector<std::shared_ptr<const BagConnection>> connections_;
  std::map<std::uint32_t, std::shared_ptr<const BagConnection>> by_id_;
  std::string trouble_;
};

}  // namespace allan_lio
