// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/run_perturbation.h"

#include <algorithm>

#include "allan_lio/lidar/thin_scan.h"
#include "allan_lio/math/random_bits.h"

namespace allan_lio {
namespace {

enum Kind : std::uint64_t { kStart, kPhase, kSample, kScan, kPacket };

}  // namespace

RunPerturbation::RunPerturbation(std::uint64_t seed, std::uint64_t recording, std::uint32_t run)
    : as_it_is_(run == 0),
      state_(hash_bits(hash_bits(hash_bits(seed) ^ recording) ^ run)),
      start_(kLatestStart * draw(kStart, 0)),
      phase_(static_cast<std::uint32_t>(kThinningPhases * draw(kPhase, 0))) {}

double RunPerturbation::draw(std::uint64_t kind, std::uint64_t index) const {
  return uniform_from_bits(hash_bits(hash_bits(state_ ^ kind) ^ index));
}

bool RunPerturbation::keeps_sample(std::size_t index) const {
  return as_it_is_ || draw(kSample, index) >= kLostSamples;
}

bool RunPerturbation::keeps_scan(std::size_t index, double since_first) const {
  return as_it_is_ || (since_first >= start_ && draw(kScan, index) >= kLostScans);
}

void RunPerturbation::apply(std::size_t index, double leaf, ScanDownsampler& downsampler, Scan& scan) const {
  if (as_it_is_) return;
  // A packet is a piece of the sweep: of its time, or of the message where the points have none.
  const std::int64_t duration = std::int64_t{scan.last_offset_ns} - scan.first_offset_ns;
  const auto packet_of = [&](const ScanPoint& p) {
    const std::int64_t since = std::int64_t{p.offset_ns} - scan.first_offset_ns, place = &p - scan.points.data();
    return duration > 0 ? kPackets * since / (duration + 1)
                        : kPackets * place / static_cast<std::int64_t>(scan.points.size());
  };
  std::vector<ScanPoint> kept;
  kept.reserve(scan.points.size());
  for (const ScanPoint& p : scan.points)
    if (draw(kPacket, index * kPackets + static_cast<std::uint64_t>(packet_of(p))) >= kLostPackets) kept.push_back(p);
  scan.points = std::move(kept);
  scan.registered = registered_at_phase(scan.points, leaf, phase_, downsampler);
}

}  // namespace allan_lio
