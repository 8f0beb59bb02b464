// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/whole_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

/// The name to write under first; `path` itself if it is a device or a pipe.
std::string interim_name(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) throw std::runtime_error(path + ": cannot be written, it is a directory");
  return fs::exists(status) && !fs::is_regular_file(status) ? path : path + ".part";
}

}  // namespace

void check_writable(const std::string& path) {
  const std::string interim = interim_name(path);
  const bool open = std::ofstream(interim, std::ios::app).is_open();
  if (!open) throw std::runtime_error(path + ": cannot be written");
  std::error_code ignored;
  if (interim != path) fs::remove(interim, ignored);
}

void write_whole(const std::string& path, const std::string& text) {
  const std::string interim = interim_name(path);
  std::ofstream out(interim, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out && interim != path) fs::rename(interim, path, error);
  if (out && !error) return;
  if (interim != path) fs::remove(interim, error);
  throw std::runtime_error(path + ": cannot be written");
}

}  // namespace allan_lio
