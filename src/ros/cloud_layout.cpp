// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/cloud_layout.h"

#include <array>

namespace allan_lio {
namespace {

constexpr std::array<std::size_t, 11> kNumberSize{0, 1, 1, 2, 2, 4, 4, 4, 8, 8, 8};

std::string field_names(const sensor_msgs::PointCloud2& cloud) {
  std::string names;
  for (const auto& field : cloud.fields) names += (names.empty() ? "" : ", ") + field.name;
  return names.empty() ? "none" : names;
}

/// The field if it is there and lies inside a point. `error` is set when it is there and does not.
std::optional<CloudField> find_field(const sensor_msgs::PointCloud2& cloud, const std::string& name,
                                     std::string& error) {
  for (const auto& field : cloud.fields) {
    if (field.name != name) continue;
    if (field.datatype == 0 || field.datatype >= kNumberSize.size()) {
      error = "field '" + name + "' has the unknown data type " + std::to_string(field.datatype);
      return std::nullopt;
    }
    const std::uint64_t end = std::uint64_t{field.offset} + kNumberSize[field.datatype];
    if (end > cloud.point_step) {
      error = "field '" + name + "' ends at byte " + std::to_string(end) + " of a point of " +
              std::to_string(cloud.point_step) + " bytes";
      return std::nullopt;
    }
    return CloudField{name, static_cast<NumberType>(field.datatype), field.offset};
  }
  return std::nullopt;
}

bool read_sizes(const CloudView& view, CloudLayout& layout, std::string& error) {
  const sensor_msgs::PointCloud2& cloud = view.head;
  const std::uint64_t row_bytes = std::uint64_t{cloud.width} * cloud.point_step;
  const std::uint64_t row_step = cloud.height == 1 ? row_bytes : cloud.row_step;
  // Each factor is below 2^32 and row_step is checked first, so none of this overflows 64 bits.
  const bool fits = cloud.point_step > 0 && row_bytes <= view.size && row_step >= row_bytes &&
                    row_step * (cloud.height - 1ULL) + row_bytes <= view.size;
  if (!fits) {
    error = "the cloud's header does not match its " + std::to_string(view.size) + " bytes: width " +
            std::to_string(cloud.width) + ", height " + std::to_string(cloud.height) + ", point_step " +
            std::to_string(cloud.point_step) + ", row_step " + std::to_string(cloud.row_step);
    return false;
  }
  layout.data = view.data;
  layout.rows = cloud.height;
  layout.columns = cloud.width;
  layout.point_step = cloud.point_step;
  layout.row_step = static_cast<std::size_t>(row_step);
  return true;
}

bool read_position(const sensor_msgs::PointCloud2& cloud, CloudLayout& layout, std::string& error) {
  const auto read = [&](const char* name, CloudField& to) {
    const std::optional<CloudField> field = find_field(cloud, name, error);
    if (!field) {
      if (error.empty())
        error = "the cloud has no field '" + std::string(name) + "' (fields: " + field_names(cloud) + ")";
      return false;
    }
    to = *field;
    if (to.type == NumberType::kFloat32 || to.type == NumberType::kFloat64) return true;
    error = "field '" + to.name + "' is " + number_type_name(to.type) + "; float32 or float64 is read";
    return false;
  };
  if (!read("x", layout.x) || !read("y", layout.y) || !read("z", layout.z)) return false;
  if (layout.x.type == layout.y.type && layout.x.type == layout.z.type) return true;
  error = "fields x, y, z are of different types";
  return false;
}

}  // namespace

std::optional<CloudLayout> read_layout(const CloudView& view, const std::string& time_field, std::string& error) {
  const sensor_msgs::PointCloud2& cloud = view.head;
  error.clear();
  CloudLayout layout;
  if (cloud.width == 0 || cloud.height == 0) return layout;
  if (cloud.is_bigendian) {
    error = "the cloud is big-endian; only little-endian clouds are read";
    return std::nullopt;
  }
  if (!read_sizes(view, layout, error) || !read_position(cloud, layout, error)) return std::nullopt;
  layout.intensity = find_field(cloud, "intensity", error);
  layout.tag = find_field(cloud, "tag", error);
  // Only Livox's tag is one byte; others' fields of that name mean something else.
  if (layout.tag && layout.tag->type != NumberType::kUint8) layout.tag.reset();
  for (const auto& field : cloud.fields) {
    const bool wanted = time_field.empty() ? is_point_time_name(field.name) : field.name == time_field;
    if (wanted && error.empty()) layout.time = find_field(cloud, field.name, error);
    if (layout.time) break;
  }
  if (!error.empty()) return std::nullopt;
  return layout;
}

}  // namespace allan_lio
