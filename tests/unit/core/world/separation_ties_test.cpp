// SPDX-License-Identifier: BSD-3-Clause
// Separations: bounds that are equal to the bit to the margin so far, and surfaces that are back at their size in one
// piece of several.
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/separation_parts.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Eastwards at 1 m/s in pieces of a second.
path::TimedPath east(int pieces)
{
    std::vector<Vec3> positions;
    for (int i = 0; i <= pieces; ++i) {
        positions.push_back(Vec3(static_cast<float>(i), 0, 0));
    }
    return flight(positions, 1.0F);
}

/// Costs of a scene's threats one after the other.
struct TiedCosts : testing::Test {
    [[nodiscard]] std::uint32_t cost(const path::TimedPath& path, const Cutoff& cutoff = {}) const
    {
        WorkBudget budget(kPlenty);
        static_cast<void>(least_separation(scene.situation(), path, 100.0F, budget, EscapeRule{}, cutoff));
        return budget.spent();
    }
    static constexpr std::uint32_t kFar = units::kThreat + units::kThreatChunk;
    Scene scene;
};

/// Threats that cannot be nearer than the margin so far are skipped, also if exactly as near.
TEST_F(TiedCosts, AThreatThatIsNoNearerIsPassedOver)
{
    const path::TimedPath path = east(2);
    scene.track(Vec3(6, 0, 0), Vec3::Zero(), 1.0F);  // 2 m at the end
    const std::uint32_t first = cost(path);
    ASSERT_EQ(separation(scene, path).margin, 2.0F);
    scene.track(Vec3(6, 0, 0), Vec3::Zero(), 1.0F);
    EXPECT_EQ(cost(path), first + kFar);
    scene.tracks.pop_back();
    scene.cylinder(Vec2(-5, 0), 2.0F);  // 2 m at the start
    EXPECT_EQ(cost(path), first + kFar);
    scene.airspace.cylinders = {};
    scene.obstacle(geometry::make_box(Vec3(0, 20, 0), Vec3(3, 3, 3)));
    const float bound = 19.0F - geometry::bounding_radius(scene.obstacles[0].shape);
    scene.tracks.clear();
    const std::uint32_t empty = cost(path, Cutoff{-kSeparationCap, bound, {}});
    scene.obstacles.clear();
    EXPECT_EQ(empty, cost(path) + kFar);
}

/// A cylinder in contact with the flight's bounding box may have any depth, and is checked.
TEST_F(TiedCosts, ACylinderThatTouchesTheFlightsBoxIsLookedAt)
{
    const path::TimedPath path = east(2);
    scene.track(Vec3(1, 0, 0), Vec3::Zero(), 0.5F);
    ASSERT_LT(separation(scene, path).margin, 0.0F);
    const std::uint32_t first = cost(path);
    scene.cylinder(Vec2(6, 0), 3.0F);
    EXPECT_EQ(cost(path), first + kFar + 2 * units::kThreatPiece + 2 * units::kCylinderPart);
    scene.cylinders[0].circle.radius = 2.99F;
    scene.airspace.cylinders = scene.cylinders;
    EXPECT_EQ(cost(path), first + kFar);
}

/// A sphere about the vehicle of exactly the depth of the margin so far is checked.
TEST_F(TiedCosts, ASphereOfExactlyTheDepthSoFarIsLookedAt)
{
    const path::TimedPath path = east(2);
    scene.track(Vec3(5, 0, 0), Vec3(-4, 0, 0), 1.0F);
    ASSERT_EQ(separation(scene, path).margin, -1.0F);
    const std::uint32_t first = cost(path);
    scene.track(Vec3(20, 0, 0), Vec3(-20, 0, 0), 0.5F).max_acceleration = 1.0F;  // a radius of a metre after a second
    EXPECT_EQ(cost(path), first + kFar + 2 * units::kThreatPiece + 2 * 4 * units::kSpherePart);
}

/// Now: an obstacle that cannot be nearer than the margin so far costs no query, also where it may be as near.
TEST(SeparationAtTies, AnObstacleThatIsNoNearerCostsNoQuery)
{
    Scene scene;
    scene.obstacle(geometry::make_box(Vec3(0, 9, 0), Vec3::Constant(0.5F)));
    const float near = 9.0F - geometry::bounding_radius(scene.obstacles[0].shape) - Vec3::Ones().norm();
    scene.track(Vec3(11, 0, 0), Vec3::Zero(), 10.0F - near);
    WorkBudget budget(kPlenty);
    const Separation found = separation_at(scene.situation(), Vec3::Zero(), 0.0F, budget);
    ASSERT_EQ(found.margin, near);
    EXPECT_EQ(budget.spent(), 2 * units::kThreat);
    scene.tracks[0].radius -= 1e-3F;
    WorkBudget more(kPlenty);
    EXPECT_EQ(separation_at(scene.situation(), Vec3::Zero(), 0.0F, more).against.kind, ThreatKind::track);
    EXPECT_GT(more.spent(), 2 * units::kThreat + units::kSolidQuery);
}

/// Spheres are checked in closed form, at the cost of a quick check.
TEST(SeparationAtTies, ASphereCostsNoQueryHoweverNear)
{
    Scene scene;
    scene.obstacle(geometry::make_sphere(Vec3(0, 9, 0), 1.0F));
    WorkBudget budget(kPlenty);
    EXPECT_NEAR(separation_at(scene.situation(), Vec3::Zero(), 0.0F, budget).margin, 7.0F, 1e-6F);
    EXPECT_EQ(budget.spent(), units::kThreat);
}

/// A flight in exact contact at the start is outside: no credit to go inside.
TEST(TouchingStarts, HaveNoCredit)
{
    const path::TimedPath in = flight({Vec3::Zero(), Vec3(0.04F, 0, 0)}, 0.01F);
    Scene track;
    track.track(Vec3(4, 0, 0), Vec3::Zero(), 3.0F);
    EXPECT_NEAR(separation(track, in).margin, -0.04F, 1e-5F);
    Scene sphere;
    sphere.obstacle(geometry::make_sphere(Vec3(4, 0, 0), 3.0F));
    EXPECT_NEAR(separation(sphere, in).margin, -0.04F, 1e-5F);
    Scene floor;
    floor.airspace.has_floor = true;
    floor.airspace.floor = -1.0F;
    EXPECT_NEAR(separation(floor, flight({Vec3::Zero(), Vec3(0, 0, -0.04F)}, 0.01F)).margin, -0.04F, 1e-5F);
}

/// A tenth of a metre below the floor: 0.15 m of credit, gone after 0.3 s. Each piece counts for its own time alone.
TEST(FloorEscapes, AreJudgedInThePieceInWhichTheCreditEnds)
{
    Scene scene;
    scene.airspace.has_floor = true;
    scene.airspace.floor = -0.9F;
    const auto margin = [&](const std::vector<std::pair<Seconds, float>>& heights) {
        path::TimedPath path;
        for (std::size_t i = 0; i < heights.size(); ++i) {
            const std::size_t next = std::min(i + 1, heights.size() - 1);
            const Seconds span = heights[next].first - heights[i].first;
            const float climb = span > 0.0F ? (heights[next].second - heights[i].second) / span : 0.0F;
            path.points.unchecked_push_back({Vec3(0, 0, heights[i].second), Vec3(0, 0, climb), heights[i].first});
        }
        return separation(scene, path).margin;
    };
    EXPECT_NEAR(margin({{0.0F, 0.0F}, {0.1F, 0.0F}, {0.2F, 0.5F}, {5.0F, 0.5F}}), 0.0F, 1e-5F)
        << "level until 0.1 s: the credit of then, not of 0.3 s";
    EXPECT_NEAR(margin({{0.0F, 0.0F}, {0.1F, 0.5F}, {1.0F, 0.5F}, {1.5F, 5.0F}}), 0.05F, 1e-5F)
        << "a climb later on counts from where it begins";
    EXPECT_NEAR(margin({{0.0F, 0.0F}, {1.0F, 0.1F}, {2.0F, 3.0F}}), -0.07F, 1e-5F) << "0.03 m higher when it ends";
}

/// Across the path in each direction, fast: a moving threat counts from its start to its end.
TEST(CrossingThreats, CountOnAllOfTheirWay)
{
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
        const Vec3 own = 2.0F * Vec3(along.y(), along.x(), 0);
        const path::TimedPath path = flight({Vec3(-own), own}, 2.0F);
        Scene track;
        track.track(-100.0F * along, 100.0F * along, 1.0F);
        EXPECT_NEAR(separation(track, path).margin, -1.0F, 1e-3F);
        Scene cylinder;
        cylinder.cylinder(-100.0F * along.head<2>(), 3.0F, 100.0F * along.head<2>());
        EXPECT_NEAR(separation(cylinder, path).margin, -3.0F, 1e-2F);
    }
}

/// A path with jumps is also checked at the beginning of each piece.
TEST(JumpingPaths, CountWhereEachPieceBegins)
{
    for (const float side : {1.0F, -1.0F}) {
        Scene scene;
        scene.track(Vec3(0, 7, 0), Vec3::Zero(), 1.0F);  // 5 m
        scene.track(side * Vec3(34, 0, 0), Vec3::Zero(), 1.0F);
        const std::vector<path::PathPoint> points = {{Vec3::Zero(), Vec3::Zero(), 0.0F},
                                                     {side * Vec3(30, 0, 0), side * Vec3(-10, 0, 0), 1.0F},
                                                     {side * Vec3(20, 0, 0), side * Vec3(-10, 0, 0), 2.0F}};
        WorkBudget budget(kPlenty);
        const Separation found = least_separation(scene.situation(), points, 100.0F, budget);
        EXPECT_NEAR(found.margin, 2.0F, 1e-5F);
        EXPECT_EQ(found.against.index, 1U);
        EXPECT_EQ(found.when, 1.0F);
    }
}

/// A growing threat counts with its size at the end of a part, a shrunk one with its regrown size at that time.
TEST(GrowingThreats, CountAsTheyAreAtTheEndOfAPart)
{
    Scene beside;
    beside.track(Vec3(0, 20, 0), Vec3(1, 0, 0), 1.0F).max_acceleration = 2.0F;
    EXPECT_NEAR(separation(beside, flight({Vec3::Zero(), Vec3(2, 0, 0)}, 2.0F)).margin, 20.0F - 1.0F - 5.0F, 1e-4F);
    Scene inside;
    inside.track(Vec3(4.5F, 0, 0), Vec3::Zero(), 4.0F);  // half a metre: 0.55 m of credit at 0.5 m/s
    const path::TimedPath stay = flight({Vec3::Zero(), Vec3::Zero()}, 1.0F);
    EXPECT_NEAR(separation(inside, stay).margin, -0.45F, 1e-4F);
    inside.tracks.clear();
    inside.cylinder(Vec2(4.5F, 0), 4.0F);
    EXPECT_NEAR(separation(inside, stay).margin, -0.45F, 1e-3F);
}

/// Beside an initially nearer threat, a growing threat is checked separately in each part.
TEST(GrowingThreats, AreNotPassedOverInThePartInWhichTheyComeNear)
{
    Scene scene;
    scene.track(Vec3(0, 17, 0), Vec3::Zero(), 1.0F);  // 15 m
    scene.track(Vec3(50, 0, 0), Vec3(-40, 0, 0), 1.0F).max_acceleration = 1e-3F;
    EXPECT_NEAR(separation(scene, flight({Vec3::Zero(), Vec3::Zero()}, 1.0F)).margin, 8.0F, 1e-2F);
}

/// Nearer than the nearest threat so far by less than the uncertainty of the own position.
TEST(UncertainPlaces, ThreatsThatAreNearerByTheUncertaintyCount)
{
    const auto scene_with = [](float nearest) {
        Scene scene;
        scene.own.sigma_position = 0.5F;  // 1.5 m
        scene.track(Vec3(0, nearest + 3.5F, 0), Vec3::Zero(), 1.0F);
        return scene;
    };
    const path::TimedPath path = east(1);
    WorkBudget budget(kPlenty);
    Scene solid = scene_with(2.0F);
    solid.obstacle(geometry::make_capsule(Vec3(6, 0, 0), Vec3(6.02F, 0, 0), 1.0F));  // 3 m, less 1.5 m
    EXPECT_NEAR(separation(solid, path).margin, 1.5F, kObstacleResolution + 1e-3F);
    EXPECT_EQ(separation(solid, path).against.kind, ThreatKind::obstacle);
    Scene cylinder = scene_with(2.0F);
    cylinder.cylinder(Vec2(6, 0), 1.0F);
    EXPECT_NEAR(separation(cylinder, path).margin, 1.5F, 1e-3F);
    EXPECT_EQ(separation_at(cylinder.situation(), Vec3(1, 0, 0), 0.0F, budget).against.kind, ThreatKind::cylinder);
    EXPECT_NEAR(separation_at(cylinder.situation(), Vec3(1, 0, 0), 0.0F, budget).margin, 1.5F, 1e-3F);
    Scene sphere = scene_with(5.0F);
    sphere.obstacle(geometry::make_sphere(Vec3(9, 0, 0), 4.0F));  // 4 m, less 1.5 m
    EXPECT_EQ(separation_at(sphere.situation(), Vec3::Zero(), 0.0F, budget).against.kind, ThreatKind::obstacle);
    EXPECT_NEAR(separation_at(sphere.situation(), Vec3::Zero(), 0.0F, budget).margin, 2.5F, 1e-4F);
}

/// Out of a solid and out of a cylinder: for any remaining budget, unchecked parts are contact, from the first
/// unchecked instant.
TEST(SpentBudgets, AreContactAlsoDuringAnEscape)
{
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(-3, 0, 0), Vec3(-6, 0, 0)}, 1.0F);
    const auto all_fail = [&](const Scene& scene) {
        WorkBudget ample(kPlenty);
        ASSERT_GE(least_separation(scene.situation(), path, 100.0F, ample).margin, 0.0F);
        for (std::uint32_t n = 0; n < ample.spent(); ++n) {
            WorkBudget budget(n);
            ASSERT_EQ(least_separation(scene.situation(), path, 100.0F, budget).margin, -kSeparationCap) << n;
        }
    };
    Scene solid;
    solid.obstacle(geometry::make_box(Vec3(3, 0, 0), Vec3(2.5F, 2, 2)));
    all_fail(solid);
    Scene cylinder;
    cylinder.cylinder(Vec2(4.5F, 0), 4.0F);
    all_fail(cylinder);
    const std::uint32_t before = 1 + 3 * units::kPathPiece + units::kThreat + units::kThreatChunk;
    WorkBudget budget(before + 2 * units::kThreatPiece);
    EXPECT_EQ(least_separation(cylinder.situation(), path, 100.0F, budget).when, 0.0F);
    // In one piece, in the middle of which the surface is back at its size.
    WorkBudget one(before - units::kPathPiece + units::kThreatPiece);
    const path::TimedPath slow = flight({Vec3::Zero(), Vec3(-6, 0, 0)}, 2.0F);
    EXPECT_EQ(least_separation(cylinder.situation(), slow, 100.0F, one).when, 0.0F);
}

/// A turn back to where it came from: a cylinder's surface that is back at its size counts for a piece's own time
/// alone.
TEST(CylinderEscapes, AreJudgedInThePieceInWhichTheCreditEnds)
{
    Scene scene;
    scene.cylinder(Vec2(4.5F, 0), 4.0F);  // half a metre inside: credit until 1.1 s
    // Out by 6 m in a second, 3 m back until 2 s, away again: not nearer than 2 m afterwards.
    path::TimedPath path =
        flight({Vec3::Zero(), Vec3(-6, 0, 0), Vec3(-6, 0, 0), Vec3(-3, 0, 0), Vec3(-15, 0, 0)}, 1.0F);
    EXPECT_NEAR(separation(scene, path).margin, 0.05F, 2e-3F) << "at the start";
    path = flight({Vec3::Zero(), Vec3(-3, 0, 0), Vec3(-3, 0, 0), Vec3(-3, 0, 0), Vec3(-63, 0, 0)}, 1.0F);
    EXPECT_NEAR(separation(scene, path).margin, 0.05F, 2e-3F) << "fast away at last";
}

}  // namespace
}  // namespace jink::world
