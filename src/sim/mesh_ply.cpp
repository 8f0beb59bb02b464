// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <string>

#include "mesh_formats.h"

namespace allan_lio {
namespace {

struct Type {
  int size;  // [bytes]
  enum { kSigned, kUnsigned, kFloating } kind;
};

struct Property {
  std::string name;
  Type type;  // of the value, or of a list's entries
  bool is_list = false;
  Type count_type{1, Type::kUnsigned};
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool binary = false;
  std::vector<Element> elements;
};

Type type_named(const MeshText& text, const std::string& name) {
  static const std::map<std::string, Type> kTypes = {
      {"char", {1, Type::kSigned}},     {"int8", {1, Type::kSigned}},      {"uchar", {1, Type::kUnsigned}},
      {"uint8", {1, Type::kUnsigned}},  {"short", {2, Type::kSigned}},     {"int16", {2, Type::kSigned}},
      {"ushort", {2, Type::kUnsigned}}, {"uint16", {2, Type::kUnsigned}},  {"int", {4, Type::kSigned}},
      {"int32", {4, Type::kSigned}},    {"uint", {4, Type::kUnsigned}},    {"uint32", {4, Type::kUnsigned}},
      {"float", {4, Type::kFloating}},  {"float32", {4, Type::kFloating}}, {"double", {8, Type::kFloating}},
      {"float64", {8, Type::kFloating}}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) text.fail_line("'" + name.substr(0, 40) + "' is not a type of PLY");
  return found->second;
}

Property read_property(const MeshText& text, const std::vector<std::string>& words) {
  Property property;
  property.is_list = words.size() == 5 && words[1] == "list";
  if (!property.is_list && words.size() != 3) text.fail_line("a property is a type and a name, or a list");
  if (property.is_list) property.count_type = type_named(text, words[2]);
  property.type = type_named(text, words[words.size() - 2]);
  property.name = words.back();
  return property;
}

void read_format(const MeshText& text, const std::vector<std::string>& words, Header& header) {
  if (words.size() != 3) text.fail_line("the format line has three words");
  header.binary = words[1] == "binary_little_endian";
  if (!header.binary && words[1] != "ascii")
    text.fail_line("the format '" + words[1] + "' is not read; ascii and binary_little_endian are");
}

Header read_header(MeshText& text) {
  Header header;
  std::vector<std::string> words;
  if (!text.next_line(words) || words != std::vector<std::string>{"ply"}) text.fail_line("this is not a PLY file");
  bool has_format = false;
  while (text.next_line(words)) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      if (!has_format) text.fail_line("the header has no format line");
      return header;
    }
    if (words[0] == "format") {
      read_format(text, words, header);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back({words[1], text.whole(words[2]), {}});
      if (header.elements.back().count < 0) text.fail_line("an element's count is negative");
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(text, words));
    } else {
      text.fail_line("'" + words[0].substr(0, 40) + "' does not belong here in a PLY header");
    }
  }
  text.fail_line("the header has no end_header");
}

/// The values of an element's properties one after another, from text or from bytes.
class ValueReader {
 public:
  ValueReader(MeshText& text, bool binary) : text_(text), binary_(binary) {}

  void begin(const Element& element) {
    if (binary_) return;
    do {
      if (!text_.next_line(words_)) text_.fail_line("the file ends before its last " + element.name);
    } while (words_.empty());
    word_ = 0;
  }

  void end() {
    if (!binary_ && word_ != words_.size()) text_.fail_line("the line holds more than the header says");
  }

  double next(const Type& type) {
    if (!binary_) {
      if (word_ == words_.size()) text_.fail_line("the line holds less than the header says");
      return text_.number(words_[word_++]);
    }
    const char* bytes = text_.take(type.size, "an element");
    if (type.kind == Type::kFloating) return type.size == 4 ? read_float(bytes) : read_double(bytes);
    const std::uint64_t bits = read_unsigned(bytes, type.size);
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.size - 1);
    const bool negative = type.kind == Type::kSigned && (bits & sign) != 0;
    return static_cast<double>(bits) - (negative ? 2.0 * static_cast<double>(sign) : 0.0);
  }

  [[noreturn]] void fail(const std::string& sentence) const {
    if (binary_) text_.fail_byte(sentence);
    text_.fail_line(sentence);
  }

 private:
  MeshText& text_;
  bool binary_;
  std::vector<std::string> words_;
  std::size_t word_ = 0;
};

void read_list(ValueReader& values, const Property& property, std::vector<std::int64_t>& list) {
  list.clear();
  const double count = values.next(property.count_type);
  if (!(count >= 0 && count <= 1e6)) values.fail("a list claims " + std::to_string(count) + " entries");
  for (int i = 0; i < count; ++i) {
    const double entry = values.next(property.type);
    list.push_back(entry >= 0 && entry < 1e15 ? static_cast<std::int64_t>(entry) : -1);  // -1 is no vertex
  }
}

int axis_of(const std::string& name) { return name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : -1; }

void check_vertex(const MeshText& text, const Element& element) {
  int axes = 0;
  for (const Property& property : element.properties) axes += !property.is_list && axis_of(property.name) >= 0;
  if (axes != 3) text.fail_line("the vertices of the header don't have the three properties x, y and z");
}

void read_element(ValueReader& values, const Element& element, std::int64_t all_vertices, TriangleMesh& mesh) {
  values.begin(element);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::vector<std::int64_t> list;
  for (const Property& property : element.properties) {
    if (property.is_list) {
      read_list(values, property, list);
      if (element.name != "face" || (property.name != "vertex_indices" && property.name != "vertex_index")) continue;
      if (!add_polygon(list, static_cast<std::size_t>(all_vertices), mesh))
        values.fail("a face names a vertex beyond the " + std::to_string(all_vertices) + " that there are");
    } else {
      const double value = values.next(property.type);
      if (element.name == "vertex" && axis_of(property.name) >= 0) position[axis_of(property.name)] = value;
    }
  }
  values.end();
  if (element.name == "vertex") mesh.vertices.push_back(position);
}

}  // namespace

void read_ply(MeshText text, TriangleMesh& mesh) {
  const Header header = read_header(text);
  std::int64_t vertices = 0;
  for (const Element& element : header.elements) {
    if (element.properties.empty() && element.count > 0)
      text.fail_line("the element " + element.name + " of the header has no properties");
    if (element.name != "vertex") continue;
    check_vertex(text, element);
    vertices = element.count;
  }
  ValueReader values(text, header.binary);
  for (const Element& element : header.elements)
    for (std::int64_t i = 0; i < element.count; ++i) read_element(values, element, vertices, mesh);
}

}  // namespace allan_lio
