// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/publisher.h>
#include <ros/serialization.h>

#include <array>
#include <boost/array.hpp>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace allan_lio {

/// Walks over a message's fields as a serialiser does, but only looks whether the numbers are finite: no field of any
/// message can be forgotten.
class FiniteCheck {
 public:
  template <class T>
  void next(const T& field) {
    if constexpr (std::is_floating_point<T>::value) {
      finite_ = finite_ && std::isfinite(field);
    } else if constexpr (std::is_class<T>::value) {
      ros::serialization::Serializer<T>::template allInOne<FiniteCheck, const T&>(*this, field);
    }
  }
  template <class T, class A>
  void next(const std::vector<T, A>& fields) {
    if constexpr (!std::is_integral<T>::value)
      for (const T& field : fields) next(field);
  }
  template <class T, std::size_t N>
  void next(const boost::array<T, N>& fields) {
    for (const T& field : fields) next(field);
  }
  void next(const std::string&) {}
  void next(const ros::Time&) {}
  void next(const ros::Duration&) {}

  bool finite() const { return finite_; }

 private:
  bool finite_ = true;
};

/// True if no number of the message is NaN or infinite.
template <class Message>
bool all_finite(const Message& message) {
  FiniteCheck check;
  check.next(message);
  return check.finite();
}

/// The one way to publish what the filter computed: nothing with NaN or inf in it goes out. False if it did not.
template <class Message>
bool publish_finite(const ros::Publisher& publisher, const Message& message) {
  if (!all_finite(*message)) {
    ROS_ERROR_STREAM_THROTTLE(1.0, publisher.getTopic() << ": a message with NaN or inf was not published");
    return false;
  }
  publisher.publish(message);
  return true;
}

}  // namespace allan_lio
