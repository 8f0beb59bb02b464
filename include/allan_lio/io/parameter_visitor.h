// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace allan_lio {

/// The physical dimension of a quantity that carries its unit in the configuration (see noise_units.h).
enum class Dimension {
  kGyroWhiteNoise,   ///< rad/s/sqrt(Hz)
  kAccelWhiteNoise,  ///< m/s^2/sqrt(Hz)
  kAngularRate,      ///< rad/s
  kAcceleration,     ///< m/s^2
  kTime,             ///< s
  kGyroRandomWalk,   ///< rad/s^2/sqrt(Hz)
  kAccelRandomWalk,  ///< m/s^3/sqrt(Hz)
  kFrequency,        ///< Hz
};

/// What is said once about a parameter.
struct ParameterInfo {
  std::string key;       ///< "imu/k_gb"
  std::string unit;      ///< "m", "1" for a pure number
  std::string sentence;  ///< what it is, and "Change it when ..."
  bool live = false;     ///< may be changed while the filter runs
};

/// Closed interval, or open below where `exclusive_low` is set.
struct ParameterRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool exclusive_low = false;

  static ParameterRange positive() { return {0.0, std::numeric_limits<double>::infinity(), true}; }
  static ParameterRange not_negative() { return {0.0, std::numeric_limits<double>::infinity(), false}; }
  static ParameterRange between(double low, double high) { return {low, high, false}; }
};

/// Walks over the one declaration of all parameters. Reader, defaults, print-out and documentation are visitors.
/// A declaration passes the field, its default, unit, range and sentence; a visitor does with it what it is for.
class ParameterVisitor {
 public:
  virtual ~ParameterVisitor() = default;
  virtual void number(const ParameterInfo& info, double& field, double fallback, const ParameterRange& range) = 0;
  virtual void integer(const ParameterInfo& info, int& field, int fallback, const ParameterRange& range) = 0;
  virtual void flag(const ParameterInfo& info, bool& field, bool fallback) = 0;
  virtual void text(const ParameterInfo& info, std::string& field, const std::string& fallback) = 0;
  /// One of `names`; `field` and `fallback` are indices into them.
  virtual void choice(const ParameterInfo& info, int& field, int fallback, const std::vector<std::string>& names) = 0;
  /// A list of exactly `fallback.size()` numbers.
  virtual void numbers(const ParameterInfo& info, Eigen::Ref<Eigen::VectorXd> field, const Eigen::VectorXd& fallback,
                       const ParameterRange& range) = 0;
  /// `{value: 0.42, unit: deg/sqrt(h)}`, value one number or three. `field` is SI. There is no default: an IMU's
  /// noise must be given. White noise and random walks may also be a PSD, or with `rate: 400 Hz` the standard
  /// deviation or covariance of single samples (noise_units.h). A value must be finite and, by `range` (in SI),
  /// positive or not negative.
  virtual void quantity(const ParameterInfo& info, Eigen::Vector3d& field, Dimension dimension,
                        const ParameterRange& range) = 0;
  /// The same for one of several ways to say a thing: where the source is silent, `field` becomes `absent` on every
  /// axis, and a field that holds `absent` is not printed.
  virtual void optional_quantity(const ParameterInfo& info, Eigen::Vector3d& field, double absent, Dimension dimension,
                                 const ParameterRange& range) = 0;

  /// choice() for an enum whose values count from 0 in the order of `names`.
  template <class Enum>
  void option(const ParameterInfo& info, Enum& field, Enum fallback, const std::vector<std::string>& names) {
    static_assert(std::is_enum<Enum>::value, "option() is for enums");
    int index = static_cast<int>(field);
    choice(info, index, static_cast<int>(fallback), names);
    field = static_cast<Enum>(index);
  }
};

}  // namespace allan_lio
