// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite_file.h"

#include <limits>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr int kBusyMs = 30'000;  // that another process may hold the file
constexpr int kRetryMs = 20;

}  // namespace

SqliteFile::SqliteFile(const std::string& path) : path_(path) {
  const int code = sqlite3_open_v2(path.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  const bool writable = code == SQLITE_OK && sqlite3_db_readonly(handle_, "main") == 0;
  if (!writable) {
    const std::string why = code == SQLITE_OK ? "it cannot be written" : sqlite3_errstr(code);
    sqlite3_close(handle_);
    fail("cannot be opened: " + why);
  }
  sqlite3_busy_timeout(handle_, kBusyMs);
}

SqliteFile::~SqliteFile() { sqlite3_close(handle_); }

void SqliteFile::fail(const std::string& why) const { throw std::runtime_error(path_ + ": " + why); }
void SqliteFile::fail() const { fail(std::string("cannot be used: ") + sqlite3_errmsg(handle_)); }

void SqliteFile::run(const std::string& sql) const {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t SqliteFile::integer(const char* sql) const {
  SqliteStatement statement(*this, sql);
  return statement.step() ? statement.integer() : 0;
}

void SqliteFile::use_write_ahead_log() const {
  // Unlike everything else, the switch does not wait for other connections by itself.
  for (int waited = 0;; waited += kRetryMs) {
    const int code = sqlite3_exec(handle_, "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr);
    if (code == SQLITE_OK) return;
    if (code != SQLITE_BUSY || waited > kBusyMs) fail();
    sqlite3_sleep(kRetryMs);
  }
}

SqliteStatement::SqliteStatement(const SqliteFile& file, const char* sql) : file_(file) {
  check(sqlite3_prepare_v2(file.handle(), sql, -1, &statement_, nullptr));
}

void SqliteStatement::check(int code) const {
  if (code != SQLITE_OK) file_.fail();
}

void SqliteStatement::bind(const std::string& text) {
  check(sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
}
void SqliteStatement::bind(double number) { check(sqlite3_bind_double(statement_, ++bound_, number)); }
void SqliteStatement::bind(std::int64_t number) { check(sqlite3_bind_int64(statement_, ++bound_, number)); }

bool SqliteStatement::step() {
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) file_.fail();
  read_ = 0;
  return code == SQLITE_ROW;
}

double SqliteStatement::number() {
  const int column = read_++;
  if (sqlite3_column_type(statement_, column) == SQLITE_NULL) return std::numeric_limits<double>::quiet_NaN();
  return sqlite3_column_double(statement_, column);
}

}  // namespace allan_lio
