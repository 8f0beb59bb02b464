// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/sim/mesh.h"

namespace allan_lio {

/// Reads the triangles of an STL (binary or ASCII), OBJ or PLY (ASCII or binary little endian) file, told apart by the
/// name's end; lengths are taken as metres, polygons are cut into fans, normals, colours and textures are left aside,
/// triangles without an area are dropped. Counts that a file claims allocate nothing before the data are there.
/// Throws std::runtime_error naming the file and the line, or the byte in a binary one.
TriangleMesh read_mesh(const std::string& path);

}  // namespace allan_lio
