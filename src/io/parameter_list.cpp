// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/parameter_list.h"

#include <cmath>
#include <utility>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/yaml_quoted.h"

namespace allan_lio {
namespace {

using Kind = ParameterEntry::Kind;

/// Takes down what the declaration says and what the fields hold; changes nothing.
class Lister : public ParameterVisitor {
 public:
  void number(const ParameterInfo& info, double& field, double, const ParameterRange& range) override {
    add(info, Kind::kNumber, {number_text(field)}).range = range;
  }
  void integer(const ParameterInfo& info, int& field, int, const ParameterRange& range) override {
    add(info, Kind::kInteger, {std::to_string(field)}).range = range;
  }
  void flag(const ParameterInfo& info, bool& field, bool) override {
    add(info, Kind::kFlag, {field ? "true" : "false"});
  }
  void text(const ParameterInfo& info, std::string& field, const std::string&) override {
    add(info, Kind::kText, {field});
  }
  void choice(const ParameterInfo& info, int& field, int, const std::vector<std::string>& names) override {
    add(info, Kind::kChoice, {names.at(static_cast<std::size_t>(field))}).choices = names;
  }
  void numbers(const ParameterInfo& info, Eigen::Ref<Eigen::VectorXd> field, const Eigen::VectorXd&,
               const ParameterRange& range) override {
    ParameterEntry& entry = add(info, Kind::kNumbers, {});
    for (Eigen::Index i = 0; i < field.size(); ++i) entry.items.push_back(number_text(field[i]));
    entry.is_list = true;
    entry.range = range;
  }
  void quantity(const ParameterInfo& info, Eigen::Vector3d& field, Dimension dimension,
                const ParameterRange& range) override {
    ParameterEntry& entry = add(info, Kind::kQuantity, {number_text(field[0])});
    entry.is_list = field[1] != field[0] || field[2] != field[0];
    if (entry.is_list) entry.items = {number_text(field[0]), number_text(field[1]), number_text(field[2])};
    entry.range = range;
    entry.dimension = dimension;
  }

  void optional_quantity(const ParameterInfo& info, Eigen::Vector3d& field, double absent, Dimension dimension,
                         const ParameterRange& range) override {
    quantity(info, field, dimension, range);
    entries_.back().optional = true;
    entries_.back().given = (field.array() != absent).any();
  }

  std::vector<ParameterEntry> take() { return std::move(entries_); }

 private:
  ParameterEntry& add(const ParameterInfo& info, Kind kind, std::vector<std::string> items) {
    ParameterEntry entry;
    entry.info = info;
    entry.kind = kind;
    entry.items = std::move(items);
    entries_.push_back(std::move(entry));
    return entries_.back();
  }

  std::vector<ParameterEntry> entries_;
};

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = key.find('/'); end != std::string::npos; end = key.find('/', begin)) {
    parts.push_back(key.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(key.substr(begin));
  return parts;
}

}  // namespace

std::vector<ParameterEntry> list_parameters(const LioConfig& config) {
  Lister lister;
  LioConfig copy = config;  // visitors may write; this one does not
  declare_parameters(lister, copy);
  return lister.take();
}

std::string range_text(const ParameterRange& range) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (low && high) return number_text(range.low) + " to " + number_text(range.high);
  if (low) return (range.exclusive_low ? "> " : ">= ") + number_text(range.low);
  return high ? "<= " + number_text(range.high) : "";
}

std::string yaml_value(const ParameterEntry& entry) {
  std::string list;
  for (const std::string& item : entry.items) {
    list += (list.empty() ? "" : ", ") + (entry.kind == Kind::kText ? yaml_quoted(item) : item);
  }
  if (entry.is_list) list = "[" + list + "]";
  return entry.kind == Kind::kQuantity ? "{value: " + list + ", unit: " + si_unit(entry.dimension) + "}" : list;
}

void YamlTree::add(const std::string& key, const std::string& value, const std::vector<std::string>& comments) {
  std::vector<std::string> groups = split_key(key);
  const std::string name = groups.back();
  groups.pop_back();
  std::size_t depth = 0;
  while (depth < groups.size() && depth < open_.size() && groups[depth] == open_[depth]) ++depth;
  for (; depth < groups.size(); ++depth) text_ += std::string(2 * depth, ' ') + groups[depth] + ":\n";
  const std::string indent(2 * groups.size(), ' ');
  for (const std::string& comment : comments) text_ += indent + "# " + comment + "\n";
  text_ += indent + name + ": " + value + "\n";
  open_ = std::move(groups);
}

}  // namespace allan_lio
