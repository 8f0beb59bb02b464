// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/prepared_record.h"
#include "binary_file.h"

namespace allan_lio {
namespace {

constexpr std::uint64_t kFormat = 0x414c5052'00000001;  // "ALPR", version 1

}  // namespace

template <class Archive, class Record>
void PreparedRecord::exchange(Archive& a, Record& record) {
  const auto three = [&a](auto& v) { a.number(v[0]), a.number(v[1]), a.number(v[2]); };
  a.each(record.imu_, [&](auto& s) { a.number(s.stamp), three(s.gyro), three(s.accel); });
  a.each(record.scans_, [&](auto& e) { each_number(e, [&a](auto& number) { a.number(number); }); });
  a.each(record.points_, [&](auto& p) { a.number(p.x), a.number(p.y), a.number(p.z), a.number(p.offset_ns); });
  a.each(record.registered_, [&](auto& index) { a.number(index); });
  a.each(record.reference_, [&](auto& p) {
    a.number(p.stamp), three(p.pose.translation);
    for (int i = 0; i < 4; ++i) a.number(p.pose.rotation.coeffs()[i]);
  });
}

void PreparedRecord::save(const std::string& path) const {
  BinaryWriter out(path, kFormat);
  out.number(digest());
  exchange(out, *this);
  out.finish();
}

PreparedRecord PreparedRecord::load(const std::string& path) {
  BinaryReader in(path, kFormat, "a prepared record");
  std::uint64_t digest = 0;
  in.number(digest);
  PreparedRecord record;
  exchange(in, record);
  in.end();
  if (record.digest() != digest) in.fail("is damaged");
  return record;
}

}  // namespace allan_lio
