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
#include <string>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/tum.h"

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

void print_json(const std::string& align, const TrajectoryError& e) {
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
            << ",\n  \"end_drift_percent\": " << json_number(e.end_drift_percent) << "\n}\n";
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares an estimated trajectory with a reference, both as TUM files (t x y z qx qy qz qw).\n"
      "The reference is interpolated at the stamps of the estimate. End drift is the position error of the last pose\n"
      "as seen from the first, whatever the alignment.");
  std::string reference, estimate, align = "se3", errors;
  bool json = false;
  double max_gap = 0.5;
  app.add_option("--reference", reference, "TUM file with the truth")->required();
  app.add_option("--estimate", estimate, "TUM file to be judged")->required();
  app.add_option("--align", align,
                 "se3: best rotation and translation; yaw: best heading and translation; start: first poses coincide; "
                 "none (default se3)")
      ->check(CLI::IsMember({"se3", "yaw", "start", "none"}));
  app.add_option("--max-gap", max_gap, "longest gap of the reference to interpolate over [s] (default 0.5)")
      ->check(CLI::PositiveNumber);
  app.add_flag("--json", json, "print JSON instead of a table");
  app.add_option("--errors", errors, "also write the error at every matched pose to this CSV file");
  CLI11_PARSE(app, argc, argv);

  try {
    const TrajectoryError result = allan_lio::evaluate_trajectory(
        allan_lio::read_tum(reference), allan_lio::read_tum(estimate), kAlignments.at(align), max_gap);
    if (!errors.empty()) write_errors(errors, result);
    json ? print_json(align, result) : print_table(align, result);
  } catch (const std::exception& e) {
    std::cerr << "evaluate_trajectory: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
