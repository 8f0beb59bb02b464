// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

namespace allan_lio {

/// Where an IMU's readings stand in a row; -1: nowhere.
struct ImuCsvColumns {
  std::array<int, 6> axes{{-1, -1, -1, -1, -1, -1}};  ///< gyro x y z, accelerometer x y z
  int time = -1;
  int temperature = -1;
  int count = 0;                      ///< fields of a row
  std::string time_unit;              ///< "s", "ms", "us", "ns", or empty: not said
  std::string gyro_unit, accel_unit;  ///< as convert_unit() reads it, or empty: not said
};

/// The columns that their names tell: `gyro_x`, `w_RS_S_x [rad s^-1]`, `field.angular_velocity.x`, `ax`,
/// `accel_x_m_s2`, `t_s`, `#timestamp [ns]` and the like. False if the names don't tell all six axes. Throws
/// std::invalid_argument if an axis is told twice, or in units that differ between the axes of a sensor.
bool find_imu_columns(const std::vector<std::string>& names, ImuCsvColumns* columns);

/// Without names: 7 fields are time, gyro, accelerometer; 6 are gyro, accelerometer. False for other counts.
bool default_imu_columns(int count, ImuCsvColumns* columns);

}  // namespace allan_lio
