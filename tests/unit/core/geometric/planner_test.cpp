// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/oracle/route_oracle.hpp"
#include "tests/unit/core/geometric/flight.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(Planner, HeadOnTrafficIsPassed)
{
    Flight flight;
    flight.add(Vec3(60.0F, 0.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    const world::Manoeuvre& m = flight.out;
    EXPECT_EQ(m.kind, world::ManoeuvreKind::follow_path);
    EXPECT_EQ(m.start, flight.now);
    EXPECT_NEAR(m.valid_until - m.start, m.path.duration(), 1e-4F);
    EXPECT_NEAR(m.side.norm(), 1.0F, 1e-4F);
    EXPECT_NEAR(m.side.x(), 0.0F, 1e-5F);
    EXPECT_GT(m.cost, 0.0F);
    EXPECT_LE(m.cost, 1.0F);
    EXPECT_EQ(m.path.points.front().position, flight.own.position);
    EXPECT_GE(world::least_separation(flight.situation(), m.path, 100.0F, flight.budget).margin, 0.0F);
}

TEST(Planner, UncertainTrackIsGivenMoreRoom)
{
    Flight flight;
    flight.add(Vec3(60.0F, 0.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    const float sure = std::abs(flight.planner.last().candidates[flight.planner.last().chosen].shape.offset);
    flight.tracks[0].sigma_position = 0.3F;
    flight.tracks[0].sigma_velocity = 0.1F;
    flight.tracks[0].max_acceleration = 0.02F;
    flight.own.sigma_position = 0.2F;
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GT(std::abs(flight.planner.last().candidates[flight.planner.last().chosen].shape.offset), sure + 1.0F);
    EXPECT_GE(world::least_separation(flight.situation(), flight.out.path, 100.0F, flight.budget).margin, 0.0F);
}

/// What is uncertain of a solid, or of a track's height, is passed by as much more, at the first attempt.
TEST(Planner, UncertainSolidsAndHeightsArePassedCloseBy)
{
    const auto widest = [](Flight& flight) {
        float widest = 0.0F;
        EXPECT_EQ(flight.plan(), PlanStatus::found);
        EXPECT_EQ(flight.planner.last().attempt, 0U);
        for (const path::PathPoint& p : flight.out.path.points) {
            widest = std::max(widest, Vec3(0.0F, p.position.y(), p.position.z() - 50.0F).norm());
        }
        return widest;
    };
    float sure = 0.0F;
    for (const float uncertainty : {0.0F, 0.1F, 0.3F, 0.6F}) {
        Flight flight;
        flight.obstacles = {{1, geometry::make_box(Vec3(25.0F, 0.0F, 50.0F), Vec3(1.0F, 1.5F, 1.5F)), uncertainty}};
        const float width = widest(flight);
        sure = uncertainty == 0.0F ? width : sure;
        EXPECT_LT(width, sure + 2.0F * uncertainty + 0.01F) << uncertainty;
    }
    for (const float half_height : {0.0F, 1.2F, 2.4F}) {
        Flight flight;
        flight.add(Vec3(25.0F, 0.0F, 50.0F), Vec3::Zero(), 1.0F);
        flight.tracks[0].half_height = half_height;
        // Over or under it alone.
        flight.obstacles = {{1, geometry::make_box(Vec3(25.0F, 6.6F, 50.0F), Vec3(40.0F, 4.0F, 40.0F))},
                            {2, geometry::make_box(Vec3(25.0F, -6.6F, 50.0F), Vec3(40.0F, 4.0F, 40.0F))}};
        const float width = widest(flight);
        sure = half_height == 0.0F ? width : sure;
        EXPECT_LT(width, sure + 1.5F * half_height + 0.01F) << half_height;
    }
}

TEST(Planner, TreeInTheWay)
{
    Flight flight;
    flight.obstacles = {{1, geometry::make_capsule(Vec3(30.0F, 0.5F, 0.0F), Vec3(30.0F, 0.5F, 70.0F), 1.0F)}};
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_LT(flight.out.side.y(), -0.5F);  // the tree is half a metre to the left
}

TEST(Planner, WallIsFlownOver)
{
    Flight flight;
    flight.obstacles = {{1, geometry::make_box(Vec3(40.0F, 0.0F, 40.0F), Vec3(0.5F, 40.0F, 12.0F))}};
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GT(flight.out.side.z(), 0.5F);
}

/// Bounds are kept as early as the own position is uncertain: no plan that the final check refuses for them.
TEST(Planner, BoundsAreKeptWithOwnUncertainty)
{
    int found = 0;
    for (int i = 0; i < 60; ++i) {
        Flight flight;
        flight.own.sigma_position = 0.4F;
        flight.airspace.has_ceiling = true;
        flight.airspace.ceiling = 53.0F + 0.1F * static_cast<float>(i);
        flight.airspace.has_floor = true;
        flight.airspace.floor = 48.0F - 0.1F * static_cast<float>(i);
        flight.airspace.has_keep_in = true;
        flight.airspace.keep_in_radius = 62.0F + 0.1F * static_cast<float>(i);
        flight.obstacles = {{1, geometry::make_sphere(Vec3(30.0F, 0.0F, 50.0F), 1.0F)}};
        if (flight.plan() == PlanStatus::found) {
            ++found;
            WorkBudget budget(1'000'000);
            ASSERT_GE(world::least_separation(flight.situation(), flight.out.path, 100.0F, budget).margin, -1e-3F)
                << "case " << i;
        }
    }
    EXPECT_GT(found, 5);
}

TEST(Planner, ConfigureRefusesWhatIsOutOfRange)
{
    Planner planner{Settings{}};
    Settings settings;
    settings.extra_planes = 5;
    EXPECT_TRUE(planner.configure(settings));
    settings.waypoints = 3;
    EXPECT_FALSE(planner.configure(settings));
    EXPECT_EQ(planner.settings().extra_planes, 5);
    EXPECT_EQ(planner.settings().waypoints, 25);
}

TEST(Planner, KeepsToTheSideBeingFlown)
{
    Flight flight;
    flight.add(Vec3(40.0F, 0.0F, 50.0F), Vec3::Zero(), 1.0F);
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    world::Manoeuvre flown = flight.out;
    for (const float side : {1.0F, -1.0F}) {
        flown.side = side * Vec3::UnitY();
        flight.flying = &flown;
        ASSERT_EQ(flight.plan(), PlanStatus::found);
        EXPECT_GT(flight.out.side.dot(flown.side), 0.9F);
    }
}

TEST(PlannerRetry, AWallOfSphereoonsHasItsGapFurtherOut)
{
    Flight flight;
    for (int y = -2; y <= 2; ++y) {
        for (int z = -1; z <= 1; ++z) {
            flight.add(Vec3(45.0F, 4.0F * static_cast<float>(y), 50.0F + 4.0F * static_cast<float>(z)), Vec3::Zero(),
                       1.5F);
        }
    }
    Settings settings;
    settings.retries = 0;
    ASSERT_TRUE(flight.planner.configure(settings));
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
    settings.retries = 4;
    ASSERT_TRUE(flight.planner.configure(settings));
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GE(world::least_separation(flight.situation(), flight.out.path, 100.0F, flight.budget).margin, 0.0F);
    // With Pinheiro's settings the offsets are unchanged.
    Settings source = source_settings();
    source.retries = 4;
    ASSERT_TRUE(flight.planner.configure(source));
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
}

TEST(PlannerRetry, SlowerFlightTurnsWhereFastFlightCannot)
{
    Flight flight;
    flight.limits.max_acceleration = 1.5F;
    flight.limits.max_vertical_acceleration = 0.5F;
    flight.add(Vec3(14.0F, 0.0F, 50.0F), Vec3::Zero(), 1.0F);
    Settings settings;
    settings.retries = 0;
    ASSERT_TRUE(flight.planner.configure(settings));
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
    settings.retries = 1;
    ASSERT_TRUE(flight.planner.configure(settings));
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_LT(flight.out.path.points[12].velocity.norm(), 3.1F);
    flight.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
}

/// An avenue of balloons about the leg, under a ceiling, that something crosses.
Flight avenue()
{
    Flight flight;
    for (int i = 0; i < 13; ++i) {
        for (const float side : {-1.0F, 1.0F}) {
            flight.add(Vec3(3.0F + 3.0F * static_cast<float>(i), 3.6F * side, 50.0F), Vec3::Zero(), 2.0F);
        }
    }
    flight.airspace.has_ceiling = flight.airspace.has_floor = true;
    flight.airspace.ceiling = 52.0F;
    flight.airspace.floor = 48.0F;
    flight.add(Vec3(25.0F, -10.0F, 50.0F), Vec3(0.0F, 2.0F, 0.0F), 1.0F);
    return flight;
}

TEST(PlannerRetry, InAnAvenueWhatCrossesIsWaitedFor)
{
    Flight flight = avenue();
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    const Candidate& chosen = flight.planner.last().candidates[flight.planner.last().chosen];
    EXPECT_EQ(chosen.shape.family, Family::wait);
    EXPECT_EQ(kAttempts[flight.planner.last().attempt].kind, Attempt::Kind::wait);
    EXPECT_EQ(flight.out.side, Vec3::Zero()) << "no side: nothing to keep to";
    float slowest = 5.0F;
    for (const path::PathPoint& point : flight.out.path.points) {
        EXPECT_NEAR(point.position.y(), 0.0F, 1e-4F);
        EXPECT_NEAR(point.position.z(), 50.0F, 1e-4F);
        EXPECT_LE(point.velocity.norm(), 5.0F + 1e-3F);
        slowest = std::min(slowest, point.velocity.norm());
    }
    EXPECT_LT(slowest, 3.1F);
    EXPECT_NEAR(flight.out.path.points.back().velocity.norm(), 5.0F, 0.05F) << "and on";
    EXPECT_GE(world::least_separation(flight.situation(), flight.out.path, 100.0F, flight.budget).margin, 0.0F);
}

TEST(PlannerRetry, WhatStandsIsNotWaitedForAndFixedWingsDoNotWait)
{
    Flight standing = avenue();
    standing.tracks.back().velocity = Vec3::Zero();
    standing.tracks.back().position.y() = 0.0F;
    EXPECT_EQ(standing.plan(), PlanStatus::none_available);
    Flight winged = avenue();
    winged.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(winged.plan(), PlanStatus::none_available);
}

TEST(PlannerRetry, ALongHouseIsClimbedOverFirst)
{
    Flight flight;
    flight.obstacles = {{1, geometry::make_box(Vec3(38.0F, 0.0F, 27.0F), Vec3(14.0F, 60.0F, 27.0F))}};
    flight.airspace.has_ceiling = true;
    flight.airspace.ceiling = 57.0F;
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    const Candidate& chosen = flight.planner.last().candidates[flight.planner.last().chosen];
    EXPECT_EQ(chosen.shape.family, Family::plateau);
    EXPECT_GT(flight.out.side.z(), 0.5F);
    EXPECT_GE(world::least_separation(flight.situation(), flight.out.path, 100.0F, flight.budget).margin, -0.06F);
}

TEST(PlannerRetry, AnEndFurtherOutMakesCurvesGentler)
{
    Flight flight;
    flight.limits.max_acceleration = 0.8F;
    flight.limits.max_vertical_acceleration = 0.5F;
    flight.limits.kind = vehicle::VehicleKind::fixed_wing;  // does not fly slower
    flight.add(Vec3(20.0F, 0.0F, 50.0F), Vec3::Zero(), 1.5F);
    Settings settings;
    settings.retries = 1;
    ASSERT_TRUE(flight.planner.configure(settings));
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
    settings.retries = 2;
    ASSERT_TRUE(flight.planner.configure(settings));
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GT(flight.planner.last().candidates[flight.planner.last().chosen].duration, 1.4F * 30.0F / 5.0F);
}

TEST(Planner, SmallThreatsArePlannedForAsIfHalfAMetre)
{
    Flight flight;
    flight.add(Vec3(40.0F, 0.0F, 50.0F), Vec3::Zero(), 0.01F);
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GT(std::abs(flight.planner.last().candidates[flight.planner.last().chosen].shape.offset), 1.5F);
}

TEST(Planner, AnyBudgetIsAnsweredOrSpentAlongALegAndARoute)
{
    // Solids near the nominal path, none of which blocks it: the search for conflicts may run out of work units before
    // it finds a conflict.
    oracle::TwinRoute bent;
    ASSERT_TRUE(bent.leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(25.0F, 0.0F, 50.0F)));
    ASSERT_TRUE(bent.leg(Vec3(25.0F, 0.0F, 50.0F), Vec3(25.0F, 60.0F, 50.0F)));
    for (const bool bends : {false, true}) {
        Flight flight;
        if (bends) {
            flight.reference = world::Reference(bent.route, flight.reference.speed);
        }
        flight.airspace.has_floor = true;
        for (int i = 0; i < 6; ++i) {
            const Vec3 beside(4.0F + 4.0F * static_cast<float>(i), 2.6F, 50.0F);
            flight.obstacles.push_back({static_cast<world::ObstacleId>(i), geometry::make_box(beside, Vec3::Ones())});
        }
        WorkBudget plenty(1'000'000);
        const PlanStatus answer = flight.planner.plan(flight.situation(), plenty, flight.out);
        for (std::uint32_t units = 0; units < plenty.spent(); ++units) {
            WorkBudget budget(units);
            const PlanStatus status = flight.planner.plan(flight.situation(), budget, flight.out);
            // A solid at which the search ran out counts as a conflict now.
            ASSERT_TRUE(status == PlanStatus::budget_spent || status == PlanStatus::too_close || status == answer)
                << units;
        }
    }
}

}  // namespace
}  // namespace jink::geometric
