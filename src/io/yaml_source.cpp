// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/yaml_source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

const char* const kInclude = "include";

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// What could have been named: every YAML file below the search directories, without its extension.
std::string list_available(const std::vector<std::string>& search_dirs) {
  std::set<std::string> names;
  for (const std::string& dir : search_dirs) {
    std::error_code error;
    for (fs::recursive_directory_iterator at(dir, error), end; !error && at != end; at.increment(error)) {
      fs::path path = at->path();
      if (path.extension() == ".yaml") names.insert(path.lexically_relative(dir).replace_extension().generic_string());
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

class Loader {
 public:
  explicit Loader(const std::vector<std::string>& search_dirs) : search_dirs_(search_dirs) {}

  /// `asked_by`: "robot.yaml:1: ", or empty for the file that the user named.
  ConfigSource load(const std::string& name, const fs::path& base, const std::string& asked_by) {
    const fs::path path = find(name, base, asked_by);
    refuse_cycle(path, asked_by);
    open_.push_back(path);
    ConfigSource own = parse_yaml(read(path), path.string());
    ConfigSource result;
    const auto include = own.find(kInclude);
    if (include != own.end()) {
      const ConfigEntry entry = include->second;
      own.erase(include);
      for (const std::string& part : entry.items)
        result = merge(std::move(result), load(part, path.parent_path(), entry.origin + ": "));
    }
    open_.pop_back();
    return merge(std::move(result), own);
  }

 private:
  fs::path find(const std::string& name, const fs::path& base, const std::string& asked_by) const {
    std::vector<fs::path> places = {base / name};  // an absolute name stays as it is
    for (const std::string& dir : search_dirs_) {
      places.push_back(fs::path(dir) / name);
      places.push_back(fs::path(dir) / "robots" / name);
    }
    for (const fs::path& place : places) {
      if (is_file(place)) return place.lexically_normal();
      if (is_file(place.string() + ".yaml")) return fs::path(place.string() + ".yaml").lexically_normal();
    }
    const std::string available = list_available(search_dirs_);
    throw ConfigError(asked_by + "configuration '" + name + "' is not found: it is not a file" +
                      (available.empty() ? ", and there is none to choose from" : ", nor one of " + available));
  }

  void refuse_cycle(const fs::path& path, const std::string& asked_by) const {
    const auto same = [&path](const fs::path& other) {
      std::error_code error;
      return fs::equivalent(path, other, error);
    };
    const auto first = std::find_if(open_.begin(), open_.end(), same);
    if (first == open_.end()) return;
    std::string chain;
    for (auto at = first; at != open_.end(); ++at) chain += at->string() + " includes ";
    throw ConfigError(asked_by + "includes go in a circle: " + chain + path.string());
  }

  static std::string read(const fs::path& path) {
    std::ifstream in(path);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || in.bad()) throw ConfigError(path.string() + ": cannot be read");
    return text.str();
  }

  std::vector<std::string> search_dirs_;
  std::vector<fs::path> open_;  ///< the files being loaded, outermost first
};

}  // namespace

ConfigSource load_yaml(const std::string& name_or_path, const std::vector<std::string>& search_dirs) {
  return Loader(search_dirs).load(name_or_path, fs::path(), "");
}

}  // namespace allan_lio
