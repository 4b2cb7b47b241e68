// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/map_obstacles.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "core/base/work_units.hpp"
#include "tests/oracle/map_of_hulls.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"

// Obstacles of a map against all of its pieces, in double precision: whatever the place, the reach and the budget,
// every piece within reach is held.

namespace jink::world {
namespace {

namespace go = geometry::oracle;
using go::Vec3d;

using Hulls = std::vector<std::vector<Vec3>>;

Hulls any_hulls(Random& random, std::size_t count, float room)
{
    Hulls hulls(count);
    const Vec3 centre = random.below(3) == 0 ? go::in_cube(random, 800.0F) : Vec3(Vec3::Zero());
    for (auto& hull : hulls) {
        const Vec3 at = centre + go::in_cube(random, room);
        const float size = random.uniform(0.1F, 3.0F);
        hull.resize(random.below(2) == 0 ? 3 : 4 + random.below(geometry::kMaxPieceVertices - 3));
        for (Vec3& v : hull) {
            v = at + go::in_cube(random, size);
        }
    }
    return hulls;
}

/// Where a vertex of a hull really lies in the world.
Vec3d placed(const Vec3& vertex, const MapPlace& place) { return vertex.cast<double>() + place.origin.cast<double>(); }

double distance_of(const std::vector<Vec3>& hull, const MapPlace& place, const Vec3& point)
{
    const auto support = [&](const Vec3d& direction) -> Vec3d {
        Vec3d best = placed(hull[0], place);
        for (const Vec3& v : hull) {
            best = placed(v, place).dot(direction) > best.dot(direction) ? placed(v, place) : best;
        }
        return best - point.cast<double>();
    };
    return go::distance_from_origin(support, 1e-6).lower;
}

/// Whether an obstacle, grown by its uncertainty, holds a point: of a box by its sides, of a hull one of its vertices.
bool holds(const Obstacle& obstacle, const Vec3d& point)
{
    const geometry::Shape& shape = obstacle.shape;
    const Vec3d centre = shape.centre.cast<double>();
    const auto grown = double(obstacle.uncertainty);
    if (shape.kind == geometry::ShapeKind::box) {
        return ((point - centre).cwiseAbs() - shape.half.cast<double>()).maxCoeff() <= grown;
    }
    return std::any_of(shape.vertices.begin(), shape.vertices.end(),
                       [&](const Point3& v) { return (centre + v.vec().cast<double>() - point).norm() <= grown; });
}

double box_distance(const geometry::Shape& box, const Vec3& point)
{
    return ((point - box.centre).cast<double>().cwiseAbs() - box.half.cast<double>()).cwiseMax(0.0).norm();
}

struct MapCase {
    Hulls hulls;
    MapPlace place;
    Vec3 point;
    float reach = 0.0F;
    std::uint32_t units = 0;
};

MapCase any_case(Random& random)
{
    MapCase c;
    const float room = random.uniform(1.0F, 60.0F);
    c.hulls = any_hulls(random, 1 + random.below(300), room);
    c.place.origin = random.below(2) == 0 ? Vec3(Vec3::Zero()) : go::in_cube(random, 5000.0F);
    c.place.uncertainty = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 2.0F);
    c.point = c.hulls[0][0] + c.place.origin + go::in_cube(random, room);
    c.reach = random.uniform(0.0F, 80.0F);
    c.units = random.below(4) == 0 ? static_cast<std::uint32_t>(random.below(100)) : 1'000'000;
    return c;
}

/// The piece whose hull the obstacle is; of a box the number of pieces.
std::size_t piece_of(const geometry::MeshMap& map, const Obstacle& obstacle)
{
    const geometry::MeshNode& node = map.nodes[obstacle.id - kFirstMapId];
    return node.is_leaf() ? node.piece : map.pieces.size();
}

/// Every piece within reach is held by one obstacle, and nearer than `exact_within` by its own hull.
void check_pieces(const MapCase& c, const geometry::MeshMap& map, const MapSelection& found,
                  std::span<const Obstacle> obstacles)
{
    for (std::size_t i = 0; i < c.hulls.size(); ++i) {
        const std::vector<Vec3>& hull = c.hulls[i];
        const double distance = distance_of(hull, c.place, c.point);
        const auto own =
            std::count_if(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) { return piece_of(map, o) == i; });
        ASSERT_LE(own, 1);
        if (distance > double(c.reach)) {
            continue;
        }
        const bool held = std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& o) {
            const bool is_it = piece_of(map, o) == i || o.shape.kind == geometry::ShapeKind::box;
            return is_it &&
                   std::all_of(hull.begin(), hull.end(), [&](const Vec3& v) { return holds(o, placed(v, c.place)); });
        });
        ASSERT_TRUE(held) << "piece " << i << " at " << distance << " m of " << c.reach;
        ASSERT_TRUE(own == 1 || distance >= double(found.exact_within)) << "piece " << i << " at " << distance;
    }
}

TEST(AppendMap, EveryPieceWithinReachIsHeld)
{
    Random random(go::seed_of(31));
    std::size_t coarse = 0;
    std::size_t exact = 0;
    std::size_t few_units = 0;
    const std::size_t cases = go::case_count(2'000);
    for (std::size_t n = 0; n < cases; ++n) {
        SCOPED_TRACE(n);
        const MapCase c = any_case(random);
        const jink::oracle::MapOfHulls tables(c.hulls, 1e-3F);
        const geometry::MeshMap& map = tables.map();
        ASSERT_EQ(geometry::check(map), geometry::MapStatus::good);
        ObstacleTable table;
        table.keep_places_for_map();
        WorkBudget budget(c.units);
        const MapSelection found = append_map(map, c.place, c.point, c.reach, budget, table);
        const std::span<const Obstacle> obstacles = table.obstacles();
        ASSERT_EQ(found.pieces + found.boxes, obstacles.size());
        ASSERT_LE(obstacles.size(), kMaxMapObstacles);
        ASSERT_LE(found.exact_within, c.reach);
        for (std::size_t i = 0; i < obstacles.size(); ++i) {
            ASSERT_TRUE(geometry::is_valid(obstacles[i].shape));
            ASSERT_TRUE(i == 0 || obstacles[i].id > obstacles[i - 1].id);
            if (obstacles[i].shape.kind == geometry::ShapeKind::box) {
                ASSERT_GE(box_distance(obstacles[i].shape, c.point), double(found.exact_within) - 1e-3);
            }
        }
        check_pieces(c, map, found, obstacles);
        ASSERT_FALSE(HasFatalFailure());
        // Boxes are for want of places or of units alone.
        ASSERT_TRUE(found.boxes == 0 || obstacles.size() + 1 >= kMaxMapObstacles || budget.exhausted());
        ASSERT_TRUE(found.boxes > 0 || found.exact_within == c.reach);
        coarse += found.boxes > 0 ? 1 : 0;
        exact += found.pieces > 0 && found.boxes == 0 ? 1 : 0;
        few_units += budget.exhausted() ? 1 : 0;
    }
    std::cout << coarse << " with boxes, " << exact << " without, " << few_units << " with few units\n";
    EXPECT_GT(coarse, cases / 10);
    EXPECT_GT(exact, cases / 10);
    EXPECT_GT(few_units, cases / 50);
}

/// The same place gives the same obstacles, whatever the table held before.
TEST(AppendMap, TheSamePlaceGivesTheSameObstacles)
{
    Random random(go::seed_of(32));
    for (std::size_t n = 0; n < go::case_count(200); ++n) {
        const MapCase c = any_case(random);
        const jink::oracle::MapOfHulls tables(c.hulls);
        ObstacleTable fresh;
        ObstacleTable used;
        fresh.keep_places_for_map();
        used.keep_places_for_map();
        WorkBudget first(c.units);
        static_cast<void>(append_map(tables.map(), c.place, c.point, c.reach, first, fresh));
        WorkBudget other(c.units);
        static_cast<void>(append_map(tables.map(), c.place, c.point + Vec3(9, 1, 3), 200.0F, other, used));
        const std::size_t sensed = random.below(kMaxObstacles);
        for (std::size_t i = 0; i < sensed; ++i) {
            static_cast<void>(
                used.update({static_cast<ObstacleId>(i), geometry::make_sphere(c.point, 1.0F)}, {}, c.point));
        }
        ASSERT_TRUE(sensed == 0 || used.obstacles().size() == used.own().size()) << "the other place is forgotten";
        used.expire({});  // drops what was appended
        WorkBudget second(c.units);
        static_cast<void>(append_map(tables.map(), c.place, c.point, c.reach, second, used));
        const std::span<const Obstacle> others = used.obstacles().subspan(used.own().size());
        ASSERT_EQ(others.size(), fresh.obstacles().size());
        for (std::size_t i = 0; i < others.size(); ++i) {
            ASSERT_EQ(others[i].id, fresh.obstacles()[i].id);
            ASSERT_EQ(others[i].shape.centre, fresh.obstacles()[i].shape.centre);
            ASSERT_EQ(others[i].shape.half, fresh.obstacles()[i].shape.half);
            ASSERT_EQ(others[i].uncertainty, fresh.obstacles()[i].uncertainty);
        }
    }
}

}  // namespace
}  // namespace jink::world
