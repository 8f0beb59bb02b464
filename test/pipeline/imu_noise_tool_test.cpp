// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/io/imu_yaml.h"
#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr double kRounding = 1e-12;  // relative

const std::string kData = ALLAN_LIO_SOURCE_DIR "/test/data/noise/";

Outcome imu_noise(const std::string& arguments) { return run_tool("imu_noise " + arguments); }

class ImuNoiseToolTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return directory_.file(name); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    return file(name);
  }

  TemporaryDirectory directory_;
};

TEST_F(ImuNoiseToolTest, FastLioBecomesKalibrAndComesBack) {
  const std::string out = file("out.yaml"), back = file("back.yaml");
  const Outcome there =
      imu_noise("convert --from fast_lio --rate 400 " + kData + "fast_lio_ros2.yaml --to kalibr " + out);
  ASSERT_EQ(there.status, 0) << there.text;
  const Outcome again = imu_noise("convert " + out + " --to fast_lio " + back);
  ASSERT_EQ(again.status, 0) << again.text;
  const NoiseFile a = read_noise_file(contents_of(kData + "fast_lio_ros2.yaml"), "a", NoiseFormat::kFastLio, 400.0);
  const NoiseFile b = read_noise_file(contents_of(back), "b", NoiseFormat::kFastLio, 400.0);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(b.figures[i].value.x() / a.figures[i].value.x(), 1.0, kRounding) << a.figures[i].key;
}

TEST_F(ImuNoiseToolTest, StandardOutputHoldsTheFileAndNothingElse) {
  const Outcome outcome = imu_noise("convert imu/mti600 --to kalibr --rate 400 2>" + file("notes"));
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const NoiseFile read = read_noise_file(outcome.text, "stdout", NoiseFormat::kKalibr);
  EXPECT_EQ(read.rate, 400.0);
  EXPECT_NE(contents_of(file("notes")).find("correlation time of the gyro's bias is lost"), std::string::npos);
  EXPECT_EQ(imu_noise("convert imu/mti600 --to kalibr --rate 400 - 2>&-").text, outcome.text);
}

TEST_F(ImuNoiseToolTest, WhatItWritesForUsLoadsByName) {
  const std::string out = file("unit.yaml");
  ASSERT_EQ(imu_noise("convert " + kData + "kf_gins_a15.yaml --to allan_lio " + out).status, 0);
  const Outcome lint = imu_noise("lint " + out);
  EXPECT_EQ(lint.status, 0) << lint.text;
  EXPECT_NE(lint.text.find("format: allan_lio"), std::string::npos);
  const std::string robot = write("robot.yaml", "include: [unit]\n");
  EXPECT_EQ(imu_noise("lint " + robot).status, 0) << "an include is followed";
}

TEST_F(ImuNoiseToolTest, FastLiosDefaultsAreCalledByName) {
  const Outcome outcome = imu_noise("lint " + kData + "fast_lio_defaults.yaml --rate 400");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.text.find("FAST-LIO2's shipped defaults, not a calibration: k_g = 129, k_a = 27, k_gb = 32, "
                              "k_ab = 12.5 to 17.7 at 400 Hz against imu/mti600"),
            std::string::npos)
      << outcome.text;
}

TEST_F(ImuNoiseToolTest, ASoundFileIsFine) {
  for (const char* arguments : {"imu/mti600", "imu/ideal --rate 200", "imu/mti600 --against imu/bmi088"})
    EXPECT_EQ(imu_noise(std::string("lint ") + arguments).status, 0) << arguments;
  const Outcome outcome = imu_noise("lint " + kData + "openvins_euroc.yaml");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.text.find("nothing suspicious"), std::string::npos) << outcome.text;
}

TEST_F(ImuNoiseToolTest, AFileCanBeComparedWithAnother) {
  const Outcome outcome =
      imu_noise("lint " + kData + "openvins_euroc.yaml --against " + kData + "openvins_tum_vi.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("k_ab = 3.49 against " + kData + "openvins_tum_vi.yaml"), std::string::npos)
      << outcome.text;
}

TEST_F(ImuNoiseToolTest, ShowTellsAllFourKinds) {
  const Outcome outcome = imu_noise("show " + kData + "fast_lio_defaults.yaml --rate 400 --bias-time 31.7");
  EXPECT_EQ(outcome.status, 0);
  for (const char* part : {"Allan ", "Gauss-Markov", "random walk   K = 0.0005 rad/s^2/sqrt(Hz)",
                           "samples at 400 Hz: covariance 0.1 (rad/s)^2", "T_b = 31.7 s"})
    EXPECT_NE(outcome.text.find(part), std::string::npos) << part << '\n' << outcome.text;
}

TEST_F(ImuNoiseToolTest, BadUseAndUnreadableFilesEndWithStatusTwoAndOneLine) {
  const std::string defaults = kData + "fast_lio_defaults.yaml", out = file("out.yaml");
  const std::string zero = write("zero.yaml", "imuGyrNoise: 0\nimuAccNoise: 1\nimuGyrBiasN: 1\nimuAccBiasN: 1\n");
  const std::string nan = write("nan.yaml", "imuGyrNoise: .nan\nimuAccNoise: 1\nimuGyrBiasN: 1\nimuAccBiasN: 1\n");
  const std::string nobody = write("nobody.yaml", "lidar: {blind: 1}\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "subcommand is required"},
      {"lint", "file is required"},
      {"lint " + file("absent.yaml"), "absent.yaml' is not found"},
      {"convert --from kalibr --to lio_sam " + file("absent.yaml"), "absent.yaml: cannot be read"},
      {"lint " + directory_.path(), directory_.path() + ": cannot be read"},
      {"lint " + nobody, "nobody.yaml: holds no IMU noise of a format that is known"},
      {"lint " + nan, "nan.yaml:1: imuGyrNoise = '.nan' is not a finite decimal number"},
      {"lint " + defaults, "give --rate"},
      {"lint " + defaults + " --rate -1", "--rate"},
      {"lint " + defaults + " --rate 400 --against imu/none", "imu/none"},
      {"convert " + defaults + " --rate 400 " + out, "--to is required"},
      {"convert " + defaults + " --rate 400 --to kalibrr " + out, "'kalibrr' is not a format that is known"},
      {"convert " + defaults + " --rate 400 --to kf_gins " + out, "give --bias-time"},
      {"convert " + zero + " --to kalibr --rate 400 " + out, "zero.yaml: the gyro's white noise is zero"},
      {"convert " + defaults + " --rate 400 --to kalibr " + file("no/such/out.yaml"), "out.yaml: cannot be written"}};
  for (const auto& [arguments, sentence] : cases) {
    const Outcome outcome = imu_noise(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << " gives " << outcome.text;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << arguments << " gives " << outcome.text;
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(ImuNoiseToolTest, AFailedConversionLeavesTheOldFileAlone) {
  const std::string out = write("out.yaml", "precious\n");
  EXPECT_EQ(imu_noise("convert " + kData + "fast_lio_defaults.yaml --rate 400 --to kf_gins " + out).status, 2);
  EXPECT_EQ(contents_of(out), "precious\n");
  EXPECT_EQ(imu_noise("convert imu/mti600 --rate 400 --to kalibr " + out).status, 0);
  EXPECT_NE(contents_of(out), "precious\n");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) files += entry.is_regular_file();
  EXPECT_EQ(files, 1) << "nothing unfinished is left";
}

TEST_F(ImuNoiseToolTest, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  for (const char* out : {"/dev/full", "- >/dev/full"}) {
    const Outcome outcome = imu_noise(std::string("convert imu/mti600 --rate 400 --to kalibr ") + out);
    EXPECT_EQ(outcome.status, 2) << out;
    EXPECT_NE(outcome.text.find("cannot be written"), std::string::npos) << outcome.text;
  }
}

TEST_F(ImuNoiseToolTest, HelpNamesTheSubcommandsAndOptions) {
  const Outcome outcome = imu_noise("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* part : {"convert", "lint", "show"}) EXPECT_NE(outcome.text.find(part), std::string::npos) << part;
  const Outcome convert = imu_noise("convert --help");
  EXPECT_EQ(convert.status, 0);
  for (const char* part : {"--from", "--to", "--rate", "--bias-time", "kf_gins", "imu_utils_mintar"})
    EXPECT_NE(convert.text.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace allan_lio
