// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/states_csv.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <locale>
#include <stdexcept>

#include "allan_lio/io/csv_table.h"
#include "allan_lio/io/tum.h"

namespace allan_lio {
namespace {

constexpr int kTruthDigits = 12;  // far below every sigma

using Columns = std::vector<std::vector<double>>;

Columns columns_of(const CsvTable& table, const std::string& name, const std::vector<std::string>& entries) {
  Columns columns;
  for (const std::string& entry : entries) columns.push_back(table.numbers(name + "_" + entry));
  return columns;
}

Columns vector_columns(const CsvTable& table, const std::string& name) {
  return columns_of(table, name, {"x", "y", "z"});
}

Eigen::Vector3d vector_at(const Columns& columns, std::size_t i) {
  return {columns[0][i], columns[1][i], columns[2][i]};
}

/// A 3 x 3 block from its three sigmas and its three covariances.
class BlockColumns {
 public:
  BlockColumns(const CsvTable& table, const std::string& name)
      : sigma_(vector_columns(table, "sigma_" + name)), cross_(columns_of(table, "cov_" + name, {"xy", "xz", "yz"})) {}

  Eigen::Matrix3d at(std::size_t i) const {
    Eigen::Matrix3d block = vector_at(sigma_, i).cwiseAbs2().asDiagonal();
    block(0, 1) = block(1, 0) = cross_[0][i];
    block(0, 2) = block(2, 0) = cross_[1][i];
    block(1, 2) = block(2, 1) = cross_[2][i];
    return block;
  }

 private:
  Columns sigma_, cross_;
};

void read_nav(const CsvTable& table, std::vector<StateRow>& rows) {
  const Columns p = vector_columns(table, "p"), q = columns_of(table, "q", {"x", "y", "z", "w"}),
                v = vector_columns(table, "v"), bg = vector_columns(table, "bg"), ba = vector_columns(table, "ba"),
                g = vector_columns(table, "g");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    NavState& nav = rows[i].nav;
    nav.stamp = table.stamps()[i];
    nav.T_world_imu.translation = vector_at(p, i);
    nav.T_world_imu.rotation = Eigen::Quaterniond(q[3][i], q[0][i], q[1][i], q[2][i]).normalized();
    nav.velocity_world = vector_at(v, i);
    nav.gyro_bias = vector_at(bg, i);
    nav.accel_bias = vector_at(ba, i);
    nav.gravity_world = vector_at(g, i);
  }
}

void read_covariances(const CsvTable& table, std::vector<StateRow>& rows) {
  const BlockColumns theta(table, "theta"), p(table, "p"), bg(table, "bg"), ba(table, "ba");
  const Columns tilt = columns_of(table, "cov_tilt", {"00", "01", "11"}),
                v = columns_of(table, "cov_v_imu", {"xx", "xy", "xz", "yy", "yz", "zz"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cov_theta = theta.at(i);
    rows[i].cov_position = p.at(i);
    rows[i].cov_gyro_bias = bg.at(i);
    rows[i].cov_accel_bias = ba.at(i);
    rows[i].cov_tilt << tilt[0][i], tilt[1][i], tilt[1][i], tilt[2][i];
    rows[i].cov_imu_velocity << v[0][i], v[1][i], v[2][i], v[1][i], v[3][i], v[4][i], v[2][i], v[4][i], v[5][i];
  }
}

void read_support(const CsvTable& table, std::vector<StateRow>& rows) {
  for (const std::string& name : table.names_with("support_")) {
    const std::vector<double> support = table.numbers(name);
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i].weakest_support = std::min(rows[i].weakest_support, support[i]);
  }
}

void read_innovation(const CsvTable& table, std::vector<StateRow>& rows) {
  const std::vector<double> nis = table.numbers_or_nan("nis"), dof = table.numbers_or_nan("nis_dof");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].nis = nis[i];
    rows[i].nis_dof = dof[i];
  }
  for (int k = 0; k < 6; ++k) {
    const std::vector<double> column = table.numbers_or_nan("innovation_" + std::to_string(k));
    // Where nothing was measured the run writes zeros, which are no innovations.
    for (std::size_t i = 0; i < rows.size(); ++i)
      rows[i].innovation[k] = dof[i] > 0.0 ? column[i] : std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

StateRecord read_states_csv(const std::string& path) {
  const CsvTable table(path);
  StateRecord record;
  record.rows.resize(table.rows());
  read_nav(table, record.rows);
  read_covariances(table, record.rows);
  read_support(table, record.rows);
  record.has_innovation = table.has("nis");
  if (record.has_innovation) read_innovation(table, record.rows);
  return record;
}

std::vector<TruthState> read_truth_csv(const std::string& path) {
  const CsvTable table(path);
  const Columns v = vector_columns(table, "v"), bg = vector_columns(table, "bg"), ba = vector_columns(table, "ba");
  std::vector<TruthState> truth;
  truth.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i)
    truth.push_back({table.stamps()[i], vector_at(v, i), vector_at(bg, i), vector_at(ba, i)});
  return truth;
}

void write_truth_csv(const std::string& path, const std::vector<TruthState>& truth) {
  std::ofstream out(path);
  out.imbue(std::locale::classic());
  out.precision(kTruthDigits);
  out << "t,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z\n";
  for (const TruthState& state : truth) {
    out << format_seconds(state.stamp);
    for (const Eigen::Vector3d* vector : {&state.velocity_world, &state.gyro_bias, &state.accel_bias})
      for (int k = 0; k < 3; ++k) out << ',' << (*vector)[k];
    out << '\n';
  }
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace allan_lio
