// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "firmware/linux/map_file.hpp"
#include "toolchain/mesh/convex_hull.hpp"

// Pieces as the tables that are flown.

namespace jink::mesh {

/// Size of a map's tables in flash.
[[nodiscard]] std::size_t bytes_of(const geometry::MeshMap& map);

/// The tables of a map of these pieces: their numbers rounded, and the tree laid over them. Boxes are halved at the
/// median along their longest side. The map's slack is what rounding may have taken off, and kFlat of the largest
/// coordinate.
/// @throws CannotBuild when there are none or more than geometry::kMaxMeshPieces, or one exceeds a map's limits
[[nodiscard]] files::MapTables stored_map(std::string name, const std::vector<Piece>& pieces,
                                          const geometry::MapOrigin& origin = {});

}  // namespace jink::mesh
