// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <limits>
#include <locale>
#include <stdexcept>

#include "allan_lio/eval/consistency_report.h"
#include "allan_lio/io/csv_table.h"

namespace allan_lio {
namespace {

constexpr int kDigits = 6;  // for plots and means

/// "NAME_x,NAME_y,..." as many as there are entries.
std::string column_names(const std::string& name, const std::string& entries) {
  std::string text;
  for (const char entry : entries) text += "," + name + "_" + entry;
  return text;
}

std::string header() {
  std::string text = "t,support";
  for (const auto& [name, entries] : {std::pair<const char*, const char*>{"tilt", "01"},
                                      {"velocity", "xyz"},
                                      {"gyro_bias", "xyz"},
                                      {"accel_bias", "xyz"},
                                      {"across", "01"}})
    text += column_names(std::string("e_") + name, entries) + column_names(std::string("s_") + name, entries);
  text += ",e_along,s_along";
  for (int b = 0; b < kNeesBlocks; ++b) text += std::string(",nees_") + nees_block_name(static_cast<NeesBlock>(b));
  return text + ",dof_innovation";
}

}  // namespace

void write_consistency_csv(const std::string& path, const ConsistencySeries& series) {
  std::ofstream out(path);
  out.imbue(std::locale::classic());
  out.precision(kDigits);
  out << header() << '\n';
  const auto put = [&out](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) out << ',' << values[i];
  };
  for (const ConsistencySample& s : series) {
    out << format_seconds(s.stamp) << ',' << s.support;
    put(s.tilt), put(s.sigma_tilt);
    put(s.velocity), put(s.sigma_velocity);
    put(s.gyro_bias), put(s.sigma_gyro_bias);
    put(s.accel_bias), put(s.sigma_accel_bias);
    put(s.across), put(s.sigma_across);
    out << ',' << s.along << ',' << s.sigma_along;
    for (const double nees : s.nees) out << ',' << nees;
    out << ',' << s.dof[static_cast<std::size_t>(NeesBlock::kInnovation)] << '\n';
  }
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

ConsistencySeries read_consistency_csv(const std::string& path) {
  const CsvTable table(path);
  ConsistencySeries series(table.rows());
  const std::vector<double> support = table.numbers("support"), along = table.numbers("e_along"),
                            sigma = table.numbers("s_along"), dof = table.numbers_or_nan("dof_innovation");
  for (std::size_t i = 0; i < series.size(); ++i) {
    ConsistencySample& s = series[i];
    s.stamp = table.stamps()[i];
    s.support = support[i];
    s.along = along[i];
    s.sigma_along = sigma[i];
    s.dof = {2, 3, 3, 3, 1, 2, 3, 3, dof[i]};
    s.innovation.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  for (std::size_t b = 0; b < kNeesBlocks; ++b) {
    const std::vector<double> nees =
        table.numbers_or_nan(std::string("nees_") + nees_block_name(static_cast<NeesBlock>(b)));
    for (std::size_t i = 0; i < series.size(); ++i) series[i].nees[b] = nees[i];
  }
  return series;
}

}  // namespace allan_lio
