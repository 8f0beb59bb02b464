// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr const char* kHeader =
    "t_s,gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]";

TEST(SimulateStatic, WritesTheNoiseOfTheImuAtRestWithGravityUp) {
  constexpr double kGravity = 9.80665, kWhite = 0.42 * 3.14159265358979323846 / 180.0 / 60.0;
  const TemporaryDirectory directory;
  const Outcome outcome = run_tool("simulate_static --imu imu/mti600 --hours 0.01 --rate 100 --no-turn-on-bias --out " +
                                   directory.file("s.csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  std::istringstream in(contents_of(directory.file("s.csv")));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, kHeader);
  int rows = 0;
  double square = 0.0, up = 0.0;
  for (; std::getline(in, line); ++rows) {
    double t, v[6];
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &t, v, v + 1, v + 2, v + 3, v + 4, v + 5), 7);
    EXPECT_NEAR(t, rows / 100.0, 1e-9);
    square += v[0] * v[0];
    up += v[5];
  }
  ASSERT_EQ(rows, 3600);
  EXPECT_NEAR(std::sqrt(square / rows) / (kWhite * std::sqrt(100.0)), 1.0, 4.0 / std::sqrt(2.0 * rows));
  EXPECT_NEAR(up / rows, kGravity, 1e-3);
}

TEST(SimulateStatic, DependsOnTheSeedAlone) {
  const TemporaryDirectory directory;
  for (const std::string& name : {"1 --out " + directory.file("a.csv"), "1 --out " + directory.file("b.csv"),
                                  "2 --out " + directory.file("c.csv")})
    ASSERT_EQ(run_tool("simulate_static --hours 0.001 --seed " + name).status, 0);
  const std::string a = contents_of(directory.file("a.csv"));
  EXPECT_EQ(a, contents_of(directory.file("b.csv")));
  EXPECT_NE(a, contents_of(directory.file("c.csv")));
}

TEST(SimulateStatic, WritesABagAndRefusesWhatItCannotWrite) {
  const TemporaryDirectory directory;
  EXPECT_EQ(run_tool("simulate_static --hours 0.001 --topic /my/imu --out " + directory.file("s.bag")).status, 0);
  const std::string bag = contents_of(directory.file("s.bag"));
  EXPECT_EQ(bag.substr(0, 13), "#ROSBAG V2.0\n");
  EXPECT_NE(bag.find("/my/imu"), std::string::npos);
  for (const char* bad :
       {"--out s.txt", "--hours -1 --out s.csv", "--imu no_such_imu --out s.csv", "--out /no/such/s.csv"})
    EXPECT_NE(run_tool(std::string("simulate_static --hours 0.001 ") + bad).status, 0) << bad;
}

}  // namespace
}  // namespace allan_lio
