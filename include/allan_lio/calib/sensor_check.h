// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "allan_lio/calib/imu_check.h"
#include "allan_lio/calib/stamp_check.h"
#include "allan_lio/lio/lio_config.h"

namespace allan_lio {

/// What a recording shows of its sensors, before any filter runs on it.
struct SensorCheck {
  struct Topic {
    std::string name, datatype;
  };
  /// What both sensors' topics have.
  struct Stream {
    std::string topic, datatype;
    StampReport stamps;
    double delay = 0.0;  ///< median of arrival less stamp, for a scan less its end [s]
    std::set<std::string> frames;
    std::size_t undecodable = 0;  ///< messages
  };
  struct Imu : Stream {
    ImuReport readings;
  };
  struct Lidar : Stream {
    std::string model;    ///< file of config/lidar that fits best by the fields
    std::string verdict;  ///< on the point times
    std::string refusal;  ///< the last undecodable cloud's
    bool deskew = true;   ///< as it can be read; with the next it makes the suggestion
    PointTime point_time = PointTime::kAuto;
    double points = 0.0;  ///< valid ones of a scan, median
    double sweep = 0.0;   ///< from the first to the last point, median [s]
    std::vector<std::string> remarks;
    PointTime turn = PointTime::kAuto;  ///< without deskew: the azimuth's way in whose order the points come, if any
  };

  std::vector<std::string> files;
  std::vector<Topic> topics;
  std::optional<Imu> imu;
  std::optional<Lidar> lidar;
  std::vector<std::string> other_topics;  ///< of these types, not looked at
  std::vector<std::string> troubles;      ///< of the files
};

/// One thing that will go wrong.
struct SensorFinding {
  bool fatal;  ///< the estimator cannot run on this
  std::string sentence;
};

std::vector<SensorFinding> judge_sensors(const SensorCheck& check);

/// The report, without the findings.
std::string describe_sensors(const SensorCheck& check);

/// A configuration to begin with, in YAML; empty unless both sensors are there.
std::string suggest_config(const SensorCheck& check);

}  // namespace allan_lio
