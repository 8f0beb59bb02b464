// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// Reads a bag of format 2.0 without its index, as far as it goes: recordings that were cut off, or never closed.
/// Walks once through all records to find the messages, and then delivers them in the order of time.
class BagSalvage : public BagReader {
 public:
  /// `why`: what made the index unusable; becomes part of trouble(). Throws BagError if the file cannot be opened.
  BagSalvage(const std::string& file, const std::string& why);

  const std::vector<std::shared_ptr<const BagConnection>>& connections() const override { return connections_; }
  ros::Time begin() const override { return messages_.empty() ? ros::Time() : messages_.front().time; }
  ros::Time end() const override { return messages_.empty() ? ros::Time() : messages_.back().time; }
  void select(const std::set<std::string>& topics) override { topics_ = topics; }
  bool next(BagMessage& message) override;
  const std::string& trouble() const override { return trouble_; }

 private:
  struct Chunk {
    std::uint64_t position;       ///< of its data in the file [bytes]
    std::uint32_t stored_size;    ///< in the file [bytes]
    std::uint32_t unpacked_size;  ///< [bytes]
    std::string compression;
  };
  struct Message {
    ros::Time time;
    std::size_t chunk;     ///< index into chunks_
    std::uint32_t offset;  ///< of its data in the unpacked chunk [bytes]
    std::uint32_t size;    ///< [bytes]
    std::uint32_t connection;
  };
  struct Unpacked {
    std::size_t chunk;
    std::vector<char> bytes;
  };

  void walk_file();
  /// False if the chunk's records do not reach its end.
  bool walk_chunk(std::size_t chunk);
  void add_connection(const std::string& header, const char* data, std::size_t size);
  /// As much of the chunk as can be unpacked.
  std::vector<char> unpack(const Chunk& chunk);
  const std::vector<char>& unpacked(std::size_t chunk);

  std::string file_;
  std::ifstream stream_;
  std::uint64_t file_size_ = 0;
  std::uint64_t readable_ = 0;  ///< bytes at the file's begin that make sense
  std::vector<Chunk> chunks_;
  std::vector<Message> messages_;
  std::size_t position_ = 0;  ///< index of the next message
  std::vector<std::shared_ptr<const BagConnection>> connections_;
  std::map<std::uint32_t, std::shared_ptr<const BagConnection>> by_id_;
  std::set<std::string> topics_;
  std::deque<Unpacked> cache_;
  std::string trouble_;
};

}  // namespace allan_lio
