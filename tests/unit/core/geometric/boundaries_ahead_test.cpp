// SPDX-License-Identifier: BSD-3-Clause
// The nominal path ahead of a manoeuvre, straight or a route: refusals, start of a route, and its cost.
#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Straight on along the leg of a scene that begins at (0, 0, 50), from 10 m on.
path::Route straight_route()
{
    path::Route route;
    EXPECT_EQ(route.add_leg(Vec3(10.0F, 0.0F, 50.0F), Vec3(400.0F, 0.0F, 50.0F)), path::RouteStatus::ok);
    return route;
}

/// By both functions that check it.
bool is_refused(Scene& scene)
{
    path::TimedPath path;
    const bool made = make_candidate_path(scene.problem, {Family::symmetric, 0.0F, 3.0F}, 25, scene.limits, path);
    const bool bad = scene.run() == PlanStatus::bad_input;
    EXPECT_NE(made, bad);
    EXPECT_EQ(path.points.empty(), bad);
    return bad;
}

TEST(AheadBorder, ARouteHasSegmentsAndIsReachedSomewhere)
{
    const path::Route route = straight_route();
    Scene scene;
    scene.problem.ahead = {route, 10.0F, 0.0F};
    EXPECT_FALSE(is_refused(scene));
    scene.problem.ahead.straight = 0.0F;
    EXPECT_FALSE(is_refused(scene));
    for (const float wrong : {-1.0F, -1e-30F, kNan, kInfinity}) {
        scene.problem.ahead = {route, wrong, 0.0F};
        EXPECT_TRUE(is_refused(scene)) << wrong;
        scene.problem.ahead = {route, 10.0F, wrong};
        EXPECT_TRUE(is_refused(scene)) << wrong;
        scene.problem.ahead = {{}, wrong, wrong};
        EXPECT_FALSE(is_refused(scene)) << "without a route nobody asks";
    }
}

TEST(AheadBorder, ALegGoesOnForSomeWayOrNone)
{
    for (const float wrong : {-1.0F, -1e-30F, kNan, -kInfinity}) {
        Scene scene;
        scene.problem.straight = wrong;
        EXPECT_TRUE(is_refused(scene)) << wrong;
    }
    for (const float right : {0.0F, 1.0F, kInfinity}) {
        Scene scene;
        scene.problem.straight = right;
        EXPECT_FALSE(is_refused(scene)) << right;
    }
}

TEST(AheadBorder, AManoeuvreBeginsNowOrLater)
{
    for (const float wrong : {-1.0F, -1e-30F, kNan, kInfinity}) {
        Scene scene;
        scene.problem.begins = wrong;
        EXPECT_TRUE(is_refused(scene)) << wrong;
    }
    Scene scene;
    EXPECT_FALSE(is_refused(scene));
    scene.problem.begins = 3.0F;
    EXPECT_FALSE(is_refused(scene));
}

/// Two level candidates beside a leg of 60 m, or beside a route that is as straight.
Scene beside(const path::RouteView& route, std::uint16_t waypoints)
{
    Scene scene = two_level_candidates(3.0F);
    scene.settings.waypoints = waypoints;
    scene.problem.ahead = {route, 10.0F, 0.0F};
    return scene;
}

TEST(AheadBorder, EachPointAlongARouteCostsMore)
{
    const path::Route route = straight_route();
    const auto more = [&](std::uint16_t waypoints) {
        std::uint32_t spent[2] = {};
        for (const bool along : {false, true}) {
            Scene scene = beside(along ? path::RouteView(route) : path::RouteView(), waypoints);
            EXPECT_EQ(scene.run(), PlanStatus::found);
            spent[along] = scene.budget.spent();
        }
        return spent[1] - spent[0];
    };
    // Of both candidates, and of the chosen one when it is made once more.
    EXPECT_EQ(more(20), units::kRoute + 3 * 20 * units::kRoutePoint);
    EXPECT_EQ(more(40), units::kRoute + 3 * 40 * units::kRoutePoint);
}

TEST(AheadBorder, AlongARouteChecksGetOneShareMore)
{
    const path::Route route = straight_route();
    const auto least = [&](const path::RouteView& along) {
        std::uint32_t units = 0;
        for (PlanStatus status = PlanStatus::none_available; status != PlanStatus::found && units < 5'000; ++units) {
            Scene scene = beside(along, 25);
            scene.settings.verify_flight = true;
            scene.settings.check_units = units;
            status = scene.run();
        }
        return units;
    };
    const std::uint32_t straight = least({});
    EXPECT_GT(straight, 100U);
    EXPECT_LT(least(route), 3 * straight / 4);
}

}  // namespace
}  // namespace jink::geometric
