// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>

#include "allan_lio/io/tum.h"
#include "allan_lio/sim/recorded_imu.h"
#include "allan_lio/sim/recorded_trajectory.h"
#include "allan_lio/sim/sensor_report.h"
#include "allan_lio/sim/sensor_settings.h"
#include "shared_data.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0, kG = 9.80665;
constexpr double kRounding = 1e-15;

#define EXPECT_HAS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << text

TEST(SimSensorSettings, ValuesAreReadInTheirUnits) {
  const ImuDefects d =
      parse_imu_errors({"gyro_scale_factor=500ppm", "accel_misalignment=1.5mrad", "g_sensitivity=0.001deg/s/g",
                        "rectification=100ug/g^2", "clock_offset=-2ms", "dropped_samples=0.1%", "gyro_range=300deg/s",
                        "accel_quantization=3e-1mg", "vibration_frequency=90Hz"});
  EXPECT_NEAR(d.gyro.scale_factor, 5e-4, kRounding);
  EXPECT_EQ(d.accel.scale_factor, 0.0);
  EXPECT_NEAR(d.accel.misalignment, 1.5e-3, kRounding);
  EXPECT_NEAR(d.g_sensitivity, 0.001 * kDegree / kG, kRounding);
  EXPECT_NEAR(d.rectification, 1e-4 / kG, kRounding);
  EXPECT_NEAR(d.clock_offset, -2e-3, kRounding);
  EXPECT_NEAR(d.dropped_samples, 1e-3, kRounding);
  EXPECT_NEAR(d.gyro.range, 300 * kDegree, kRounding);
  EXPECT_NEAR(d.accel.quantization, 3e-4 * kG, kRounding);
  EXPECT_EQ(d.vibration_frequency, 90.0);
  const LidarEffects e = parse_lidar_effects({"divergence=3mrad", "quantization=2mm", "mixed_pixels=50%"});
  EXPECT_NEAR(e.divergence, 3e-3, kRounding);
  EXPECT_NEAR(e.quantization, 2e-3, kRounding);
  EXPECT_NEAR(e.mixed_pixels, 0.5, kRounding);
}

TEST(SimSensorSettings, NothingIsOnUnlessAskedForAndLaterWordsWin) {
  EXPECT_FALSE(parse_imu_errors({}).any());
  EXPECT_EQ(settings_text(ImuDefects()), "none");
  EXPECT_EQ(settings_text(LidarEffects()), "none");
  const ImuDefects d = parse_imu_errors({"real", "accel_vibration=0", "scale_factor=100ppm"});
  EXPECT_EQ(d.accel.vibration, 0.0);
  EXPECT_EQ(d.gyro.vibration, mti600_defects().gyro.vibration);
  EXPECT_NEAR(d.gyro.scale_factor, 1e-4, kRounding);
  EXPECT_NEAR(d.accel.scale_factor, 1e-4, kRounding);
  EXPECT_FALSE(parse_imu_errors({"vibration_frequency=90Hz"}).any()) << "a frequency without an amplitude is nothing";
}

TEST(SimSensorSettings, EveryExampleIsAcceptedAndTellsWhatIsSet) {
  ImuDefects defects;
  for (const SensorSetting& one : settings_of(defects))
    EXPECT_NO_THROW(parse_imu_errors({one.key + "=" + one.example})) << one.key;
  LidarEffects effects;
  for (const SensorSetting& one : settings_of(effects))
    EXPECT_NO_THROW(parse_lidar_effects({"divergence=1mrad", one.key + "=" + one.example})) << one.key;
  EXPECT_EQ(settings_text(parse_lidar_effects({"dropout_rate=2%", "quantization=5mm"})),
            "dropout_rate=0.02 quantization=0.005m");
}

TEST(SimSensorSettings, MistakesAreRefusedWithTheWordAndWhatThereIs) {
  const auto complaint = [](const std::string& word) -> std::string {
    try {
      parse_imu_errors({word});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_HAS(complaint("scale=1"), "'scale=1' is no error of an IMU; there are real, scale_factor=500ppm");
  EXPECT_HAS(complaint("unreal"), "'unreal'");
  EXPECT_HAS(complaint("scale_factor"), "'scale_factor'");
  EXPECT_HAS(complaint("clock_offset=2"), "'clock_offset=2': the unit is missing; write for example clock_offset=2ms");
  EXPECT_HAS(complaint("clock_offset=2m"), "'m' is no unit of s");
  EXPECT_HAS(complaint("gyro_range=5m/s^2"), "no unit of rad/s");
  EXPECT_HAS(complaint("scale_factor=5deg"), "no unit of a plain number");
  EXPECT_HAS(complaint("clock_offset=ms"), "no number");
  EXPECT_HAS(complaint("clock_offset=2parsec"), "parsec");
  EXPECT_HAS(complaint("gyro_scale_factor=-5ppm"), "'gyro_scale_factor' must lie between 0 and 1");
}

TEST(SimSensorReport, TellsEveryFigureAndTheConstantsThatWereDrawn) {
  LidarPattern pattern = make_lidar_pattern("livox_avia");
  pattern.effects = parse_lidar_effects({"real"});
  ImuErrorConfig errors;
  errors.defects = mti600_defects();
  const YAML::Node report = YAML::Load(sensor_report(pattern, "", errors, 200.0, 7));
  EXPECT_EQ(report["lidar"]["pattern"].as<std::string>(), "livox_avia");
  EXPECT_EQ(report["lidar"]["effects"]["quantization"].as<double>(), 0.002);
  EXPECT_EQ(report["imu"]["errors"]["clock_offset"].as<double>(), 0.001);
  const ImuDefectModel model(errors.defects, 200.0, 7);
  EXPECT_EQ(report["imu"]["drawn"]["accel_error"][1][2].as<double>(), model.accel_error()(1, 2));
  EXPECT_FALSE(YAML::Load(sensor_report(pattern, "", {}, 200.0, 7))["imu"]["drawn"]);
  EXPECT_HAS(sensor_report(pattern, "log.csv", errors, 200.0, 7), "recorded: \"log.csv\"");
}

class SimRecordedImu : public ::testing::Test {
 protected:
  std::string write(const std::string& text) const {
    const std::string path = directory_.file("imu.csv");
    std::ofstream(path) << text;
    return path;
  }
  TemporaryDirectory directory_;
};

const char* const kEuroc =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m "
    "s^-2],a_RS_S_z [m s^-2]\n";

TEST_F(SimRecordedImu, EurocRowsBecomeSamplesWithTheirStamps) {
  const auto record = read_recorded_imu(write(std::string(kEuroc) + "1403715273262142976,-0.1,0.2,0.3,9,0.5,-3\n"
                                                                    "1403715273267143000,0.1,0.2,nan,9,0.5,-3\n"
                                                                    "1403715273272143104,0.4,0.5,0.6,8,0.7,-4\n"));
  ASSERT_EQ(record.size(), 2u) << "a row with a hole is left out";
  EXPECT_EQ(record[0].stamp, 1403715273262142976);
  EXPECT_EQ(record[1].stamp, 1403715273272143104);
  EXPECT_EQ(record[1].gyro, Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_EQ(record[1].accel, Eigen::Vector3d(8, 0.7, -4));
}

TEST_F(SimRecordedImu, UnitsOfTheHeaderAreConverted) {
  const auto record = read_recorded_imu(
      write("t_s,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,accel_x_g,accel_y_g,accel_z_g\n1.0,90,0,0,0,0,1\n"
            "1.005,90,0,0,0,0,1\n"));
  EXPECT_NEAR(record.at(0).gyro.x(), 90 * kDegree, kRounding);
  EXPECT_NEAR(record.at(0).accel.z(), kG, kRounding);
}

TEST_F(SimRecordedImu, TimesThatDoNotRiseAndRecordsWithoutTimeAreRefused) {
  EXPECT_THROW(read_recorded_imu(write(std::string(kEuroc) + "200,0,0,0,0,0,9\n100,0,0,0,0,0,9\n")),
               std::runtime_error);
  EXPECT_THROW(read_recorded_imu(write("0.1,0.1,0.1,0.1,0.1,9\n0.1,0.1,0.1,0.1,0.1,9\n")), std::runtime_error);
}

TEST(SimRecordedImuCut, ThePieceCoversTheTrajectoryAndARecordThatDoesNotIsRefused) {
  std::vector<ImuSample> record(1000);
  for (int k = 0; k < 1000; ++k) record[k].stamp = kNsPerSecond + k * 10000000LL + 5;  // 1 s to 11 s
  const SimulatedImu imu = recorded_imu(record, 3 * kNsPerSecond, 5 * kNsPerSecond);
  EXPECT_EQ(imu.samples.front().stamp, 3 * kNsPerSecond - 10000000 + 5) << "the one before the begin";
  EXPECT_EQ(imu.samples.back().stamp, 5 * kNsPerSecond - 10000000 + 5);
  EXPECT_EQ(imu.true_stamps.front(), imu.samples.front().stamp);
  EXPECT_TRUE(imu.gyro_bias.empty()) << "nobody knows them";
  EXPECT_THROW(recorded_imu(record, 0, 5 * kNsPerSecond), std::invalid_argument);
  EXPECT_THROW(recorded_imu(record, 3 * kNsPerSecond, 12 * kNsPerSecond), std::invalid_argument);
}

TEST(SimRecordedImuCut, TheSharedEurocRecordIsRead) {
  const std::string folder = shared_data("euroc_v1_01");
  if (folder.empty()) GTEST_SKIP() << "the shared data are not here";
  const auto record = read_recorded_imu(folder + "/imu.csv");
  EXPECT_EQ(record.size(), 29120u);
  EXPECT_EQ(record.front().stamp, 1403715273262142976);
  EXPECT_NEAR(record.front().accel.norm(), 9.8, 0.2);
}

/// The record's frames and clock: along the fitted path, turned and moved as a simulation does, an IMU without errors
/// reads what the real one read, but for the biases (fitted by the makers of the shared folder) and its vibration.
TEST(SimRecordedImuCut, TheEurocImuReadsWhatItsTruthMakesOneReadButForItsBiases) {
  const std::string folder = shared_data("euroc_v1_01");
  if (folder.empty()) GTEST_SKIP() << "the shared data are not here";
  const Trajectory truth = read_tum(folder + "/truth.tum");
  RecordedOptions options;
  options.standstill = 0.0;
  const RecordedTrajectory way(truth, place_record(truth, {50.0, -20.0, 3.0}, 1.1), options);
  const TimeNs begin = way.first_stamp(), end = begin + to_ns(way.duration());
  const SimulatedImu imu = recorded_imu(read_recorded_imu(folder + "/imu.csv"), begin, end);
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : imu.samples) {
    const MotionState state = way.at(way.time_of(sample.stamp));
    gyro += (sample.gyro - state.rate_imu) / static_cast<double>(imu.samples.size());
    accel += (sample.accel - specific_force(state)) / static_cast<double>(imu.samples.size());
  }
  constexpr double kGyroTolerance = 1e-3;   // [rad/s]
  constexpr double kAccelTolerance = 0.03;  // [m/s^2]: the truth's world is level within 0.15 deg
  EXPECT_LT((gyro - Eigen::Vector3d(-0.00242, 0.02086, 0.07621)).norm(), kGyroTolerance) << gyro.transpose();
  EXPECT_LT((accel - Eigen::Vector3d(-0.022, 0.151, 0.077)).norm(), kAccelTolerance) << accel.transpose();
}

}  // namespace
}  // namespace allan_lio
