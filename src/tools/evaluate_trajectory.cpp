// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "allan_lio/eval/consistency_report.h"
#include "allan_lio/eval/posterior_bound.h"
#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/states_csv.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"

namespace {

using allan_lio::Alignment;
using allan_lio::ErrorStatistics;
using allan_lio::RelativeError;
using allan_lio::TrajectoryError;

constexpr double kDegPerRad = 57.295779513082320876798;

const std::map<std::string, Alignment> kAlignments = {
    {"se3", Alignment::kSe3}, {"yaw", Alignment::kYaw}, {"start", Alignment::kStart}, {"none", Alignment::kNone}};

/// JSON has no NaN: what has no value is null.
std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  out << value;
  return out.str();
}

std::string json_relative(const RelativeError& e) {
  const double valid = e.pairs > 0 ? 1.0 : std::numeric_limits<double>::quiet_NaN();
  return "{\"pairs\": " + std::to_string(e.pairs) +
         ", \"translation_rmse\": " + json_number(valid * e.translation_rmse) +
         ", \"translation_percent\": " + json_number(valid * e.translation_percent) +
         ", \"rotation_rmse_deg\": " + json_number(valid * kDegPerRad * e.rotation_rmse) + "}";
}

struct Options {
  std::string reference, estimate, align = "se3", errors;
  bool json = false;
  double max_gap = 0.5;  // [s]
  std::string states, truth_biases, axis = "path", series;
  std::vector<std::string> over_runs;
  std::string bound_imu;
  double bound_position_sigma = 0.002;  // [m]
};

/// `consistency`: a JSON object, or empty.
void print_json(const std::string& align, const TrajectoryError& e, const std::string& consistency) {
  const ErrorStatistics &t = e.translation, &r = e.rotation;
  std::cout << "{\n  \"align\": \"" << align << "\",\n  \"matched\": " << e.matched
            << ",\n  \"unmatched\": " << e.unmatched << ",\n  \"duration\": " << json_number(e.duration)
            << ",\n  \"path_length\": " << json_number(e.path_length)
            << ",\n  \"ate\": {\"rmse\": " << json_number(t.rmse) << ", \"mean\": " << json_number(t.mean)
            << ", \"median\": " << json_number(t.median) << ", \"max\": " << json_number(t.max)
            << ", \"rotation_rmse_deg\": " << json_number(kDegPerRad * r.rmse)
            << ", \"rotation_max_deg\": " << json_number(kDegPerRad * r.max)
            << "},\n  \"rpe_1s\": " << json_relative(e.over_1s) << ",\n  \"rpe_10m\": " << json_relative(e.over_10m)
            << ",\n  \"end_drift_m\": " << json_number(e.end_drift)
            << ",\n  \"end_drift_percent\": " << json_number(e.end_drift_percent)
            << (consistency.empty() ? "" : ",\n  \"consistency\": ") << consistency << "\n}\n";
}

void print_relative(const char* name, const RelativeError& e) {
  if (e.pairs == 0) {
    std::printf("%s the trajectory is too short for it\n", name);
  } else {
    std::printf("%s %.4f m (%.3f %%), %.4f deg rms over %zu pairs\n", name, e.translation_rmse, e.translation_percent,
                kDegPerRad * e.rotation_rmse, e.pairs);
  }
}

void print_table(const std::string& align, const TrajectoryError& e) {
  std::printf("matched poses        %zu of %zu%s\n", e.matched, e.matched + e.unmatched,
              e.unmatched > 0 ? " (the others lie outside the reference or in a gap of it)" : "");
  std::printf("path, duration       %.2f m, %.1f s\n", e.path_length, e.duration);
  std::printf("alignment            %s\n", align.c_str());
  std::printf("ATE translation [m]  rmse %.4f  mean %.4f  median %.4f  max %.4f\n", e.translation.rmse,
              e.translation.mean, e.translation.median, e.translation.max);
  std::printf("ATE rotation [deg]   rmse %.4f  mean %.4f  median %.4f  max %.4f\n", kDegPerRad * e.rotation.rmse,
              kDegPerRad * e.rotation.mean, kDegPerRad * e.rotation.median, kDegPerRad * e.rotation.max);
  print_relative("RPE over 1 s        ", e.over_1s);
  print_relative("RPE over 10 m       ", e.over_10m);
  std::printf("end drift            %.4f m", e.end_drift);
  if (std::isfinite(e.end_drift_percent)) std::printf(" (%.3f %% of the path)", e.end_drift_percent);
  std::printf("\n");
}

/// One line a matched pose: error in the reference's world and the angle.
void write_errors(const std::string& path, const TrajectoryError& e) {
  std::ofstream out(path);
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  out << "t,e_x,e_y,e_z,translation_m,rotation_deg\n";
  for (const allan_lio::PoseError& error : e.errors)
    out << allan_lio::format_seconds(error.stamp) << ',' << error.translation.x() << ',' << error.translation.y() << ','
        << error.translation.z() << ',' << error.translation.norm() << ',' << kDegPerRad * error.rotation << '\n';
  out.close();
  if (!out) throw std::runtime_error(path + ": cannot be written");
}

/// Of the IMU asked for: a name in config/imu or a file.
allan_lio::BoundOptions load_bound(const Options& options) {
  std::vector<std::string> dirs;
  for (const std::string& dir : allan_lio::config_search_dirs()) dirs.insert(dirs.end(), {dir + "/imu", dir});
  const auto config = allan_lio::read_config(allan_lio::load_yaml(options.bound_imu, dirs));
  allan_lio::BoundOptions bound = allan_lio::bound_options(config.imu.spec);
  bound.position_sigma = options.bound_position_sigma;
  bound.max_gap = options.max_gap;
  return bound;
}

void judge_trajectory(const Options& o) {
  if (o.reference.empty()) throw std::invalid_argument("--reference is required");
  if (o.estimate.empty()) throw std::invalid_argument("--estimate is required");
  const allan_lio::Trajectory reference = allan_lio::read_tum(o.reference);
  const TrajectoryError result =
      allan_lio::evaluate_trajectory(reference, allan_lio::read_tum(o.estimate), kAlignments.at(o.align), o.max_gap);
  if (!o.errors.empty()) write_errors(o.errors, result);
  std::string consistency;
  if (!o.states.empty()) {
    std::vector<allan_lio::TruthState> truth;
    if (!o.truth_biases.empty()) truth = allan_lio::read_truth_csv(o.truth_biases);
    const allan_lio::AxisChoice axis = allan_lio::parse_axis(o.axis);
    const allan_lio::ConsistencySeries series =
        allan_lio::consistency_series(reference, truth, allan_lio::read_states_csv(o.states), {axis, o.max_gap});
    if (!o.series.empty()) allan_lio::write_consistency_csv(o.series, series);
    allan_lio::ConsistencySummary summary = allan_lio::summarize_consistency({series});
    if (!o.bound_imu.empty()) allan_lio::add_bounds(reference, axis, load_bound(o), summary);
    consistency = o.json ? allan_lio::consistency_json(summary) : allan_lio::consistency_table(summary);
  }
  if (o.json) return print_json(o.align, result, consistency);
  print_table(o.align, result);
  std::fputs(consistency.c_str(), stdout);
}

void judge_runs(const Options& o) {
  std::vector<allan_lio::ConsistencySeries> runs;
  for (const std::string& path : o.over_runs) runs.push_back(allan_lio::read_consistency_csv(path));
  const allan_lio::ConsistencySummary summary = allan_lio::summarize_consistency(runs);
  if (o.json) {
    std::cout << allan_lio::consistency_json(summary) << '\n';
  } else {
    std::cout << allan_lio::consistency_table(summary);
  }
}

void declare(CLI::App& app, Options& o) {
  CLI::Option* const reference = app.add_option("--reference", o.reference, "TUM file with the truth");
  CLI::Option* const estimate = app.add_option("--estimate", o.estimate, "TUM file to be judged");
  app.add_option("--align", o.align,
                 "se3: best rotation and translation; yaw: best heading and translation; start: first poses coincide; "
                 "none (default se3)")
      ->check(CLI::IsMember({"se3", "yaw", "start", "none"}));
  app.add_option("--max-gap", o.max_gap, "longest gap of the reference to interpolate over [s] (default 0.5)")
      ->check(CLI::PositiveNumber);
  app.add_flag("--json", o.json, "print JSON instead of a table");
  app.add_option("--errors", o.errors, "also write the error at every matched pose to this CSV file");

  CLI::Option* const states = app.add_option(
      "--states", o.states, "the run's states.csv: also report whether its covariance is honest (NEES, NIS, 3 sigma)");
  app.add_option("--truth-biases", o.truth_biases,
                 "CSV with velocity and biases of the truth, as simulate_bag writes F_truth.csv; without it the "
                 "velocity is differentiated and the biases are not judged")
      ->needs(states);
  app.add_option("--axis", o.axis,
                 "along what the axial error is taken: path (where the true path extends most), motion, weakest (where "
                 "the filter is least sure), or a direction in the truth's world, x,y,z (default path)")
      ->needs(states);
  app.add_option("--series", o.series,
                 "write errors, sigmas and NEES of every scan to this CSV (scripts/plot_consistency)")
      ->needs(states);
  app.add_option(
         "--bound", o.bound_imu,
         "IMU (a name in config/imu or a file): print beside every stretch without support what an ideal filter "
         "with this IMU could know along the true path (1 sigma; with --axis weakest both horizontal positions "
         "and the heading are unseen there), and for an axis what dead reckoning with known tilt allows")
      ->needs(states);
  app.add_option("--bound-position-sigma", o.bound_position_sigma,
                 "1 sigma per axis of the position that an ideal scan tells [m] (default 0.002)")
      ->check(CLI::PositiveNumber);
  app.add_option("--over-runs", o.over_runs,
                 "instead of the above: series files of one sequence with different seeds; NEES averaged over them")
      ->excludes(reference)
      ->excludes(estimate)
      ->excludes(states);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares an estimated trajectory with a reference, both as TUM files (t x y z qx qy qz qw).\n"
      "The reference is interpolated at the stamps of the estimate. End drift is the position error of the last pose\n"
      "as seen from the first, whatever the alignment. With --states it also says whether the run's covariance is\n"
      "honest; the first poses coincide there in all six degrees of freedom, and the truth's world must be level.");
  Options options;
  declare(app, options);
  CLI11_PARSE(app, argc, argv);

  try {
    options.over_runs.empty() ? judge_trajectory(options) : judge_runs(options);
  } catch (const std::exception& e) {
    std::cerr << "evaluate_trajectory: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
