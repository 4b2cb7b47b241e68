// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/geometry/mesh_map.hpp"
#include "toolchain/mesh/decompose.hpp"

// Maps as text: tables for the user, a C++ header for the co-processor, JSON for the drawing script.

namespace jink::host {

/// A header with the map as constant tables, `k<Name>Map` in jink::geometry; `source`: the mesh's file.
[[nodiscard]] std::string map_header(const geometry::MeshMap& map, const std::string& source);

/// The contents of a map, one item per line.
[[nodiscard]] std::string summary_of(const geometry::MeshMap& map);

/// A map built with one recipe, for comparison.
struct MeasuredMap {
    std::string name;
    files::MapTables map;
    double excess = 0.0;  ///< greatest distance of a piece's surface from the mesh [m]
    double gap = 0.0;     ///< and of the mesh's surface from the pieces
};
/// Name, pieces, vertices, bytes, excess, gap, one line each.
[[nodiscard]] std::string table_of(const std::vector<MeasuredMap>& maps);
/// For mesh_maps.py.
[[nodiscard]] std::string drawing_of(const std::vector<MeasuredMap>& maps, const mesh::TriangleMesh& mesh);

}  // namespace jink::host
