// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/program_files.h"

#include <ros/package.h>

#include <filesystem>
#include <stdexcept>

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

std::string beside_this_program(const std::string& name) {
  std::error_code ignored;
  return (fs::read_symlink("/proc/self/exe", ignored).parent_path() / name).string();
}

}  // namespace

std::string sibling_program(const std::string& name) {
  const std::string path = beside_this_program(name);
  if (!fs::exists(path)) throw std::runtime_error(path + ": the program " + name + " is not there");
  return path;
}

std::string package_script(const std::string& name) {
  const std::string beside = beside_this_program(name);
  if (fs::exists(beside)) return beside;
  const std::string package = ros::package::getPath("allan_lio"), in_tree = package + "/scripts/" + name;
  if (!package.empty() && fs::exists(in_tree)) return in_tree;
  throw std::runtime_error("the script " + name + " is neither beside this program nor in the package allan_lio");
}

}  // namespace allan_lio
