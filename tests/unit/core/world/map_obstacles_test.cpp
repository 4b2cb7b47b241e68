// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/map_obstacles.hpp"

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/separation.hpp"
#include "tests/oracle/map_of_hulls.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

std::vector<Vec3> cube(const Vec3& middle, float half)
{
    std::vector<Vec3> out;
    for (int i = 0; i < 8; ++i) {
        out.emplace_back(middle + half * Vec3((i & 1) != 0 ? 1.0F : -1.0F, (i & 2) != 0 ? 1.0F : -1.0F,
                                              (i & 4) != 0 ? 1.0F : -1.0F));
    }
    return out;
}

/// Cubes of 1 m, 4 m apart, eastwards from the origin on.
std::vector<std::vector<Vec3>> row(std::size_t count)
{
    std::vector<std::vector<Vec3>> out;
    for (std::size_t i = 0; i < count; ++i) {
        out.push_back(cube({4.0F * static_cast<float>(i), 0, 0}, 0.5F));
    }
    return out;
}

class MapOfCubes : public ::testing::Test {
protected:
    MapOfCubes() { table.keep_places_for_map(); }
    MapSelection append(const oracle::MapOfHulls& tables, const Vec3& point, float reach,
                        std::uint32_t units = 1'000'000, const MapPlace& place = {})
    {
        table.expire({});  // drops what was appended
        WorkBudget budget(units);
        return append_map(tables.map(), place, point, reach, budget, table);
    }
    ObstacleTable table;
};

TEST_F(MapOfCubes, APieceIsAnObstacleWhereTheMapLies)
{
    const oracle::MapOfHulls tables(row(3), 0.01F);
    const MapSelection found = append(tables, {100, 50, 7}, 3.0F, 1000, {{96, 50, 5}, 0.5F});
    ASSERT_EQ(found.pieces, 1);
    EXPECT_EQ(found.boxes, 0);
    EXPECT_EQ(found.exact_within, 3.0F);
    const Obstacle& obstacle = table.obstacles()[0];
    EXPECT_EQ(geometry::support(obstacle.shape, {1, 1, 1}), Vec3(100.5F, 50.5F, 5.5F));
    EXPECT_NEAR(obstacle.uncertainty, 0.51F, 1e-3F);
    EXPECT_GE(obstacle.uncertainty, 0.51F);
    EXPECT_GE(obstacle.id, kFirstMapId);
}

/// The reach ends at the surface of what may stand out of the piece.
TEST_F(MapOfCubes, WhatIsOutOfReachIsLeftOut)
{
    const oracle::MapOfHulls tables(row(1), 0.25F);
    EXPECT_EQ(append(tables, {2, 0, 0}, 1.26F).pieces, 1) << "1.5 m less 0.25 m";
    EXPECT_EQ(append(tables, {2, 0, 0}, 1.24F).pieces, 0);
    EXPECT_TRUE(table.obstacles().empty());
    EXPECT_EQ(append(tables, {2, 0, 0}, 1.0F, 1000, {Vec3::Zero(), 0.3F}).pieces, 1);
    EXPECT_EQ(append(tables, {900, 0, 0}, 50.0F).exact_within, 50.0F) << "nothing there is exact";
}

/// More pieces than places: the near ones by themselves, boxes about the far ones.
TEST_F(MapOfCubes, BoxesStandForFarPiecesWhereThereAreTooMany)
{
    const oracle::MapOfHulls tables(row(4 * kMaxMapObstacles));
    const Vec3 point(-3, 0, 0);
    const MapSelection found = append(tables, point, 1e4F);
    EXPECT_GE(found.pieces + found.boxes + 1U, kMaxMapObstacles);
    EXPECT_GT(found.pieces, kMaxMapObstacles / 4);
    EXPECT_GT(found.boxes, 0);
    EXPECT_GT(found.exact_within, 4.0F * static_cast<float>(found.pieces) - 4.0F);
    float farthest = 0.0F;
    for (const Obstacle& obstacle : table.obstacles()) {
        farthest = std::max(farthest, geometry::support(obstacle.shape, Vec3::UnitX()).x());
        if (obstacle.shape.kind == geometry::ShapeKind::box) {
            EXPECT_GE(geometry::support(obstacle.shape, -Vec3::UnitX()).x() - point.x(), found.exact_within);
        }
    }
    EXPECT_EQ(farthest, 4.0F * static_cast<float>(4 * kMaxMapObstacles - 1) + 0.5F) << "the last cube is in a box";
}

TEST_F(MapOfCubes, WithoutBudgetTheWholeMapIsABox)
{
    const oracle::MapOfHulls tables(row(5));
    const MapSelection found = append(tables, {-3, 0, 0}, 100.0F, 0);
    EXPECT_EQ(found.pieces, 0);
    ASSERT_EQ(found.boxes, 1);
    EXPECT_NEAR(found.exact_within, 2.5F, 1e-4F);
    EXPECT_EQ(geometry::support(table.obstacles()[0].shape, {1, 1, 1}), Vec3(16.5F, 0.5F, 0.5F));
    EXPECT_EQ(append(tables, {1, 0, 0}, 100.0F, 0).exact_within, 0.0F) << "in the box";
}

TEST_F(MapOfCubes, OpeningANodeTakesItsUnits)
{
    const oracle::MapOfHulls tables(row(2));
    EXPECT_EQ(append(tables, Vec3::Zero(), 100.0F, units::kMeshNode - 1).boxes, 1);
    EXPECT_EQ(append(tables, Vec3::Zero(), 100.0F, units::kMeshNode).pieces, 2);
}

/// A table that keeps no places says that nothing is known.
TEST(MapWithoutPlaces, NothingIsExact)
{
    const oracle::MapOfHulls tables(row(2));
    ObstacleTable table;
    for (std::size_t i = 0; i < kMaxObstacles - 1; ++i) {
        static_cast<void>(table.update({static_cast<ObstacleId>(i), geometry::make_sphere(Vec3::Zero(), 1.0F)},
                                       TimePoint{1'000'000'000}, Vec3::Zero()));
    }
    WorkBudget budget(1000);
    EXPECT_EQ(append_map(tables.map(), {}, Vec3::Zero(), 100.0F, budget, table).exact_within, 0.0F);
}

/// Whatever comes from a map is a threat like any other: conflict prediction and the final check meet it, and its
/// uncertainty.
TEST_F(MapOfCubes, ThreatsOfAMapAreMetByConflictAndFinalCheck)
{
    const oracle::MapOfHulls tables({cube({30, 0, 10}, 3.0F)}, 0.01F);
    static_cast<void>(append(tables, {0, 0, 10}, 100.0F, 1000, {Vec3::Zero(), 0.5F}));
    test::Scene scene;
    scene.own.position = {0, 0, 10};
    scene.own.velocity = {5, 0, 0};
    scene.leg({0, 0, 10}, {100, 0, 10});
    scene.obstacles.assign(table.obstacles().begin(), table.obstacles().end());
    const auto margin = [&](float aside) {
        const Situation situation = scene.situation();
        const path::TimedPath path = test::flight({{0, 0, 10}, {10, aside, 10}, {50, aside, 10}}, 4.0F);
        WorkBudget budget(100'000);
        return least_separation(situation, path, 20.0F, budget).margin;
    };
    EXPECT_LT(margin(0.0F), 0.0F) << "through the piece";
    const float half = scene.limits.half_extents.y();
    EXPECT_LT(margin(3.0F + half + 0.45F), 0.0F) << "where the piece may be";
    EXPECT_GT(margin(3.0F + half + 0.6F), 0.0F);
    const Situation situation = scene.situation();
    WorkBudget budget(100'000);
    Conflict conflict;
    ASSERT_TRUE(main_conflict(situation, way_of(situation), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.threat.kind, ThreatKind::obstacle);
    EXPECT_NEAR(conflict.time_to_loss, (27.0F - 0.51F - scene.limits.half_extents.x()) / 5.0F, 0.2F);
}

}  // namespace
}  // namespace jink::world
