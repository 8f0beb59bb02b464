// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/mesh_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "allan_lio/io/number_text.h"
#include "mesh_formats.h"

namespace allan_lio {
namespace {

// Beyond it the ray caster's single precision would be coarser than a centimetre.
constexpr double kFarthest = 1e5;  // [m]

std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  std::ostringstream out;
  out << in.rdbuf();
  if (in.bad() || (out.fail() && in.peek() != std::ifstream::traits_type::eof()))
    throw std::runtime_error(path + ": cannot be read");
  return out.str();
}

std::string ending(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return "";
  std::string text = path.substr(dot + 1);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

void drop_slivers(TriangleMesh& mesh) {
  constexpr double kSmallest = 1e-12;  // twice the area [m^2]
  const auto flat = [&](const std::array<std::uint32_t, 3>& t) {
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return (b - a).cross(c - a).norm() < kSmallest;
  };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), flat), mesh.triangles.end());
}

}  // namespace

bool MeshText::next_line(std::vector<std::string>& words) {
  words.clear();
  if (at_ >= bytes_.size()) return false;
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  ++line_;
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  for (std::size_t i = at_; i < end;) {
    while (i < end && blank(bytes_[i])) ++i;
    const std::size_t begin = i;
    while (i < end && !blank(bytes_[i])) ++i;
    if (i > begin) words.push_back(bytes_.substr(begin, i - begin));
  }
  at_ = std::min(end + 1, bytes_.size());
  return true;
}

const char* MeshText::take(std::size_t count, const char* what) {
  if (left() < count) fail_byte(std::string("the file ends within ") + what);
  at_ += count;
  return bytes_.data() + at_ - count;
}

void MeshText::fail_line(const std::string& sentence) const {
  throw std::runtime_error(name_ + ":" + std::to_string(line_) + ": " + sentence);
}

void MeshText::fail_byte(const std::string& sentence) const {
  throw std::runtime_error(name_ + ": byte " + std::to_string(at_) + ": " + sentence);
}

double MeshText::number(const std::string& word) const {
  double value = 0.0;
  const bool plus = word.size() > 1 && word[0] == '+';  // which some exporters write
  if (!parse_number(plus ? word.substr(1) : word, &value)) fail_line("'" + word.substr(0, 40) + "' is not a number");
  return value;
}

std::int64_t MeshText::whole(const std::string& word) const {
  const double value = number(word);
  if (value != std::floor(value) || std::abs(value) > 1e15) fail_line("'" + word + "' is not a whole number");
  return static_cast<std::int64_t>(value);
}

float read_float(const char* bytes) {
  const auto bits = static_cast<std::uint32_t>(read_unsigned(bytes, 4));
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

double read_double(const char* bytes) {
  const std::uint64_t bits = read_unsigned(bytes, 8);
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::uint64_t read_unsigned(const char* bytes, int size) {
  std::uint64_t value = 0;
  for (int i = size - 1; i >= 0; --i) value = (value << 8) | static_cast<unsigned char>(bytes[i]);
  return value;
}

bool add_polygon(const std::vector<std::int64_t>& corners, std::size_t vertices, TriangleMesh& mesh) {
  for (const std::int64_t corner : corners)
    if (corner < 0 || corner >= static_cast<std::int64_t>(vertices)) return false;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    mesh.triangles.push_back({static_cast<std::uint32_t>(corners[0]), static_cast<std::uint32_t>(corners[i]),
                              static_cast<std::uint32_t>(corners[i + 1])});
  return true;
}

TriangleMesh read_mesh(const std::string& path) {
  const std::string format = ending(path);
  if (format != "stl" && format != "obj" && format != "ply")
    throw std::runtime_error(path + ": a mesh file ends in .stl, .obj or .ply");
  const std::string bytes = read_bytes(path);
  TriangleMesh mesh;
  if (format == "stl") read_stl(MeshText(path, bytes), mesh);
  if (format == "obj") read_obj(MeshText(path, bytes), mesh);
  if (format == "ply") read_ply(MeshText(path, bytes), mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (mesh.vertices[i].array().abs().maxCoeff() <= kFarthest && mesh.vertices[i].allFinite()) continue;
    throw std::runtime_error(path + ": vertex " + std::to_string(i) +
                             " is not a finite place within 100 km of the origin; move the mesh nearer to it");
  }
  drop_slivers(mesh);
  if (mesh.triangles.empty()) throw std::runtime_error(path + ": holds no triangle");
  return mesh;
}

}  // namespace allan_lio
