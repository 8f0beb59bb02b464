// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// Whose file it is that holds an IMU's noise.
enum class NoiseFormat {
  kAllanLio,          ///< config/imu/ of this package
  kKalibr,            ///< imu.yaml
  kAllanVarianceRos,  ///< the imu.yaml that it writes for kalibr: the same keys, the worst of the three axes
  kImuUtils,          ///< upstream: sigma(1 s) sqrt(rate), and the minimum of the curve
  kImuUtilsMintar,    ///< the fork by mintar: N and K, under the same keys; the text at `unit` tells them apart
  kFastLio,           ///< FAST-LIO2 and its kin (Faster-LIO, FAST-LIVO2): covariances of single samples
  kPointLio,          ///< covariances of single samples, imu_time_inte
  kLioSam,            ///< densities and random walks
  kOpenVins,          ///< kalibr_imu_chain.yaml
  kKfGins,            ///< kf-gins.yaml: a Gauss-Markov bias with one correlation time
};

/// "allan_lio", "kalibr", ... in the order of the enumeration.
std::vector<std::string> noise_format_names();
std::string noise_format_name(NoiseFormat format);

/// The inverse. Throws ConfigError listing the names.
NoiseFormat noise_format_by_name(const std::string& name);

/// What a figure states (u = rad/s or m/s^2).
enum class FigureKind {
  kDensity,          ///< N [u/sqrt(Hz)]
  kSampleSigma,      ///< N sqrt(rate) [u]
  kSampleVariance,   ///< N^2 rate [u^2]
  kBiasInstability,  ///< sigma_b [u]
  kRandomWalk,       ///< K [u/s/sqrt(Hz)]
  kBiasVariance,     ///< K^2 rate [(u/s)^2]
  kBiasSigma,        ///< steady state of a Gauss-Markov bias [u]
};

bool is_white(FigureKind kind);
/// Whether it holds for one rate only.
bool is_discrete(FigureKind kind);

/// One figure as it stands in the file.
struct NoiseFigure {
  std::string key;                                  ///< "mapping/acc_cov"
  std::string origin;                               ///< "avia.yaml:12"
  bool gyro = false;                                ///< else of the accelerometer
  FigureKind kind = FigureKind::kDensity;           ///< how it was understood
  std::string unit;                                 ///< of `value`, as in physical_unit.h; SI for our own files
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< as written; the same three times where the file has one
};

struct NoiseFile {
  NoiseFormat format = NoiseFormat::kAllanLio;
  NoiseSpec spec;
  double rate = 0.0;                 ///< [Hz] of the samples: as asked, else as the file says; 0 if neither does
  std::vector<NoiseFigure> figures;  ///< white noise of gyro and accelerometer, then their biases
  std::vector<std::string> notes;    ///< what a reader should know of how the file was understood
};

/// Whose file `text` is, by its keys. `name` is what errors call it. Throws ConfigError: not YAML, or nobody's.
NoiseFormat detect_noise_format(const std::string& text, const std::string& name);

/// Reads a file of another package, or one of our own that includes no other (else see read_noise_config()). `rate`
/// [Hz] goes before what the file says of it; 0: not given. Figures of zero are read. Throws ConfigError with file,
/// line and key: a figure is missing, given twice, not a finite number, negative, or a list where a number belongs and
/// the reverse; an unknown unit; a format of single samples without a rate.
NoiseFile read_noise_file(const std::string& text, const std::string& name, NoiseFormat format, double rate = 0.0);

/// What read_config() reads below imu/noise, of a source that load_yaml() made; the rest of it is left alone.
NoiseFile read_noise_config(const ConfigSource& source, const std::string& name);

struct WriteOptions {
  double rate = 0.0;       ///< [Hz]; 0: unknown
  double bias_time = 0.0;  ///< T_b [s] where the noise has none of its own; 0: unknown
};

/// The noise as a file of that format, S_b being kept where the kind of bias changes. One figure for the three axes
/// is their root mean square, which is their mean in S. What is lost or made up is told in `notes`. Throws
/// ConfigError: a figure is zero or not finite, or a rate or T_b is needed and not known.
std::string write_noise(const NoiseSpec& spec, NoiseFormat format, const WriteOptions& options,
                        std::vector<std::string>* notes);

}  // namespace allan_lio
