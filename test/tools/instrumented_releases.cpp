// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Goes into src/tools/nodelet_manager.cpp's program in builds with a sanitizer.
//
// The thread sanitizer sees no order between the last reader of a shared object and the one who deletes it where the
// counts of shared pointers are released in libraries that are not instrumented. ROS's call that release by name, and
// of two of the same name take the program's: here stand the instrumented ones.
#include <nodelet/detail/callback_queue.h>
#include <ros/ros.h>

#include <boost/smart_ptr/shared_ptr.hpp>
#include <memory>

namespace {

// What is pointed to is compiled as a function of its own.
[[maybe_unused]] void (boost::detail::sp_counted_base::*volatile const kRelease)() =
    &boost::detail::sp_counted_base::release;
[[maybe_unused]] void (boost::detail::sp_counted_base::*volatile const kWeakRelease)() =
    &boost::detail::sp_counted_base::weak_release;
[[maybe_unused]] void (std::_Sp_counted_base<>::*volatile const kStdRelease)() = &std::_Sp_counted_base<>::_M_release;

}  // namespace

namespace nodelet {
namespace detail {

// Does what nodelet's does, which releases its hold of the nodelet inline.
uint32_t CallbackQueue::callOne() {
  const ros::VoidConstPtr held = tracked_object_.lock();
  return has_tracked_object_ && !held ? ros::CallbackQueue::Disabled : queue_.callOne();
}

}  // namespace detail
}  // namespace nodelet
