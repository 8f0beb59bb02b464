// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/prepared_record.h"

#include <stdexcept>
#include <utility>

#include "allan_lio/eval/trajectory_error.h"
#include "number_hash.h"

namespace allan_lio {
namespace {

template <class T>
double bytes_of(const std::vector<T>& values) {
  return static_cast<double>(values.capacity() * sizeof(T));
}

}  // namespace

void PreparedRecord::add(const Scan& scan) {
  if (!scan.thinned) throw std::invalid_argument("a scan of a prepared record must have been thinned");
  for (const ScanPoint& p : scan.points) points_.push_back({p.x, p.y, p.z, p.offset_ns});
  registered_.insert(registered_.end(), scan.registered.begin(), scan.registered.end());
  scans_.push_back({scan, imu_.size(), points_.size(), registered_.size()});
}

void PreparedRecord::set_reference(Trajectory reference) {
  Trajectory at_scans;
  for (std::size_t i = 0; i < scans(); ++i) at_scans.push_back({scan_end(i), {}});
  const TrajectoryError cover = evaluate_trajectory(reference, at_scans, Alignment::kNone);
  if (2 * cover.matched < scans())
    throw std::runtime_error("the truth holds the time of only " + std::to_string(cover.matched) + " of " +
                             std::to_string(scans()) + " scans");
  evaluate_trajectory(reference, reference, Alignment::kSe3);  // throws if it cannot be aligned to
  reference_ = std::move(reference);
}

void PreparedRecord::shrink() {
  imu_.shrink_to_fit();
  scans_.shrink_to_fit();
  points_.shrink_to_fit();
  registered_.shrink_to_fit();
}

Scan PreparedRecord::scan(std::size_t index) const {
  const Entry& entry = scans_[index];
  const std::uint64_t first_point = index == 0 ? 0 : scans_[index - 1].points_end;
  const std::uint64_t first_registered = index == 0 ? 0 : scans_[index - 1].registered_end;
  Scan scan;
  static_cast<ScanHeader&>(scan) = entry.header;
  scan.thinned = true;
  scan.points.reserve(entry.points_end - first_point);
  for (std::uint64_t i = first_point; i < entry.points_end; ++i)
    scan.points.push_back({points_[i].x, points_[i].y, points_[i].z, 0.0F, points_[i].offset_ns});
  scan.registered.assign(registered_.data() + first_registered, registered_.data() + entry.registered_end);
  return scan;
}

double PreparedRecord::megabytes() const {
  return 1e-6 * (bytes_of(imu_) + bytes_of(scans_) + bytes_of(points_) + bytes_of(registered_) + bytes_of(reference_));
}

std::uint64_t PreparedRecord::digest() const {
  NumberHash hash;
  hash.add(imu_.size());
  for (const ImuSample& s : imu_) hash.add(s.stamp), hash.add_each(s.gyro), hash.add_each(s.accel);
  hash.add(scans_.size());
  for (const Entry& e : scans_) each_number(e, [&hash](const auto& number) { hash.add(number); });
  for (const Point& p : points_) hash.add(p.x), hash.add(p.y), hash.add(p.z), hash.add(p.offset_ns);
  for (const std::uint32_t index : registered_) hash.add(index);
  hash.add(reference_.size());
  for (const StampedPose& p : reference_)
    hash.add(p.stamp), hash.add_each(p.pose.translation), hash.add_each(p.pose.rotation.coeffs());
  return hash.value();
}

}  // namespace allan_lio
