// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "toolchain/mesh/triangle_mesh.hpp"

// Meshes for tests, and as the text of an OBJ or STL file.

namespace jink::test {

using mesh::TriangleMesh;
using mesh::Vec3d;

/// A polygon in the level plane, counter-clockwise, from `low` to `high`; `caps` are its triangles.
inline TriangleMesh prism(const std::vector<std::array<double, 2>>& outline,
                          const std::vector<std::array<std::size_t, 3>>& caps, double low, double high)
{
    TriangleMesh out;
    const std::size_t n = outline.size();
    for (const double z : {low, high}) {
        for (const auto& p : outline) {
            out.vertices.emplace_back(p[0], p[1], z);
        }
    }
    for (const auto& c : caps) {
        out.triangles.push_back({c[0], c[2], c[1]});
        out.triangles.push_back({c[0] + n, c[1] + n, c[2] + n});
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (i + 1) % n;
        out.triangles.push_back({i, j, j + n});
        out.triangles.push_back({i, j + n, i + n});
    }
    return out;
}

inline TriangleMesh box(double x, double y, double z)
{
    return prism({{0, 0}, {x, 0}, {x, y}, {0, y}}, {{0, 1, 2}, {0, 2, 3}}, 0, z);
}

/// Two bars of 4 m by 1 m at a right angle.
inline TriangleMesh corner()
{
    return prism({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}, 0, 1);
}

/// Three bars about a gap 2 m wide and 3 m deep.
inline TriangleMesh gate()
{
    return prism({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {1, 1}, {1, 4}, {0, 4}},
                 {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}, {0, 5, 6}, {0, 6, 7}}, 0, 2);
}

/// A sphere of radius 1 with `rings` rings of twice as many vertices.
inline TriangleMesh sphere(std::size_t rings)
{
    TriangleMesh out;
    const std::size_t around = 2 * rings;
    out.vertices.emplace_back(0, 0, -1);
    for (std::size_t i = 1; i <= rings; ++i) {
        const double polar = M_PI * double(i) / double(rings + 1);
        for (std::size_t j = 0; j < around; ++j) {
            const double angle = 2.0 * M_PI * double(j) / double(around);
            out.vertices.emplace_back(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                                      -std::cos(polar));
        }
    }
    const std::size_t top = out.vertices.size();
    out.vertices.emplace_back(0, 0, 1);
    const auto at = [&](std::size_t ring, std::size_t j) { return 1 + ring * around + j % around; };
    for (std::size_t j = 0; j < around; ++j) {
        out.triangles.push_back({0, at(0, j + 1), at(0, j)});
        out.triangles.push_back({top, at(rings - 1, j), at(rings - 1, j + 1)});
        for (std::size_t i = 0; i + 1 < rings; ++i) {
            out.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
            out.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
        }
    }
    return out;
}

inline TriangleMesh moved(TriangleMesh mesh, const Vec3d& by)
{
    for (Vec3d& v : mesh.vertices) {
        v += by;
    }
    return mesh;
}

inline TriangleMesh both(TriangleMesh a, const TriangleMesh& b)
{
    for (const auto& t : b.triangles) {
        const std::size_t n = a.vertices.size();
        a.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    }
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    return a;
}

inline std::string as_obj(const TriangleMesh& mesh)
{
    std::string out;
    for (const Vec3d& v : mesh.vertices) {
        out += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
    }
    for (const auto& t : mesh.triangles) {
        out += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
    }
    return out;
}

inline std::string as_stl(const TriangleMesh& mesh)
{
    std::string out = "solid test\n";
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        out += " facet normal 0 0 0\n  outer loop\n";
        for (const Vec3d& v : mesh.corners(i)) {
            out +=
                "   vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
        }
        out += "  endloop\n endfacet\n";
    }
    return out + "endsolid test\n";
}

}  // namespace jink::test
