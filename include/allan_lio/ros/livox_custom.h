// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "allan_lio/math/time.h"
#include "allan_lio/ros/cloud_layout.h"

namespace allan_lio {

/// Of livox_ros_driver/CustomMsg and livox_ros_driver2/CustomMsg, which are the same message.
constexpr char kLivoxCustomMd5sum[] = "e4d6829bdfe657cb6c21a746c86b21a6";

/// A Livox CustomMsg whose lengths have been checked. The layout's points lie in the bytes that were read, and its
/// time is offset_time, uint32 nanoseconds since the message's `timebase`, which the drivers give as its stamp as well.
struct LivoxCustom {
  TimeNs stamp = 0;      ///< of the header
  std::string frame_id;  ///< of the header
  TimeNs timebase = 0;   ///< the LiDAR's clock at offset_time 0 [ns]
  CloudLayout layout;
};

/// Reads the wire format. Makes room for nothing but the frame's name. Nothing if a length does not fit the bytes;
/// `error` says so.
std::optional<LivoxCustom> read_livox_custom(const std::uint8_t* bytes, std::size_t size, std::string& error);

}  // namespace allan_lio
