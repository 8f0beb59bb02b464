// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/calib/record_analysis.h"
#include "allan_lio/io/imu_csv.h"

namespace allan_lio {

/// By which figures the bias is written.
enum class BiasOutput {
  kFlat,         ///< the flat part of the fitted curve: bias_instability, bias_time
  kGaussMarkov,  ///< the Gauss-Markov bias of the fit: bias_instability, bias_time
  kRandomWalk,   ///< K: bias_random_walk
};

/// Where a record came from, for the headers of what is written.
struct RecordOrigin {
  std::string name;  ///< files, and the topic of bags
  TemperatureSpan temperature;
  std::vector<std::string> remarks;  ///< sentences on what is not as it should be
};

struct NoiseYaml {
  std::string text;
  std::vector<std::string> missing;  ///< one sentence for each figure that the record does not show
};

/// The noise as a file for config/imu/. A figure that is not observable on some axis stands there as a comment with
/// its bound, so that the file is refused until somebody decides.
NoiseYaml noise_yaml(const RecordAnalysis& analysis, const RecordOrigin& origin, BiasOutput bias);

/// CSV: tau, then for each axis its Allan deviation, the 95 % band and the fitted model.
std::string deviation_table(const RecordAnalysis& analysis);

/// JSON: every coefficient of every axis with its interval, in SI.
std::string fits_json(const RecordAnalysis& analysis, const RecordOrigin& origin);

/// What is printed: the record's length, rate and jitter, and the remarks.
std::string record_text(const StaticRecord& record, const RecordOrigin& origin);

/// What is printed: a table of coefficients per axis, in SI and in data-sheet units.
std::string fits_text(const RecordAnalysis& analysis);

/// Decimal text of `value` with that many significant digits, with a point whatever the locale.
std::string rounded_text(double value, int digits);

}  // namespace allan_lio
