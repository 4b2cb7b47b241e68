// SPDX-License-Identifier: BSD-3-Clause
// Maps of convex pieces: they contain their whole mesh, exceed it by at most the stated excess, and stay within the
// limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Geometry>

#include "core/geometry/hull_distance.hpp"
#include "tests/host/held_points.hpp"
#include "tests/host/mesh_shapes.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/mesh/decompose.hpp"

namespace jink::test {
namespace {

using namespace jink::mesh;

std::string refusal(const std::function<void()>& action)
{
    try {
        action();
    } catch (const CannotBuild& error) {
        return error.what();
    }
    return "";
}

TriangleMesh read(const std::string& name, const std::string& text, const ReadOptions& options = {})
{
    const Scratch scratch;
    return read_mesh(scratch.write(name, text), options);
}

bool is_held(const geometry::MeshMap& map, const Vec3d& point, double room) { return Held(map).holds(point, room); }

/// Random points of every triangle, its corners and its edges among them.
void expect_all_held(const TriangleMesh& mesh, const geometry::MeshMap& map, int samples)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double room = double(map.slack) + 2e-6 * mesh.vertices[0].cwiseAbs().maxCoeff() + 1e-6;
    const Held held(map);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        for (int n = 0; n < samples; ++n) {
            double a = n < 3 ? double(n == 1) : uniform(random);
            double b = n < 3 ? double(n == 2) : n % 4 == 0 ? 0.0 : uniform(random);
            if (a + b > 1) {
                a = 1 - a;
                b = 1 - b;
            }
            const Vec3d point = c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]);
            ASSERT_TRUE(held.holds(point, room)) << "triangle " << t << " sample " << n;
        }
    }
}

double most_excess(const std::vector<Piece>& pieces)
{
    double most = 0;
    for (const Piece& piece : pieces) {
        most = std::max(most, piece.excess);
    }
    return most;
}

struct Named {
    const char* name;
    TriangleMesh mesh;
};

std::vector<Named> shapes()
{
    TriangleMesh turned = corner();
    const Eigen::Matrix3d by = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
    for (Vec3d& v : turned.vertices) {
        v = by * v + Vec3d(300.1, -200.7, 55.3);
    }
    return {{"box", box(1, 2, 3)}, {"corner", corner()},       {"gate", gate()},
            {"sphere", sphere(6)}, {"turned and far", turned}, {"two", both(sphere(5), moved(gate(), {5, 0, 0}))}};
}

TEST(MeshPieces, EveryPointOfTheMeshLiesInAPieceWhateverTheMethod)
{
    for (const Named& shape : shapes()) {
        for (const Method method : {Method::hull, Method::decompose, Method::soup}) {
            SCOPED_TRACE(std::string(shape.name) + " method " + std::to_string(int(method)));
            Recipe recipe;
            recipe.method = method;
            recipe.concavity = 0.3;
            const files::MapTables stored = stored_map("test", pieces_of(shape.mesh, recipe));
            const geometry::MeshMap map = stored.view();
            ASSERT_EQ(geometry::check(map), geometry::MapStatus::good);
            ASSERT_LE(map.slack, 1e-4F);
            expect_all_held(shape.mesh, map, 30);
            EXPECT_LE(gap_of(shape.mesh, map, 0.5), 1e-4);
        }
    }
}

TEST(MeshPieces, HullsOfObjects)
{
    Recipe recipe;
    recipe.method = Method::hull;
    EXPECT_EQ(pieces_of(box(1, 2, 3), recipe).size(), 1U);
    EXPECT_LT(most_excess(pieces_of(box(1, 2, 3), recipe)), 0.02);
    EXPECT_EQ(pieces_of(both(box(1, 1, 1), moved(box(1, 1, 1), {3, 0, 0})), recipe).size(), 2U);
    // The hull closes the gate: its surface across the gap is 1 m from the posts.
    const std::vector<Piece> closed = pieces_of(gate(), recipe);
    EXPECT_EQ(closed.size(), 1U);
    EXPECT_NEAR(most_excess(closed), 1.0, 0.03);
}

TEST(MeshPieces, DecompositionKeepsToTheConcavityAndLeavesTheGateOpen)
{
    for (const double concavity : {0.05, 0.2, 0.6}) {
        Recipe recipe;
        recipe.concavity = concavity;
        const std::vector<Piece> pieces = pieces_of(gate(), recipe);
        EXPECT_LE(most_excess(pieces), concavity);
        EXPECT_GE(pieces.size(), 2U);
        const files::MapTables stored = stored_map("gate", pieces);
        EXPECT_FALSE(is_held(stored.view(), {2.0, 3.0, 1.0}, 0.0)) << "the middle of the passage";
    }
}

TEST(MeshPieces, ASoupIsExact)
{
    Recipe recipe;
    recipe.method = Method::soup;
    const std::vector<Piece> pieces = pieces_of(gate(), recipe);
    EXPECT_EQ(pieces.size(), gate().triangles.size());
    EXPECT_EQ(most_excess(pieces), 0.0);
}

/// 182 vertices exceed a piece's limit: the piece grows outwards, never inwards, and states its excess.
TEST(MeshPieces, ARoundHullIsSimplifiedOutwards)
{
    const TriangleMesh mesh = sphere(9);
    Recipe recipe;
    recipe.method = Method::hull;
    const std::vector<Piece> pieces = pieces_of(mesh, recipe);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_LE(pieces[0].vertices.size(), geometry::kMaxPieceVertices);
    double farthest = 0;
    for (const auto& plane : pieces[0].planes) {
        for (const Vec3d& v : mesh.vertices) {
            ASSERT_LE(plane.first.dot(v), plane.second + 1e-9);
        }
    }
    for (const Vec3d& v : pieces[0].vertices) {
        farthest = std::max(farthest, v.norm() - 1.0);
    }
    EXPECT_GE(pieces[0].excess, farthest - 0.02);
    EXPECT_LT(pieces[0].excess, 0.35);
}

TEST(MeshPieces, ExcessIsNotBelowThatOfRandomPointsOfThePiece)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const Named& shape : shapes()) {
        Recipe recipe;
        recipe.method = Method::hull;
        const Solid solid(shape.mesh);
        ASSERT_TRUE(solid.is_closed()) << shape.name;
        for (const Piece& piece : pieces_of(shape.mesh, recipe)) {
            double most = 0;
            for (int n = 0; n < 3000; ++n) {
                const auto& t = piece.surface[random() % piece.surface.size()];
                double a = uniform(random);
                double b = uniform(random);
                if (a + b > 1) {
                    a = 1 - a;
                    b = 1 - b;
                }
                const Vec3d p = piece.vertices[t[0]] + a * (piece.vertices[t[1]] - piece.vertices[t[0]]) +
                                b * (piece.vertices[t[2]] - piece.vertices[t[0]]);
                // The nearest of many points of the mesh: an upper bound that is good to their spacing.
                most = std::max(most, solid.holds(p) ? 0.0 : solid.nearest_on_surface(p).distance);
            }
            EXPECT_GE(piece.excess + 1e-6, most - 0.03) << shape.name;
            EXPECT_LE(piece.excess, most + 0.1) << shape.name;
        }
    }
}

TEST(Solid, DistanceIsThatOfTheNearestOfManyPoints)
{
    const TriangleMesh mesh = gate();
    const Solid solid(mesh);
    std::vector<Vec3d> points;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto c = mesh.corners(t);
        for (int i = 0; i <= 40; ++i) {
            for (int j = 0; i + j <= 40; ++j) {
                points.push_back(c[0] + i / 40.0 * (c[1] - c[0]) + j / 40.0 * (c[2] - c[0]));
            }
        }
    }
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1.0, 5.0);
    for (int n = 0; n < 200; ++n) {
        const Vec3d p(uniform(random), uniform(random), uniform(random));
        double least = 1e300;
        for (const Vec3d& point : points) {
            least = std::min(least, (p - point).norm());
        }
        EXPECT_LE(solid.nearest_on_surface(p).distance, least + 1e-12);
        EXPECT_GE(solid.nearest_on_surface(p).distance, least - 0.1);
        const bool in_bars = p.z() > 0 && p.z() < 2 && p.y() > 0 && p.y() < 4 && p.x() > 0 && p.x() < 4 &&
                             !(p.y() > 1 && p.x() > 1 && p.x() < 3);
        EXPECT_EQ(solid.holds(p), in_bars) << n;
    }
}

/// Of a text that is no good map: why.
std::string complaint_of(const std::string& text)
{
    files::Complaints complaints;
    const bool good = files::parse_map(text, "x.map", complaints).has_value();
    EXPECT_EQ(complaints.size(), good ? 0U : 1U);
    return good ? "" : files::to_string(complaints.front());
}

TEST(MeshFile, AMapIsReadAsItWasWritten)
{
    const geometry::MapOrigin origin{true, 481'234'567, -1'123'456'789, -250'500};
    const files::MapTables stored = stored_map("gate", pieces_of(gate(), Recipe{}), origin);
    const std::string text = files::map_file_of(stored.view());
    files::Complaints complaints;
    const auto again = files::parse_map(text, "gate.map", complaints);
    ASSERT_TRUE(again);
    EXPECT_EQ(files::map_file_of(again->view()), text);
    EXPECT_EQ(again->view().name, "gate");
    EXPECT_TRUE(again->origin.known);
    EXPECT_EQ(again->origin.latitude, origin.latitude);
    EXPECT_EQ(again->origin.longitude, origin.longitude);
    EXPECT_EQ(again->origin.altitude, origin.altitude);
    EXPECT_EQ(again->view().checksum, geometry::checksum_of(again->view()));
    EXPECT_EQ(bytes_of(again->view()), bytes_of(stored.view()));
}

TEST(MeshFile, EveryChangedByteAndEveryCutIsNoticed)
{
    const std::string text = files::map_file_of(stored_map("box", pieces_of(box(1, 2, 3), Recipe{})).view());
    const std::size_t name = 12;  // the name is not in the checksum
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (i >= name && i < name + 3) {
            continue;
        }
        std::string damaged = text;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
        EXPECT_NE(complaint_of(damaged), "") << "byte " << i;
    }
    for (std::size_t length = 0; length < text.size(); ++length) {
        EXPECT_NE(complaint_of(text.substr(0, length)), "") << length;
    }
    EXPECT_NE(complaint_of(text + "x"), "");
}

TEST(MeshFile, WhatIsWrongIsSaid)
{
    const std::string text = files::map_file_of(stored_map("box", pieces_of(box(1, 2, 3), Recipe{})).view());
    EXPECT_EQ(complaint_of("solid box"), "x.map: not a map file: jink mesh build makes them");
    EXPECT_EQ(complaint_of(text.substr(0, 40)), "x.map: the file ends too early");
    EXPECT_EQ(complaint_of(text + "x"), "x.map: the file goes on after its end");
    std::string old = text;
    old[8] = 1;
    EXPECT_EQ(complaint_of(old), "x.map: version 1 of the file, where 2 is read: make it anew by jink mesh build");
    std::string damaged = text;
    damaged.back() = static_cast<char>(damaged.back() ^ 1);
    EXPECT_EQ(complaint_of(damaged), "x.map: wrong checksum");
}

TEST(ReadMesh, StlAndObjAreTheSameMesh)
{
    for (const TriangleMesh& mesh : {gate(), sphere(4)}) {
        const TriangleMesh obj = read("a.obj", as_obj(mesh));
        const TriangleMesh stl = read("a.stl", as_stl(mesh));
        EXPECT_EQ(obj.vertices.size(), mesh.vertices.size());
        EXPECT_EQ(stl.vertices.size(), mesh.vertices.size()) << "corners of several triangles become one";
        EXPECT_EQ(obj.triangles.size(), mesh.triangles.size());
        EXPECT_EQ(stl.triangles.size(), mesh.triangles.size());
        EXPECT_TRUE(Solid(obj).is_closed());
        EXPECT_TRUE(Solid(stl).is_closed());
    }
}

TEST(ReadMesh, ScaleAndUp)
{
    ReadOptions options;
    options.scale = 0.001;
    options.y_up = true;
    const TriangleMesh mesh = read("a.obj", as_obj(box(1000, 2000, 3000)), options);
    const Solid solid(mesh);
    EXPECT_TRUE(solid.holds({0.5, -1.5, 1.0})) << "3 m deep, 2 m high";
    EXPECT_FALSE(solid.holds({0.5, 1.5, 1.0}));
}

TEST(ReadMesh, RefusesWhatIsNoMesh)
{
    const auto why = [](const std::string& name, const std::string& text) {
        return refusal([&] { static_cast<void>(read(name, text)); });
    };
    EXPECT_EQ(refusal([] { static_cast<void>(read_mesh("/nonexistent/a.stl", {})); }), "no such file");
    EXPECT_NE(why("a.stl", "").find("'solid' is wanted"), std::string::npos);
    EXPECT_NE(why("a.obj", ""), "");
    EXPECT_NE(why("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
    EXPECT_NE(why("a.txt", "hello").find("neither .obj nor .stl"), std::string::npos);
    EXPECT_NE(why("a.stl", "solid x\nendsolid x\n"), "");
    EXPECT_NE(why("a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "");
    EXPECT_NE(why("a.obj", "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n"), "");
    EXPECT_NE(why("a.obj", as_obj(box(1001, 1, 1))).find("beyond 1000 m"), std::string::npos);
    EXPECT_NE(why("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "");
    ReadOptions options;
    options.scale = 0.0;
    EXPECT_NE(refusal([&] { static_cast<void>(read("a.obj", as_obj(box(1, 1, 1)), options)); }), "");
}

TEST(MeshPieces, AnOpenMeshIsRefusedWhereItMatters)
{
    TriangleMesh open = box(1, 1, 1);
    open.triangles.pop_back();
    for (const Method method : {Method::hull, Method::decompose}) {
        Recipe recipe;
        recipe.method = method;
        const std::string why = refusal([&] { static_cast<void>(pieces_of(open, recipe)); });
        EXPECT_NE(why.find("not closed: 3 edges"), std::string::npos) << why;
        recipe.open = true;
        expect_all_held(open, stored_map("open", pieces_of(open, recipe)).view(), 20);
    }
    TriangleMesh inside_out = box(1, 1, 1);
    std::swap(inside_out.triangles[3][0], inside_out.triangles[3][1]);
    EXPECT_NE(refusal([&] { static_cast<void>(pieces_of(inside_out, Recipe{})); }), "");
    Recipe soup;
    soup.method = Method::soup;
    EXPECT_EQ(pieces_of(open, soup).size(), 11U);
}

TEST(MeshPieces, MoreThanAMapHoldsIsRefused)
{
    Recipe soup;
    soup.method = Method::soup;
    const std::string why = refusal([&] { static_cast<void>(pieces_of(sphere(40), soup)); });
    EXPECT_NE(why.find("more pieces than a map may have, 4096"), std::string::npos) << why;
    Recipe recipe;
    recipe.concavity = 0.0;
    EXPECT_NE(refusal([&] { static_cast<void>(pieces_of(box(1, 1, 1), recipe)); }), "");
    EXPECT_NE(refusal([] { static_cast<void>(stored_map("none", {})); }), "");
}

/// Degenerate triangles (lines, points and needles) are kept as obstacles.
TEST(MeshPieces, TrianglesWithoutAreaAreKept)
{
    TriangleMesh mesh = box(1, 1, 1);
    const std::size_t n = mesh.vertices.size();
    mesh.vertices.emplace_back(2, 0, 0);
    mesh.vertices.emplace_back(4, 0, 0);
    mesh.triangles.push_back({n, n + 1, n});
    for (const Method method : {Method::hull, Method::decompose, Method::soup}) {
        Recipe recipe;
        recipe.method = method;
        recipe.open = true;
        const files::MapTables stored = stored_map("line", pieces_of(mesh, recipe));
        float nearest = 1e9F;
        for (std::size_t i = 0; i < stored.pieces.size(); ++i) {
            WorkBudget budget(10'000);
            nearest = std::min(
                nearest,
                geometry::point_shape_distance({3.0F, 1.0F, 0.0F}, stored.view().shape_of(i), {}, budget).distance);
        }
        EXPECT_NEAR(nearest, 1.0F, 1e-4F);
    }
}

}  // namespace
}  // namespace jink::test
