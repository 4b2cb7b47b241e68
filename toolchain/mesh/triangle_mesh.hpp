// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

// Surfaces as they come from files.

namespace jink::mesh {

using Vec3d = Eigen::Vector3d;

/// Why no map is made of a mesh, in words for the user.
struct CannotBuild : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// World frame, metres, z up. Triangles have their vertices counter-clockwise, seen from outside.
struct TriangleMesh {
    std::vector<Vec3d> vertices;  ///< no two alike
    std::vector<std::array<std::size_t, 3>> triangles;

    [[nodiscard]] std::array<Vec3d, 3> corners(std::size_t triangle) const
    {
        const auto& t = triangles[triangle];
        return {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    }
};

/// How the file's numbers become metres, z up.
struct ReadOptions {
    double scale = 1.0;  ///< metres in one unit of the file
    bool y_up = false;   ///< the file's y is up, its z points backwards (usual in OBJ files)
};

/// Reads an STL or OBJ file. Vertices at the same place become one, so that triangles know their neighbours; triangles
/// without area are kept: what is there may be met.
/// @throws CannotBuild when the file is missing, is no mesh, has no triangle, or a coordinate is not finite or beyond
///         1000 m
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& file, const ReadOptions& options);

/// Triangles that hang together by common vertices, in the order of the first triangle of each.
[[nodiscard]] std::vector<std::vector<std::size_t>> objects_of(const TriangleMesh& mesh);

/// Edges of the triangles that do not have exactly one neighbour, which passes them the other way. None: the surface is
/// closed, and has an inside.
[[nodiscard]] std::size_t open_edges(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles);

}  // namespace jink::mesh
