// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/decompose.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>

#include <bullet/HACD/hacdHACD.h>

#include "core/geometry/mesh_map.hpp"

namespace jink::mesh {
namespace {

using Cluster = std::vector<std::size_t>;

constexpr std::size_t kMaxTriangles = 50'000;
/// HACD measures concavity in thousandths of an object's diagonal.
constexpr double kHacdUnits = 1000.0;

std::vector<Vec3d> points_of(const TriangleMesh& mesh, const Cluster& cluster)
{
    std::set<std::size_t> indices;
    for (const std::size_t triangle : cluster) {
        indices.insert(mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
    }
    std::vector<Vec3d> out;
    for (const std::size_t index : indices) {
        out.push_back(mesh.vertices[index]);
    }
    return out;
}

TriangleMesh part_of(const TriangleMesh& mesh, const Cluster& cluster)
{
    TriangleMesh out;
    out.vertices = mesh.vertices;
    for (const std::size_t triangle : cluster) {
        out.triangles.push_back(mesh.triangles[triangle]);
    }
    return out;
}

double size_of(const std::vector<Vec3d>& points)
{
    Vec3d low = points[0];
    Vec3d high = points[0];
    for (const Vec3d& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

/// HACD's clusters of one object's triangles; a single cluster where HACD finds none.
std::vector<Cluster> clusters_of(const TriangleMesh& mesh, const Cluster& object, double concavity)
{
    std::map<std::size_t, long> places;
    std::vector<HACD::Vec3<HACD::Real>> points;
    std::vector<HACD::Vec3<long>> triangles;
    for (const std::size_t triangle : object) {
        std::array<long, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t index = mesh.triangles[triangle][i];
            const auto [at, is_new] = places.try_emplace(index, static_cast<long>(points.size()));
            if (is_new) {
                const Vec3d& v = mesh.vertices[index];
                points.emplace_back(v.x(), v.y(), v.z());
            }
            corners[i] = at->second;
        }
        triangles.emplace_back(corners[0], corners[1], corners[2]);
    }
    HACD::HACD hacd;
    hacd.SetPoints(points.data());
    hacd.SetNPoints(points.size());
    hacd.SetTriangles(triangles.data());
    hacd.SetNTriangles(triangles.size());
    hacd.SetCompacityWeight(0.1);
    hacd.SetVolumeWeight(0.0);
    hacd.SetNClusters(1);
    hacd.SetNVerticesPerCH(geometry::kMaxPieceVertices);
    hacd.SetConcavity(kHacdUnits * concavity / size_of(points_of(mesh, object)));
    hacd.SetAddExtraDistPoints(true);
    hacd.SetAddFacesPoints(true);
    hacd.SetConnectDist(0.0);
    if (!hacd.Compute() || hacd.GetNClusters() == 0) {
        return {object};
    }
    std::map<long, Cluster> parts;
    for (std::size_t i = 0; i < object.size(); ++i) {
        parts[hacd.GetPartition()[i]].push_back(object[i]);
    }
    std::vector<Cluster> out;
    for (auto& [number, cluster] : parts) {
        out.push_back(std::move(cluster));
    }
    return out;
}

/// Two halves, divided across the longest side of the cluster's box.
std::array<Cluster, 2> halves_of(const TriangleMesh& mesh, Cluster cluster)
{
    const auto centre = [&](std::size_t t) -> Vec3d {
        const auto c = mesh.corners(t);
        return c[0] + c[1] + c[2];
    };
    Vec3d low = centre(cluster[0]);
    Vec3d high = low;
    for (const std::size_t t : cluster) {
        low = low.cwiseMin(centre(t));
        high = high.cwiseMax(centre(t));
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    std::sort(cluster.begin(), cluster.end(), [&](std::size_t a, std::size_t b) {
        const double x = centre(a)[axis];
        const double y = centre(b)[axis];
        return x != y ? x < y : a < b;
    });
    const auto middle = cluster.begin() + static_cast<std::ptrdiff_t>(cluster.size() / 2);
    return {Cluster(cluster.begin(), middle), Cluster(middle, cluster.end())};
}

void add(std::vector<Piece>& pieces, Piece piece)
{
    pieces.push_back(std::move(piece));
    if (pieces.size() > geometry::kMaxMeshPieces) {
        throw CannotBuild("more pieces than a map may have, " + std::to_string(geometry::kMaxMeshPieces) +
                          "; allow a larger concavity");
    }
}

/// Adds the cluster's hull, or the hulls of its repeated halves: no excess above `most`, except for single triangles.
void add_divided(const TriangleMesh& mesh, const Solid& solid, const Cluster& whole, double most,
                 std::vector<Piece>& pieces)
{
    std::vector<Cluster> waiting{whole};
    while (!waiting.empty()) {
        const Cluster cluster = std::move(waiting.back());
        waiting.pop_back();
        const std::vector<Vec3d> points = points_of(mesh, cluster);
        std::optional<Piece> piece = piece_around(points);
        if (piece && cluster.size() > 1) {
            const double tolerance = std::max(std::min(0.1 * most, 0.005 * size_of(points)), 1e-6);
            piece->excess = excess_of(*piece, solid, tolerance);
        }
        if (piece && (cluster.size() == 1 || piece->excess <= most)) {
            add(pieces, std::move(*piece));
            continue;
        }
        for (Cluster& half : halves_of(mesh, cluster)) {
            waiting.push_back(std::move(half));
        }
    }
}

std::vector<Piece> soup_of(const TriangleMesh& mesh)
{
    std::vector<Piece> pieces;
    for (const auto& t : mesh.triangles) {
        add(pieces, Piece{{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, {}, {{0, 1, 2}}, 0.0});
    }
    return pieces;
}

}  // namespace

std::vector<Piece> pieces_of(const TriangleMesh& mesh, const Recipe& recipe)
{
    if (recipe.method == Method::soup) {
        return soup_of(mesh);
    }
    if (!(recipe.concavity > 0.0)) {
        throw CannotBuild("a concavity has to be above 0");
    }
    if (mesh.triangles.size() > kMaxTriangles) {
        throw CannotBuild(std::to_string(mesh.triangles.size()) + " triangles are more than the " +
                          std::to_string(kMaxTriangles) + " that are decomposed");
    }
    std::vector<Piece> pieces;
    for (const Cluster& object : objects_of(mesh)) {
        if (const std::size_t open = open_edges(mesh, object); open > 0 && !recipe.open) {
            throw CannotBuild("an object is not closed: " + std::to_string(open) +
                              " edges without exactly one neighbour, passed the other way; mend the mesh, take --open, "
                              "or --method soup");
        }
        // Excess beyond the piece's own object: an upper bound on the excess beyond the whole mesh.
        const TriangleMesh alone = part_of(mesh, object);
        const Solid solid(alone);
        if (recipe.method == Method::hull) {
            add_divided(mesh, solid, object, std::numeric_limits<double>::infinity(), pieces);
            continue;
        }
        for (const Cluster& cluster : clusters_of(mesh, object, recipe.concavity)) {
            add_divided(mesh, solid, cluster, recipe.concavity, pieces);
        }
    }
    return pieces;
}

}  // namespace jink::mesh
