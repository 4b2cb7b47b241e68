// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/mesh_map.hpp"
#include "firmware/linux/complaint.hpp"

// Map files, which `jink mesh build` makes: the tables of a geometry::MeshMap, number by number, low byte first,
// whatever the machine.

namespace jink::files {

/// The tables of a map, owned.
struct MapTables {
    std::string name;
    std::uint16_t version = geometry::kMeshVersion;
    float metres_per_unit = 1.0F;
    float slack = 0.0F;
    geometry::MapOrigin origin;
    Point3 low;
    Point3 high;
    std::vector<geometry::MeshPiece> pieces;
    std::vector<Point3> vertices;
    std::vector<geometry::MeshNode> nodes;
    std::uint32_t checksum = 0;

    /// A view of this, which outlives it.
    [[nodiscard]] geometry::MeshMap view() const;
};

/// The file: "JINKMAP" and a zero byte; version (2 bytes); length of the name (2) and the name; metres per unit, slack
/// (4 each, float); whether the origin is known (2), its latitude, longitude and altitude (4 each, integer); bounds (6
/// floats); counts of pieces, vertices and nodes (4 each); the tables in that order, each number as it is in the
/// structures of core/geometry/mesh_map.hpp; the checksum (4). Low byte first.
[[nodiscard]] std::string map_file_of(const geometry::MeshMap& map);

/// Larger files are refused before they are read [bytes]; the largest map takes 1.9 MiB.
inline constexpr std::size_t kMaxMapFile = 4U << 20U;

/// Nothing, and a complaint in a line, where the text is no such file or not a good map (geometry::check). `file` is
/// what the complaint calls it.
[[nodiscard]] std::optional<MapTables> parse_map(std::string_view text, const std::string& file,
                                                 Complaints& complaints);
/// The same of a file.
[[nodiscard]] std::optional<MapTables> read_map_file(const std::filesystem::path& path, Complaints& complaints);

/// In words for the user.
[[nodiscard]] const char* to_string(geometry::MapStatus status);

}  // namespace jink::files
