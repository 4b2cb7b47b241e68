// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <tuple>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "core/geometry/mesh_map.hpp"
#include "firmware/linux/complaint.hpp"
#include "toolchain/mesh/mesh_lines.hpp"

namespace jink::mesh {
namespace {

/// Adds each place once.
class Weld {
public:
    explicit Weld(TriangleMesh& mesh) : mesh_(mesh) {}

    std::size_t index_of(const Vec3d& v)
    {
        // Minus zero is the same place as zero.
        const auto [at, is_new] = known_.try_emplace({v.x() + 0.0, v.y() + 0.0, v.z() + 0.0}, mesh_.vertices.size());
        if (is_new) {
            mesh_.vertices.push_back(v);
        }
        return at->second;
    }

private:
    TriangleMesh& mesh_;
    std::map<std::tuple<double, double, double>, std::size_t> known_;
};

Vec3d in_metres(const aiVector3D& v, const ReadOptions& options)
{
    const Vec3d raw(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
    return options.scale * (options.y_up ? Vec3d(raw.x(), -raw.z(), raw.y()) : raw);
}

void check_place(const Vec3d& v)
{
    if (!v.allFinite()) {
        throw CannotBuild("a coordinate is not a finite number");
    }
    const auto limit = static_cast<double>(geometry::kMaxMeshCoordinate);
    if (v.cwiseAbs().maxCoeff() > limit) {
        throw CannotBuild("a coordinate of " + std::to_string(v.cwiseAbs().maxCoeff()) +
                          " m is beyond 1000 m from the map's origin; is --scale right?");
    }
}

void append(const aiMesh& part, const ReadOptions& options, Weld& weld, TriangleMesh& out)
{
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
        const aiFace& face = part.mFaces[f];
        if (face.mNumIndices != 3) {
            continue;  // points and lines
        }
        std::array<std::size_t, 3> triangle{};
        for (unsigned i = 0; i < 3; ++i) {
            const Vec3d v = in_metres(part.mVertices[face.mIndices[i]], options);
            check_place(v);
            triangle[i] = weld.index_of(v);
        }
        out.triangles.push_back(triangle);
    }
}

/// Refuses what Assimp would pass over.
void check_lines(const std::filesystem::path& file)
{
    std::string kind = file.extension().string();
    std::transform(kind.begin(), kind.end(), kind.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (kind != ".obj" && kind != ".stl") {
        throw CannotBuild("its name ends in neither .obj nor .stl");
    }
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in) {
        throw CannotBuild("cannot be read");
    }
    if (kind == ".obj") {
        check_obj(text);
    } else if (!is_binary_stl(text)) {
        check_ascii_stl(text);
    }
}

using Edge = std::pair<std::size_t, std::size_t>;

Edge sorted(std::size_t a, std::size_t b) { return a < b ? Edge{a, b} : Edge{b, a}; }

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& file, const ReadOptions& options)
{
    if (!(std::isfinite(options.scale) && options.scale > 0.0)) {
        throw CannotBuild("a scale has to be above 0");
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        throw CannotBuild("no such file");
    }
    check_lines(file);
    Assimp::Importer importer;
    // Applies node transformations; keeps everything else unchanged, including triangles without area.
    const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
    if (scene == nullptr) {
        throw CannotBuild("cannot be read: " + files::printable(importer.GetErrorString()));
    }
    TriangleMesh out;
    Weld weld(out);
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
        append(*scene->mMeshes[i], options, weld, out);
    }
    if (out.triangles.empty()) {
        throw CannotBuild("holds no triangle");
    }
    return out;
}

std::vector<std::vector<std::size_t>> objects_of(const TriangleMesh& mesh)
{
    // Union of triangles that share a vertex: parts joined in a single point would otherwise lose the common corner.
    std::vector<std::size_t> leader(mesh.vertices.size());
    std::iota(leader.begin(), leader.end(), std::size_t{0});
    const auto find = [&](std::size_t v) {
        while (leader[v] != v) {
            leader[v] = leader[leader[v]];
            v = leader[v];
        }
        return v;
    };
    for (const auto& t : mesh.triangles) {
        leader[find(t[1])] = find(t[0]);
        leader[find(t[2])] = find(t[0]);
    }
    std::map<std::size_t, std::size_t> place;
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [at, is_new] = place.try_emplace(find(mesh.triangles[i][0]), out.size());
        if (is_new) {
            out.emplace_back();
        }
        out[at->second].push_back(i);
    }
    return out;
}

std::size_t open_edges(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles)
{
    std::map<Edge, std::pair<int, int>> uses;  // number of traversals in either direction
    for (const std::size_t triangle : triangles) {
        const auto& t = mesh.triangles[triangle];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t a = t[i];
            const std::size_t b = t[(i + 1) % 3];
            auto& use = uses[sorted(a, b)];
            (a < b ? use.first : use.second) += 1;
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, use] : uses) {
        open += use.first == 1 && use.second == 1 ? 0 : 1;
    }
    return open;
}

}  // namespace jink::mesh
