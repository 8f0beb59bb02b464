// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Temperature.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <utility>
#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/yaml_source.h"
#include "child_process.h"
#include "shared_data.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr double kDegree = M_PI / 180.0, kGravity = 9.80665;
constexpr TimeNs kPeriod = 20'000'000;                     // 50 Hz
constexpr double kGyroWhite = 1e-4, kAccelWhite = 1e-3;    // [u/sqrt(Hz)]
constexpr double kGyroSigma = 1e-4, kAccelSigma = 1.2e-3;  // of the Gauss-Markov biases [u]
constexpr double kBiasTime = 10.0;                         // [s]

/// White noise and Gauss-Markov biases, 3000 s.
std::vector<ImuSample> simulate(std::size_t count = 150000) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const double dt = 1e-9 * kPeriod, decay = std::exp(-dt / kBiasTime), drive = std::sqrt(1.0 - decay * decay);
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
  std::vector<ImuSample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i].stamp = 1'600'000'000 * kNsPerSecond + static_cast<TimeNs>(i) * kPeriod;
    for (int axis = 0; axis < 3; ++axis) {
      gyro_bias[axis] = decay * gyro_bias[axis] + drive * kGyroSigma * normal(random);
      accel_bias[axis] = decay * accel_bias[axis] + drive * kAccelSigma * normal(random);
      samples[i].gyro[axis] = 0.01 + gyro_bias[axis] + kGyroWhite / std::sqrt(dt) * normal(random);
      samples[i].accel[axis] = accel_bias[axis] + kAccelWhite / std::sqrt(dt) * normal(random);
    }
    samples[i].accel.z() += kGravity + 0.1;
  }
  return samples;
}

/// Rows of a table, readings divided by `gyro` and `accel`.
std::string rows(const std::vector<ImuSample>& samples, double gyro = 1.0, double accel = 1.0, bool stamps = true) {
  std::string text;
  for (const ImuSample& s : samples) {
    char row[256];
    if (stamps) {
      std::snprintf(row, sizeof row, "%lld.%09lld,", static_cast<long long>(s.stamp / kNsPerSecond),
                    static_cast<long long>(s.stamp % kNsPerSecond));
      text += row;
    }
    std::snprintf(row, sizeof row, "%.12g,%.12g,%.12g,%.12g,%.12g,%.12g\n", s.gyro.x() / gyro, s.gyro.y() / gyro,
                  s.gyro.z() / gyro, s.accel.x() / accel, s.accel.y() / accel, s.accel.z() / accel);
    text += row;
  }
  return text;
}

Outcome run(const std::string& arguments) { return run_tool("allan_variance " + arguments); }

/// A file without its header comments.
std::string body_of(const std::string& text) { return text.substr(text.find("imu:")); }

NoiseSpec spec_of(const std::string& file) { return read_config(load_yaml(file, {})).imu.spec; }

class AllanVarianceToolTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = new TemporaryDirectory;
    std::ofstream(file("imu.csv")) << rows(simulate());
  }
  static void TearDownTestSuite() {
    delete directory_;
    directory_ = nullptr;
  }
  static std::string file(const std::string& name) { return directory_->file(name); }
  static std::string csv() { return "--csv " + file("imu.csv"); }
  static std::string out() { return " --out " + file("out.yaml"); }

  void SetUp() override { std::filesystem::remove(file("out.yaml")); }

  static void expect_truth(const NoiseSpec& spec) {
    // The intervals' own widths at 3000 s, with room.
    constexpr double kWhite = 0.03, kInstability = 0.25, kTimeFactor = 2.0;
    const double flat = std::sqrt(2.0 * gauss_markov_peak_value());  // sigma_b over the steady-state deviation
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(spec.gyro.white[axis], kGyroWhite, kWhite * kGyroWhite);
      EXPECT_NEAR(spec.accel.white[axis], kAccelWhite, kWhite * kAccelWhite);
      EXPECT_NEAR(spec.gyro.bias_instability[axis], flat * kGyroSigma, kInstability * flat * kGyroSigma);
      EXPECT_NEAR(spec.accel.bias_instability[axis], flat * kAccelSigma, kInstability * flat * kAccelSigma);
      for (const double time : {spec.gyro.bias_time[axis], spec.accel.bias_time[axis]}) {
        EXPECT_GT(time, kBiasTime / kTimeFactor);
        EXPECT_LT(time, kBiasTime * kTimeFactor);
      }
    }
    EXPECT_NEAR(spec.gyro.turn_on_bias[0], 0.01, 2e-4);
    EXPECT_NEAR(spec.accel.turn_on_bias[0], 0.1, 2e-3);
  }

  static TemporaryDirectory* directory_;
};
TemporaryDirectory* AllanVarianceToolTest::directory_ = nullptr;

TEST_F(AllanVarianceToolTest, ATableGivesAFileThatTheConfigurationAccepts) {
  const Outcome outcome = run(csv() + out() + " --table " + file("table.csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  expect_truth(spec_of(file("out.yaml")));
  for (const char* words : {"record       imu.csv", "150000 samples at 50 Hz", "temperature  not recorded", "gyro x",
                            "accel z", "deg/sqrt(h)", "ug/sqrt(Hz)", "Gauss-Markov T_b", "flat part tau_flat"})
    EXPECT_NE(outcome.text.find(words), std::string::npos) << words;

  const std::string text = contents_of(file("out.yaml"));
  for (const char* words : {"record:      imu.csv", "length:      3000 s at 50 Hz", "temperature: not recorded",
                            "least squares", "one sample of a turn-on bias"})
    EXPECT_NE(text.find(words), std::string::npos) << words;
  const std::string table = contents_of(file("table.csv"));
  EXPECT_EQ(table.substr(0, table.find(",accel_x")),
            "tau,gyro_x,gyro_x_low,gyro_x_high,gyro_x_fitted,gyro_y,gyro_y_low,gyro_y_high,gyro_y_fitted,gyro_z,"
            "gyro_z_low,gyro_z_high,gyro_z_fitted");
  EXPECT_EQ(table.find("nan"), std::string::npos);
  EXPECT_NE(table.find("\n0.02,"), std::string::npos);
}

TEST_F(AllanVarianceToolTest, ABagGivesTheSameAsATable) {
  ASSERT_EQ(run(csv() + out()).status, 0);
  const std::string by_table = contents_of(file("out.yaml"));
  {
    rosbag::Bag bag(file("imu.bag"), rosbag::bagmode::Write);
    for (const ImuSample& s : simulate()) {
      sensor_msgs::Imu imu;
      imu.header.stamp.fromNSec(static_cast<std::uint64_t>(s.stamp));
      // The table's twelve digits.
      const auto rounded = [](double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.12g", value);
        return std::strtod(text, nullptr);
      };
      imu.angular_velocity.x = rounded(s.gyro.x());
      imu.angular_velocity.y = rounded(s.gyro.y());
      imu.angular_velocity.z = rounded(s.gyro.z());
      imu.linear_acceleration.x = rounded(s.accel.x());
      imu.linear_acceleration.y = rounded(s.accel.y());
      imu.linear_acceleration.z = rounded(s.accel.z());
      bag.write("/imu/data", imu.header.stamp, imu);
      if (s.stamp % kNsPerSecond != 0) continue;
      sensor_msgs::Temperature temperature;
      temperature.temperature = 20.0 + 0.001 * static_cast<double>((s.stamp / kNsPerSecond) % 3000);
      bag.write("/imu/temperature", imu.header.stamp, temperature);
    }
  }
  const Outcome outcome = run("--bag " + file("imu.bag") + " --temperature-topic imu/temperature" + out());
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const std::string by_bag = contents_of(file("out.yaml"));
  EXPECT_EQ(body_of(by_bag), body_of(by_table));
  EXPECT_NE(by_bag.find("record:      imu.bag /imu/data"), std::string::npos);
  EXPECT_NE(by_bag.find("temperature: 20 to 23 degC"), std::string::npos) << by_bag;
}

TEST_F(AllanVarianceToolTest, StampsUnitsAndThreadsDoNotMatter) {
  ASSERT_EQ(run(csv() + out() + " --threads 1").status, 0);
  const std::string expected = body_of(contents_of(file("out.yaml")));
  std::ofstream(file("bare.csv")) << rows(simulate(), 1.0, 1.0, false);
  std::ofstream(file("units.csv")) << "t,wx [deg/s],wy [deg/s],wz [deg/s],ax [mg],ay [mg],az [mg]\n"
                                   << rows(simulate(), kDegree, 1e-3 * kGravity);
  std::ofstream(file("g.csv")) << rows(simulate(), kDegree, kGravity);
  for (const std::string& arguments :
       {csv() + " --threads 2", "--csv " + file("bare.csv") + " --rate 50", "--csv - < " + file("imu.csv"),
        "--csv " + file("units.csv"), "--csv " + file("g.csv") + " --gyro-unit deg/s"}) {
    const Outcome outcome = run(out() + " " + arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_EQ(body_of(contents_of(file("out.yaml"))), expected) << arguments;
  }
}

TEST_F(AllanVarianceToolTest, TheBiasCanBeTheGaussMarkovOne) {
  ASSERT_EQ(run(csv() + out() + " --bias gauss_markov").status, 0);
  expect_truth(spec_of(file("out.yaml")));
  EXPECT_NE(contents_of(file("out.yaml")).find("Gauss-Markov bias of the fit"), std::string::npos);
}

TEST_F(AllanVarianceToolTest, MaximumLikelihoodFindsTheSame) {
  const Outcome outcome = run(csv() + out() + " --method ml");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  expect_truth(spec_of(file("out.yaml")));
  EXPECT_NE(contents_of(file("out.yaml")).find("maximum likelihood"), std::string::npos);
}

TEST_F(AllanVarianceToolTest, WhatIsNotObservableIsLeftToTheUser) {
  // The simulated noise has no random walk.
  const Outcome outcome = run(csv() + out() + " --bias random_walk");
  EXPECT_EQ(outcome.status, 1) << outcome.text;
  EXPECT_NE(outcome.text.find("gyro_bias_random_walk is not observable in this record"), std::string::npos)
      << outcome.text;
  const std::string text = contents_of(file("out.yaml"));
  EXPECT_NE(text.find("\n    # not observable in this record, "), std::string::npos) << text;
  EXPECT_NE(text.find("\n    # gyro_bias_random_walk: {value: ["), std::string::npos) << text;
  EXPECT_NE(text.find("unit: rad/s^2/sqrt(Hz)}"), std::string::npos) << text;
  EXPECT_THROW(spec_of(file("out.yaml")), ConfigError);
}

TEST_F(AllanVarianceToolTest, ThePlotIsDrawn) {
  if (run_command("/usr/bin/python3 -c 'import matplotlib'").status != 0) GTEST_SKIP() << "matplotlib is not here";
  const Outcome outcome = run(csv() + out() + " --plot " + file("allan.png"));
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_EQ(contents_of(file("allan.png")).substr(0, 4), "\x89PNG");
}

TEST_F(AllanVarianceToolTest, FaultsOfTheRecordAreSaid) {
  std::vector<ImuSample> samples = simulate();
  samples[1000].gyro.x() = std::nan("");
  samples[2000].stamp = samples[1999].stamp;
  for (std::size_t i = 60000; i < 60200; ++i) samples[i].accel.x() += std::sin(static_cast<double>(i));
  samples.erase(samples.begin() + 100000, samples.begin() + 100100);
  std::ofstream(file("faults.csv")) << rows(samples) << "1600003000.0,1,2";
  const Outcome outcome = run("--csv " + file("faults.csv") + out());
  for (const char* words :
       {"1 sample dropped for NaN or inf", "1 sample dropped for a stamp not later", "1 gap of more than 10 samples",
        "in 2 pieces", "the last line is cut off", "allan_variance: the sensor was not still"})
    EXPECT_NE(outcome.text.find(words), std::string::npos) << words << " in\n" << outcome.text;
  EXPECT_NE(contents_of(file("out.yaml")).find("note:        WARNING: the sensor was not still"), std::string::npos);
}

TEST_F(AllanVarianceToolTest, BadInputIsOneSentenceAndNothingIsWritten) {
  std::ofstream(file("bad.csv")) << "0.00,0,0,0,0,0,9.8\n0.01,0,0,x,0,0,9.8\n0.02,0,0,0,0,0,9.8\n";
  std::ofstream(file("short.csv")) << rows(simulate(20));
  std::ofstream(file("one.csv")) << rows(simulate(1));
  std::ofstream(file("bare6.csv")) << rows(simulate(100), 1.0, 1.0, false);
  std::vector<ImuSample> dead = simulate(5000);
  for (ImuSample& s : dead) s.gyro.y() = 0.5;
  std::ofstream(file("dead.csv")) << rows(dead);
  std::ofstream(file("feet.csv")) << rows(simulate(5000), 1.0, 0.01);
  const std::string elsewhere = file("no/such/directory.yaml");
  const std::pair<std::string, std::string> cases[] = {
      {out(), "give either --bag or --csv"},
      {csv() + " --bag x.bag" + out(), "give either --bag or --csv"},
      {csv() + " --topic /imu" + out(), "--topic and --temperature-topic need --bag"},
      {csv(), "--out is required"},
      {csv() + out() + " --method magic", "magic not in"},
      {csv() + out() + " --rate -5", "--rate"},
      {csv() + out() + " --gyro-unit m/s", "--gyro-unit: unit 'm/s'"},
      {csv() + out() + " --accel-unit furlong", "--accel-unit: unit 'furlong'"},
      {csv() + " --out " + elsewhere, elsewhere + ": cannot be written"},
      {csv() + out() + " --plot " + elsewhere, elsewhere + ": cannot be written"},
      {"--csv " + file("absent.csv") + out(), "absent.csv: cannot be opened"},
      {"--csv " + file("bad.csv") + out(), "bad.csv:2: 'x' is not a number"},
      {"--csv " + file("short.csv") + out(), "gyro x: "},
      {"--csv " + file("one.csv") + out(), "one.csv: holds no two usable samples"},
      {"--csv " + file("bare6.csv") + out(), "has no column of time: give the sampling rate with --rate"},
      {"--csv " + file("dead.csv") + out(), "gyro y: it reads the same value all the time"},
      {"--csv " + file("feet.csv") + out(), "neither g nor m/s^2"},
      {"--bag " + file("absent.bag") + out(), "absent.bag"},
      {"--bag " + file("imu.csv") + out(), "is not a bag"}};
  for (const auto& [arguments, sentence] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << " gives " << outcome.text;
    EXPECT_NE(outcome.text.find("allan_variance: "), std::string::npos) << arguments;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << arguments << " gives " << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(file("out.yaml"))) << arguments;
    EXPECT_FALSE(std::filesystem::exists(file("out.yaml.part"))) << arguments;
  }
}

TEST_F(AllanVarianceToolTest, HelpNamesEveryOption) {
  const Outcome outcome = run("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* option : {"--bag", "--topic", "--csv", "--rate", "--out", "--table", "--plot", "--method", "--bias",
                             "--temperature-topic", "--gyro-unit", "--accel-unit", "--time-unit", "--threads"})
    EXPECT_NE(outcome.text.find(option), std::string::npos) << option;
}

TEST_F(AllanVarianceToolTest, RealLogsAgreeWithTheirPublishedCurves) {
  const std::string data = shared_data("static_adis16405");
  if (data.empty()) GTEST_SKIP() << "shared/data/static_adis16405 is not here";
  const std::string tool = ALLAN_LIO_BIN_DIR "/allan_variance";
  // 1 s and 10 s of the README's table: gyro x, accel z.
  const double expected[3][4] = {{7.138e-04, 6.086e-03, 2.334e-04, 2.299e-03},
                                 {7.058e-04, 6.157e-03, 2.368e-04, 2.249e-03},
                                 {7.293e-04, 6.288e-03, 2.394e-04, 2.158e-03}};
  constexpr double kFourDigits = 2.5e-4;  // half of the last one, beside a first of 2
  for (int log = 0; log < 3; ++log) {
    const Outcome outcome = run_command("xz -dc " + data + "/imu" + std::to_string(log + 1) + ".csv.xz | " + tool +
                                        " --csv - --table " + file("real.csv") + out());
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 1) << outcome.text;
    std::ifstream in(file("real.csv"));
    int compared = 0;
    for (std::string line; std::getline(in, line);) {
      std::vector<double> columns;
      std::istringstream words(line);
      for (std::string word; std::getline(words, word, ',');) columns.push_back(std::atof(word.c_str()));
      if (columns[0] != 1.0 && columns[0] != 10.0) continue;
      const double* row = expected[log] + (columns[0] == 1.0 ? 0 : 2);
      EXPECT_NEAR(columns[1], row[0], kFourDigits * row[0]);
      EXPECT_NEAR(columns[21], row[1], kFourDigits * row[1]);
      ++compared;
    }
    EXPECT_EQ(compared, 2);
    // N, which the sensor's filter spares between 0.3 and 3 s: 7.1e-4 rad/s/sqrt(Hz), by the README.
    const std::string text = contents_of(file("out.yaml"));
    EXPECT_NE(text.find("length:      10000 s at 100 Hz"), std::string::npos);
    const std::size_t white = text.find("gyro_white_noise: {value: [");
    ASSERT_NE(white, std::string::npos);
    EXPECT_NEAR(std::atof(text.c_str() + white + 27), 2.4, 0.15);
  }
}

TEST_F(AllanVarianceToolTest, TheFitBeginsWhereOneSaysAndRefusesWhatLeavesNothing) {
  const Outcome from = run(csv() + " --from 0.5 --out " + file("from.yaml"));
  EXPECT_NE(from.text.find("from 0.5 s on"), std::string::npos) << from.text;
  EXPECT_EQ(run(csv() + " --from 1e6 --out " + file("from.yaml")).status, 2);
  EXPECT_EQ(run(csv() + " --from -1 --out " + file("from.yaml")).status, 2);
}

TEST_F(AllanVarianceToolTest, WhoReadsOnlyTheFirstLineStillGetsTheFiles) {
  run(csv() + " --out " + file("piped.yaml") + " --table " + file("piped.csv") + " | head -1");
  EXPECT_NE(contents_of(file("piped.yaml")).find("gyro_white_noise"), std::string::npos);
  EXPECT_FALSE(contents_of(file("piped.csv")).empty());
}

}  // namespace
}  // namespace allan_lio
