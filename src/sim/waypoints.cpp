// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/waypoints.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "allan_lio/io/line_reader.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

std::vector<std::string> split_words(std::string text) {
  text = text.substr(0, text.find('#'));
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::vector<Waypoint> read_waypoints(const std::string& path, double speed) {
  LineReader reader(path);
  std::vector<Waypoint> waypoints;
  bool heading_allowed = true;
  for (TextLine line; reader.next(line);) {
    const std::vector<std::string> words = split_words(line.text());
    if (words.empty()) continue;
    const auto fail = [&](const std::string& sentence) {
      throw std::runtime_error(path + ":" + std::to_string(line.number) + ": " + sentence);
    };
    double numbers[4] = {0.0, 0.0, 0.0, speed};
    const bool heading = heading_allowed && !parse_number(words[0], &numbers[0]);
    heading_allowed = false;
    if (heading) continue;
    if (words.size() != 3 && words.size() != 4)
      fail("a waypoint is x, y, z and perhaps a speed, here are " + std::to_string(words.size()) + " numbers");
    for (std::size_t i = 0; i < words.size(); ++i)
      if (!parse_number(words[i], &numbers[i])) fail("'" + words[i] + "' is not a finite number");
    if (!(numbers[3] > 0)) fail("the speed must be positive");
    const Waypoint waypoint{{numbers[0], numbers[1], numbers[2]}, numbers[3]};
    if (!waypoints.empty() && (waypoint.position - waypoints.back().position).norm() <= 1e-3)
      fail("the waypoint lies where the one before it lies");
    waypoints.push_back(waypoint);
  }
  if (waypoints.size() < 2) throw std::runtime_error(path + ": a way needs two waypoints or more");
  return waypoints;
}

}  // namespace allan_lio
