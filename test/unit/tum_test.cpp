// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/tum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <sstream>
#include <stdexcept>

namespace allan_lio {
namespace {

Trajectory read(const std::string& text) {
  std::istringstream in(text);
  return read_tum(in, "file.tum");
}

/// The sentence with which the text is refused, or "" if it is taken.
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Tum, SecondsArePrintedExactly) {
  EXPECT_EQ(format_seconds(0), "0.000000000");
  EXPECT_EQ(format_seconds(1), "0.000000001");
  EXPECT_EQ(format_seconds(-1), "-0.000000001");
  EXPECT_EQ(format_seconds(-2'500'000'000), "-2.500000000");
  EXPECT_EQ(format_seconds(1'403'636'579'763'555'584), "1403636579.763555584");
  EXPECT_EQ(format_seconds(std::numeric_limits<TimeNs>::max()), "9223372036.854775807");
  EXPECT_EQ(format_seconds(std::numeric_limits<TimeNs>::min()), "-9223372036.854775808");
}

TEST(Tum, SecondsAreReadExactlyWhereADoubleWouldRound) {
  const std::vector<std::pair<std::string, TimeNs>> cases = {
      {"1403636579.763555583", 1'403'636'579'763'555'583},
      {"1403636579.763555584", 1'403'636'579'763'555'584},
      {"1403636579.7635555834", 1'403'636'579'763'555'583},
      {"1403636579.7635555836", 1'403'636'579'763'555'584},
      {"0.9999999995", 1'000'000'000},
      {"1.403636579763555584e+09", 1'403'636'579'763'555'584},
      {"1.5E2", 150'000'000'000},
      {"25e-10", 3},
      {"4e-10", 0},
      {"-0.1", -100'000'000},
      {"+7", 7'000'000'000},
      {".5", 500'000'000},
      {"5.", 5'000'000'000},
      {"0000000000000000000000000000000000000000000000000012", 12'000'000'000},
      {"9223372036.854775806", 9'223'372'036'854'775'806}};
  for (const auto& [text, expected] : cases) {
    TimeNs stamp = -12345;
    EXPECT_TRUE(parse_seconds(text, &stamp)) << text;
    EXPECT_EQ(stamp, expected) << text;
  }
}

TEST(Tum, WhatIsNotATimeIsRefused) {
  for (const char* text : {"", "-", ".", "abc", "1.2.3", "1e", "1e+", "1e9x", "nan", "inf", "0x10", "1 2", "1e30",
                           "9223372036.9", "99999999999999999999", "1e9999999999"}) {
    TimeNs stamp = 0;
    EXPECT_FALSE(parse_seconds(text, &stamp)) << "'" << text << "'";
  }
}

TEST(Tum, CommentsCommasAndBlanksAreRead) {
  const Trajectory trajectory = read(
      "# t x y z qx qy qz qw\n"
      "\n"
      "1.0 1 2 3 0 0 0 1  # first\n"
      "2.0,4,5,6,0,0,1,0\r\n"
      "\t3.0, 7, 8, 9, 0, 0, 0, 2\n");
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory[1].stamp, 2 * kNsPerSecond);
  EXPECT_EQ(trajectory[1].pose.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(trajectory[1].pose.rotation.z(), 1.0);
  EXPECT_EQ(trajectory[2].pose.rotation.w(), 1.0) << "a quaternion is normalised";
}

TEST(Tum, BadLinesAreRefusedWithFileAndLine) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {good + "2 0 0 0 0 0 1\n", "file.tum:2: a TUM line holds 8 numbers (t x y z qx qy qz qw), this one 7"},
      {good + "2 0 0 0 0 0 0 1 9\n", "this one 9"},
      {good + "2 0 0 0 0 0 0 0\n", "file.tum:2: the quaternion is zero"},
      {good + "#\n2 0 nan 0 0 0 0 1\n", "file.tum:3: 'nan' is not a finite number"},
      {good + "2 0 inf 0 0 0 0 1\n", "file.tum:2: 'inf' is not a finite number"},
      {good + "2 0 1e999 0 0 0 0 1\n", "file.tum:2: '1e999' is not a finite number"},
      {good + "2 0 1x 0 0 0 0 1\n", "file.tum:2: '1x' is not a finite number"},
      {good + "two 0 0 0 0 0 0 1\n", "file.tum:2: 'two' is not a time in seconds"},
      {good + "2 0 0 0 1e300 1e300 0 1\n", "file.tum:2: the quaternion is too large"},
      {good + good, "file.tum:2: the stamp 1 is not later than the one before, 1.000000000"},
      {good + "0.5 0 0 0 0 0 0 1\n", "file.tum:2: the stamp 0.5 is not later"},
      {"# nothing\n", "file.tum: holds no pose"},
      {"", "file.tum: holds no pose"}};
  for (const auto& [text, sentence] : cases)
    EXPECT_NE(refusal(text).find(sentence), std::string::npos) << "'" << text << "' gives '" << refusal(text) << "'";
}

TEST(Tum, AMissingFileAndADirectoryAreRefusedByName) {
  for (const std::string path : {"/no/such/file.tum", "/tmp"}) {
    try {
      read_tum(path);
      FAIL() << path << " was taken";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(write_tum("/no/such/file.tum", {StampedPose{}}), std::runtime_error);
}

TEST(Tum, WhatIsWrittenIsReadBackToTheSameBits) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Trajectory written;
  for (int i = 0; i < 200; ++i) {
    StampedPose pose;
    pose.stamp = 1'700'000'000'123'456'789 + i * TimeNs{99'999'937};
    pose.pose.translation = Eigen::Vector3d(1e3 * normal(random), 1e-7 * normal(random), normal(random));
    pose.pose.rotation =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    written.push_back(pose);
  }
  const std::string path = ::testing::TempDir() + "allan_lio_tum_test.tum";
  write_tum(path, written);
  const Trajectory back = read_tum(path);
  std::remove(path.c_str());
  ASSERT_EQ(back.size(), written.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    EXPECT_EQ(back[i].stamp, written[i].stamp);
    EXPECT_EQ(back[i].pose.translation, written[i].pose.translation);
    EXPECT_EQ(back[i].pose.rotation.coeffs(), written[i].pose.rotation.coeffs());
  }
}

}  // namespace
}  // namespace allan_lio
