// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/parameter_doc.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/config_dirs.h"

namespace {

/// Prints the configuration that a run with the same arguments would use.
void print_in_force(const std::string& name, const std::vector<std::string>& overrides) {
  allan_lio::ConfigSource source = allan_lio::load_yaml(name, allan_lio::config_search_dirs());
  for (const std::string& text : overrides)
    source = allan_lio::merge(std::move(source), allan_lio::parse_override(text));
  const allan_lio::LioConfig config = allan_lio::read_config(source);
  std::cout << "# in force: " << name << ", hash " << allan_lio::config_hash(config) << "\n"
            << allan_lio::print_config(config);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Lists every parameter, or checks a configuration and prints what is in force.");
  bool markdown = false, yaml = false;
  std::string config;
  std::vector<std::string> overrides;
  CLI::Option_group* what = app.add_option_group("what");
  what->add_flag("--markdown", markdown, "Print doc/parameters.md");
  what->add_flag("--yaml", yaml, "Print config/lio.yaml: every parameter with its default");
  CLI::Option* config_option =
      what->add_option("--config", config, "Check this configuration: a name in config/robots or a path");
  what->require_option(1);
  app.add_option("--param", overrides, "key=value, replaces what the configuration says; may be repeated")
      ->needs(config_option)
      ->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  try {
    if (markdown) std::cout << allan_lio::parameters_markdown();
    if (yaml) std::cout << allan_lio::parameters_yaml();
    if (*config_option) print_in_force(config, overrides);
    std::cout.flush();
  } catch (const std::exception& error) {
    std::cerr << "lio_parameters: " << error.what() << "\n";
    return 1;
  }
  return std::cout ? 0 : 1;
}
