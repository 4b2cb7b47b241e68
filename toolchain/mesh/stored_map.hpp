// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/mesh_map.hpp"
#include "toolchain/mesh/convex_hull.hpp"

// A map as flight tables, and as a file.

namespace jink::mesh {

/// Size of a map's tables in flash.
[[nodiscard]] std::size_t bytes_of(const geometry::MeshMap& map);

/// The tables, owned.
class StoredMap {
public:
    /// Rounds the pieces' numbers and builds the tree: boxes are halved at the median along their longest side. The
    /// map's slack covers the rounding, and kFlat of the largest coordinate.
    /// @throws CannotBuild when there are no pieces or more than geometry::kMaxMeshPieces, or a piece exceeds a map's
    /// limits
    StoredMap(std::string name, const std::vector<Piece>& pieces);

    /// A view of this map, which must outlive the view.
    [[nodiscard]] geometry::MeshMap view() const;

    /// The file: "JINKMAP" and a zero byte; version (2 bytes); length of the name (2) and the name; metres per unit,
    /// slack, bounds (8 floats); counts of pieces, vertices, faces and nodes (4 each); the tables in that order, each
    /// number as in the structures of core/geometry/mesh_map.hpp; the checksum (4). Little-endian.
    [[nodiscard]] std::string file() const;
    /// @throws CannotBuild when the text is not a map file or the map is invalid
    [[nodiscard]] static StoredMap from_file(const std::string& text);

private:
    StoredMap() = default;

    std::string name_;
    std::uint16_t version_ = geometry::kMeshVersion;
    float metres_per_unit_ = 1.0F;
    float slack_ = 0.0F;
    Point3 low_;
    Point3 high_;
    std::vector<geometry::MeshPiece> pieces_;
    std::vector<Point3> vertices_;
    std::vector<geometry::FacePlane> faces_;
    std::vector<geometry::MeshNode> nodes_;
    std::uint32_t checksum_ = 0;

    void round(const Piece& piece);
    void split(std::vector<std::uint16_t>& order, std::size_t first, std::size_t last);
};

/// In words for the user.
[[nodiscard]] const char* to_string(geometry::MapStatus status);

}  // namespace jink::mesh
