// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_source.h"

#include <algorithm>
#include <map>

namespace allan_lio {
namespace {

std::string without_slash(const std::string& topic) {
  return !topic.empty() && topic.front() == '/' ? topic.substr(1) : topic;
}

template <class Words>
std::string joined(const Words& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

}  // namespace

bool same_topic(const std::string& a, const std::string& b) { return without_slash(a) == without_slash(b); }

BagSource::BagSource(const std::vector<std::string>& files) {
  if (files.empty()) throw BagError("no bag was named");
  for (const std::string& file : files) {
    Input input;
    input.reader = open_bag(file);
    inputs_.push_back(std::move(input));
  }
}

void BagSource::require(const std::string& topic, const std::vector<std::string>& datatypes) const {
  std::map<std::string, std::set<std::string>> others;  // topics by type
  std::string held;
  for (const auto& connection : connections()) {
    const bool right = std::find(datatypes.begin(), datatypes.end(), connection->datatype) != datatypes.end();
    if (same_topic(connection->topic, topic) && right) return;
    if (same_topic(connection->topic, topic)) held = connection->datatype;
    if (right) others[connection->datatype].insert(connection->topic);
  }
  const std::string types = joined(datatypes, " or ");
  std::string message = held.empty() ? "the bag holds no topic " + topic
                                     : "topic " + topic + " of the bag is of type " + held + ", not " + types;
  if (others.empty()) message += "; it holds no topic of type " + types + " at all";
  for (const auto& [datatype, names] : others)
    message += "; its topics of type " + datatype + ": " + joined(names, ", ");
  for (const std::string& trouble : troubles()) message += "; " + trouble;
  throw BagError(message);
}

std::vector<std::shared_ptr<const BagConnection>> BagSource::connections() const {
  std::vector<std::shared_ptr<const BagConnection>> all;
  for (const Input& input : inputs_)
    all.insert(all.end(), input.reader->connections().begin(), input.reader->connections().end());
  return all;
}

void BagSource::select(const std::set<std::string>& topics) {
  std::set<std::string> both;
  for (const std::string& topic : topics) {
    both.insert(without_slash(topic));
    both.insert("/" + without_slash(topic));
  }
  for (Input& input : inputs_) input.reader->select(both);
}

bool BagSource::next(BagMessage& message) {
  const auto advance = [](Input& input) { input.has_head = input.reader->next(input.head); };
  if (!started_) std::for_each(inputs_.begin(), inputs_.end(), advance);
  started_ = true;
  Input* earliest = nullptr;
  for (Input& input : inputs_)
    if (input.has_head && (earliest == nullptr || input.head.time < earliest->head.time)) earliest = &input;
  if (earliest == nullptr) return false;
  std::swap(message, earliest->head);
  advance(*earliest);
  return true;
}

ros::Time BagSource::begin() const {
  ros::Time first = inputs_.front().reader->begin();
  for (const Input& input : inputs_) first = std::min(first, input.reader->begin());
  return first;
}

ros::Time BagSource::end() const {
  ros::Time last = inputs_.front().reader->end();
  for (const Input& input : inputs_) last = std::max(last, input.reader->end());
  return last;
}

std::vector<std::string> BagSource::troubles() const {
  std::vector<std::string> troubles;
  for (const Input& input : inputs_)
    if (!input.reader->trouble().empty()) troubles.push_back(input.reader->trouble());
  return troubles;
}

}  // namespace allan_lio
