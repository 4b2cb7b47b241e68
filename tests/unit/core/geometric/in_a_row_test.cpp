// SPDX-License-Identifier: BSD-3-Clause
// Two-stage manoeuvres: the contact on the path back from beside the first threat, and the second stage around it.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/core/geometric/in_a_row.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// The second stage equals that of the problem computed in double precision, and has the same end. Its offsets show the
/// assumed position and size of the contact.
void expect_second_part(InARow& scene, const std::string& what, Problem* seen = nullptr)
{
    SCOPED_TRACE(what);
    auto first = std::make_unique<Result>();
    ASSERT_EQ(scene.first_part(*first), PlanStatus::found);
    ASSERT_EQ(scene.run_in_a_row(), PlanStatus::found);
    if (scene.result.side != first->side) {
        ASSERT_EQ(scene.first_part(*first, first->side), PlanStatus::found);
        ASSERT_EQ(scene.result.side, first->side);
    }
    Problem second;
    ASSERT_TRUE(second_problem(scene, *first, second));
    if (seen != nullptr) {
        *seen = second;
    }
    Settings with = scene.settings;
    with.waypoints = std::min<std::uint16_t>(scene.settings.waypoints,
                                             static_cast<std::uint16_t>(kMaxPathPoints - scene.first_points()));
    with.escape_from_margin = false;
    auto expected = std::make_unique<Result>();
    WorkBudget unlimited(100'000'000);
    ASSERT_EQ(solve(second, with, scene.limits, scene.airframe, unlimited, *expected), PlanStatus::found);
    ASSERT_EQ(scene.result.candidates.size(), expected->candidates.size());
    for (std::size_t i = 0; i < expected->candidates.size(); ++i) {
        EXPECT_NEAR(scene.result.candidates[i].shape.offset, expected->candidates[i].shape.offset, 2e-3F) << i;
    }
    const Vec3 end = scene.result.path.points.back().position;
    EXPECT_LT((end - expected->path.points.back().position).norm(), 5e-3F);
    const Vec3 from_start = end - scene.problem.frame.origin;
    EXPECT_LT(from_start.cross(Vec3(scene.problem.frame.axes.col(0))).norm(), 1e-3F) << "back on the leg";
    EXPECT_EQ(scene.result.path.points.size(), scene.first_points() - 1U + with.waypoints);
}

TEST(InARowSecond, GoesRoundWhatStandsOnTheWayBack)
{
    for (const float share : {0.3F, 0.5F, 0.7F, 0.9F}) {
        InARow scene;
        scene.threats.push_back(Scene::still(on_way_back(scene, share) + Vec3(0.0F, 0.2F, -0.1F), 1.0F));
        expect_second_part(scene, std::to_string(share));
    }
}

TEST(InARowSecond, GoesRoundWhatIsFartherOnAndBackToTheLegBeyondIt)
{
    InARow scene;
    scene.threats.push_back(Scene::still(Vec3(37.0F, 0.3F, 50.0F), 1.5F));
    expect_second_part(scene, "just before the leg");
    EXPECT_GT(scene.result.path.points.back().position.x(), 45.0F);
}

TEST(InARowSecond, GoesRoundWhatIsNearerThanTwoAndAHalfRadii)
{
    InARow scene;
    scene.threats.push_back(Scene::still(on_way_back(scene, 0.25F), 2.2F));
    Problem second;
    expect_second_part(scene, "5 m after the first", &second);
    EXPECT_LT(second.distance, kMinDistanceInRadii * second.main_radius);
}

TEST(InARowSecond, EndsHalfAsFarOnAsTheMainThreatAtLeast)
{
    InARow scene;
    scene.threats.push_back(Scene::still(on_way_back(scene, 0.2F), 0.3F));
    expect_second_part(scene, "4 m after the first");
    EXPECT_NEAR(scene.result.path.points.back().position.x(), 30.0F, 1e-3F);
}

TEST(InARowSecond, WhatIsMetFirstCountsInWhateverOrderItIsReported)
{
    InARow probe;
    const Sphere near = Scene::still(on_way_back(probe, 0.5F), 0.5F);
    const Sphere far = Scene::still(on_way_back(probe, 0.85F) + Vec3(0.0F, 0.0F, 1.2F), 0.4F);
    const Sphere aside = Scene::still(on_way_back(probe, 0.3F) + Vec3(0.0F, 0.0F, 9.0F), 1.0F);
    for (const auto& order :
         {std::array{near, far, aside}, std::array{far, near, aside}, std::array{aside, far, near}}) {
        InARow scene;
        scene.threats.insert(scene.threats.end(), order.begin(), order.end());
        expect_second_part(scene, "first at " + std::to_string(order[0].motion.position.x()));
    }
}

TEST(InARowSecond, OfThoseMetAtOnceTheFirstCounts)
{
    // Equally far above and below the path.
    for (const float up : {0.5F, -0.5F}) {
        InARow scene;
        const Vec3 on_way = on_way_back(scene, 0.5F);
        scene.threats.push_back(Scene::still(on_way + Vec3(0.0F, 0.0F, up), 0.7F));
        scene.threats.push_back(Scene::still(on_way - Vec3(0.0F, 0.0F, up), 0.7F));
        expect_second_part(scene, "above by " + std::to_string(up));
    }
}

TEST(InARowSecond, WhatGrowsIsAsLargeAsItIsThen)
{
    for (const bool evenly : {true, false}) {
        InARow scene;
        Sphere threat = Scene::still(on_way_back(scene, 0.6F) + Vec3(0.0F, 0.0F, 2.0F), 0.2F);
        // Small enough to be passed below, were it not for its growth.
        threat.radius_rate = evenly ? 0.06F : 0.0F;
        threat.radius_acceleration = evenly ? 0.0F : 0.008F;
        scene.threats.push_back(threat);
        expect_second_part(scene, evenly ? "evenly" : "faster and faster");
    }
}

TEST(InARowSecond, WhatMovesIsWhereItThenIs)
{
    for (const Vec3& velocity : {Vec3(-0.5F, 0.0F, 0.0F), Vec3(0.3F, 0.4F, 0.0F), Vec3(0.0F, 0.1F, -0.5F)}) {
        InARow scene;
        const Vec3 there = on_way_back(scene, 0.5F);
        scene.threats.push_back({{there - 16.0F * velocity, velocity}, 0.8F});
        expect_second_part(scene, "east at " + std::to_string(velocity.x()));
    }
}

TEST(InARowSecond, ObstaclesAreMetAsThreatsAreAndKeptClearOf)
{
    for (const float clearance : {0.0F, 0.4F}) {
        InARow scene;
        const Vec3 there = on_way_back(scene, 0.6F);
        scene.uncertainty = clearance;
        // Beside the path: in contact with the clearance.
        scene.obstacles = {{1, geometry::make_sphere(there + Vec3(0.0F, 0.0F, 1.9F), 0.6F)}};
        expect_second_part(scene, std::to_string(clearance));
    }
    InARow scene;
    scene.obstacles = {{1, geometry::make_sphere(on_way_back(scene, 0.6F), 0.6F)}};
    expect_second_part(scene, "on the way");
}

TEST(InARowSecond, WhatIsNoSphereIsPassedALittleAside)
{
    InARow scene;
    const Vec3 there = on_way_back(scene, 0.5F);
    scene.obstacles = {{1, geometry::make_box(there, Vec3::Constant(0.1F))}};
    expect_second_part(scene, "a small box");
    EXPECT_GT(std::abs(scene.result.candidates[scene.result.chosen].shape.offset), 1.0F);
}

TEST(InARowSecond, AWayBackThatIsFreeIsFlown)
{
    InARow scene;
    expect_second_part(scene, "free");
    // 20 m to the main threat and 20 m back: a leg of exactly this length suffices, a shorter one does not.
    scene.problem.straight = 40.0F;
    EXPECT_EQ(scene.run_in_a_row(), PlanStatus::found);
    scene.problem.straight = std::nextafter(40.0F, 0.0F);
    EXPECT_EQ(scene.run_in_a_row(), PlanStatus::none_available);
    EXPECT_TRUE(scene.result.path.points.empty());
}

TEST(InARowSecond, NothingThatHasNoSizeIsGoneRound)
{
    InARow scene;
    scene.settings.extra_planes = 0;
    scene.settings.offsets = 2;        // one to the left and one to the right, as far out
    scene.problem.main_radius = 2.0F;  // so far that the main threat is behind
    const Vec3 there = on_way_back(scene, 0.5F);
    for (const float side : {-1.0F, 1.0F}) {
        scene.threats.push_back(Scene::still(Vec3(there.x(), side * there.y(), there.z()), 0.0F));
    }
    EXPECT_EQ(scene.run_in_a_row(), PlanStatus::none_available);
    EXPECT_FALSE(scene.result.candidates.empty()) << "those that were looked at are told";
    EXPECT_TRUE(scene.result.path.points.empty());
}

}  // namespace
}  // namespace jink::geometric
