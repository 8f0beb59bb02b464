// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/sim/mesh.h"

namespace allan_lio {

/// A file's bytes, read from the front.
class MeshText {
 public:
  MeshText(const std::string& name, const std::string& bytes) : name_(name), bytes_(bytes) {}

  std::size_t offset() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  std::size_t line() const { return line_; }  ///< the last one read, from 1

  /// The next line's words, parted by blanks; empty lines give none. False at the end.
  bool next_line(std::vector<std::string>& words);

  /// The next `count` bytes; fails where they are missing.
  const char* take(std::size_t count, const char* what);

  [[noreturn]] void fail_line(const std::string& sentence) const;  ///< "name:line: sentence"
  [[noreturn]] void fail_byte(const std::string& sentence) const;  ///< "name: byte n: sentence"

  /// A word as a finite number, or as a whole one.
  double number(const std::string& word) const;
  std::int64_t whole(const std::string& word) const;

 private:
  const std::string& name_;
  const std::string& bytes_;
  std::size_t at_ = 0, line_ = 0;
};

/// Little-endian values of a binary file.
float read_float(const char* bytes);
double read_double(const char* bytes);
std::uint64_t read_unsigned(const char* bytes, int size);

/// The polygon's fan of triangles. False if a corner is not one of `vertices`.
bool add_polygon(const std::vector<std::int64_t>& corners, std::size_t vertices, TriangleMesh& mesh);

void read_stl(MeshText text, TriangleMesh& mesh);
void read_obj(MeshText text, TriangleMesh& mesh);
void read_ply(MeshText text, TriangleMesh& mesh);

}  // namespace allan_lio
