// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "imu_yaml_formats.h"

#include <algorithm>

#include "allan_lio/io/yaml_source.h"

namespace allan_lio {
namespace {

const char* const kNames[] = {"allan_lio", "kalibr",  "allan_variance_ros", "imu_utils", "imu_utils_mintar", "fast_lio",
                              "point_lio", "lio_sam", "openvins",           "kf_gins"};

std::vector<FigureRule> kalibr_rules() {
  return {{"gyroscope_noise_density", true, FigureKind::kDensity, "rad/s/sqrt(Hz)"},
          {"accelerometer_noise_density", false, FigureKind::kDensity, "m/s^2/sqrt(Hz)"},
          {"gyroscope_random_walk", true, FigureKind::kRandomWalk, "rad/s^2/sqrt(Hz)"},
          {"accelerometer_random_walk", false, FigureKind::kRandomWalk, "m/s^3/sqrt(Hz)"}};
}

/// Both filters propagate with F P F' + G Q G' dt^2, hence S = Q dt (theory section 2, `discrete`).
std::vector<FigureRule> covariance_rules(const char* gyro, const char* accel) {
  return {{gyro, true, FigureKind::kSampleVariance, "(rad/s)^2"},
          {accel, false, FigureKind::kSampleVariance, "(m/s^2)^2"},
          {"b_gyr_cov", true, FigureKind::kBiasVariance, "(rad/s^2)^2"},
          {"b_acc_cov", false, FigureKind::kBiasVariance, "(m/s^3)^2"}};
}

/// A matrix of rows in the file, which other users of kalibr's keys have no need of.
bool is_chain(const ConfigSource& source) {
  return std::any_of(source.begin(), source.end(), [](const auto& item) { return ends_with_key(item.first, "T_i_b"); });
}

}  // namespace

std::vector<std::string> noise_format_names() { return {std::begin(kNames), std::end(kNames)}; }

std::string noise_format_name(NoiseFormat format) { return kNames[static_cast<int>(format)]; }

NoiseFormat noise_format_by_name(const std::string& name) {
  const auto at = std::find(std::begin(kNames), std::end(kNames), name);
  if (at != std::end(kNames)) return static_cast<NoiseFormat>(at - std::begin(kNames));
  std::string sentence = "'" + name + "' is not a format that is known; known are";
  for (const char* known : kNames) sentence += std::string(known == kNames[0] ? " " : ", ") + known;
  throw ConfigError(sentence);
}

bool is_white(FigureKind kind) {
  return kind == FigureKind::kDensity || kind == FigureKind::kSampleSigma || kind == FigureKind::kSampleVariance;
}

bool is_discrete(FigureKind kind) {
  return kind == FigureKind::kSampleSigma || kind == FigureKind::kSampleVariance || kind == FigureKind::kBiasVariance;
}

std::vector<FigureRule> figure_rules(NoiseFormat format) {
  switch (format) {
    case NoiseFormat::kAllanLio:
      return {};
    case NoiseFormat::kKalibr:
    case NoiseFormat::kAllanVarianceRos:
    case NoiseFormat::kOpenVins:
      return kalibr_rules();
    case NoiseFormat::kImuUtils:
      // gyr_n is the fitted deviation at 1 s times the root of the rate, so it holds a little of the bias as well.
      return {{"gyr_n", true, FigureKind::kSampleSigma, "rad/s"},
              {"acc_n", false, FigureKind::kSampleSigma, "m/s^2"},
              {"gyr_w", true, FigureKind::kBiasInstability, "rad/s"},
              {"acc_w", false, FigureKind::kBiasInstability, "m/s^2"}};
    case NoiseFormat::kImuUtilsMintar:
      return {{"gyr_n", true, FigureKind::kDensity, "rad/sqrt(s)"},
              {"acc_n", false, FigureKind::kDensity, "m/s^2/sqrt(Hz)"},
              {"gyr_w", true, FigureKind::kRandomWalk, "rad/s^2/sqrt(Hz)"},
              {"acc_w", false, FigureKind::kRandomWalk, "m/s^3/sqrt(Hz)"}};
    case NoiseFormat::kFastLio:
      return covariance_rules("gyr_cov", "acc_cov");
    case NoiseFormat::kPointLio:
      // imu_meas_*_cov are the variances of the samples, which are measurements to it. gyr_cov_output, acc_cov_output
      // and vel_cov are how fast the vehicle may change its motion, lidar_meas_cov is the LiDAR's: no IMU noise.
      return covariance_rules("imu_meas_omg_cov", "imu_meas_acc_cov");
    case NoiseFormat::kLioSam:
      // Its preintegration squares the noises into densities and gives the bias sqrt(dt) times the last two.
      return {{"imuGyrNoise", true, FigureKind::kDensity, "rad/s/sqrt(Hz)"},
              {"imuAccNoise", false, FigureKind::kDensity, "m/s^2/sqrt(Hz)"},
              {"imuGyrBiasN", true, FigureKind::kRandomWalk, "rad/s^2/sqrt(Hz)"},
              {"imuAccBiasN", false, FigureKind::kRandomWalk, "m/s^3/sqrt(Hz)"}};
    case NoiseFormat::kKfGins:
      return {{"arw", true, FigureKind::kDensity, "deg/sqrt(h)"},
              {"vrw", false, FigureKind::kDensity, "m/s/sqrt(h)"},
              {"gbstd", true, FigureKind::kBiasSigma, "deg/h"},
              {"abstd", false, FigureKind::kBiasSigma, "mGal"}};
  }
  throw ConfigError("figure_rules: unknown format");
}

std::string rate_key(NoiseFormat format) {
  switch (format) {
    case NoiseFormat::kKalibr:
    case NoiseFormat::kAllanVarianceRos:
    case NoiseFormat::kOpenVins:
      return "update_rate";
    case NoiseFormat::kPointLio:
      return "imu_time_inte";
    case NoiseFormat::kKfGins:
      return "imudatarate";
    default:
      return "";
  }
}

bool ends_with_key(const std::string& path, const std::string& key) {
  if (path.size() < key.size() || path.compare(path.size() - key.size(), key.size(), key) != 0) return false;
  return path.size() == key.size() || path[path.size() - key.size() - 1] == '/';
}

NoiseFormat detect_noise_format(const ConfigSource& source, const std::string& text, const std::string& name) {
  const auto has = [&source](const std::string& key) {
    return std::any_of(source.begin(), source.end(),
                       [&key](const auto& item) { return ends_with_key(item.first, key); });
  };
  const auto starts = [&source](const std::string& key) {
    const auto at = source.lower_bound(key);
    return at != source.end() && at->first.compare(0, key.size(), key) == 0;
  };
  if (starts("imu/noise/") || source.count("include") > 0) return NoiseFormat::kAllanLio;
  if (has("gyroscope_noise_density") || has("accelerometer_noise_density")) {
    if (is_chain(source)) return NoiseFormat::kOpenVins;
    // Its headings are in the singular, kalibr's example has the plural.
    const bool singular = text.find("#Gyroscope\n") != std::string::npos;
    return singular ? NoiseFormat::kAllanVarianceRos : NoiseFormat::kKalibr;
  }
  if (starts("Gyr/") || starts("Acc/")) return NoiseFormat::kImuUtils;
  if (has("imuGyrNoise") || has("imuAccNoise")) return NoiseFormat::kLioSam;
  if (has("imu_meas_omg_cov") || has("imu_meas_acc_cov")) return NoiseFormat::kPointLio;
  if (has("gyr_cov") || has("acc_cov")) return NoiseFormat::kFastLio;
  if (has("arw") || has("gbstd")) return NoiseFormat::kKfGins;
  std::string sentence = name + ": holds no IMU noise of a format that is known:";
  for (const char* known : kNames) sentence += std::string(known == kNames[0] ? " " : ", ") + known;
  throw ConfigError(sentence);
}

NoiseFormat detect_noise_format(const std::string& text, const std::string& name) {
  return detect_noise_format(parse_foreign_yaml(text, name), text, name);
}

}  // namespace allan_lio
