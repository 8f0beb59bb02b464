// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <type_traits>

#include "allan_lio/calib/prepared_record.h"

namespace allan_lio {
namespace {

// The bytes of a number lie as in memory: the first word tells a machine of the other byte order.
constexpr std::uint64_t kFormat = 0x414c5052'00000001;  // "ALPR", version 1

class Writer {
 public:
  explicit Writer(const std::string& path) : out_(path, std::ios::binary) {}

  template <class T>
  void number(const T& value) {
    static_assert(std::is_arithmetic<T>::value, "a number");
    out_.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class Items, class OnItem>
  void each(const Items& items, const OnItem& on_item) {
    number(static_cast<std::uint64_t>(items.size()));
    for (const auto& item : items) on_item(item);
  }
  bool close() {
    out_.close();
    return static_cast<bool>(out_);
  }

 private:
  std::ofstream out_;
};

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), in_(path, std::ios::binary | std::ios::ate) {
    if (!in_) throw std::runtime_error(path_ + ": cannot be opened");
    left_ = static_cast<std::uint64_t>(in_.tellg());
    in_.seekg(0);
  }

  template <class T>
  void number(T& value) {
    static_assert(std::is_arithmetic<T>::value, "a number");
    if (left_ < sizeof value || !in_.read(reinterpret_cast<char*>(&value), sizeof value)) fail("is cut off");
    left_ -= sizeof value;
  }
  template <class Items, class OnItem>
  void each(Items& items, const OnItem& on_item) {
    std::uint64_t size = 0;
    number(size);
    if (size > left_) fail("is damaged");  // an item takes a byte at least: no memory is asked for what is not there
    items.resize(size);
    for (auto& item : items) on_item(item);
  }
  void end() const {
    if (left_ != 0) fail("goes on after its end");
  }
  [[noreturn]] void fail(const char* what) const { throw std::runtime_error(path_ + ": " + what); }

 private:
  std::string path_;
  std::ifstream in_;
  std::uint64_t left_ = 0;
};

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
  const std::string part = path + ".part" + std::to_string(getpid());
  Writer out(part);
  out.number(kFormat);
  out.number(digest());
  exchange(out, *this);
  if (out.close() && std::rename(part.c_str(), path.c_str()) == 0) return;
  std::remove(part.c_str());
  throw std::runtime_error(path + ": cannot be written");
}

PreparedRecord PreparedRecord::load(const std::string& path) {
  Reader in(path);
  std::uint64_t format = 0, digest = 0;
  in.number(format);
  if (format != kFormat) in.fail("is not a prepared record of this version");
  in.number(digest);
  PreparedRecord record;
  exchange(in, record);
  in.end();
  if (record.digest() != digest) in.fail("is damaged");
  return record;
}

}  // namespace allan_lio
