// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/parameter_doc.h"

#include <sstream>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {
namespace {

using Kind = ParameterEntry::Kind;

constexpr std::size_t kCommentWidth = 110;

std::vector<ParameterEntry> defaults() { return list_parameters(default_config(NoiseSpec())); }

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// What may stand there: "> 0", "one of auto, start", "3 numbers".
std::string allowed(const ParameterEntry& entry) {
  switch (entry.kind) {
    case Kind::kFlag:
      return "true or false";
    case Kind::kChoice:
      return "one of " + join(entry.choices);
    case Kind::kText:
      return "text";
    case Kind::kNumbers: {
      const std::string range = range_text(entry.range);
      return std::to_string(entry.items.size()) + " numbers" + (range.empty() ? "" : ", each " + range);
    }
    case Kind::kInteger:
      return "whole, " + range_text(entry.range);
    case Kind::kQuantity:
    case Kind::kNumber:
      break;
  }
  return range_text(entry.range);
}

std::string unit_or_empty(const ParameterEntry& entry) { return entry.info.unit == "1" ? "" : entry.info.unit; }

std::vector<std::string> wrap(const std::string& text) {
  std::vector<std::string> lines(1);
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    std::string& line = lines.back();
    if (!line.empty() && line.size() + 1 + word.size() > kCommentWidth) {
      lines.push_back(word);
    } else {
      line += (line.empty() ? "" : " ") + word;
    }
  }
  return lines;
}

/// "  # [m], > 0": what follows the value on its line.
std::string remark(const ParameterEntry& entry) {
  if (entry.kind == Kind::kText || entry.kind == Kind::kFlag) return "";
  const std::string unit = unit_or_empty(entry), range = allowed(entry);
  return "  # " + (unit.empty() ? "" : "[" + unit + "]") + (unit.empty() || range.empty() ? "" : ", ") + range +
         (entry.info.live ? ", live" : "");
}

std::string last_part(const std::string& key) { return key.substr(key.rfind('/') + 1); }

/// A quantity has no default, so it stands in the file as a comment.
void append_quantity(const ParameterEntry& entry, std::vector<std::string>* lines) {
  if (lines->empty()) {
    *lines = {"The IMU's noise has no default: include the file of your IMU in config/imu/, for example",
              "include: [imu/mti600], or give all of these (doc/imu_noise.md; the units are examples):", "noise:"};
  }
  for (const std::string& line : wrap(entry.info.sentence)) lines->push_back("  # " + line);
  lines->push_back("  # Units: " + join(usual_units(entry.dimension)));
  const std::string instead = entry.optional ? "one of the ways to tell the bias; " : "";
  lines->push_back("  " + last_part(entry.info.key) + ": {value: NUMBER, unit: " + entry.info.unit + "}  # " + instead +
                   range_text(entry.range) + ", one number or three");
}

/// An empty line before every group at the left margin.
std::string space_groups(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  bool indented = false;
  for (std::string line; std::getline(in, line);) {
    const bool now = line.compare(0, 1, " ") == 0;
    if (indented && !now) out += "\n";
    out += line + "\n";
    indented = now;
  }
  return out;
}

}  // namespace

std::string parameters_markdown() {
  std::string text =
      "# Parameters\n\n"
      "Made by `rosrun allan_lio lio_parameters --markdown` from `src/lio/lio_config.cpp`, the one place where they "
      "are\ndeclared; a test keeps this page and `config/lio.yaml` the same as the code. Keys are joined by `/` here "
      "and on the command\nline (`--param imu/k_gb=2`), nested in YAML and on the parameter server. A key that is "
      "not here is refused.\nNoise quantities carry their unit, as in "
      "`gyro_white_noise: {value: 0.42, unit: deg/sqrt(h)}` (see imu_noise.md); of the bias\nfigures "
      "`bias_instability`, `bias_random_walk` and `bias_sigma` exactly one is given. What is `live` can be "
      "changed while the node\nruns, by `rosparam set` or dynamic_reconfigure, and is in force with the next scan.\n";
  std::string group;
  for (const ParameterEntry& entry : defaults()) {
    const std::string this_group = entry.info.key.substr(0, entry.info.key.find('/'));
    if (this_group != group)
      text += "\n## " + this_group +
              "\n\n| key | unit | default | allowed | what it is |\n| --- | --- | --- | --- | --- |\n";
    group = this_group;
    const bool quantity = entry.kind == Kind::kQuantity;
    const std::string unit = unit_or_empty(entry);
    text += "| `" + entry.info.key + "` | " + (quantity ? "`" + join(usual_units(entry.dimension)) + "`" : unit) +
            " | " +
            (entry.optional ? "not given"
             : quantity     ? "none"
                            : "`" + yaml_value(entry) + "`") +
            " | " + allowed(entry) + (quantity ? "; one number or three" : "") + (entry.info.live ? "; live" : "") +
            " | " + entry.info.sentence + " |\n";
  }
  return text;
}

std::string parameters_yaml() {
  YamlTree tree;
  std::vector<std::string> quantities;
  for (const ParameterEntry& entry : defaults()) {
    if (entry.kind == Kind::kQuantity) {
      append_quantity(entry, &quantities);
      continue;
    }
    std::vector<std::string> comments = quantities;
    for (const std::string& line : wrap(entry.info.sentence)) comments.push_back(line);
    tree.add(entry.info.key, yaml_value(entry) + remark(entry), comments);
    quantities.clear();
  }
  return "# Every parameter of allan_lio with its default: what is not said in your own file is as it stands here.\n"
         "# Made by `rosrun allan_lio lio_parameters --yaml`; a test keeps it the same as the code.\n"
         "# What is live can be changed while the node runs: it is in force with the next scan.\n\n" +
         space_groups(tree.text());
}

}  // namespace allan_lio
