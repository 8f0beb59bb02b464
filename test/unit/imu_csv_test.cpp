// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/imu_csv.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <stdexcept>

#include "allan_lio/io/decimal.h"
#include "shared_data.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

class ImuCsvTest : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string path = directory_.file("imu.csv");
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  std::vector<ImuSample> read(const std::string& text, const ImuCsvOptions& options = {}) {
    ImuCsvReader reader(write(text), options);
    std::vector<ImuSample> samples;
    for (ImuSample sample; reader.next(sample);) samples.push_back(sample);
    note_ = reader.note();
    return samples;
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryDirectory directory_;
  std::string note_;
};

void expect_sample(const ImuSample& sample, TimeNs stamp) {
  EXPECT_EQ(sample.stamp, stamp);
  EXPECT_EQ(sample.gyro, Eigen::Vector3d(1, -2, 3.5));
  EXPECT_EQ(sample.accel, Eigen::Vector3d(4e-3, 5, -9.81));
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// The number of texts that to_double() leaves to others; every other must be strtod's to the bit.
int compare_with_strtod(const std::vector<std::string>& texts) {
  int left = 0;
  for (const std::string& text : texts) {
    Decimal decimal;
    double value = 0.0;
    EXPECT_EQ(scan_decimal(text.data(), text.data() + text.size(), &decimal), text.data() + text.size()) << text;
    if (!to_double(decimal, &value)) {
      ++left;
    } else {
      EXPECT_TRUE(same_bits(value, std::strtod(text.c_str(), nullptr))) << text;
    }
  }
  return left;
}

TEST(DecimalTest, RandomNumbersAreThoseOfStrtodToTheBit) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const char* format : {"%.3f", "%.9g", "%.15g", "%.16g", "%.17g", "%.18e", "%.18f"}) {
    std::vector<std::string> texts;
    for (int i = 0; i < 100000; ++i) {
      char text[64];
      std::snprintf(text, sizeof text, format, normal(random) * std::pow(10.0, static_cast<int>(random() % 5) - 3));
      texts.emplace_back(text);
    }
    // Numbers below 1e-4 in 18 digits have exponents beyond 22, and those from 10 on 20 digits.
    EXPECT_LT(compare_with_strtod(texts), std::strstr(format, ".18") != nullptr ? 30000 : 500) << format;
  }
}

TEST(DecimalTest, RandomMantissasAndExponentsAreThoseOfStrtodToTheBit) {
  std::mt19937_64 random(2);
  std::vector<std::string> texts;
  for (int i = 0; i < 400000; ++i)
    texts.push_back((i % 2 ? "-" : "") + std::to_string(random() >> (random() % 64)) + "e" +
                    std::to_string(static_cast<int>(random() % 45) - 22));
  EXPECT_LT(compare_with_strtod(texts), 30000) << "those of 20 digits";
}

TEST(DecimalTest, TheMiddleBetweenTwoDoublesIsNotGuessed) {
  // 2^53 + 1 and its like lie exactly in the middle, the others a hair beside it.
  const std::vector<std::string> texts = {"9007199254740993",
                                          "9007199254740995",
                                          "9007199254740993.0",
                                          "9007199254740992.9",
                                          "9007199254740993001",
                                          "0.9007199254740993",
                                          "18446744073709551615",
                                          "9999999999999999999",
                                          "1e22",
                                          "1e-22",
                                          "0",
                                          "-0.0"};
  compare_with_strtod(texts);
}

TEST(DecimalTest, NumbersEndWhereTheyEnd) {
  for (const char* text : {"1.5,", "1.5 ", "1.5e3x", ".5;", "5.|", "-1e-5#"}) {
    Decimal decimal;
    const char* const end = text + std::strlen(text);
    EXPECT_EQ(scan_decimal(text, end, &decimal), end - 1) << text;
  }
  for (const char* text : {"", "-", ".", "e5", "x", "-.e1", "1e", "1e+"}) {
    Decimal decimal;
    EXPECT_EQ(scan_decimal(text, text + std::strlen(text), &decimal), nullptr) << text;
  }
}

TEST(DecimalTest, TimesAreExactToTheNanosecond) {
  const struct {
    std::string text;
    int shift;
    TimeNs expected;
  } cases[] = {{"1403636580.838555574", 9, 1403636580838555574},
               {"1403636580.8385555744", 9, 1403636580838555574},
               {"1.403636580838555574e+09", 9, 1403636580838555574},
               {"1403636580838555574", 0, 1403636580838555574},
               {"-0.0000000015", 9, -2},
               {"0.0000000004", 9, 0},
               {"0.00000000000000000006", 9, 0},
               {"12.5", 6, 12500000},
               {"0.0", 9, 0}};
  for (const auto& c : cases) {
    Decimal decimal;
    TimeNs time = -1;
    ASSERT_NE(scan_decimal(c.text.data(), c.text.data() + c.text.size(), &decimal), nullptr);
    ASSERT_TRUE(to_time(decimal, c.shift, &time)) << c.text;
    EXPECT_EQ(time, c.expected) << c.text;
  }
  Decimal large;
  TimeNs time = 0;
  const std::string text = "1e11";
  scan_decimal(text.data(), text.data() + text.size(), &large);
  EXPECT_FALSE(to_time(large, 9, &time));
}

TEST_F(ImuCsvTest, EverySeparatorIsUnderstood) {
  for (const std::string text :
       {"0.01,1,-2,3.5,4e-3,5,-9.81\n", "0.01 , 1, -2 ,3.5,4e-3,5,-9.81\r\n", "0.01;1;-2;3.5;4e-3;5;-9.81",
        "0.01 1  -2\t3.5 4e-3 5 -9.81 \n", "  0.01\t1\t-2\t3.5\t4e-3\t5\t-9.81\n"}) {
    const std::vector<ImuSample> samples = read("# a comment\n\n" + text);
    ASSERT_EQ(samples.size(), 1U) << text;
    expect_sample(samples[0], 10'000'000);
  }
}

TEST_F(ImuCsvTest, HeadersFindTheColumns) {
  for (const std::string header :
       {"t,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", "Time,wx,wy,wz,ax,ay,az", "timestamp,gx,gy,gz,ax,ay,az",
        "time [s],GyroX,GyroY,GyroZ,AccX,AccY,AccZ",
        "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2",
        "\"t\",\"w_x\",\"w_y\",\"w_z\",\"f_x\",\"f_y\",\"f_z\"",
        "#timestamp [s],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m "
        "s^-2],a_RS_S_z [m s^-2]"}) {
    const std::vector<ImuSample> samples = read(header + "\n0.01,1,-2,3.5,4e-3,5,-9.81\n");
    ASSERT_EQ(samples.size(), 1U) << header;
    expect_sample(samples[0], 10'000'000);
  }
}

TEST_F(ImuCsvTest, ColumnsMayStandInAnyOrderAmongOthers) {
  const std::vector<ImuSample> samples = read(
      "ax,ay,az,temp,gx,gy,gz,mx,my,mz,frame,t_ms\n4e-3,5,-9.81,25.5,1,-2,3.5,9,9,9,imu,10\n"
      "4e-3,5,-9.81,26,1,-2,3.5,9,9,9,imu,20\n");
  ASSERT_EQ(samples.size(), 2U);
  expect_sample(samples[1], 20'000'000);
}

TEST_F(ImuCsvTest, RostopicEchoIsUnderstood) {
  std::string header = "%time,field.header.seq,field.header.stamp,field.header.frame_id";
  std::string row = "1600000000000000001,0,1600000000000000000,imu_link";
  for (const std::string field : {"orientation", "angular_velocity", "linear_acceleration"}) {
    for (const char* axis : {".x", ".y", ".z"}) header += ",field." + field + axis;
    header += ",field." + field + "_covariance0";
  }
  row += ",0,0,0,-1,1,-2,3.5,0,4e-3,5,-9.81,0";
  const std::vector<ImuSample> samples = read(header + "\n" + row + "\n");
  ASSERT_EQ(samples.size(), 1U);
  expect_sample(samples[0], 1'600'000'000 * kNsPerSecond);
}

TEST_F(ImuCsvTest, UnitsComeFromBracketsAndNames) {
  const auto units = [&](const std::string& header) {
    const ImuCsvReader reader(write(header + "\n1,1,1,1,1,1,1\n"));
    return reader.gyro_unit() + " " + reader.accel_unit();
  };
  EXPECT_EQ(units("t,wx [deg/s],wy [deg/s],wz [deg/s],ax (g),ay (g),az (g)"), "deg/s g");
  EXPECT_EQ(units("t,gyro_x_dps,gyro_y_dps,gyro_z_dps,acc_x_mg,acc_y_mg,acc_z_mg"), "deg/s mg");
  EXPECT_EQ(units("#timestamp [s],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
                  "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"),
            "rad*s^-1 m*s^-2");
  EXPECT_EQ(units("t,wx,wy,wz,ax,ay,az"), " ");
}

TEST_F(ImuCsvTest, TheUnitOfTimeIsToldByTheIntervals) {
  const auto second_stamp = [&](const std::string& a, const std::string& b) {
    const std::string rest = ",0,0,0,0,0,9.8\n";
    return read(a + rest + b + rest).back().stamp;
  };
  EXPECT_EQ(second_stamp("1403636580.83", "1403636580.835"), 1403636580835000000);
  EXPECT_EQ(second_stamp("1403636580835000000", "1403636580840000000"), 1403636580840000000);
  EXPECT_EQ(second_stamp("1403636580835000", "1403636580840000"), 1403636580840000000);
  EXPECT_EQ(second_stamp("1403636580835", "1403636580840"), 1403636580840000000);
  EXPECT_EQ(second_stamp("0", "2500000"), 2500000);
  EXPECT_EQ(second_stamp("0", "2500"), 2500000);
  EXPECT_EQ(second_stamp("0", "2.5"), 2500000);
  EXPECT_EQ(second_stamp("0", "0.0025"), 2500000);
  EXPECT_NE(error_of("0,0,0,0,0,0,9\n1,0,0,0,0,0,9\n").find("do not tell the unit of time"), std::string::npos);
  ImuCsvOptions options;
  options.time_unit = "ms";
  EXPECT_EQ(read("0,0,0,0,0,0,9\n1,0,0,0,0,0,9\n", options).back().stamp, 1'000'000);
}

TEST_F(ImuCsvTest, SixColumnsHaveNoTime) {
  const std::vector<ImuSample> samples = read("1,-2,3.5,4e-3,5,-9.81\n");
  ASSERT_EQ(samples.size(), 1U);
  expect_sample(samples[0], 0);
  EXPECT_FALSE(ImuCsvReader(write("1,-2,3.5,4e-3,5,-9.81\n")).has_time());
  EXPECT_TRUE(ImuCsvReader(write("0,1,-2,3.5,4e-3,5,-9.81\n")).has_time());
}

TEST_F(ImuCsvTest, MissingReadingsAreNan) {
  const std::vector<ImuSample> samples = read("0.01,nan,,-inf,1,2,3\n0.02,1,2,3,NaN,5,6\n");
  ASSERT_EQ(samples.size(), 2U);
  for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(std::isnan(samples[0].gyro[axis]));
  EXPECT_TRUE(std::isnan(samples[1].accel.x()));
  EXPECT_EQ(samples[1].accel.z(), 6.0);
}

TEST_F(ImuCsvTest, ATruncatedLastLineIsDroppedAndSaid) {
  const std::string row = "0.01,1,-2,3.5,4e-3,5,-9.81\n";
  EXPECT_EQ(read(row + row + "0.03,1,-2,3.").size(), 2U);
  EXPECT_NE(note_.find("imu.csv:3: the last line is cut off"), std::string::npos);
  EXPECT_EQ(read(row + "0.03,1,-2,3.5,4e-3,5,-9.8e").size(), 1U);
  EXPECT_FALSE(note_.empty());
  EXPECT_EQ(read(row + "0.03,1,-2,3.5,4e-3,5,-9.81").size(), 2U) << "whole, only without newline";
  EXPECT_TRUE(note_.empty());
}

TEST_F(ImuCsvTest, BadLinesAreNamed) {
  const std::string row = "0.01,1,-2,3.5,4e-3,5,-9.81\n0.015,1,-2,3.5,4e-3,5,-9.81\n";
  const std::pair<std::string, std::string> cases[] = {
      {row + "0.03,1,x,3.5,4e-3,5,-9.81\n" + row, "imu.csv:3: 'x' is not a number"},
      {row + "# c\n0.03,1,2\n" + row, "imu.csv:4: has 3 fields instead of 7"},
      {row + "now,1,-2,3.5,4e-3,5,-9.81\n", "imu.csv:3: 'now' is not a time"},
      {row + "0.02,1,-2,3.5,4e-3,5,-9.81,1\n", "imu.csv:3: has 8 fields"},
      {row + "0.02,1,-2,1e999,4e-3,5,-9.81\n", "imu.csv:3: '1e999' is not a number"},
      {"", "imu.csv: holds no row of numbers"},
      {"t,wx,wy,wz,ax,ay,az\n", "imu.csv: holds no row of numbers"},
      {"1,2,3\n", "imu.csv:1: has 3 fields, and no header tells"},
      {"t,wx,wx,wz,ax,ay,az\n" + row, "imu.csv:1: columns 'wx' and 'wx' both name the same axis"},
      {"t,wx [rad/s],wy [deg/s],wz,ax,ay,az\n" + row, "column 'wy [deg/s]' is in deg/s"},
      {"t [h],wx,wy,wz,ax,ay,az\n" + row, "'h' is no unit of time"}};
  for (const auto& [text, sentence] : cases)
    EXPECT_NE(error_of(text).find(sentence), std::string::npos) << error_of(text);
  EXPECT_THROW(ImuCsvReader(directory_.file("absent.csv")), std::runtime_error);
  EXPECT_THROW(ImuCsvReader{directory_.path()}, std::runtime_error);
}

TEST_F(ImuCsvTest, LongFilesAreReadAcrossTheBuffer) {
  std::string text;
  constexpr int kRows = 60000;
  for (int i = 0; i < kRows; ++i) {
    char row[96];
    std::snprintf(row, sizeof row, "%d.%03d,%d,0.5,1,2,3,%d.25\n", i / 200, i % 200 * 5, i, -i);
    text += row;
  }
  ASSERT_GT(text.size(), std::size_t{1} << 20U);
  const std::vector<ImuSample> samples = read(text);
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(kRows));
  for (int i = 0; i < kRows; ++i) {
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].stamp, i * TimeNs{5'000'000});
    EXPECT_EQ(samples[static_cast<std::size_t>(i)].gyro.x(), i);
  }
  EXPECT_NE(error_of(std::string(3U << 20U, '1')).find("too long"), std::string::npos);
}

TEST(ImuCsvData, RealRecordingsAreRead) {
  const std::string euroc = shared_data("euroc_v1_01");
  if (euroc.empty()) GTEST_SKIP() << "shared/data/euroc_v1_01 is not here";
  ImuCsvReader reader(euroc + "/imu.csv");
  EXPECT_EQ(reader.gyro_unit(), "rad/s");
  EXPECT_EQ(reader.accel_unit(), "m/s^2");
  ImuSample sample;
  ASSERT_TRUE(reader.next(sample));
  EXPECT_EQ(sample.stamp, 1403715273262142976);
  EXPECT_EQ(sample.accel.z(), -3.6938382);
  int rows = 1;
  while (reader.next(sample)) ++rows;
  EXPECT_GT(rows, 29000);
}

}  // namespace
}  // namespace allan_lio
