// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/imu_yaml.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/io/yaml_source.h"
#include "child_process.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr double kRounding = 1e-12;  // relative
constexpr double kRate = 400.0, kBiasTime = 100.0;
constexpr double kDeg = M_PI / 180.0;

const std::string kData = ALLAN_LIO_SOURCE_DIR "/test/data/noise/";

std::vector<NoiseFormat> all_formats() {
  std::vector<NoiseFormat> formats;
  for (const std::string& name : noise_format_names()) formats.push_back(noise_format_by_name(name));
  return formats;
}

NoiseFile read_sample(const std::string& name, double rate = 0.0) {
  const std::string text = contents_of(kData + name);
  return read_noise_file(text, name, detect_noise_format(text, name), rate);
}

std::string error_of(const std::string& text, NoiseFormat format, double rate = kRate) {
  try {
    read_noise_file(text, "in.yaml", format, rate);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string write_error_of(const NoiseSpec& spec, NoiseFormat format, const WriteOptions& options) {
  try {
    write_noise(spec, format, options, nullptr);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

bool mentions(const std::vector<std::string>& notes, const std::string& part) {
  for (const std::string& note : notes)
    if (note.find(part) != std::string::npos) return true;
  return false;
}

void expect_same(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const std::string& what) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i] / b[i], 1.0, kRounding) << what << ", axis " << i;
}

/// S_b, a level without a T_b being given kBiasTime.
Eigen::Vector3d psd(SensorNoise sensor) {
  if (!sensor.bias_time.allFinite()) sensor.bias_time.setConstant(kBiasTime);
  return bias_psd(sensor);
}

void expect_same_noise(const NoiseSpec& a, const NoiseSpec& b, const std::string& what) {
  expect_same(a.gyro.white, b.gyro.white, what + ", N_g");
  expect_same(a.accel.white, b.accel.white, what + ", N_a");
  expect_same(psd(a.gyro), psd(b.gyro), what + ", S_bg");
  expect_same(psd(a.accel), psd(b.accel), what + ", S_ba");
}

/// `axes` scales the y and z axes.
NoiseSpec some_spec(const Eigen::Vector3d& axes) {
  NoiseSpec spec = mti600_spec();
  for (SensorNoise* sensor : {&spec.gyro, &spec.accel}) {
    sensor->white = sensor->white.cwiseProduct(axes);
    sensor->bias_instability = sensor->bias_instability.cwiseProduct(axes.reverse());
    sensor->bias_time.setConstant(kBiasTime);
  }
  return spec;
}

NoiseFile through(const NoiseSpec& spec, NoiseFormat format) {
  const std::string text = write_noise(spec, format, {kRate, kBiasTime}, nullptr);
  EXPECT_EQ(
      detect_noise_format(text, "out.yaml") == format ||
          (format == NoiseFormat::kImuUtilsMintar && detect_noise_format(text, "out.yaml") == NoiseFormat::kImuUtils),
      true)
      << text;
  NoiseFile file = read_noise_file(text, "out.yaml", format, kRate);
  EXPECT_EQ(file.format, format) << text;
  return file;
}

void expect_round_trip(const NoiseSpec& spec, NoiseFormat x, NoiseFormat y) {
  const std::string what = noise_format_name(x) + " to " + noise_format_name(y) + " and back";
  const NoiseFile there = through(spec, x);
  expect_same_noise(there.spec, spec, noise_format_name(x));
  const NoiseFile back = through(through(there.spec, y).spec, x);
  expect_same_noise(back.spec, there.spec, what);
  ASSERT_EQ(back.figures.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    // Our own format keeps the kind of the bias, which the other may have changed.
    if (back.figures[i].kind != there.figures[i].kind && x == NoiseFormat::kAllanLio) continue;
    EXPECT_EQ(back.figures[i].kind, there.figures[i].kind) << what;
    expect_same(back.figures[i].value, there.figures[i].value, what + ", " + there.figures[i].key);
  }
  if (x == NoiseFormat::kKfGins) expect_same(back.spec.gyro.bias_time, spec.gyro.bias_time, what + ", T_b");
}

TEST(ImuYaml, EveryPairOfFormatsIsExactToRoundingThereAndBack) {
  for (const NoiseFormat x : all_formats())
    for (const NoiseFormat y : all_formats()) expect_round_trip(some_spec({1, 1, 1}), x, y);
}

TEST(ImuYaml, AxesSurviveBetweenFormatsThatHoldThem) {
  const NoiseFormat per_axis[] = {NoiseFormat::kAllanLio, NoiseFormat::kImuUtils, NoiseFormat::kImuUtilsMintar,
                                  NoiseFormat::kKfGins};
  for (const NoiseFormat x : per_axis)
    for (const NoiseFormat y : per_axis) expect_round_trip(some_spec({1, 1.3, 0.7}), x, y);
}

TEST(ImuYaml, OurOwnFormatKeepsTheKindOfTheBias) {
  for (const BiasKind kind : {BiasKind::kAllan, BiasKind::kRandomWalk, BiasKind::kGaussMarkov}) {
    NoiseSpec spec = mti600_spec();
    spec.gyro = convert_bias(spec.gyro, kind, 0.0);
    spec.accel = convert_bias(spec.accel, kind, 0.0);
    const NoiseFile file = through(spec, NoiseFormat::kAllanLio);
    EXPECT_EQ(bias_kind(file.spec.gyro), kind);
    EXPECT_EQ(bias_kind(file.spec.accel), kind);
    expect_same_noise(file.spec, spec, "allan_lio");
    expect_same(file.spec.gyro.turn_on_bias, spec.gyro.turn_on_bias, "turn-on bias");
    if (kind != BiasKind::kRandomWalk) expect_same(file.spec.accel.bias_time, spec.accel.bias_time, "T_ba");
  }
}

TEST(ImuYaml, AnUnknownTurnOnBiasIsWrittenAsAMarkedEstimate) {
  NoiseSpec spec = mti600_spec();
  spec.gyro.turn_on_bias.setZero();
  spec.accel.turn_on_bias.setZero();
  std::vector<std::string> notes;
  const std::string text = write_noise(spec, NoiseFormat::kAllanLio, {}, &notes);
  EXPECT_NE(text.find("gyro_turn_on_bias: {value: 0.5, unit: deg/s}  # [est.]"), std::string::npos) << text;
  EXPECT_TRUE(mentions(notes, "gyro_turn_on_bias {value: 0.5, unit: deg/s} is an estimate"));
  EXPECT_TRUE(mentions(notes, "accel_turn_on_bias {value: 20, unit: mg} is an estimate"));
  EXPECT_NEAR(read_noise_file(text, "x", NoiseFormat::kAllanLio).spec.gyro.turn_on_bias.x(), 0.5 * kDeg, kRounding);
}

TEST(ImuYaml, OneFigureForThreeAxesIsTheirMeanInS) {
  std::vector<std::string> notes;
  NoiseSpec spec = mti600_spec();
  spec.gyro.white << 1e-4, 2e-4, 3e-4;
  const std::string text = write_noise(spec, NoiseFormat::kLioSam, {}, &notes);
  const NoiseFile file = read_noise_file(text, "x", NoiseFormat::kLioSam);
  EXPECT_NEAR(file.spec.gyro.white.x(), std::sqrt((1.0 + 4.0 + 9.0) / 3.0) * 1e-4, kRounding * 1e-4);
  EXPECT_NEAR(psd(file.spec.accel).x() / psd(spec.accel).mean(), 1.0, kRounding);
  EXPECT_TRUE(mentions(notes, "the gyro's axes differ"));
  EXPECT_TRUE(mentions(notes, "the accelerometer's axes differ")) << "T_ba differs by axis, hence S_ba";
  EXPECT_TRUE(mentions(notes, "correlation time of the gyro's bias is lost"));
}

TEST(ImuYaml, EverySampleIsRecognised) {
  const std::pair<const char*, NoiseFormat> samples[] = {
      {"fast_lio_defaults.yaml", NoiseFormat::kFastLio},
      {"fast_lio_ros2.yaml", NoiseFormat::kFastLio},
      {"kalibr_example.yaml", NoiseFormat::kKalibr},
      {"kalibr_adis16448.yaml", NoiseFormat::kKalibr},
      {"allan_variance_ros_d435i.yaml", NoiseFormat::kAllanVarianceRos},
      {"openvins_euroc.yaml", NoiseFormat::kOpenVins},
      {"openvins_tum_vi.yaml", NoiseFormat::kOpenVins},
      {"imu_utils_mti100.yaml", NoiseFormat::kImuUtils},
      {"imu_utils_mintar_mti100.yaml", NoiseFormat::kImuUtilsMintar},
      {"imu_utils_old_adis16448.yaml", NoiseFormat::kImuUtils},
      {"lio_sam_defaults.yaml", NoiseFormat::kLioSam},
      {"lio_sam_gx5_25.yaml", NoiseFormat::kLioSam},
      {"point_lio_defaults.yaml", NoiseFormat::kPointLio},
      {"kf_gins_a15.yaml", NoiseFormat::kKfGins},
      {"kf_gins_template.yaml", NoiseFormat::kKfGins}};
  for (const auto& [name, format] : samples) EXPECT_EQ(read_sample(name, 200.0).format, format) << name;
  const std::string ours = contents_of(ALLAN_LIO_SOURCE_DIR "/config/imu/mti600.yaml");
  EXPECT_EQ(detect_noise_format(ours, "mti600.yaml"), NoiseFormat::kAllanLio);
  EXPECT_THROW(detect_noise_format("lidar: {blind: 1}\n", "x.yaml"), ConfigError);
}

TEST(ImuYaml, KalibrsFiguresAreDensitiesAndRandomWalks) {
  const NoiseFile file = read_sample("kalibr_example.yaml");
  EXPECT_EQ(file.rate, 500.0);
  EXPECT_EQ(file.spec.gyro.white, Eigen::Vector3d::Constant(1.87e-4));
  EXPECT_EQ(file.spec.accel.white, Eigen::Vector3d::Constant(1.86e-3));
  EXPECT_EQ(file.spec.gyro.bias_random_walk, Eigen::Vector3d::Constant(2.66e-5));
  EXPECT_EQ(file.spec.accel.bias_random_walk, Eigen::Vector3d::Constant(4.33e-4));
  EXPECT_EQ(file.figures[3].key, "accelerometer_random_walk");
  EXPECT_EQ(file.figures[3].origin, "kalibr_example.yaml:5");
}

TEST(ImuYaml, OpenVinsHeaderAndMatricesAreNoHindrance) {
  const NoiseFile file = read_sample("openvins_euroc.yaml");
  EXPECT_EQ(file.rate, 200.0);
  EXPECT_EQ(file.spec.accel.bias_random_walk, Eigen::Vector3d::Constant(3e-3));
  EXPECT_EQ(file.figures[0].origin, "openvins_euroc.yaml:14");
}

TEST(ImuYaml, FastLiosCovariancesAreOfSamples) {
  const NoiseFile file = read_sample("fast_lio_defaults.yaml", kRate);
  EXPECT_NEAR(file.spec.gyro.white.x(), std::sqrt(0.1 / 400.0), kRounding);
  EXPECT_NEAR(file.spec.accel.bias_random_walk.z(), std::sqrt(1e-4 / 400.0), kRounding);
  EXPECT_EQ(file.figures[1].key, "mapping/acc_cov");
  EXPECT_EQ(file.figures[1].value.x(), 0.1);
  const NoiseFile ros2 = read_sample("fast_lio_ros2.yaml", kRate);
  constexpr double kDigits = 1e-4;  // relative, of the sample
  EXPECT_NEAR(ros2.spec.gyro.white.x() / mti600_spec().gyro.white.x(), 1.0, kDigits);
  EXPECT_NEAR(ros2.spec.accel.bias_random_walk.x() / std::sqrt(bias_psd(mti600_spec().accel).x()), 1.0, kDigits);
}

TEST(ImuYaml, PointLioTellsItsRateAndWhichCovariancesItUses) {
  const NoiseFile file = read_sample("point_lio_defaults.yaml");
  EXPECT_NEAR(file.rate, 200.0, kRounding * 200.0);
  EXPECT_NEAR(file.spec.gyro.white.x(), std::sqrt(0.1 / 200.0), kRounding);
  const std::string text = "use_imu_as_input: true\n" + contents_of(kData + "point_lio_defaults.yaml");
  const NoiseFile input = read_noise_file(text, "x", NoiseFormat::kPointLio);
  EXPECT_NEAR(input.spec.gyro.white.x(), std::sqrt(0.01 / 200.0), kRounding);
  EXPECT_EQ(input.figures[0].key, "mapping/gyr_cov_input");
}

TEST(ImuYaml, BothVersionsOfImuUtilsAgreeOnTheSameLog) {
  constexpr double kAgreement = 0.1;  // upstream's figure at 1 s holds the bias too
  const NoiseFile upstream = read_sample("imu_utils_mti100.yaml", 100.0);
  const NoiseFile mintar = read_sample("imu_utils_mintar_mti100.yaml");
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(upstream.spec.gyro.white[axis] / mintar.spec.gyro.white[axis], 1.0, kAgreement + 0.01) << axis;
    EXPECT_NEAR(upstream.spec.accel.white[axis] / mintar.spec.accel.white[axis], 1.0, kAgreement + 0.04) << axis;
  }
  EXPECT_EQ(upstream.spec.gyro.bias_instability.y(), 6.7266758753347237e-05);
  EXPECT_EQ(mintar.spec.accel.bias_random_walk.z(), 2.9063415139078617e-05);
  EXPECT_FALSE(upstream.spec.gyro.bias_time.allFinite());
}

TEST(ImuYaml, TheAverageStandsInForAxesThatWereCutOut) {
  const NoiseFile file = read_sample("imu_utils_old_adis16448.yaml", 200.0);
  EXPECT_EQ(file.figures[0].value, Eigen::Vector3d::Constant(1.8582082627718251e-04));
}

TEST(ImuYaml, KfGinsUnitsAreDegreesHoursAndMilligals) {
  const NoiseFile file = read_sample("kf_gins_a15.yaml");
  EXPECT_NEAR(file.spec.gyro.white.x() / (0.003 * kDeg / 60.0), 1.0, kRounding);
  EXPECT_NEAR(file.spec.accel.white.x() / (0.03 / 60.0), 1.0, kRounding);
  EXPECT_NEAR(file.spec.gyro.bias_sigma.x() / (0.027 * kDeg / 3600.0), 1.0, kRounding);
  EXPECT_NEAR(file.spec.accel.bias_sigma.x() / 15e-5, 1.0, kRounding);
  EXPECT_EQ(file.spec.gyro.bias_time.x(), 4 * 3600.0);
  EXPECT_EQ(file.rate, 200.0);
}

TEST(ImuYaml, TheRateThatIsAskedForGoesBeforeTheFilesOwn) {
  const NoiseFile file = read_sample("point_lio_defaults.yaml", 400.0);
  EXPECT_EQ(file.rate, 400.0);
  EXPECT_NEAR(file.spec.gyro.white.x(), std::sqrt(0.1 / 400.0), kRounding);
  EXPECT_TRUE(mentions(file.notes, "tells a rate of 200 Hz; 400 Hz is used, as asked"));
}

TEST(ImuYaml, ZeroIsReadButNotConverted) {
  const std::string text =
      "gyroscope_noise_density: 1e-4\naccelerometer_noise_density: 1e-3\n"
      "gyroscope_random_walk: 0.0\naccelerometer_random_walk: 1e-5\n";
  const NoiseFile file = read_noise_file(text, "x", NoiseFormat::kKalibr);
  EXPECT_TRUE(file.spec.gyro.bias_random_walk.isZero(0));
  for (const NoiseFormat format : all_formats()) {
    EXPECT_NE(write_error_of(file.spec, format, {kRate, kBiasTime}).find("the gyro's bias noise is zero"),
              std::string::npos)
        << noise_format_name(format);
  }
}

TEST(ImuYaml, BadFilesAreRefusedWithLineAndKey) {
  const std::string kalibr =
      "gyroscope_noise_density: 1e-4\naccelerometer_noise_density: 1e-3\n"
      "gyroscope_random_walk: 1e-6\naccelerometer_random_walk: ";
  const std::string gins = "imunoise: {arw: [1, 1, 1], vrw: [1, 1, 1], gbstd: [1, 1, 1], corrtime: 1, abstd: ";
  const std::string imu_utils = contents_of(kData + "imu_utils_mti100.yaml");
  const auto swapped = [&imu_utils](const std::string& from, const std::string& to) {
    std::string text = imu_utils;
    return text.replace(text.find(from), from.size(), to);
  };
  const struct {
    std::string text;
    NoiseFormat format;
    std::string sentence;
  } cases[] = {
      {kalibr + ".nan\n", NoiseFormat::kKalibr, "in.yaml:4: accelerometer_random_walk = '.nan' is not a finite"},
      {kalibr + "1e-5x\n", NoiseFormat::kKalibr, "in.yaml:4: accelerometer_random_walk = '1e-5x' is not a finite"},
      {kalibr + "-1e-5\n", NoiseFormat::kKalibr, "in.yaml:4: accelerometer_random_walk = -1e-5 must not be negative"},
      {kalibr + "[1, 2, 3]\n", NoiseFormat::kKalibr, "in.yaml:4: accelerometer_random_walk must be one number"},
      {kalibr + "\n", NoiseFormat::kKalibr, "accelerometer_random_walk has no value"},
      {kalibr + "1\ngyroscope_random_walk: 2\n", NoiseFormat::kKalibr,
       "in.yaml:5: 'gyroscope_random_walk' is given twice, first at in.yaml:3"},
      {"imu0: {gyroscope_noise_density: 1}\nimu1: {gyroscope_noise_density: 1}\n", NoiseFormat::kOpenVins,
       "in.yaml:2: imu1/gyroscope_noise_density says again what imu0/gyroscope_noise_density (in.yaml:1) says"},
      {kalibr + "1\nupdate_rate: 0\n", NoiseFormat::kKalibr, "in.yaml:5: update_rate must be > 0"},
      {"a: b: c\n", NoiseFormat::kKalibr, "in.yaml:1: not YAML"},
      {",a: 1\nb: 2\n", NoiseFormat::kKalibr, "in.yaml: holds more than one YAML document"},
      {"mapping: {acc_cov: 1, b_acc_cov: 1, b_gyr_cov: 1}\n", NoiseFormat::kFastLio, "in.yaml: 'gyr_cov' is missing"},
      {gins + "2}\n", NoiseFormat::kKfGins, "in.yaml:1: imunoise/abstd must be a list of 3 numbers"},
      {gins + "[1, 2]}\n", NoiseFormat::kKfGins, "in.yaml:1: imunoise/abstd must be a list of 3 numbers"},
      {swapped("\" rad/s\"", "deg/s"), NoiseFormat::kImuUtils, "Gyr/unit = 'deg/s' is neither upstream imu_utils'"},
      {swapped("\" rad/s\"", "\"gyr_n: rad / sqrt(s), gyr_w: rad / s^2 / sqrt(Hz)\""), NoiseFormat::kImuUtils,
       "Acc/unit does not belong to the same version of imu_utils as Gyr/unit"},
      {"imu: {noise: {gyro_white_noise: {value: 1, unit: deg/s}}}\n", NoiseFormat::kAllanLio, "in.yaml: "},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(c.text, c.format);
    EXPECT_NE(error.find(c.sentence), std::string::npos) << c.text << "gives: " << error << "\nnot: " << c.sentence;
  }
}

TEST(ImuYaml, WhatIsNeededAndUnknownIsAskedFor) {
  const std::string defaults = contents_of(kData + "fast_lio_defaults.yaml");
  EXPECT_NE(error_of(defaults, NoiseFormat::kFastLio, 0.0).find("fast"), 0U);
  EXPECT_NE(error_of(defaults, NoiseFormat::kFastLio, 0.0).find("in.yaml:12: mapping/gyr_cov is a figure of single"),
            std::string::npos);
  EXPECT_NE(error_of(defaults, NoiseFormat::kFastLio, 0.0).find("give --rate"), std::string::npos);
  NoiseSpec walk = mti600_spec();
  walk.gyro = convert_bias(walk.gyro, BiasKind::kRandomWalk, 0.0);
  walk.accel = convert_bias(walk.accel, BiasKind::kRandomWalk, 0.0);
  for (const NoiseFormat format : {NoiseFormat::kKfGins, NoiseFormat::kImuUtils})
    EXPECT_NE(write_error_of(walk, format, {kRate, 0.0}).find("give --bias-time"), std::string::npos);
  for (const NoiseFormat format : {NoiseFormat::kKalibr, NoiseFormat::kFastLio, NoiseFormat::kPointLio,
                                   NoiseFormat::kOpenVins, NoiseFormat::kImuUtils})
    EXPECT_NE(write_error_of(mti600_spec(), format, {}).find("give --rate"), std::string::npos);
  const NoiseFile levels = read_sample("imu_utils_mti100.yaml", 100.0);
  EXPECT_NE(write_error_of(levels.spec, NoiseFormat::kKalibr, {100.0, 0.0}).find("give --bias-time"),
            std::string::npos);
  EXPECT_EQ(write_error_of(levels.spec, NoiseFormat::kKalibr, {100.0, 31.7}), "no error");
}

TEST(ImuYaml, KfGinsOneCorrelationTimeKeepsS) {
  std::vector<std::string> notes;
  const NoiseSpec spec = mti600_spec();  // T_b differs between gyro and accelerometer, and between axes
  const NoiseFile mean =
      read_noise_file(write_noise(spec, NoiseFormat::kKfGins, {}, &notes), "x", NoiseFormat::kKfGins);
  expect_same_noise(mean.spec, spec, "mean T_b");
  EXPECT_TRUE(mentions(notes, "the correlation times differ"));
  const NoiseFile asked =
      read_noise_file(write_noise(spec, NoiseFormat::kKfGins, {0.0, 3600.0}, nullptr), "x", NoiseFormat::kKfGins);
  expect_same_noise(asked.spec, spec, "T_b as asked");
  EXPECT_NEAR(asked.spec.gyro.bias_time.x(), 3600.0, kRounding * 3600.0);
}

TEST(ImuYaml, NoFigureThatIsNoNumberIsWritten) {
  NoiseSpec spec = mti600_spec();
  spec.accel.white.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(write_error_of(spec, NoiseFormat::kLioSam, {}).find("the accelerometer's white noise is zero or no number"),
            std::string::npos);
}

}  // namespace
}  // namespace allan_lio
