// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/mesh_map.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/oracle/map_of_hulls.hpp"

namespace jink::geometry {
namespace {

std::vector<Vec3> cube(const Vec3& low, float side)
{
    std::vector<Vec3> out;
    for (int i = 0; i < 8; ++i) {
        out.emplace_back(low + side * Vec3(float(i & 1), float((i >> 1) & 1), float((i >> 2) & 1)));
    }
    return out;
}

/// Three cubes and a triangle.
std::vector<std::vector<Vec3>> pieces()
{
    return {cube({0, 0, 0}, 1.0F), cube({5, 0, 0}, 1.0F), cube({0, 5, 0}, 2.0F), {{9, 9, 0}, {9, 9, 3}, {9, 6, 0}}};
}

/// `pieces` as a map with one thing changed.
class Changed {
public:
    explicit Changed(const std::function<void(oracle::MapOfHulls&, MeshMap&)>& change, bool sealed = true)
    {
        map_ = tables_.map();
        change(tables_, map_);
        if (sealed) {
            map_.checksum = checksum_of(map_);
        }
    }
    [[nodiscard]] MapStatus status() const { return check(map_); }

private:
    oracle::MapOfHulls tables_{pieces()};
    MeshMap map_;
};

TEST(MeshMapCheck, AGoodMapIsTaken)
{
    EXPECT_EQ(Changed([](auto&, auto&) {}).status(), MapStatus::good);
}

TEST(MeshMapCheck, EmptyMapsAreRefused)
{
    EXPECT_EQ(check(MeshMap{}), MapStatus::empty);
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.pieces = {}; }).status(), MapStatus::empty);
}

TEST(MeshMapCheck, AnotherVersionIsRefused)
{
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { ++m.version; }).status(), MapStatus::wrong_version);
}

TEST(MeshMapCheck, AnotherUnitIsRefused)
{
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.metres_per_unit = 0.001F; }).status(), MapStatus::wrong_units);
}

TEST(MeshMapCheck, WhatIsTooLargeIsRefused)
{
    const std::vector<MeshPiece> many(kMaxMeshPieces + 1);
    EXPECT_EQ(Changed([&](auto&, MeshMap& m) { m.pieces = many; }).status(), MapStatus::too_large);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.pieces_[0].vertices = kMaxPieceVertices + 1; }).status(),
              MapStatus::too_large);
}

TEST(MeshMapCheck, ATreeThatIsTooDeepIsRefused)
{
    // Every node's left child is a leaf: as deep as there are pieces.
    std::vector<MeshPiece> some;
    std::vector<Point3> vertices;
    std::vector<MeshNode> nodes;
    MeshNode box;
    box.high = {1.0F, 1.0F, 1.0F};
    constexpr std::uint16_t kCount = kMaxMeshDepth + 2;
    for (std::uint16_t i = 0; i < kCount; ++i) {
        some.push_back({{}, 3U * i, 3});
        vertices.insert(vertices.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}});
        if (i + 1 < kCount) {
            nodes.push_back(box);
            nodes.back().right = static_cast<std::uint16_t>(nodes.size() + 1);
        }
        nodes.push_back(box);
        nodes.back().piece = i;
    }
    MeshMap map;
    map.high = box.high;
    map.pieces = some;
    map.vertices = vertices;
    map.nodes = nodes;
    EXPECT_EQ(check(map), MapStatus::too_large);
}

TEST(MeshMapCheck, TablesThatDoNotBelongTogetherAreRefused)
{
    EXPECT_EQ(Changed([](auto& t, MeshMap& m) {
                  m.nodes = {t.nodes_.data(), t.nodes_.size() - 1};
              }).status(),
              MapStatus::sizes_differ);
    EXPECT_EQ(Changed([](auto& t, MeshMap& m) {
                  m.vertices = {t.vertices_.data(), t.vertices_.size() - 1};
              }).status(),
              MapStatus::sizes_differ);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.pieces_[1].first_vertex = 0; }).status(), MapStatus::sizes_differ);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.pieces_[3].vertices = 2; }).status(), MapStatus::sizes_differ);
}

TEST(MeshMapCheck, BadCoordinatesAreRefused)
{
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1000.1F}) {
        EXPECT_EQ(Changed([bad](auto& t, auto&) { t.vertices_[3].y = bad; }).status(), MapStatus::bad_coordinate);
        EXPECT_EQ(Changed([bad](auto& t, auto&) { t.pieces_[2].centre.z = bad; }).status(), MapStatus::bad_coordinate);
        EXPECT_EQ(Changed([bad](auto& t, auto&) { t.nodes_[0].high.y = bad; }).status(), MapStatus::bad_coordinate);
        EXPECT_EQ(Changed([bad](auto&, MeshMap& m) { m.high.x = bad; }).status(), MapStatus::bad_coordinate);
    }
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.slack = -0.1F; }).status(), MapStatus::bad_coordinate);
}

TEST(MeshMapCheck, BoxesThatHoldTooLittleAreRefused)
{
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.low.x = 0.5F; }).status(), MapStatus::bad_bounds);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.nodes_[0].low.x = 0.5F; }).status(), MapStatus::bad_bounds);
    EXPECT_EQ(Changed([](auto& t, auto&) {
                  for (MeshNode& node : t.nodes_) {
                      if (node.is_leaf()) {
                          node.high.z -= 0.1F;
                      }
                  }
              }).status(),
              MapStatus::bad_bounds);
}

TEST(MeshMapCheck, TreesThatDoNotHoldEveryPieceOnceAreRefused)
{
    EXPECT_EQ(Changed([](auto& t, auto&) { t.nodes_[0].right = 0; }).status(), MapStatus::bad_tree);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.nodes_[0].right = 99; }).status(), MapStatus::bad_tree);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.nodes_[0].piece = 0; }).status(), MapStatus::bad_tree);
    const auto leaf = [](oracle::MapOfHulls& t) -> MeshNode& {
        return *std::find_if(t.nodes_.begin(), t.nodes_.end(), [](const MeshNode& n) { return n.is_leaf(); });
    };
    EXPECT_EQ(Changed([&](auto& t, auto&) { leaf(t).piece = 4; }).status(), MapStatus::bad_tree);
    EXPECT_EQ(Changed([&](auto& t, auto&) { leaf(t).right = 1; }).status(), MapStatus::bad_tree);
    EXPECT_NE(Changed([&](auto& t, auto&) { leaf(t).piece ^= 1; }).status(), MapStatus::good);
}

TEST(MeshMapCheck, OriginsThatAreNotOnTheGlobeAreRefused)
{
    const auto status = [](const MapOrigin& origin) {
        return Changed([&](auto&, MeshMap& m) { m.origin = origin; }).status();
    };
    EXPECT_EQ(status({true, 850'000'000, -1'800'000'000, 1'000'000'000}), MapStatus::good);
    EXPECT_EQ(status({true, -850'000'001, 0, 0}), MapStatus::wrong_origin) << "where east turns too fast";
    EXPECT_EQ(status({true, 0, 1'800'000'001, 0}), MapStatus::wrong_origin);
    EXPECT_EQ(status({true, 0, 0, -1'000'000'001}), MapStatus::wrong_origin);
}

TEST(MeshMapCheck, EveryTableIsInTheChecksum)
{
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.checksum ^= 1U; }, false).status(), MapStatus::wrong_checksum);
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.slack = 1e-6F; }, false).status(), MapStatus::wrong_checksum);
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.high.x += 1.0F; }, false).status(), MapStatus::wrong_checksum);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.pieces_[0].centre.x += 1e-4F; }, false).status(), MapStatus::bad_bounds);
    for (std::int32_t MapOrigin::*number : {&MapOrigin::latitude, &MapOrigin::longitude, &MapOrigin::altitude}) {
        EXPECT_EQ(Changed([&](auto&, MeshMap& m) { m.origin.*number = 1; }, false).status(), MapStatus::wrong_checksum);
    }
    EXPECT_EQ(Changed([](auto&, MeshMap& m) { m.origin.known = true; }, false).status(), MapStatus::wrong_checksum);
    EXPECT_EQ(Changed([](auto& t, auto&) { t.vertices_[0].x += 1e-4F; }, false).status(), MapStatus::wrong_checksum);
}

TEST(MeshMapShape, APieceIsTheHullOfItsVerticesWhereItLies)
{
    const oracle::MapOfHulls tables(pieces());
    const Shape shape = tables.map().shape_of(2);
    ASSERT_TRUE(is_valid(shape));
    EXPECT_EQ(support(shape, {1, 1, 1}), Vec3(2, 7, 2));
    EXPECT_EQ(support(shape, {-1, -1, -1}), Vec3(0, 5, 0));
    EXPECT_LE(bounding_radius(shape), 3.5F) << "about a centre of its own";
}

/// A lower bound, and no more than rounding below the truth.
TEST(MeshMapNode, DistanceOfABox)
{
    MeshNode node;
    node.low = {1, 2, 3};
    node.high = {2, 4, 9};
    EXPECT_EQ(box_distance(node, {1.5F, 3, 4}), 0.0F);
    EXPECT_LE(box_distance(node, {-2, 3, 13}), 5.0F);
    EXPECT_NEAR(box_distance(node, {-2, 3, 13}), 5.0F, 1e-5F);
    EXPECT_NEAR(box_distance(node, {1.5F, 6, 4}), 2.0F, 1e-5F);
}

}  // namespace
}  // namespace jink::geometry
