// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/trial_store.h"

#include <cstring>

#include "sqlite_file.h"

namespace allan_lio {
namespace {

constexpr int kApplicationId = 0x414c5453;  // "ALTS"
constexpr int kFormat = 2;

constexpr char kSchema[] =
    "CREATE TABLE trials (problem TEXT NOT NULL, bag TEXT NOT NULL, k_g REAL NOT NULL, k_a REAL NOT NULL, "
    "k_gb REAL NOT NULL, k_ab REAL NOT NULL, k_r REAL NOT NULL, run INTEGER NOT NULL, seed INTEGER NOT NULL, "
    "ate REAL, end_error REAL, nll REAL, nis REAL, nis_dof INTEGER NOT NULL, horizon_nll REAL, horizon_nis REAL, "
    "horizon_dof REAL, horizon_share REAL, scans INTEGER NOT NULL, "
    "diverged INTEGER NOT NULL, PRIMARY KEY (problem, bag, k_g, k_a, k_gb, k_ab, k_r, run, seed)) WITHOUT ROWID";
constexpr char kFind[] =
    "SELECT ate, end_error, nll, nis, nis_dof, horizon_nll, horizon_nis, horizon_dof, horizon_share, scans, diverged "
    "FROM trials "
    "WHERE problem = ? AND bag = ? AND k_g = ? AND k_a = ? AND k_gb = ? AND k_ab = ? AND k_r = ? AND run = ? AND seed "
    "= ?";
constexpr char kPut[] =
    "INSERT OR REPLACE INTO trials VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)";

/// SQLite's integers have a sign; the bits are what counts.
std::int64_t to_signed(std::uint64_t value) {
  std::int64_t out;
  std::memcpy(&out, &value, sizeof(out));
  return out;
}

std::uint64_t to_unsigned(std::int64_t value) {
  std::uint64_t out;
  std::memcpy(&out, &value, sizeof(out));
  return out;
}

/// Throws for a file of something else or of a later format; false for one without content.
bool is_store(const SqliteFile& file) {
  const std::int64_t id = file.integer("PRAGMA application_id");
  const std::int64_t format = file.integer("PRAGMA user_version");
  if (id == 0 && format == 0 && file.integer("SELECT count(*) FROM sqlite_master") == 0) return false;
  if (id != kApplicationId) file.fail("is an SQLite file, but not a trial store");
  if (format != kFormat)
    file.fail("is a trial store of format " + std::to_string(format) + ", and this program knows format " +
              std::to_string(kFormat) + " only");
  return true;
}

void bind_key(SqliteStatement& statement, const TrialKey& key) {
  const NoiseSetting& s = key.setting;
  statement.bind(key.problem);
  statement.bind(key.bag);
  for (const double k : {s.imu.k_g, s.imu.k_a, s.imu.k_gb, s.imu.k_ab, s.k_r}) statement.bind(k);
  statement.bind(std::int64_t{key.run});
  statement.bind(key.run == 0 ? std::int64_t{0} : to_signed(key.seed));
}

}  // namespace

TrialStore::TrialStore(const std::string& path) : file_(std::make_unique<SqliteFile>(path)) {
  file_->run("BEGIN IMMEDIATE");  // of several programs one makes it
  if (!is_store(*file_)) {
    file_->run(kSchema);
    file_->run("PRAGMA application_id = " + std::to_string(kApplicationId));
    file_->run("PRAGMA user_version = " + std::to_string(kFormat));
  }
  file_->run("COMMIT");
  file_->use_write_ahead_log();
}

TrialStore::~TrialStore() = default;

std::optional<TrialResult> TrialStore::find(const TrialKey& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  SqliteStatement statement(*file_, kFind);
  bind_key(statement, key);
  if (!statement.step()) return std::nullopt;
  TrialResult result;
  result.ate = statement.number();
  result.end_error = statement.number();
  result.nll = statement.number();
  result.nis = statement.number();
  result.nis_dof = to_unsigned(statement.integer());
  result.horizon_nll = statement.number();
  result.horizon_nis = statement.number();
  result.horizon_dof = statement.number();
  result.horizon_share = statement.number();
  result.scans = static_cast<std::uint32_t>(statement.integer());
  result.diverged = statement.integer() != 0;
  return result;
}

void TrialStore::put(const TrialKey& key, const TrialResult& result) {
  const std::lock_guard<std::mutex> lock(mutex_);
  SqliteStatement statement(*file_, kPut);
  bind_key(statement, key);
  for (const double number : {result.ate, result.end_error, result.nll, result.nis}) statement.bind(number);
  statement.bind(to_signed(result.nis_dof));
  for (const double number : {result.horizon_nll, result.horizon_nis, result.horizon_dof, result.horizon_share})
    statement.bind(number);
  statement.bind(std::int64_t{result.scans});
  statement.bind(std::int64_t{result.diverged});
  statement.step();
}

std::size_t TrialStore::size() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<std::size_t>(file_->integer("SELECT count(*) FROM trials"));
}

}  // namespace allan_lio
