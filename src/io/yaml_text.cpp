// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "allan_lio/io/yaml_source.h"

namespace allan_lio {
namespace {

constexpr int kMaxDepth = 10;  // an alias may contain itself

/// Walks a YAML tree and joins the keys on the way with '/'.
class Flattener {
 public:
  /// `with_lines`: origins are "name:line", else the name alone. `with_matrices`: a list of lists is passed over.
  Flattener(std::string name, bool with_lines, bool with_matrices = false)
      : name_(std::move(name)), with_lines_(with_lines), with_matrices_(with_matrices) {}

  void add(const std::string& key, const YAML::Node& node) {
    if (std::count(key.begin(), key.end(), '/') > kMaxDepth) fail(node, "'" + key + "' is nested too deep");
    if (node.IsMap()) {
      for (const auto& child : node) {
        if (!child.first.IsScalar() || child.first.Scalar().empty()) fail(child.first, "a key must be a word");
        add((key.empty() ? "" : key + "/") + child.first.Scalar(), child.second);
      }
      return;
    }
    ConfigEntry entry;
    entry.origin = origin(node);
    if (node.IsScalar()) {
      entry.items.push_back(node.Scalar());
    } else if (node.IsSequence()) {
      entry.is_list = true;
      for (const auto& item : node) {
        if (item.IsScalar()) {
          entry.items.push_back(item.Scalar());
        } else if (!with_matrices_) {
          fail(item, "'" + key + "' must be a plain list of values");
        }
      }
    }
    const auto inserted = source_.emplace(key, entry);
    if (!inserted.second) fail(node, "'" + key + "' is given twice, first at " + inserted.first->second.origin);
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& sentence) const {
    throw ConfigError(origin(node) + ": " + sentence);
  }

  ConfigSource take() { return std::move(source_); }

 private:
  std::string origin(const YAML::Node& node) const {
    return with_lines_ && node.Mark().line >= 0 ? name_ + ":" + std::to_string(node.Mark().line + 1) : name_;
  }

  std::string name_;
  bool with_lines_;
  bool with_matrices_;
  ConfigSource source_;
};

/// Steps over a document.
class Unheard : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// The one document that the text holds; null if there is none.
YAML::Node parse(const std::string& text, const std::string& name) {
  try {
    // Not LoadAll(): of a text with a comma at the start of a line it makes empty documents for ever.
    std::istringstream in(text);
    YAML::Parser parser(in);
    Unheard unheard;
    if (parser.HandleNextDocument(unheard) && parser.HandleNextDocument(unheard))
      throw ConfigError(name + ": holds more than one YAML document");
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.line >= 0 ? ":" + std::to_string(error.mark.line + 1) : "";
    throw ConfigError(name + line + ": not YAML: " + error.msg);
  }
}

ConfigSource flatten(const YAML::Node& root, Flattener flattener) {
  if (root.IsNull()) return {};
  if (!root.IsMap()) flattener.fail(root, "a configuration must be 'key: value' lines");
  flattener.add("", root);
  return flattener.take();
}

}  // namespace

ConfigSource parse_yaml(const std::string& text, const std::string& name) {
  return flatten(parse(text, name), Flattener(name, true));
}

ConfigSource parse_foreign_yaml(const std::string& text, const std::string& name) {
  std::string yaml = text;
  if (yaml.compare(0, 6, "%YAML:") == 0) yaml[0] = '#';  // a comment keeps the line numbers
  return flatten(parse(yaml, name), Flattener(name, true, true));
}

ConfigSource parse_override(const std::string& text) {
  const std::string origin = "--param";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ConfigError(origin + " '" + text + "': must be key=value, for example imu/k_gb=2");
  const std::string key = text.substr(0, equals), value = text.substr(equals + 1);
  if (value.empty()) return {{key, {{""}, false, origin}}};
  Flattener flattener(origin, false);
  flattener.add(key, parse(value, origin + " '" + text + "'"));
  return flattener.take();
}

}  // namespace allan_lio
