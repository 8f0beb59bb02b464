// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_run_files.h"

#include <filesystem>
#include <stdexcept>
#include <utility>

#include "allan_lio/calib/tuning_text.h"
#include "allan_lio/io/content_hash.h"
#include "binary_file.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFormat = 0x414c4c52'00000002;  // "ALLR", version 2
constexpr std::uint64_t kLeastScan = 6 * sizeof(NavMatrix);

template <class Archive, class Matrix>
void exchange_matrix(Archive& a, Matrix& m) {
  for (Eigen::Index i = 0; i < m.size(); ++i) a.number(m.data()[i]);
}

// What depends on how many directions a scan supports: six at most.
void exchange_count(BinaryWriter& out, const LinearScan& scan) {
  out.number(static_cast<std::uint64_t>(scan.measured.size()));
}
void exchange_count(BinaryReader& in, LinearScan& scan) {
  std::uint64_t count = 0;
  in.number(count);
  if (count > 6) in.fail("is damaged");
  const auto rows = static_cast<Eigen::Index>(count);
  scan.rows.resize(rows, 6);
  scan.map_rows.resize(rows, 6);
  scan.measured.resize(rows);
  scan.variances.resize(rows);
}

template <class Archive, class Scan>
void exchange(Archive& a, Scan& scan) {
  a.number(scan.time), a.number(scan.step);
  exchange_matrix(a, scan.phi);
  for (auto& noise : scan.noise) exchange_matrix(a, noise);
  exchange_matrix(a, scan.bridged);
  exchange_matrix(a, scan.correction);
  exchange_count(a, scan);
  exchange_matrix(a, scan.rows), exchange_matrix(a, scan.map_rows);
  exchange_matrix(a, scan.measured), exchange_matrix(a, scan.variances);
  a.number(scan.log_gram);
  exchange_matrix(a, scan.view_noise);
  a.number(scan.view_kept), a.number(scan.deskewed);
}

template <class Archive, class Linearised>
void exchange_trial(Archive& a, Linearised& trial) {
  auto& r = trial.result;
  for (auto* value :
       {&r.ate, &r.end_error, &r.nll, &r.nis, &r.horizon_nll, &r.horizon_nis, &r.horizon_dof, &r.horizon_share})
    a.number(*value);
  a.number(r.nis_dof), a.number(r.scans), a.number(r.diverged);
  auto& run = trial.run;
  a.each(
      run.scans, [&a](auto& scan) { exchange(a, scan); }, kLeastScan);
  exchange_matrix(a, run.initial_covariance);
  exchange_matrix(a, run.gyro_psd);
  a.number(run.k_r);
  a.checksum();
}

LinearisedTrial load(const std::string& path) {
  BinaryReader in(path, kFormat, "a linear run");
  LinearisedTrial out;
  exchange_trial(in, out);
  in.end();
  return out;
}

}  // namespace

LinearRunFiles::LinearRunFiles(const TrialProblem& problem, std::string directory)
    : problem_(problem), directory_(std::move(directory)) {
  std::error_code failure;
  fs::create_directories(directory_, failure);
  if (failure) throw std::runtime_error(directory_ + ": cannot be made: " + failure.message());
}

std::string LinearRunFiles::name_of(const NoiseTrial& trial) const {
  const TrialKey key = problem_.key(trial);
  const std::uint64_t seed = key.run == 0 ? 0 : key.seed;  // plays no part in run 0
  return "run_" +
         hash_text(key.problem + " " + key.bag + " " + text_of(key.setting) + " " + std::to_string(key.run) + " " +
                   std::to_string(seed)) +
         ".bin";
}

/// By the directory's listing, which a network file system shows fresher than a name that was asked for in vain.
std::optional<LinearisedTrial> LinearRunFiles::find(const NoiseTrial& trial) const {
  const std::string name = name_of(trial);
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) {
    if (entry.path().filename() != name) continue;
    try {
      LinearisedTrial found = load(entry.path().string());
      found.trial = trial;
      return found;
    } catch (const std::runtime_error&) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

void LinearRunFiles::put(const LinearisedTrial& linearised) const {
  BinaryWriter out(directory_ + "/" + name_of(linearised.trial), kFormat);
  exchange_trial(out, linearised);
  out.finish();
}

LinearisedTrial LinearRunFiles::get(const NoiseTrial& trial) const {
  if (std::optional<LinearisedTrial> known = find(trial)) return std::move(*known);
  LinearisedTrial made = problem_.run_linearised(trial);
  put(made);
  return made;
}

}  // namespace allan_lio
