// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/parameter_visitor.h"
#include "allan_lio/lio/lio_config.h"

namespace allan_lio {

/// One declared parameter with its value as text, for print-out and documentation.
struct ParameterEntry {
  enum class Kind { kNumber, kInteger, kFlag, kText, kChoice, kNumbers, kQuantity };

  ParameterInfo info;
  Kind kind = Kind::kNumber;
  std::vector<std::string> items;  ///< the value; several for a list
  bool is_list = false;
  ParameterRange range;                    ///< of numbers, integers and quantities
  std::vector<std::string> choices;        ///< of a choice
  Dimension dimension = Dimension::kTime;  ///< of a quantity
  bool optional = false;                   ///< a quantity that need not be given
  bool given = true;                       ///< false: an optional one that is not
};

/// Every parameter in the order of the declaration with its value in `config`; quantities in SI, those that are not
/// given too.
std::vector<ParameterEntry> list_parameters(const LioConfig& config);

/// "> 0", ">= 0", "9.7 to 9.9"; empty if there is no bound.
std::string range_text(const ParameterRange& range);

/// The value as YAML: texts quoted, lists in brackets, a quantity as {value: ..., unit: ...}.
std::string yaml_value(const ParameterEntry& entry);

/// Writes keys parted by '/' as nested YAML. Keys of a group must follow one another.
class YamlTree {
 public:
  /// Opens the groups that `key` lies in and adds the line "name: value" below `comments`, one line each.
  void add(const std::string& key, const std::string& value, const std::vector<std::string>& comments = {});

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::vector<std::string> open_;  ///< the groups of the last key
};

}  // namespace allan_lio
