// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "allan_lio/calib/allan_fit.h"
#include "allan_lio/calib/static_record.h"

namespace allan_lio {

enum class FitMethod {
  kLeastSquares,  ///< of the Allan variances
  kLikelihood,    ///< of the samples; a Gauss-Markov bias
};

/// What a record says of one axis; u is rad/s or m/s^2.
struct AxisReport {
  AllanCurve curve;
  AxisAnalysis analysis;
  std::vector<DeviationBand> bands;  ///< one a point of the curve
  std::vector<double> fitted;        ///< Allan deviation of the better model at the curve's points [u]
  double mean = 0.0;                 ///< [u]
};

struct RecordAnalysis {
  FitMethod method = FitMethod::kLeastSquares;
  double tau0 = 0.0;      ///< [s]
  double duration = 0.0;  ///< [s]
  std::array<AxisReport, StaticRecord::kAxes> axes;
};

/// "gyro x" to "accel z".
std::string axis_name(int axis);

/// Curves and fits of all six axes; `shortest` [s] as in fit_allan_variance(). With kLikelihood the Gauss-Markov model
/// counts as the better one, and the flat part is that of its bias alone. Throws std::invalid_argument, naming the
/// axis, if the record is too short for a fit or an axis reads the same value all the time.
RecordAnalysis analyse_record(const StaticRecord& record, FitMethod method, int threads, double shortest = 0.0);

}  // namespace allan_lio
