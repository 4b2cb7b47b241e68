// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

// Triangle surfaces from files.

namespace jink::mesh {

using Vec3d = Eigen::Vector3d;

/// Why no map can be built of a mesh, in words for the user.
struct CannotBuild : std::runtime_error {
    using std::runtime_error::runtime_error;
    CannotBuild(std::size_t in_line, std::size_t in_column, const std::string& why)
        : std::runtime_error(why), line(in_line), column(in_column)
    {
    }

    std::size_t line = 0;    ///< of the file, from 1; 0: the file as a whole
    std::size_t column = 0;  ///< from 1
};

/// World frame, metres, z up. Triangles have their vertices counter-clockwise, seen from outside.
struct TriangleMesh {
    std::vector<Vec3d> vertices;  ///< all different
    std::vector<std::array<std::size_t, 3>> triangles;

    [[nodiscard]] std::array<Vec3d, 3> corners(std::size_t triangle) const
    {
        const auto& t = triangles[triangle];
        return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    }
};

/// Conversion of the file's coordinates to metres, z up.
struct ReadOptions {
    double scale = 1.0;  ///< metres per unit of the file
    bool y_up = false;   ///< the file's y is up, its z points backwards (usual in OBJ files)
};

/// Reads an STL or OBJ file, as its name ends in .stl or .obj. Vertices at the same place are merged, so that triangles
/// know their neighbours. Triangles without area are kept as obstacles.
/// @throws CannotBuild when the file is missing, is not a mesh, has a line that is not understood (mesh_lines.hpp) or
///         no triangle, or a coordinate is not finite or beyond 1000 m
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& file, const ReadOptions& options);

/// Sets of triangles connected by common vertices, in the order of each set's first triangle.
[[nodiscard]] std::vector<std::vector<std::size_t>> objects_of(const TriangleMesh& mesh);

/// Number of triangle edges without exactly one neighbour in the opposite direction. 0: the surface is closed, and has
/// an inside.
[[nodiscard]] std::size_t open_edges(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles);

}  // namespace jink::mesh
