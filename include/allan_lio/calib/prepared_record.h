// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// A recording as the odometry needs it, decoded and thinned once for many trials: read only then, so that threads may
/// share it. Every part lies in one piece; 160 s of a 16-beam LiDAR at 10 Hz in a corridor take 140 MB.
class PreparedRecord {
 public:
  /// Samples and scans in the order in which the messages came. A scan must come from thin_scan().
  void add(const ImuSample& sample) { imu_.push_back(sample); }
  void add(const Scan& scan);

  /// The truth, poses of the IMU. Throws std::runtime_error with a sentence unless its positions determine an alignment
  /// and it holds the time of at least half of the scans, so call it after they are there.
  void set_reference(Trajectory reference);

  /// Gives back what the vectors hold in reserve. Call it when nothing is to be added any more.
  void shrink();

  const std::vector<ImuSample>& imu() const { return imu_; }
  const Trajectory& reference() const { return reference_; }  ///< empty: there is no truth
  std::size_t scans() const { return scans_.size(); }

  TimeNs scan_begin(std::size_t index) const { return scans_[index].header.begin(); }
  TimeNs scan_end(std::size_t index) const { return scans_[index].header.end(); }
  std::size_t samples_before(std::size_t scan) const { return scans_[scan].samples_before; }  ///< in order of arrival

  /// As it was added, without the intensities.
  Scan scan(std::size_t index) const;

  double megabytes() const;

  /// As a file for other processes of this kind of machine, in one piece; reading it gives the same bits, in a tenth of
  /// the time that a bag takes and a tenth of its size. Throw std::runtime_error naming the path; load() also for a
  /// file that is cut off, damaged or of another format.
  void save(const std::string& path) const;
  static PreparedRecord load(const std::string& path);

  /// 64 bits that tell this content from any other: what is hashed are the samples, scans and poses themselves, so a
  /// bag that was moved, compressed or merged is the same one and a change of the decoder makes another.
  std::uint64_t digest() const;

 private:
  /// Every number of the record in one order, from and to a file.
  template <class Archive, class Record>
  static void exchange(Archive& archive, Record& record);

  struct Point {
    float x, y, z;  ///< [m]
    std::int32_t offset_ns;
  };
  struct Entry {
    ScanHeader header;
    std::uint64_t samples_before;
    std::uint64_t points_end, registered_end;  ///< one past its last in the common vectors
  };

  /// Every number of a scan's entry in one order.
  template <class AnEntry, class OnNumber>
  static void each_number(AnEntry& entry, const OnNumber& on_number) {
    auto& h = entry.header;
    on_number(h.stamp), on_number(entry.samples_before), on_number(entry.points_end), on_number(entry.registered_end);
    on_number(h.first_offset_ns), on_number(h.last_offset_ns);
    on_number(h.dropped_invalid), on_number(h.dropped_range), on_number(h.thinned_away);
  }

  std::vector<ImuSample> imu_;
  std::vector<Entry> scans_;
  std::vector<Point> points_;
  std::vector<std::uint32_t> registered_;
  Trajectory reference_;
};

}  // namespace allan_lio
