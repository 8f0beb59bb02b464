// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/imu_yaml.h"

namespace allan_lio {

/// An IMU to compare with.
struct KnownImu {
  std::string name;  ///< "imu/mti600"
  NoiseSpec spec;
};

/// The IMUs of imu/ below the directories, by name; without those that are no sensors (ideal, pseudo_imu).
/// Throws ConfigError.
std::vector<KnownImu> load_known_imus(const std::vector<std::string>& search_dirs);

/// By which k's the known IMU would behave as the file says.
struct ImpliedScale {
  std::string name;
  NoiseScale k;           ///< the axes averaged in S
  NoiseScale low, high;   ///< the axes one by one
  double distance = 0.0;  ///< sum of squared ln k, of those that are not 0
};

/// What a slip looks like when it is undone.
enum class Slip {
  kZero,                ///< a figure is 0
  kShippedDefaults,     ///< FAST-LIO2's or Point-LIO's own, which are nobody's calibration
  kSigmaForVariance,    ///< a standard deviation where its square belongs
  kDensityForVariance,  ///< N or K where the covariance of samples belongs
  kRootRateTooMuch,     ///< the deviation of samples where the density belongs
  kRootRateTooLittle,   ///< the density where the deviation or the covariance of samples belongs
  kDegrees,             ///< deg for rad
  kGravities,           ///< g for m/s^2
  kSwapped,             ///< the gyro's for the accelerometer's
  kLevelForRandomWalk,  ///< bias instability in the slot of the random walk
  kFarFromAll,          ///< noisier than ten times the noisiest IMU that is known
  kInflatedBias,        ///< a large k_gb or k_ab: a note, since many a filter wants it so
};

struct LintFinding {
  Slip slip;
  bool suspicious = true;  ///< else a note
  std::string sentence;
};

struct LintReport {
  NoiseFile file;
  std::vector<ImpliedScale> implied;  ///< one a known IMU
  int nearest = -1;                   ///< index of the smallest distance; -1: nothing to compare
  int reference = -1;                 ///< the one that was asked for, else the nearest
  std::vector<KnownImu> known;
  std::vector<LintFinding> findings;

  bool suspicious() const;
};

/// Compares with the known IMUs and looks for slips: each is undone in turn, and is named if what comes out is close
/// to a known IMU while the file as it stands is far off. `against`: the name of the IMU to tell the k's of, empty for
/// the nearest; it must be one of `known` (std::invalid_argument).
LintReport lint_noise(const NoiseFile& file, const std::vector<KnownImu>& known, const std::string& against = "");

}  // namespace allan_lio
