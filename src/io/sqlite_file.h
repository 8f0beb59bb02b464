// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <string>

namespace allan_lio {

/// A connection to an SQLite file, whose errors name the file. Not thread-safe.
class SqliteFile {
 public:
  /// Opens the file or makes it. Throws std::runtime_error if that cannot be done or it cannot be written.
  explicit SqliteFile(const std::string& path);
  ~SqliteFile();
  SqliteFile(const SqliteFile&) = delete;
  SqliteFile& operator=(const SqliteFile&) = delete;

  void run(const std::string& sql) const;

  /// The first column of a statement's first row, 0 if there is none.
  std::int64_t integer(const char* sql) const;

  /// Readers and a writer do not wait for each other then.
  void use_write_ahead_log() const;

  /// Throws std::runtime_error "path: why".
  [[noreturn]] void fail(const std::string& why) const;
  /// With what SQLite says.
  [[noreturn]] void fail() const;

  sqlite3* handle() const { return handle_; }

 private:
  const std::string path_;
  sqlite3* handle_ = nullptr;
};

/// A statement: its parameters are bound in order, a row's columns read in order.
class SqliteStatement {
 public:
  SqliteStatement(const SqliteFile& file, const char* sql);
  ~SqliteStatement() { sqlite3_finalize(statement_); }
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  void bind(const std::string& text);
  void bind(double number);
  void bind(std::int64_t number);

  /// True for a row.
  bool step();

  double number();  ///< NaN for NULL, as which SQLite keeps a NaN
  std::int64_t integer() { return sqlite3_column_int64(statement_, read_++); }

 private:
  void check(int code) const;

  const SqliteFile& file_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0, read_ = 0;
};

}  // namespace allan_lio
