// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "mesh_formats.h"

namespace allan_lio {
namespace {

/// The vertex of a face's corner "v", "v/t", "v//n" or "v/t/n": counted from 1, or backwards from the last one.
std::int64_t vertex_of(const MeshText& text, const std::string& word, std::size_t vertices) {
  const std::int64_t number = text.whole(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  const std::int64_t index = number < 0 ? count + number : number - 1;
  if (number == 0 || index < 0 || index >= count)
    text.fail_line("the face names vertex " + std::to_string(number) + ", there are " + std::to_string(count));
  return index;
}

}  // namespace

void read_obj(MeshText text, TriangleMesh& mesh) {
  std::vector<std::string> words;
  std::vector<std::int64_t> corners;
  while (text.next_line(words)) {
    if (words.empty()) continue;
    if (words[0] == "v") {
      if (words.size() < 4) text.fail_line("a vertex has three coordinates");
      mesh.vertices.emplace_back(text.number(words[1]), text.number(words[2]), text.number(words[3]));
    } else if (words[0] == "f") {
      if (words.size() < 4) text.fail_line("a face has three corners or more");
      corners.clear();
      for (std::size_t i = 1; i < words.size(); ++i) corners.push_back(vertex_of(text, words[i], mesh.vertices.size()));
      add_polygon(corners, mesh.vertices.size(), mesh);
    } else if (words[0].find('\0') != std::string::npos) {
      text.fail_line("this is not a text file");
    }
  }
}

}  // namespace allan_lio
