// SPDX-License-Identifier: BSD-3-Clause
// The planner's problem for a situation: at the last number before it refuses, before it moves the start, and before a
// body counts as small.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/core/geometric/flight.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

float next_below(float x) { return std::nextafter(x, 0.0F); }

/// A static sphere `ahead` of a vehicle on a path with exact numbers: the collision point is its centre.
struct SphereAhead : Flight {
    explicit SphereAhead(float ahead)
    {
        limits.half_extents = Vec3::Constant(0.5F);
        limits.cruise_speed = reference.speed = 8.0F;
        own.velocity = Vec3(8.0F, 0.0F, 0.0F);
        obstacles = {{1, geometry::make_sphere(Vec3(ahead, 0.0F, 50.0F), 0.5F)}};
    }
    PlanStatus plan_unchecked(Seconds latency)
    {
        Settings settings;
        settings.check_acceleration = settings.verify_flight = false;
        rules.latency = latency;
        EXPECT_TRUE(planner.configure(settings));
        return plan();
    }
    bool begins_later() const { return out.path.points[1].time == rules.latency; }
};

TEST(PlanBorder, TwoAndAHalfRadiiAreNotTooClose)
{
    SphereAhead on_it(1.25F);
    EXPECT_NE(on_it.plan_unchecked(0.0F), PlanStatus::too_close);
    SphereAhead nearer(next_below(1.25F));
    EXPECT_EQ(nearer.plan_unchecked(0.0F), PlanStatus::too_close);
}

TEST(PlanBorder, TheStartIsMovedWhereFourTimesTheWayAreLeft)
{
    SphereAhead on_it(5.0F);
    ASSERT_EQ(on_it.plan_unchecked(0.125F), PlanStatus::found);
    EXPECT_TRUE(on_it.begins_later()) << "4 m are left after 1 m";
    SphereAhead nearer(next_below(5.0F));
    ASSERT_EQ(nearer.plan_unchecked(0.125F), PlanStatus::found);
    EXPECT_FALSE(nearer.begins_later());
}

TEST(PlanBorder, ASmallBodyIsTheLeastOneHoweverUncertain)
{
    const auto offsets = [](float body, float sigma) {
        Flight flight;
        flight.limits.half_extents = Vec3::Constant(0.1F);
        flight.add(Vec3(30.0F, 0.0F, 50.0F), Vec3::Zero(), body);
        flight.tracks[0].sigma_position = sigma;
        EXPECT_EQ(flight.plan(), PlanStatus::found);
        std::vector<float> all;
        for (const Candidate& c : flight.planner.last().candidates) {
            all.push_back(c.shape.offset);
        }
        return all;
    };
    // Both are 0.6 m large including their uncertainty; the offsets extend to 3.2 times the body.
    const std::vector<float> least = offsets(Planner::kMinMainRadius, 0.1F / 3.0F);
    const std::vector<float> small = offsets(0.1F, 0.5F / 3.0F);
    ASSERT_EQ(small.size(), least.size());
    for (std::size_t i = 0; i < small.size(); ++i) {
        EXPECT_NEAR(small[i], least[i], 1e-3F);
    }
}

TEST(PlanBorder, BadInputIsRefusedWhereThereIsNoConflict)
{
    Flight free;
    EXPECT_EQ(free.plan(), PlanStatus::no_conflict);
    Flight crowded;
    while (crowded.tracks.size() <= kMaxTracks) {
        crowded.add(Vec3(0.0F, 400.0F, 50.0F), Vec3::Zero(), 1.0F);
    }
    EXPECT_EQ(crowded.plan(), PlanStatus::bad_input);
    Flight without_route;
    const path::Route empty;
    without_route.reference = world::Reference(empty, without_route.reference.speed);
    EXPECT_EQ(without_route.plan(), PlanStatus::bad_input);
    Flight misset;
    Settings settings;
    settings.max_cost = 2.0F;
    misset.planner = Planner{settings};
    EXPECT_EQ(misset.plan(), PlanStatus::bad_input);
}

TEST(PlanBorder, WorkThatHasRunOutBeforeLeavesNothingKnown)
{
    Flight flight;
    flight.budget = WorkBudget{0};
    ASSERT_FALSE(flight.budget.spend());
    EXPECT_EQ(flight.plan(), PlanStatus::budget_spent);
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(200.0F, 0.0F, 50.0F)), path::RouteStatus::ok);
    flight.reference = world::Reference(route, flight.reference.speed);
    EXPECT_EQ(flight.plan(), PlanStatus::budget_spent);
}

/// A path begins at the vehicle's position, and the flight continues from its position after the latency. Along a route
/// both differ minimally: 2.5 R remain to the collision point, but not along the path to it.
TEST(PlanBorder, AStartAlongARouteIsMovedOrElseThreatsAreMetAsTheyAre)
{
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(25.0F, 0.0F, 50.0F)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(25.0F, 0.0F, 50.0F), Vec3(25.0F, 80.0F, 50.0F)), path::RouteStatus::ok);
    Settings settings;
    settings.check_acceleration = settings.verify_flight = false;
    settings.retries = 0;
    std::size_t moved = 0;
    std::size_t stays = 0;
    std::size_t changes = 0;
    bool before = false;
    for (float x = 10.94F; x < 10.96F; x += 2e-4F) {
        Flight flight;
        flight.reference = world::Reference(route, flight.reference.speed);
        flight.rules.latency = 1.0F;
        flight.own.velocity = Vec3(1.0F, 1.0F, 0.0F);
        flight.add(Vec3(x, 0.0F, 50.0F), Vec3::Zero(), 4.0F);
        ASSERT_TRUE(flight.planner.configure(settings));
        const PlanStatus status = flight.plan();
        if (status != PlanStatus::found) {
            continue;
        }
        const auto& points = flight.out.path.points;
        ASSERT_EQ(points[0].position, flight.own.position);
        const bool is_moved = points.size() == flight.planner.last().path.points.size() + 1;
        changes += is_moved != before ? 1U : 0U;
        before = is_moved;
        (is_moved ? moved : stays) += 1;
        if (is_moved) {
            const Vec3 then = flight.own.position + flight.rules.latency * flight.own.velocity;
            ASSERT_LT((points[1].position - then).norm(), 1e-4F) << x;
        }
    }
    EXPECT_GT(moved, 0U);
    EXPECT_GT(stays, 0U);
    EXPECT_EQ(changes, 1U);
}

}  // namespace
}  // namespace jink::geometric
