// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/noise_lint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "allan_lio/io/noise_text.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/yaml_source.h"
#include "child_process.h"

namespace allan_lio {
namespace {

const std::string kConfig = ALLAN_LIO_SOURCE_DIR "/config";
const std::string kData = ALLAN_LIO_SOURCE_DIR "/test/data/noise/";
constexpr double kDegPerRad = 180.0 / M_PI, kGravity = 9.80665;

const double kRates[] = {100.0, 200.0, 400.0};

std::vector<KnownImu> known_imus() { return load_known_imus({kConfig}); }

NoiseFile read_sample(const std::string& name, double rate) {
  const std::string text = contents_of(kData + name);
  return read_noise_file(text, name, detect_noise_format(text, name), rate);
}

/// gyro and accelerometer white noise, gyro and accelerometer bias, under the four keys.
NoiseFile four(NoiseFormat format, const std::vector<std::string>& keys, const std::vector<double>& values,
               double rate) {
  std::string text;
  for (std::size_t i = 0; i < 4; ++i) text += keys[i] + ": " + number_text(values[i]) + "\n";
  return read_noise_file(text, "in.yaml", format, rate);
}

NoiseFile kalibr(const std::vector<double>& values, double rate) {
  return four(
      NoiseFormat::kKalibr,
      {"gyroscope_noise_density", "accelerometer_noise_density", "gyroscope_random_walk", "accelerometer_random_walk"},
      values, rate);
}

NoiseFile fast_lio(const std::vector<double>& values, double rate) {
  return four(NoiseFormat::kFastLio, {"gyr_cov", "acc_cov", "b_gyr_cov", "b_acc_cov"}, values, rate);
}

/// N_g, N_a, K_g, K_a of a known IMU, the axes averaged in S.
std::vector<double> densities(const NoiseSpec& spec) {
  return {std::sqrt(spec.gyro.white.squaredNorm() / 3.0), std::sqrt(spec.accel.white.squaredNorm() / 3.0),
          std::sqrt(bias_psd(spec.gyro).mean()), std::sqrt(bias_psd(spec.accel).mean())};
}

std::vector<double> scaled(std::vector<double> v, double gyro, double accel) {
  v[0] *= gyro;
  v[1] *= accel;
  v[2] *= gyro;
  v[3] *= accel;
  return v;
}

bool finds(const LintReport& report, Slip slip) {
  for (const LintFinding& finding : report.findings)
    if (finding.slip == slip) return true;
  return false;
}

std::string all(const LintReport& report) { return lint_text(report); }

TEST(NoiseLint, TheKnownImusAreTheRealOnes) {
  std::vector<std::string> names;
  for (const KnownImu& imu : known_imus()) names.push_back(imu.name);
  const std::vector<std::string> some = {"imu/adis16448", "imu/adis16465", "imu/bmi088", "imu/icm20948", "imu/mti600"};
  for (const std::string& name : some) EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  for (const std::string& name : names) {
    EXPECT_NE(name, "imu/ideal");
    EXPECT_NE(name, "imu/pseudo_imu");
  }
}

TEST(NoiseLint, FastLiosDefaultsAreCalledByNameWithTheirK) {
  const LintReport report = lint_noise(read_sample("fast_lio_defaults.yaml", 400.0), known_imus());
  ASSERT_EQ(report.findings.size(), 1U) << all(report);
  EXPECT_EQ(report.findings[0].slip, Slip::kShippedDefaults);
  EXPECT_TRUE(report.suspicious());
  EXPECT_EQ(report.findings[0].sentence,
            "FAST-LIO2's shipped defaults, not a calibration: k_g = 129, k_a = 27, k_gb = 32, k_ab = 12.5 to 17.7 at "
            "400 Hz against imu/mti600");
}

TEST(NoiseLint, TheImpliedScalesAreThoseOfTheoryMd) {
  constexpr double kDigits = 0.005;  // relative: theory section 1 gives four digits, from rounded T_b
  const LintReport report = lint_noise(read_sample("fast_lio_defaults.yaml", 400.0), known_imus(), "imu/mti600");
  const ImpliedScale& implied = report.implied.at(static_cast<std::size_t>(report.reference));
  EXPECT_EQ(implied.name, "imu/mti600");
  EXPECT_NEAR(implied.k.k_g / 129.4, 1.0, kDigits);
  EXPECT_NEAR(implied.k.k_a / 26.9, 1.0, kDigits);
  EXPECT_NEAR(implied.k.k_gb / 31.68, 1.0, kDigits);
  EXPECT_NEAR(implied.low.k_ab / 12.54, 1.0, kDigits);   // z axis, T_b = 31.7 s
  EXPECT_NEAR(implied.high.k_ab / 17.74, 1.0, kDigits);  // x and y, T_b = 63.5 s
}

TEST(NoiseLint, NothingIsFoundInOurOwnConfigurations) {
  for (const char* name : {"adis16448", "adis16465", "bmi088", "icm20948", "mti600", "ideal", "pseudo_imu"}) {
    const std::string path = kConfig + "/imu/" + name + ".yaml";
    for (const double rate : {0.0, 100.0, 200.0, 400.0}) {
      NoiseFile file = read_noise_config(load_yaml(path, {kConfig}), path);
      file.rate = rate;
      const LintReport report = lint_noise(file, known_imus());
      EXPECT_FALSE(report.suspicious()) << name << '\n' << all(report);
    }
  }
}

TEST(NoiseLint, NothingIsFoundInOurConfigurationsWrittenForOthers) {
  for (const KnownImu& imu : known_imus()) {
    for (const std::string& name : noise_format_names()) {
      for (const double rate : kRates) {
        const NoiseFormat format = noise_format_by_name(name);
        const std::string text = write_noise(imu.spec, format, {rate, 50.0}, nullptr);
        const LintReport report = lint_noise(read_noise_file(text, name, format, rate), known_imus());
        EXPECT_FALSE(report.suspicious()) << imu.name << " as " << name << " at " << rate << '\n' << all(report);
      }
    }
  }
}

TEST(NoiseLint, NothingIsFoundInSoundFilesOfRealImus) {
  const std::pair<const char*, double> samples[] = {
      {"fast_lio_ros2.yaml", 400.0},    {"kalibr_example.yaml", 0.0},
      {"kalibr_adis16448.yaml", 0.0},   {"allan_variance_ros_d435i.yaml", 0.0},
      {"openvins_euroc.yaml", 0.0},     {"openvins_tum_vi.yaml", 0.0},
      {"imu_utils_mti100.yaml", 100.0}, {"imu_utils_mintar_mti100.yaml", 100.0},
      {"lio_sam_gx5_25.yaml", 500.0},   {"lio_sam_gx5_25.yaml", 0.0},
      {"kf_gins_a15.yaml", 0.0},        {"kf_gins_template.yaml", 0.0}};
  for (const auto& [name, rate] : samples) {
    const LintReport report = lint_noise(read_sample(name, rate), known_imus());
    EXPECT_FALSE(report.suspicious()) << name << '\n' << all(report);
  }
}

TEST(NoiseLint, AnInflatedRandomWalkIsANoteOnly) {
  const LintReport report = lint_noise(read_sample("openvins_euroc.yaml", 0.0), known_imus());
  EXPECT_TRUE(finds(report, Slip::kInflatedBias)) << all(report);
  EXPECT_FALSE(report.suspicious());
}

TEST(NoiseLint, SlipsInDensitiesAreNamedForEveryKnownImu) {
  for (const KnownImu& imu : known_imus()) {
    const std::vector<double> right = densities(imu.spec);
    for (const double rate : kRates) {
      const std::string what = imu.name + " at " + number_text(rate) + " Hz\n";
      const double root = std::sqrt(rate);
      const LintReport degrees = lint_noise(kalibr(scaled(right, kDegPerRad, 1.0), rate), known_imus());
      EXPECT_TRUE(finds(degrees, Slip::kDegrees)) << what << all(degrees);
      const LintReport gravities = lint_noise(kalibr(scaled(right, 1.0, 1.0 / kGravity), rate), known_imus());
      EXPECT_TRUE(finds(gravities, Slip::kGravities)) << what << all(gravities);
      const LintReport both =
          lint_noise(kalibr({root * right[0], root * right[1], right[2], right[3]}, rate), known_imus());
      EXPECT_TRUE(finds(both, Slip::kRootRateTooMuch)) << what << all(both);
      const LintReport swapped = lint_noise(kalibr({right[1], right[0], right[3], right[2]}, rate), known_imus());
      EXPECT_TRUE(finds(swapped, Slip::kSwapped)) << what << all(swapped);
      for (const LintReport* report : {&degrees, &gravities, &both, &swapped}) EXPECT_TRUE(report->suspicious());
    }
  }
}

TEST(NoiseLint, SlipsInCovariancesAreNamedForEveryKnownImu) {
  for (const KnownImu& imu : known_imus()) {
    const std::vector<double> n = densities(imu.spec);
    for (const double rate : kRates) {
      const std::string what = imu.name + " at " + number_text(rate) + " Hz\n";
      const double root = std::sqrt(rate);
      const auto covariances = [rate](const std::vector<double>& v) {
        return std::vector<double>{rate * v[0] * v[0], rate * v[1] * v[1], rate * v[2] * v[2], rate * v[3] * v[3]};
      };
      const LintReport sigma =
          lint_noise(fast_lio({root * n[0], root * n[1], root * n[2], root * n[3]}, rate), known_imus());
      EXPECT_TRUE(finds(sigma, Slip::kSigmaForVariance)) << what << all(sigma);
      const LintReport density = lint_noise(fast_lio(n, rate), known_imus());
      EXPECT_TRUE(finds(density, Slip::kDensityForVariance)) << what << all(density);
      const LintReport psd =
          lint_noise(fast_lio({n[0] * n[0], n[1] * n[1], n[2] * n[2], n[3] * n[3]}, rate), known_imus());
      EXPECT_TRUE(finds(psd, Slip::kRootRateTooLittle)) << what << all(psd);
      const LintReport degrees = lint_noise(fast_lio(covariances(scaled(n, kDegPerRad, 1.0)), rate), known_imus());
      EXPECT_TRUE(finds(degrees, Slip::kDegrees)) << what << all(degrees);
      const LintReport right = lint_noise(fast_lio(covariances(n), rate), known_imus());
      EXPECT_FALSE(right.suspicious()) << what << all(right);
    }
  }
}

TEST(NoiseLint, TheBiasInstabilityInTheSlotOfTheRandomWalkIsNamed) {
  for (const KnownImu& imu : known_imus()) {
    const std::vector<double> n = densities(imu.spec);
    const double level_g = imu.spec.gyro.bias_instability.norm() / std::sqrt(3.0);
    const double level_a = imu.spec.accel.bias_instability.norm() / std::sqrt(3.0);
    const LintReport report = lint_noise(kalibr({n[0], n[1], level_g, level_a}, 200.0), known_imus());
    int named = 0;
    for (const LintFinding& finding : report.findings) named += finding.slip == Slip::kLevelForRandomWalk;
    EXPECT_EQ(named, 2) << imu.name << '\n' << all(report);
  }
}

TEST(NoiseLint, SlipsInTheBiasCovariancesAloneAreNamed) {
  for (const KnownImu& imu : known_imus()) {
    const std::vector<double> n = densities(imu.spec);
    const double rate = 400.0, white_g = rate * n[0] * n[0], white_a = rate * n[1] * n[1];
    const LintReport sigma = lint_noise(fast_lio({white_g, white_a, 20.0 * n[2], 20.0 * n[3]}, rate), known_imus());
    EXPECT_TRUE(finds(sigma, Slip::kSigmaForVariance)) << imu.name << '\n' << all(sigma);
    const LintReport density = lint_noise(fast_lio({white_g, white_a, n[2], n[3]}, rate), known_imus());
    EXPECT_TRUE(finds(density, Slip::kDensityForVariance)) << imu.name << '\n' << all(density);
    const LintReport shipped = lint_noise(fast_lio({white_g, white_a, 1e-4, 1e-4}, rate), known_imus());
    EXPECT_FALSE(shipped.suspicious()) << imu.name << '\n' << all(shipped);
  }
}

TEST(NoiseLint, ZeroIsNamed) {
  const LintReport report = lint_noise(kalibr({1.2e-4, 6e-4, 0.0, 2e-5}, 400.0), known_imus());
  EXPECT_TRUE(finds(report, Slip::kZero));
  EXPECT_TRUE(report.suspicious());
  EXPECT_NE(all(report).find("gyroscope_random_walk (in.yaml:3) is 0"), std::string::npos) << all(report);
  EXPECT_TRUE(finds(lint_noise(kalibr({0.0, 0.0, 0.0, 0.0}, 400.0), known_imus()), Slip::kZero));
}

TEST(NoiseLint, NoiseThatNothingExplainsIsCalledFarFromAll) {
  const LintReport report = lint_noise(fast_lio({1.0, 1.0, 1e-4, 1e-4}, 400.0), known_imus());
  EXPECT_TRUE(finds(report, Slip::kFarFromAll)) << all(report);
  EXPECT_TRUE(report.suspicious());
}

TEST(NoiseLint, LioSamsShippedFiguresAreDeviationsOfSamples) {
  const LintReport report = lint_noise(read_sample("lio_sam_defaults.yaml", 500.0), known_imus());
  EXPECT_TRUE(finds(report, Slip::kRootRateTooMuch)) << all(report);
}

TEST(NoiseLint, EarlyImuUtilsFilesMissTheRootOfTheRate) {
  const LintReport report = lint_noise(read_sample("imu_utils_old_adis16448.yaml", 200.0), known_imus());
  EXPECT_TRUE(finds(report, Slip::kRootRateTooLittle)) << all(report);
}

TEST(NoiseLint, TheNearestImuIsTheOneWhoseFiguresTheyAre) {
  for (const KnownImu& imu : known_imus()) {
    const LintReport report = lint_noise(kalibr(densities(imu.spec), 200.0), known_imus());
    ASSERT_GE(report.nearest, 0);
    EXPECT_EQ(report.implied[static_cast<std::size_t>(report.nearest)].name, imu.name);
    EXPECT_NEAR(report.implied[static_cast<std::size_t>(report.nearest)].k.k_gb, 1.0, 1e-12);
  }
  EXPECT_THROW(lint_noise(kalibr({1, 1, 1, 1}, 1.0), known_imus(), "imu/none"), std::invalid_argument);
}

TEST(NoiseLint, WithoutKnownImusOnlyWhatNeedsNoneIsFound) {
  const LintReport report = lint_noise(fast_lio({0.1, 0.1, 1e-4, 1e-4}, 400.0), {});
  EXPECT_TRUE(finds(report, Slip::kShippedDefaults));
  EXPECT_FALSE(lint_noise(kalibr({1, 1, 1, 1}, 1.0), {}).suspicious());
}

TEST(NoiseText, FiguresAreToldInDataSheetUnits) {
  const std::string path = kConfig + "/imu/mti600.yaml";
  NoiseFile file = read_noise_config(load_yaml(path, {kConfig}), path);
  file.rate = 400.0;
  const std::string lint = lint_text(lint_noise(file, known_imus()));
  for (const char* part : {"0.42 deg/sqrt(h)", "60 ug/sqrt(Hz)", "8 deg/h", "10 ug", "nothing suspicious", "nearest"})
    EXPECT_NE(lint.find(part), std::string::npos) << part << '\n' << lint;
  const std::string show = show_text(file, 0.0);
  for (const char* part :
       {"sigma_b = 3.879e-05 rad/s = 8 deg/h with T_b = 31.7 s (flat at 60 s)", "K = 1.578e-05 rad/s^2/sqrt(Hz)",
        "sigma = 6.282e-05 rad/s", "samples at 400 Hz: covariance 5.971e-06 (rad/s)^2", "bias 9.96e-08 (rad/s^2)^2"})
    EXPECT_NE(show.find(part), std::string::npos) << part << '\n' << show;
}

TEST(NoiseText, WhatIsUnknownIsAskedForInsteadOfMadeUp) {
  const std::string show = show_text(kalibr({1e-4, 1e-3, 1e-6, 1e-5}, 0.0), 0.0);
  EXPECT_NE(show.find("a correlation time is needed, give --bias-time"), std::string::npos) << show;
  EXPECT_NE(show.find("the rate is needed, give --rate"), std::string::npos) << show;
  EXPECT_NE(show_text(kalibr({1e-4, 1e-3, 1e-6, 1e-5}, 0.0), 50.0).find("T_b = 50 s"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
