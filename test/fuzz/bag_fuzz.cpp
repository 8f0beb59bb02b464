// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A bag file, whole or not, by both readers that need no index; every message is tried as an IMU's.
#include <exception>

#include "allan_lio/ros/bag_salvage.h"
#include "allan_lio/ros/bag_stream.h"
#include "allan_lio/ros/imu_bag.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  const MemoryFile file(data, size);
  try {
    BagSalvage salvage(file.path(), "fuzz");
    BagMessage message;
    while (salvage.next(message)) must(message.connection != nullptr);
  } catch (const BagError& error) {
    must(*error.what() != '\0');
  }
  try {
    BagStream stream(file.path());
    std::set<std::string> topics;
    for (const auto& connection : stream.connections()) topics.insert(connection->topic);
    stream.read(topics, [](const BagStream::Message& message) {
      must(message.size == 0 || message.data != nullptr);
      ImuSample sample;
      decode_imu(message.data, message.size, &sample);
    });
  } catch (const BagError& error) {
    must(*error.what() != '\0');
  }
  return 0;
}
