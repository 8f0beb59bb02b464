// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/pcd.h"

#include <fstream>
#include <stdexcept>

namespace allan_lio {

void write_pcd(const std::string& path, const std::vector<WorldPoint>& points) {
  static_assert(sizeof(WorldPoint) == 4 * sizeof(float), "a WorldPoint is written as it lies in memory");
  std::ofstream file(path, std::ios::binary);
  file << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\n"
       << "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " << points.size() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
       << points.size() << "\nDATA binary\n";
  file.write(reinterpret_cast<const char*>(points.data()),
             static_cast<std::streamsize>(points.size() * sizeof(WorldPoint)));
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path);
}

}  // namespace allan_lio
