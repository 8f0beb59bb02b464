// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/run_writer.h"

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "allan_lio/imu/observable_error.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/io/yaml_quoted.h"

namespace allan_lio {
namespace {

constexpr char kStatesHeader[] =
    "t,p_x,p_y,p_z,q_x,q_y,q_z,q_w,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z,g_x,g_y,g_z,"
    "sigma_theta_x,sigma_theta_y,sigma_theta_z,sigma_p_x,sigma_p_y,sigma_p_z,sigma_v_x,sigma_v_y,sigma_v_z,"
    "sigma_bg_x,sigma_bg_y,sigma_bg_z,sigma_ba_x,sigma_ba_y,sigma_ba_z,"
    "points,registered,inliers,iterations,residual_rms,outcome,"
    "support_0,support_1,support_2,support_3,support_4,support_5,"
    "probability_0,probability_1,probability_2,probability_3,probability_4,probability_5,"
    "cov_p_xy,cov_p_xz,cov_p_yz,"
    "cov_theta_xy,cov_theta_xz,cov_theta_yz,cov_bg_xy,cov_bg_xz,cov_bg_yz,cov_ba_xy,cov_ba_xz,cov_ba_yz,"
    "cov_tilt_00,cov_tilt_01,cov_tilt_11,"
    "cov_v_imu_xx,cov_v_imu_xy,cov_v_imu_xz,cov_v_imu_yy,cov_v_imu_yz,cov_v_imu_zz,"
    "nis,nis_dof,innovation_0,innovation_1,innovation_2,innovation_3,innovation_4,innovation_5";

/// A row that reads back to the same bits, whatever the process's locale.
std::ostringstream exact_stream() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  return out;
}

const char* outcome_name(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kUpdated:
      return "updated";
    case ScanOutcome::kFirst:
      return "first";
    case ScanOutcome::kTooFewPoints:
      return "too_few_points";
    case ScanOutcome::kTooFewMatches:
      return "too_few_matches";
    case ScanOutcome::kMapRestarted:
      return "map_restarted";
  }
  return "unknown";
}

std::string states_row(const LioResult& result) {
  const NavState& nav = result.state.nav;
  std::ostringstream out = exact_stream();
  const auto put = [&out](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) out << ',' << values[i];
  };
  out << format_seconds(nav.stamp);
  put(nav.T_world_imu.translation);
  put(nav.T_world_imu.rotation.coeffs());  // x, y, z, w
  put(nav.velocity_world);
  put(nav.gyro_bias);
  put(nav.accel_bias);
  put(nav.gravity_world);
  const LioVector sigma = result.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (const int block : {kTheta, kPosition, kVelocity, kGyroBias, kAccelBias}) put(sigma.segment<3>(block));
  out << ',' << result.points << ',' << result.registered << ',' << result.inliers << ',' << result.iterations << ','
      << result.residual_rms << ',' << outcome_name(result.outcome);
  put(result.localizability.support);
  put(result.localizability.probability);
  // With the sigmas above these are the whole covariances of the blocks, so that any direction's can be had.
  for (const int block : {kPosition, kTheta, kGyroBias, kAccelBias})
    put(Eigen::Vector3d(result.covariance(block, block + 1), result.covariance(block, block + 2),
                        result.covariance(block + 1, block + 2)));
  const NavMatrix covariance = result.covariance.topLeftCorner<kNavDof, kNavDof>();
  const Eigen::Matrix2d tilt = tilt_covariance(nav, covariance);
  put(Eigen::Vector3d(tilt(0, 0), tilt(0, 1), tilt(1, 1)));
  const Eigen::Matrix3d v = imu_velocity_covariance(nav, covariance);
  put(Eigen::Vector3d(v(0, 0), v(0, 1), v(0, 2)));
  put(Eigen::Vector3d(v(1, 1), v(1, 2), v(2, 2)));
  out << ',' << result.innovation.nis << ',' << result.innovation.dof;  // 0 degrees of freedom: no update, or relocated
  put(result.innovation.whitened);
  return out.str();
}

void put_list(std::ostream& out, const std::string& key, const std::vector<std::string>& items) {
  out << key << (items.empty() ? ": []\n" : ":\n");
  for (const std::string& item : items) out << "  - " << yaml_quoted(item) << '\n';
}

void put_counters(std::ostream& out, const LioCounters& c) {
  const std::uint64_t skipped = c.scans_dropped_order + c.scans_before_imu + c.scans_after_imu +
                                c.scans_too_few_points + c.scans_too_few_matches + c.scans_overflow;
  out << "scans:\n  read: " << c.scans_read << "\n  used: " << c.scans_used << "\n  skipped: " << skipped
      << "\n  skipped_because:"
      << "\n    not_newer_than_the_last: " << c.scans_dropped_order << "\n    before_first_imu: " << c.scans_before_imu
      << "\n    after_last_imu: " << c.scans_after_imu << "\n    too_few_points: " << c.scans_too_few_points
      << "\n    too_few_matches: " << c.scans_too_few_matches << "\n    imu_did_not_come: " << c.scans_overflow
      << "\n  map_restarts: " << c.map_restarts << "\n  places_found: " << c.places_found
      << "\npoints:\n  invalid: " << c.points_invalid << "\n  out_of_range: " << c.points_out_of_range
      << "\n  over_budget: " << c.points_over_budget << "\nimu:\n  samples: " << c.imu_read
      << "\n  dropped_not_newer: " << c.imu_dropped_order << "\n  dropped_invalid: " << c.imu_dropped_invalid
      << "\n  saturated: " << c.imu_saturated << "\n  gaps: " << c.imu_gaps
      << "\n  starts_in_place: " << c.starts_in_place << '\n';
}

void put_times(std::ostream& out, const TimeStatistics& scans) {
  const auto precision = out.precision(3);
  out << std::fixed << "time_per_scan_ms: {mean: " << 1e3 * scans.mean() << ", p50: " << 1e3 * scans.percentile(0.5)
      << ", p95: " << 1e3 * scans.percentile(0.95) << ", max: " << 1e3 * scans.largest() << "}\n";
  out.precision(precision);
  out.unsetf(std::ios::floatfield);
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux gives kilobytes
}

std::string indented(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) out += line.empty() ? "\n" : "  " + line + "\n";
  return out;
}

/// Empty if all that was given to `file` so far could be written, else a sentence.
std::string write_failure(const std::ofstream& file, const std::string& path) {
  return file ? "" : path + ": could not be written (is the disk full?)";
}

/// The same, of all that was written.
std::string close_failure(std::ofstream& file, const std::string& path) {
  file.close();
  return write_failure(file, path);
}

void put_parameters(std::ostream& out, const LioConfig& config, const std::string& moment) {
  out << "parameters_hash" << moment << ": " << yaml_quoted(config_hash(config)) << "\nparameters" << moment << ":\n"
      << indented(print_config(config));
}

}  // namespace

RunWriter::RunWriter(const std::string& directory, const LioConfig& config)
    : directory_(directory), at_start_(config), in_force_(config) {
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (error) throw std::runtime_error(directory_ + ": cannot be created: " + error.message());
  std::filesystem::remove(directory_ + "/summary.yaml", error);  // it would be another run's
  if (error) throw std::runtime_error(directory_ + "/summary.yaml: cannot be replaced: " + error.message());
  trajectory_.open(directory_ + "/trajectory.tum");
  if (!trajectory_) throw std::runtime_error(directory_ + "/trajectory.tum: cannot be written");
  states_.open(directory_ + "/states.csv");
  states_ << kStatesHeader << std::endl;
  if (!states_) throw std::runtime_error(directory_ + "/states.csv: cannot be written");
}

RunWriter::~RunWriter() {
  if (finished_) return;
  try {
    flush();
    RunSummary summary;
    summary.status = trouble_.empty() ? "interrupted" : "incomplete: " + trouble_;
    summary.counters.scans_read = summary.counters.scans_used = scan_seconds_.count();
    summary.notes = {"the run did not end in order: of the counters only the scans are known, as states written"};
    write_summary(summary);
  } catch (const std::exception&) {
    // A destructor has nobody to tell; the rows are on disk as far as they could be written.
  }
}

void RunWriter::add(const LioResult& result, double cpu_seconds) {
  const NavState& nav = result.state.nav;
  trajectory_ << format_tum_line({nav.stamp, nav.T_world_imu}) << '\n';
  states_ << states_row(result) << '\n';
  const bool first = scan_seconds_.count() == 0;
  scan_seconds_.add(cpu_seconds);
  if (first || std::abs(seconds_between(last_flush_, nav.stamp)) >= 1.0) {
    flush();
    last_flush_ = nav.stamp;
  }
}

void RunWriter::flush() {
  trajectory_.flush();
  states_.flush();
  if (trouble_.empty()) trouble_ = write_failure(trajectory_, directory_ + "/trajectory.tum");
  if (trouble_.empty()) trouble_ = write_failure(states_, directory_ + "/states.csv");
}

void RunWriter::finish(const RunSummary& summary) {
  const std::string trajectory_failure = close_failure(trajectory_, directory_ + "/trajectory.tum");
  const std::string states_failure = close_failure(states_, directory_ + "/states.csv");
  if (trouble_.empty()) trouble_ = trajectory_failure.empty() ? states_failure : trajectory_failure;
  RunSummary honest = summary;
  if (!trouble_.empty()) honest.status = "incomplete: " + trouble_;
  write_summary(honest);
  finished_ = true;
  if (!trouble_.empty()) throw std::runtime_error(trouble_);
}

void RunWriter::write_summary(const RunSummary& summary) const {
  const std::string path = directory_ + "/summary.yaml";
  std::ofstream out(path);
  out.imbue(std::locale::classic());
  out << "status: " << yaml_quoted(summary.status) << '\n';
  put_list(out, "inputs", summary.inputs);
  put_list(out, "notes", summary.notes);
  put_counters(out, summary.counters);
  put_times(out, scan_seconds_);
  out << "peak_rss_mb: " << peak_rss_mb() << "\nmap: {megabytes: " << summary.map_megabytes
      << ", voxels: " << summary.map_voxels << "}\n";
  put_parameters(out, in_force_, "");
  if (config_hash(at_start_) != config_hash(in_force_)) put_parameters(out, at_start_, "_at_start");
  const std::string failure = close_failure(out, path);
  if (!failure.empty()) throw std::runtime_error(failure);
}

}  // namespace allan_lio
