// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "mesh_formats.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kHeader = 80, kRecord = 50, kFloat = 4;  // [bytes]

/// A binary file's count of triangles fits its length; a text file's bytes there practically never do.
void read_binary(MeshText& text, TriangleMesh& mesh) {
  text.take(kHeader, "the header of a binary STL");
  const std::uint64_t count = read_unsigned(text.take(4, "the count of triangles"), 4);
  if (count > text.left() / kRecord)
    text.fail_byte("the file claims " + std::to_string(count) + " triangles and has bytes for " +
                   std::to_string(text.left() / kRecord));
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* record = text.take(kRecord, "a triangle");
    Vector3d corner[3];
    for (int c = 0; c < 3; ++c)  // after the normal's three floats
      for (int axis = 0; axis < 3; ++axis) corner[c][axis] = read_float(record + kFloat * (3 + 3 * c + axis));
    mesh.add_triangle(corner[0], corner[1], corner[2]);
  }
}

void read_text(MeshText& text, TriangleMesh& mesh) {
  std::vector<std::string> words;
  std::vector<Vector3d> corners;
  bool ended = false;
  while (text.next_line(words)) {
    if (words.empty()) continue;
    if (words[0] == "vertex") {
      if (words.size() != 4) text.fail_line("a vertex has three coordinates");
      corners.emplace_back(text.number(words[1]), text.number(words[2]), text.number(words[3]));
    } else if (words[0] == "endloop") {
      if (corners.size() != 3) text.fail_line("a facet has " + std::to_string(corners.size()) + " vertices, not 3");
      mesh.add_triangle(corners[0], corners[1], corners[2]);
      corners.clear();
    } else if (words[0] == "endsolid") {
      ended = true;
    } else if (words[0] != "solid" && words[0] != "facet" && words[0] != "outer" && words[0] != "endfacet") {
      text.fail_line("'" + words[0].substr(0, 40) + "' is not a word of an ASCII STL");
    }
  }
  if (!ended || !corners.empty()) text.fail_line("the file ends before 'endsolid'");
}

}  // namespace

void read_stl(MeshText text, TriangleMesh& mesh) {
  const std::string solid = "solid";
  MeshText probe = text, word = text;
  // Binary files may begin with "solid" too, so the length decides.
  bool binary = word.left() < solid.size() || std::string(word.take(solid.size(), ""), solid.size()) != solid;
  if (!binary && probe.left() >= kHeader + 4) {
    probe.take(kHeader, "");
    const std::uint64_t count = read_unsigned(probe.take(4, ""), 4);
    binary = probe.left() == count * kRecord;
  }
  if (binary)
    read_binary(text, mesh);
  else
    read_text(text, mesh);
}

}  // namespace allan_lio
