// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/parameter_doc.h"
#include "allan_lio/io/parameter_list.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/sim/lidar_simulator.h"

namespace allan_lio {
namespace {

const char* const kMti600Noise =
    "imu:\n"
    "  noise:\n"
    "    gyro_white_noise: {value: 0.42, unit: deg/sqrt(h)}\n"
    "    accel_white_noise: {value: 60, unit: ug/sqrt(Hz)}\n"
    "    gyro_bias_instability: {value: 8, unit: deg/h}\n"
    "    accel_bias_instability: {value: 10, unit: ug}\n"
    "    gyro_bias_time: {value: 31.7, unit: s}\n"
    "    accel_bias_time: {value: [63.5, 63.5, 31.7], unit: s}\n"
    "    gyro_turn_on_bias: {value: 0.2, unit: deg/s}\n"
    "    accel_turn_on_bias: {value: 0, unit: mg}\n";

/// A complete configuration with `yaml` laid over it.
ConfigSource source_with(const std::string& yaml) {
  return merge(parse_yaml(kMti600Noise, "base.yaml"), parse_yaml(yaml, "test.yaml"));
}

/// What reading `yaml` over a complete configuration complains of; empty if it is accepted.
std::string complaint(const std::string& yaml) {
  try {
    read_config(source_with(yaml));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_HAS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << text

TEST(ConfigNumbers, StrictDecimalNumbersAndNothingElse) {
  const std::pair<const char*, double> good[] = {
      {"1e-3", 1e-3}, {".5", 0.5}, {"5.", 5.0}, {"-2", -2.0}, {"+3E2", 300.0}};
  for (const auto& item : good) {
    double value = -1.0;
    ASSERT_TRUE(parse_number(item.first, &value)) << item.first;
    EXPECT_EQ(value, item.second);
  }
  for (const char* text :
       {"", " 1", "1 ", "0.1x", "0x10", "nan", "inf", "-inf", "1e999", "1e", "e5", "1,5", "--1", "."}) {
    double value = -1.0;
    EXPECT_FALSE(parse_number(text, &value)) << text;
  }
}

TEST(ConfigNumbers, TextReadsBackToTheSameBits) {
  for (const double value : {0.1, 1.0 / 3.0, -0.0, 1e-300, 4.9e-324, 1.7976931348623157e308, 9.80665e-6 / 7.0}) {
    double back = 1.0;
    ASSERT_TRUE(parse_number(number_text(value), &back));
    EXPECT_EQ(back, value);
    EXPECT_EQ(std::signbit(back), std::signbit(value));
  }
  EXPECT_EQ(number_text(0.1), "0.1");
}

TEST(Config, SilentParametersHaveTheirDefaults) {
  const LioConfig config = read_config(source_with(""));
  EXPECT_EQ(config.topics.imu, "/imu/data");
  EXPECT_EQ(config.imu.scale.k_gb, 1.0);
  EXPECT_EQ(config.imu.discretization, Discretization::kTrapezoid);
  EXPECT_TRUE(config.lidar.deskew);
  EXPECT_EQ(config.lidar.min_points, 50);
  EXPECT_EQ(config.T_imu_lidar.rotation.w(), 1.0);
}

TEST(Config, NoiseIsReadInItsUnits) {
  const NoiseSpec spec = read_config(source_with("")).imu.spec;
  const double degree = 3.14159265358979323846 / 180.0;
  constexpr double kRounding = 1e-15;
  EXPECT_NEAR(spec.gyro.white[2] / (0.42 * degree / 60.0), 1.0, kRounding);
  EXPECT_NEAR(spec.accel.white[0] / (60e-6 * 9.80665), 1.0, kRounding);
  EXPECT_NEAR(spec.gyro.bias_instability[1] / (8 * degree / 3600.0), 1.0, kRounding);
  EXPECT_EQ(spec.accel.bias_time, Eigen::Vector3d(63.5, 63.5, 31.7));
  EXPECT_EQ(spec.accel.turn_on_bias, Eigen::Vector3d::Zero());
}

TEST(Config, EveryKindOfValueIsRead) {
  const LioConfig config = read_config(
      source_with("imu: {discretization: van_loan, accel_unit: g, k_gb: 1e1}\n"
                  "lidar: {deskew: off, min_points: 7, time_field: \"t: 1\"}\n"
                  "extrinsics: {T_imu_lidar: {translation: [1, -2.5, .5], rotation: [0, 0, 1, 0]}, estimate: True}\n"
                  "threads: 2\n"));
  EXPECT_EQ(config.imu.discretization, Discretization::kVanLoan);
  EXPECT_EQ(config.imu.accel_unit, AccelUnit::kG);
  EXPECT_EQ(config.imu.scale.k_gb, 10.0);
  EXPECT_FALSE(config.lidar.deskew);
  EXPECT_EQ(config.lidar.min_points, 7);
  EXPECT_EQ(config.lidar.time_field, "t: 1");
  EXPECT_EQ(config.T_imu_lidar.translation, Eigen::Vector3d(1, -2.5, 0.5));
  EXPECT_EQ(config.T_imu_lidar.rotation.z(), 1.0);
  EXPECT_TRUE(config.estimate_extrinsics);
  EXPECT_EQ(config.threads, 2);
}

TEST(Config, AnUnknownKeyIsRefusedWithTheNearestOne) {
  const std::string error = complaint("lidar:\n  max_rnage: 5\n");
  EXPECT_HAS(error, "'lidar/max_rnage' (test.yaml:2)");
  EXPECT_HAS(error, "'lidar/max_range'");
  EXPECT_HAS(complaint("k_gb: 2\n"), "'imu/k_gb'");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_nois: {value: 1, unit: deg/sqrt(h)}}}\n"),
             "'imu/noise/gyro_white_noise/");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {vlaue: 1}}}\n"), "'imu/noise/gyro_white_noise/value'");
}

TEST(Config, AGroupTakesNoValueButMayBeEmpty) {
  EXPECT_HAS(complaint("lidar: 5\n"), "'lidar' (test.yaml:1) is a group");
  EXPECT_EQ(complaint("lidar:\n"), "");
}

TEST(Config, AMissingQuantityIsRefusedByName) {
  ConfigSource source = source_with("");
  source.erase("imu/noise/accel_bias_time/value");
  source.erase("imu/noise/accel_bias_time/unit");
  try {
    read_config(source);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_HAS(error.what(), "imu/noise/accel_bias_time is missing");
    EXPECT_HAS(error.what(), "include");
  }
}

TEST(Config, ANumberWithoutAUnitIsRefusedWithTheUnitsThatAreAccepted) {
  const std::string bare = complaint("imu: {noise: {gyro_white_noise: 0.42}}\n");
  EXPECT_HAS(bare, "imu/noise/gyro_white_noise = '0.42' (test.yaml:1)");
  EXPECT_HAS(bare, "a unit is needed");
  EXPECT_HAS(bare, "deg/sqrt(h)");
  ConfigSource source = source_with("");
  source.erase("imu/noise/gyro_white_noise/unit");
  try {
    read_config(source);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_HAS(error.what(), "imu/noise/gyro_white_noise/value");
    EXPECT_HAS(error.what(), "a unit is needed");
  }
}

TEST(Config, AUnitOfAnotherDimensionIsRefused) {
  const std::string error = complaint("imu: {noise: {gyro_white_noise: {value: 8, unit: deg/h}}}\n");
  EXPECT_HAS(error, "imu/noise/gyro_white_noise/unit = 'deg/h' (test.yaml:1)");
  EXPECT_HAS(error, "an angular rate");
  EXPECT_HAS(complaint("imu: {noise: {gyro_bias_time: {value: 8, unit: parsec}}}\n"), "'parsec' is not a unit");
}

TEST(Config, ABiasIsToldInOneOfThreeWaysAndTheLaterOneReplacesTheEarlier) {
  const LioConfig walk =
      read_config(source_with("imu: {noise: {gyro_bias_random_walk: {value: 2e-5, unit: rad/s^2/sqrt(Hz)}}}"));
  EXPECT_EQ(walk.imu.spec.gyro.bias_random_walk, Eigen::Vector3d::Constant(2e-5));
  EXPECT_TRUE(walk.imu.spec.gyro.bias_instability.isZero(0));
  EXPECT_FALSE(walk.imu.spec.gyro.bias_time.allFinite()) << "the time of the file below went with its figure";
  EXPECT_TRUE(walk.imu.spec.accel.bias_time.allFinite()) << "the accelerometer was not spoken of";

  const LioConfig markov = read_config(source_with(
      "imu: {noise: {accel_bias_sigma: {value: [1, 2, 3], unit: mGal}, accel_bias_time: {value: 1, unit: h}}}"));
  EXPECT_EQ(bias_kind(markov.imu.spec.accel), BiasKind::kGaussMarkov);
  EXPECT_EQ(markov.imu.spec.accel.bias_time, Eigen::Vector3d::Constant(3600.0));
  EXPECT_NEAR(markov.imu.spec.accel.bias_sigma.z(), 3e-5, 1e-19);

  const LioConfig flat = read_config(source_with("imu: {noise: {gyro_bias_flat_time: {value: 200, unit: s}}}"));
  EXPECT_NEAR(flat.imu.spec.gyro.bias_time.x(), 105.7, 0.05);
  EXPECT_FALSE(flat.imu.spec.gyro.bias_instability.isZero(0)) << "the figure stays, only its time is told otherwise";
}

TEST(Config, NoiseOfSingleSamplesIsReadWithItsRate) {
  const LioConfig config =
      read_config(source_with("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2, rate: 400 Hz},"
                              " accel_white_noise: {value: 0.1, unit: m/s^2, rate: 100Hz},"
                              " gyro_bias_random_walk: {value: 1e-4, unit: (rad/s^2)^2, rate: 400 Hz}}}"));
  EXPECT_NEAR(config.imu.spec.gyro.white.x(), std::sqrt(0.1 / 400), 1e-17);
  EXPECT_NEAR(config.imu.spec.accel.white.x(), 0.01, 1e-17);
  EXPECT_NEAR(config.imu.spec.gyro.bias_random_walk.x(), 1e-2 / 20.0, 1e-18);
  const ConfigSource discrete =
      parse_yaml("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2, rate: 400 Hz}}}", "fast.yaml");
  const ConfigSource density =
      parse_yaml("imu: {noise: {gyro_white_noise: {value: 1, unit: deg/sqrt(h)}}}", "sheet.yaml");
  EXPECT_EQ(complaint(""), "");
  EXPECT_NO_THROW(read_config(merge(merge(source_with(""), discrete), density))) << "the rate goes with its figure";
}

TEST(Config, SingleSamplesWithoutARateAndARateWithoutSamplesAreRefused) {
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2}}}"),
             "add the rate at which they are taken: 'rate: 400 Hz'");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2, rate: 400}}}"),
             "imu/noise/gyro_white_noise/rate = '400' (test.yaml:1): must be a number with its unit");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2, rate: 400 s}}}"), "a frequency");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {value: 0.1, unit: (rad/s)^2, rate: 0 Hz}}}"), "must be > 0");
  EXPECT_HAS(complaint("imu: {noise: {gyro_white_noise: {value: 1, unit: deg/sqrt(h), rate: 400 Hz}}}"),
             "the rate beside it has no meaning");
}

TEST(Config, ABiasToldTwiceOrHalfIsRefused) {
  const auto twice = [] {
    try {
      read_config(
          parse_yaml(std::string(kMti600Noise) + "    gyro_bias_random_walk: {value: 2e-5, unit: rad/s^2/sqrt(Hz)}\n",
                     "base.yaml"));
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  }();
  EXPECT_HAS(twice, "imu/noise/gyro_bias_instability (base.yaml:5) and imu/noise/gyro_bias_random_walk (base.yaml:11)");
  EXPECT_HAS(complaint("imu: {noise: {gyro_bias_sigma: {value: 1, unit: deg/h}}}"),
             "imu/noise/gyro_bias_time is missing: imu/noise/gyro_bias_sigma (test.yaml:1) needs it");
  EXPECT_HAS(
      complaint("imu: {bias_model: gauss_markov, noise: {accel_bias_random_walk: {value: 1, unit: ug/sqrt(s)}}}"),
      "needs imu/noise/accel_bias_time");
}

TEST(Config, EveryKindOfBiasPrintsAndReadsBackToTheSameBits) {
  for (const char* yaml :
       {"imu: {noise: {gyro_bias_random_walk: {value: 2e-5, unit: rad/s^2/sqrt(Hz)}}}",
        "imu: {noise: {gyro_bias_sigma: {value: [1, 2, 3], unit: deg/h}, gyro_bias_time: {value: 4, unit: h}}}",
        "imu: {noise: {accel_bias_flat_time: {value: 200, unit: s}}}",
        "imu: {noise: {accel_white_noise: {value: 0.1, unit: (m/s^2)^2, rate: 250 Hz}}}"}) {
    const std::string printed = print_config(read_config(source_with(yaml)));
    EXPECT_EQ(print_config(read_config(parse_yaml(printed, "printed.yaml"))), printed) << yaml;
  }
}

TEST(Config, BadNoiseValuesAreRefusedByName) {
  const std::string key = "imu/noise/gyro_white_noise/value";
  const auto with = [](const std::string& value) {
    return complaint("imu: {noise: {gyro_white_noise: {value: " + value + ", unit: deg/sqrt(h)}}}\n");
  };
  for (const char* value : {"-0.42", "0", ".nan", "nan", ".inf", "1e999", "0.42x", "\"\"", "~", "1e-323"})
    EXPECT_HAS(with(value), key) << value;
  EXPECT_HAS(with("[1, 2]"), "list of 3");
  EXPECT_HAS(with("[1, -2, 3]"), key + "[1]");
  EXPECT_HAS(complaint("imu: {noise: {gyro_turn_on_bias: {value: -1}}}\n"), "imu/noise/gyro_turn_on_bias/value");
}

TEST(Config, BadValuesAreRefusedWithKeyValueAndOrigin) {
  const struct {
    const char* yaml;
    const char* key;
    const char* reason;
  } cases[] = {
      {"imu: {k_gb: -1}", "imu/k_gb = '-1' (test.yaml:1)", "must be > 0"},
      {"imu: {k_gb: 0}", "imu/k_gb", "must be > 0"},
      {"imu: {k_gb: .nan}", "imu/k_gb", "not a finite decimal number"},
      {"imu: {k_gb: nan}", "imu/k_gb", "not a finite decimal number"},
      {"imu: {k_gb: .inf}", "imu/k_gb", "not a finite decimal number"},
      {"imu: {k_gb: 0x10}", "imu/k_gb", "not a finite decimal number"},
      {"imu: {k_gb: [1]}", "imu/k_gb = [1]", "not a list"},
      {"imu: {k_gb: }", "imu/k_gb", "has no value"},
      {"imu: {gravity: 98.1}", "imu/gravity", "must be 9.7 to 9.9 m/s^2"},
      {"lidar: {min_points: 2.5}", "lidar/min_points", "whole number"},
      {"lidar: {min_points: 0}", "lidar/min_points", "must be 1 to 1000000"},
      {"lidar: {deskew: maybe}", "lidar/deskew", "true or false"},
      {"lidar: {point_time: middle}", "lidar/point_time", "one of auto, start, end, absolute"},
      {"topics: {imu: [a, b]}", "topics/imu", "not a list"},
      {"extrinsics: {T_imu_lidar: {translation: [1, 2]}}", "extrinsics/T_imu_lidar/translation", "list of 3 numbers"},
      {"extrinsics: {T_imu_lidar: {translation: 1}}", "extrinsics/T_imu_lidar/translation", "list of 3 numbers"},
      {"extrinsics: {T_imu_lidar: {translation: [1, 2, nan]}}", "extrinsics/T_imu_lidar/translation[2]",
       "not a finite"},
      {"extrinsics: {T_imu_lidar: {rotation: [0, 0, 0, 2]}}", "extrinsics/T_imu_lidar/rotation[3]", "-1.001 to 1.001"},
      {"extrinsics: {T_base_imu: {translation: [1, 2]}}", "extrinsics/T_base_imu/translation", "list of 3 numbers"},
  };
  for (const auto& item : cases) {
    const std::string error = complaint(item.yaml);
    EXPECT_HAS(error, item.key) << item.yaml;
    EXPECT_HAS(error, item.reason) << item.yaml;
  }
}

TEST(Config, ValuesThatContradictEachOtherAreRefusedWithTheirOrigins) {
  const std::string range = complaint("lidar:\n  min_range: 5\n  max_range: 5\n");
  EXPECT_HAS(range, "lidar/min_range = 5 must be less than lidar/max_range = 5");
  EXPECT_HAS(range, "test.yaml:2");
  EXPECT_HAS(range, "test.yaml:3");
  EXPECT_HAS(complaint("frames: {odom: base_link}\n"), "frames/odom and frames/base must differ");
  EXPECT_HAS(complaint("topics: {lidar: \"\"}\n"), "topics/lidar must not be empty");
  EXPECT_HAS(complaint("lidar: {max_registered: 49}\n"),
             "lidar/max_registered = 49 must be 0 or at least lidar/min_points = 50");
  EXPECT_EQ(complaint("lidar: {max_registered: 50}\n"), "");
  const std::string same_frame = "frames: {imu: base_link}\nextrinsics: {T_base_imu: {translation: [0, 0, 1]}}\n";
  EXPECT_HAS(complaint(same_frame), "frames/base and frames/imu are both 'base_link'");
  EXPECT_EQ(complaint("frames: {imu: base_link}\n"), "");
  EXPECT_EQ(complaint("frames: {extrinsics_from_tf: true, imu: base_link}\n"
                      "extrinsics: {T_base_imu: {translation: [0, 0, 1]}}\n"),
            "");
}

TEST(Config, TheBaseIsTheImuUnlessItIsSaidWhereItIs) {
  const LioConfig silent = read_config(source_with(""));
  EXPECT_EQ(silent.T_base_imu.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(silent.T_base_imu.rotation.w(), 1.0);
  const LioConfig told = read_config(
      source_with("extrinsics: {T_base_imu: {translation: [0.3, 0.1, 0.2], rotation: [0, 0, 0.6, 0.8]}}\n"));
  EXPECT_EQ(told.T_base_imu.translation, Eigen::Vector3d(0.3, 0.1, 0.2));
  EXPECT_EQ(told.T_base_imu.rotation.coeffs(), Eigen::Vector4d(0, 0, 0.6, 0.8));
  EXPECT_EQ(told.T_imu_lidar.translation, silent.T_imu_lidar.translation);
  EXPECT_NE(config_hash(told), config_hash(silent));
}

TEST(Config, ARotationMustBeAUnitQuaternionAndIsNormalised) {
  EXPECT_HAS(complaint("extrinsics: {T_base_imu: {rotation: [0, 0, 0, 0.9]}}\n"), "extrinsics/T_base_imu/rotation");
  const LioConfig base = read_config(source_with("extrinsics: {T_base_imu: {rotation: [0.6, 0, 0, 0.8005]}}\n"));
  EXPECT_NEAR(base.T_base_imu.rotation.norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
  EXPECT_HAS(complaint("extrinsics: {T_imu_lidar: {rotation: [0, 0, 0, 0.9]}}\n"), "norm is 0.9");
  EXPECT_HAS(complaint("extrinsics: {T_imu_lidar: {rotation: [0, 0, 0, 0]}}\n"), "extrinsics/T_imu_lidar/rotation");
  const LioConfig config = read_config(source_with("extrinsics: {T_imu_lidar: {rotation: [0.6, 0, 0, 0.8005]}}\n"));
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(config.T_imu_lidar.rotation.norm(), 1.0, kRounding);
}

/// The bits of every field, by way of the list: %.17g tells any two doubles apart.
std::vector<std::vector<std::string>> values_of(const LioConfig& config) {
  std::vector<std::vector<std::string>> values;
  for (const ParameterEntry& entry : list_parameters(config)) values.push_back(entry.items);
  return values;
}

TEST(Config, APrintedConfigurationReadsBackToTheSameBits) {
  const LioConfig config = read_config(source_with(
      "imu: {k_g: 0.30000000000000004, bias_model: gauss_markov, accel_unit: m/s^2}\n"
      "lidar: {time_field: \"a \\\"b\\\" \\\\ # : \\t\u00e9\", deskew: false}\n"
      "extrinsics: {T_imu_lidar: {rotation: [0.1, 0.2, 0.3, 0.9273618495495704], translation: [0.1, 1e-17, -3]}}\n"
      "frames: {odom: \"on\"}\n"));
  const LioConfig back = read_config(parse_yaml(print_config(config), "printed"));
  EXPECT_EQ(values_of(back), values_of(config));
  EXPECT_EQ(back.T_imu_lidar.rotation.coeffs(), config.T_imu_lidar.rotation.coeffs());
  EXPECT_EQ(back.imu.spec.gyro.white, config.imu.spec.gyro.white);
  EXPECT_EQ(back.lidar.time_field, config.lidar.time_field);
  EXPECT_EQ(back.frames.odom, "on");
  EXPECT_EQ(print_config(back), print_config(config));
  EXPECT_EQ(values_of(read_config(to_source(config))), values_of(config));
}

TEST(Config, TheHashTellsConfigurationsApart) {
  const LioConfig config = read_config(source_with(""));
  const std::string hash = config_hash(config);
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos) << hash;
  EXPECT_EQ(hash, config_hash(read_config(source_with("imu: {k_gb: 1.0}\n"))));
  EXPECT_NE(hash, config_hash(read_config(source_with("imu: {k_gb: 1.0000000000000002}\n"))));
}

TEST(Config, DefaultsWithANoiseAreAnAcceptedConfiguration) {
  const NoiseSpec spec = read_config(source_with("")).imu.spec;
  const LioConfig config = default_config(spec);
  EXPECT_NO_THROW(check_config(config));
  EXPECT_EQ(values_of(config), values_of(read_config(source_with(""))));
}

TEST(ConfigOverride, ReplacesValuesListsAndQuantities) {
  ConfigSource source = source_with("imu: {k_gb: 3}\n");
  for (const char* text : {"imu/k_gb=2", "extrinsics/T_imu_lidar/translation=[1, 2, 3]",
                           "lidar/time_field=", "imu/noise/gyro_bias_time={value: 1, unit: h}", "topics/imu=/a=b"}) {
    source = merge(std::move(source), parse_override(text));
  }
  const LioConfig config = read_config(source);
  EXPECT_EQ(config.imu.scale.k_gb, 2.0);
  EXPECT_EQ(config.T_imu_lidar.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(config.lidar.time_field, "");
  EXPECT_EQ(config.imu.spec.gyro.bias_time, Eigen::Vector3d::Constant(3600.0));
  EXPECT_EQ(config.topics.imu, "/a=b");
}

TEST(ConfigOverride, WhatIsNotKeyEqualsValueIsRefused) {
  for (const char* text : {"", "imu/k_gb", "=2", "imu/k_gb=[1", "imu/k_gb=[[1]]"})
    EXPECT_THROW(parse_override(text), ConfigError) << text;
  try {
    read_config(merge(source_with(""), parse_override("imu/kgb=2")));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_HAS(error.what(), "--param");
  }
}

std::string yaml_complaint(const std::string& text) {
  try {
    parse_yaml(text, "f.yaml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ConfigYaml, BadYamlIsRefusedWithFileAndLine) {
  EXPECT_HAS(yaml_complaint("a: 1\nb: [1, 2\nc: 3\n"), "f.yaml:");
  EXPECT_HAS(yaml_complaint("a: 1\nb: [1, 2\nc: 3\n"), "not YAML");
  EXPECT_HAS(yaml_complaint("- 1\n- 2\n"), "f.yaml:1");
  EXPECT_HAS(yaml_complaint("just text\n"), "key: value");
  EXPECT_HAS(yaml_complaint("a:\n  b: [[1], 2]\n"), "f.yaml:2");
  EXPECT_HAS(yaml_complaint("a: 1\n---\na: 2\n"), "more than one");
  EXPECT_HAS(yaml_complaint("a: &x\n  b: *x\n"), "too deep");
  EXPECT_EQ(yaml_complaint(""), "");
}

TEST(ConfigYaml, AKeyGivenTwiceIsRefusedWithBothLines) {
  for (const char* text : {"a:\n  b: 1\n  b: 2\n", "a:\n  b: 1\na/b: 2\n", "a:\n  b: 1\na:\n  b: 2\n"}) {
    const std::string error = yaml_complaint(text);
    EXPECT_HAS(error, "'a/b' is given twice") << text;
    EXPECT_HAS(error, "f.yaml:2") << text;
  }
}

/// A directory of its own for each test, gone afterwards.
class ConfigFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    root_ = ::testing::TempDir() + "allan_lio_config_" + name + "/";
    std::filesystem::remove_all(root_);
    for (const char* dir : {"config/robots", "config/imu", "home/parts"})
      std::filesystem::create_directories(root_ + dir);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  std::string write(const std::string& path, const std::string& text) const {
    std::ofstream(root_ + path) << text;
    return root_ + path;
  }
  ConfigSource load(const std::string& name) const { return load_yaml(name, {root_ + "config"}); }
  std::string complaint(const std::string& name) const {
    try {
      load(name);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  std::string root_;
};

TEST_F(ConfigFiles, AnIncludeComesFirstAndTheFileItselfWins) {
  write("config/imu/a.yaml", "x: 1\ny: 1\nz: 1\n");
  write("config/imu/b.yaml", "y: 2\nz: 2\n");
  write("config/robots/r.yaml", "include: [imu/a, imu/b.yaml]\nz: 3\n");
  const ConfigSource source = load("r");
  EXPECT_EQ(source.size(), 3u);
  EXPECT_EQ(source.at("x").items.front(), "1");
  EXPECT_EQ(source.at("y").items.front(), "2");
  EXPECT_EQ(source.at("z").items.front(), "3");
  EXPECT_EQ(source.at("z").origin, root_ + "config/robots/r.yaml:2");
}

TEST_F(ConfigFiles, AFileAnywhereIncludesRelativeToItselfAndFromTheSearchDirectories) {
  write("config/imu/a.yaml", "x: 1\n");
  write("home/parts/near.yaml", "include: ../beside\ny: 2\n");
  write("home/beside.yaml", "w: 4\n");
  const std::string path = write("home/mine.yaml", "include: [parts/near.yaml, imu/a]\nz: 3\n");
  const ConfigSource source = load(path);
  EXPECT_EQ(source.size(), 4u);
  EXPECT_EQ(source.at("w").items.front(), "4");
  EXPECT_EQ(source.at("x").items.front(), "1");
}

TEST_F(ConfigFiles, OneFileIncludedByTwoIsNoCircle) {
  write("config/imu/base.yaml", "x: 1\n");
  write("config/imu/a.yaml", "include: base\ny: 1\n");
  write("config/imu/b.yaml", "include: base\nz: 1\n");
  write("config/robots/r.yaml", "include: [imu/a, imu/b]\n");
  EXPECT_EQ(load("r").size(), 3u);
}

TEST_F(ConfigFiles, AnIncludeCircleIsRefused) {
  write("config/imu/a.yaml", "include: b\n");
  write("config/imu/b.yaml", "include: [./../imu/a]\n");
  write("config/imu/self.yaml", "include: self\n");
  EXPECT_HAS(complaint("imu/a"), "b.yaml:1");
  EXPECT_HAS(complaint("imu/a"), "circle");
  EXPECT_HAS(complaint("imu/self"), "circle");
}

TEST_F(ConfigFiles, WhatIsNotFoundIsNamedTogetherWithWhatThereIs) {
  write("config/imu/a.yaml", "x: 1\n");
  write("config/robots/r.yaml", "y: 1\ninclude: [imu/none]\n");
  const std::string error = complaint("r");
  EXPECT_HAS(error, "r.yaml:2");
  EXPECT_HAS(error, "'imu/none' is not found");
  EXPECT_HAS(error, "imu/a, robots/r");
  EXPECT_HAS(complaint("imu"), "'imu' is not found");
  EXPECT_HAS(complaint(""), "not found");
}

const std::string kSource = ALLAN_LIO_SOURCE_DIR;

LioConfig load_shipped(const std::string& yaml) {
  const std::string path = ::testing::TempDir() + "allan_lio_shipped.yaml";
  std::ofstream(path) << yaml;
  return read_config(load_yaml(path, {kSource + "/config"}));
}

TEST(ShippedConfig, EveryImuFileGivesACompleteNoise) {
  for (const char* name : {"mti600", "adis16465", "adis16448", "bmi088", "icm20948", "ideal", "pseudo_imu"}) {
    EXPECT_NO_THROW(load_shipped("include: imu/" + std::string(name) + "\n")) << name;
  }
}

TEST(ShippedConfig, EveryLidarFileIsAcceptedBesideAnImu) {
  for (const char* name : {"velodyne16", "velodyne32", "velodyne64", "ouster", "hesai", "robosense", "livox"}) {
    EXPECT_NO_THROW({
      const LioConfig config = load_shipped("include: [imu/mti600, lidar/" + std::string(name) + "]\n");
      EXPECT_LE(config.lidar.max_range, config.map.radius) << name;
    }) << name;
  }
}

TEST(ShippedConfig, EveryRobotIsComplete) {
  for (const char* name : {"simulated", "simulated_velodyne32", "simulated_ouster64", "simulated_livox_avia",
                           "simulated_livox_mid360", "simulated_euroc", "kitti_0005"})
    EXPECT_NO_THROW(read_config(load_yaml(name, {kSource + "/config"}))) << name;
}

TEST(ShippedConfig, NoFileIsForgottenByTheseTests) {
  try {
    load_yaml("no such name", {kSource + "/config"});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_HAS(error.what(),
               "nor one of imu/adis16448, imu/adis16465, imu/bmi088, imu/icm20948, imu/ideal, imu/mti600, "
               "imu/pseudo_imu, lidar/hesai, lidar/livox, lidar/ouster, lidar/robosense, lidar/velodyne16, "
               "lidar/velodyne32, lidar/velodyne64, lio, robots/kitti_0005, robots/simulated, robots/simulated_euroc, "
               "robots/simulated_livox_avia, robots/simulated_livox_mid360, robots/simulated_ouster64, "
               "robots/simulated_velodyne32, suites/degenerate, suites/degenerate_real, suites/paper");
    const std::string last = "suites/paper", text = error.what();
    EXPECT_EQ(text.find(last) + last.size(), text.size());
  }
}

TEST(ShippedConfig, Mti600AndAdis16465HoldTheFiguresOfThePaper) {
  const NoiseSpec mti = load_shipped("include: imu/mti600\n").imu.spec;
  const NoiseSpec paper = read_config(source_with("")).imu.spec;
  EXPECT_EQ(mti.gyro.white, paper.gyro.white);
  EXPECT_EQ(mti.accel.white, paper.accel.white);
  EXPECT_EQ(mti.gyro.bias_instability, paper.gyro.bias_instability);
  EXPECT_EQ(mti.accel.bias_instability, paper.accel.bias_instability);
  EXPECT_EQ(mti.gyro.bias_time, paper.gyro.bias_time);
  EXPECT_EQ(mti.accel.bias_time, paper.accel.bias_time);
  const NoiseSpec adis = load_shipped("include: imu/adis16465\n").imu.spec;
  const double degree = 3.14159265358979323846 / 180.0;
  const Eigen::Vector3d gyro_psd = bias_psd(adis.gyro.bias_instability, adis.gyro.bias_time) / (degree * degree);
  const Eigen::Vector3d accel_psd = bias_psd(adis.accel.bias_instability, adis.accel.bias_time);
  constexpr double kPrintedDigits = 2e-3;  // relative: the figures are given to four digits or three
  EXPECT_NEAR(gyro_psd[0] / 1.532e-8, 1.0, kPrintedDigits);
  EXPECT_NEAR(gyro_psd[2] / 3.06e-9, 1.0, kPrintedDigits);
  EXPECT_NEAR(accel_psd[0] / 6.185e-11, 1.0, kPrintedDigits);
  EXPECT_NEAR(accel_psd[2] / 1.547e-10, 1.0, kPrintedDigits);
}

TEST(ShippedConfig, TheSimulatedRobotIsTheOneThatTheSimulatorMakes) {
  const LioConfig config = read_config(load_yaml("simulated", {kSource + "/config"}));
  const RigidTransform mount = default_T_imu_lidar();
  constexpr double kRounding = 1e-15;
  EXPECT_LT((config.T_imu_lidar.rotation.coeffs() - mount.rotation.coeffs()).norm(), kRounding);
  EXPECT_EQ(config.T_imu_lidar.translation, mount.translation);
  const LidarPattern lidar = make_lidar_pattern("velodyne16");
  EXPECT_EQ(config.lidar.range_noise, lidar.range_noise);
  EXPECT_EQ(config.lidar.min_range, lidar.min_range);
  EXPECT_EQ(config.lidar.max_range, lidar.max_range);
}

TEST(ShippedConfig, EverySimulatedRobotHasTheRangesOfItsLidar) {
  for (const std::string& name : lidar_pattern_names()) {
    const std::string robot = name == "velodyne16" ? "simulated" : "simulated_" + name;
    const LioConfig config = read_config(load_yaml(robot, {kSource + "/config"}));
    const LidarPattern lidar = make_lidar_pattern(name);
    EXPECT_EQ(config.lidar.range_noise, lidar.range_noise) << name;
    EXPECT_EQ(config.lidar.min_range, lidar.min_range) << name;
    EXPECT_GE(config.lidar.max_range, lidar.max_range) << name;
    EXPECT_EQ(config.T_imu_lidar.translation, default_T_imu_lidar().translation) << name;
  }
}

std::string file_text(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(ShippedConfig, ParameterPageAndDefaultsFileAreWhatTheDeclarationSays) {
  EXPECT_EQ(file_text(kSource + "/doc/parameters.md"), parameters_markdown())
      << "run: rosrun allan_lio lio_parameters --markdown > doc/parameters.md";
  EXPECT_EQ(file_text(kSource + "/config/lio.yaml"), parameters_yaml())
      << "run: rosrun allan_lio lio_parameters --yaml > config/lio.yaml";
}

TEST(ShippedConfig, TheDefaultsFileChangesNothing) {
  const LioConfig with = load_shipped("include: [imu/mti600, lio]\nimu: {accel_range: 98.0665}\n");
  EXPECT_EQ(print_config(with), print_config(load_shipped("include: imu/mti600\n")));
}

}  // namespace
}  // namespace allan_lio
