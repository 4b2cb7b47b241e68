// SPDX-License-Identifier: BSD-3-Clause
// Candidates as they are flown and as a Planner makes them: their duration under limits, bounds of a flight's speed,
// when the start moves, and limits of tracks and work.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/path/timed_path.hpp"
#include "tests/unit/core/geometric/flight.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(FlightBorder, ClimbAndDescentTakeTheirTimeEach)
{
    Problem problem;
    problem.distance = 12.0F;
    problem.main_radius = 1.0F;
    struct Limits {
        float climb;
        float descent;
    };
    for (const Limits& of : {Limits{3.0F, 3.0F}, Limits{0.5F, 3.0F}, Limits{3.0F, 0.5F}, Limits{0.4F, 0.7F}}) {
        vehicle::VehicleLimits limits;
        limits.max_climb = of.climb;
        limits.max_descent = of.descent;
        for (const float offset : {-4.0F, 4.0F}) {
            const CandidateShape shape{Family::symmetric, 0.5F * kPi, offset};
            path::TimedPath path;
            ASSERT_TRUE(make_candidate_path(problem, shape, 25, limits, path));
            std::vector<Vec3> positions;
            for (const path::PathPoint& point : path.points) {
                positions.push_back(point.position);
            }
            path::TimedPath expected;
            ASSERT_TRUE(path::make_timed_path(positions, problem.speed, limits, expected));
            for (std::size_t i = 0; i < positions.size(); ++i) {
                ASSERT_NEAR(path.points[i].time, expected.points[i].time, 1e-3F) << i;
            }
        }
    }
}

/// Symmetric candidates, flown.
struct FlownScene : Scene {
    FlownScene()
    {
        settings.simple = false;
        settings.extra_planes = 0;
        settings.escape_from_margin = false;
    }
};

TEST(FlightBorder, OnlyWhatCanStandBrakesAtTheEnd)
{
    FlownScene scene;
    scene.obstacles = {{1, geometry::make_box(Vec3(43.0F, 0.0F, 50.0F), Vec3(1.0F, 60.0F, 60.0F))}};
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(scene.run(), PlanStatus::found);
}

TEST(FlightBorder, NoFlightIsFasterThanItsBound)
{
    // Faster aside than any candidate: something small is passed before its curve would ever come near.
    FlownScene aside;
    aside.settings.check_acceleration = false;
    aside.problem.start_velocity = Vec3(5.0F, 12.0F, 0.0F);
    ASSERT_EQ(aside.run(), PlanStatus::found);
    aside.threats.push_back(Scene::still(Vec3(4.6F, 9.0F, 50.0F), 0.1F));
    EXPECT_EQ(aside.run(), PlanStatus::none_available);
    EXPECT_EQ(aside.count(CandidateStatus::hits_static), aside.result.candidates.size());
}

/// A flight whose settings a test may change.
struct Leg : Flight {
    Settings settings;
    Result last;

    world::Track& add(const Vec3& position, float radius)
    {
        Flight::add(position, Vec3::Zero(), radius);
        return tracks.back();
    }
    PlanStatus plan()
    {
        Planner planned{settings};
        const PlanStatus status = planned.plan(situation(), budget, out);
        last = planned.last();
        return status;
    }
    /// Offsets of all candidates, in their order.
    std::vector<float> offsets()
    {
        static_cast<void>(plan());
        std::vector<float> all;
        for (const Candidate& candidate : last.candidates) {
            all.push_back(candidate.shape.offset);
        }
        return all;
    }
    std::size_t points() const { return out.path.points.size(); }
};

TEST(FlightBorder, AStandingVehiclesStartStaysWhereItIs)
{
    Leg leg;
    leg.add(Vec3(30.0F, 0.0F, 50.0F), 1.0F);
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), 26U) << "what is flown meanwhile comes first";
    EXPECT_EQ(leg.out.path.points[1].time, leg.rules.latency);
    leg.own.velocity = Vec3::Zero();
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), 25U);
    EXPECT_GT(leg.out.path.points[1].time, 0.0F);
    // The capacity is exhausted.
    leg.own.velocity = Vec3(5.0F, 0.0F, 0.0F);
    leg.settings.waypoints = kMaxPathPoints - 1;
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), kMaxPathPoints);
    leg.settings.waypoints = kMaxPathPoints;
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), kMaxPathPoints);
    EXPECT_EQ(leg.out.path.points[0].position, leg.own.position);
    for (std::size_t i = 0; i + 1 < leg.points(); ++i) {
        EXPECT_LT(leg.out.path.points[i].time, leg.out.path.points[i + 1].time);
    }
}

TEST(FlightBorder, TheStartIsNotMovedTooNear)
{
    // At least four times the travelled distance remain.
    Leg leg;
    leg.settings.check_acceleration = false;
    leg.settings.verify_flight = false;
    leg.rules.latency = 1.0F;
    leg.add(Vec3(22.0F, 0.0F, 50.0F), 0.5F);
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), 25U) << "the closest approach comes before the threat: less than 20 m are left after 5 m";
    leg.tracks[0].position.x() = 40.0F;
    ASSERT_EQ(leg.plan(), PlanStatus::found);
    EXPECT_EQ(leg.points(), 26U);
}

TEST(FlightBorder, ASlowStartIsNotMovedTooNearEither)
{
    // At least 2.5 R remain, also if four times the travelled distance is negligible.
    Leg leg;
    leg.settings.check_acceleration = leg.settings.verify_flight = false;
    leg.rules.latency = 0.2F;
    leg.own.velocity = Vec3(1.0F, 0.0F, 0.0F);
    leg.add(Vec3(0.0F, 0.0F, 50.0F), 4.0F);
    std::size_t moved = 0;
    std::size_t as_it_is = 0;
    for (float x = 9.5F; x < 13.0F; x += 0.05F) {
        leg.tracks[0].position.x() = x;
        if (leg.plan() != PlanStatus::found) {
            continue;
        }
        const bool is_moved = leg.out.path.points[1].time == leg.rules.latency;
        (is_moved ? moved : as_it_is) += 1;
        EXPECT_TRUE(as_it_is > 0 || !is_moved) << "the nearest that is planned for is not moved nearer";
    }
    EXPECT_GT(moved, 0U);
    EXPECT_GT(as_it_is, 0U);
    EXPECT_LE(as_it_is, 5U) << "no more of them than 0.2 m hold";
}

TEST(FlightBorder, ASmallBodyIsPlannedForAsTheLeastOne)
{
    Leg leg;
    leg.add(Vec3(30.0F, 0.0F, 50.0F), Planner::kMinMainRadius);
    const std::vector<float> least = leg.offsets();
    ASSERT_FALSE(least.empty());
    for (const float radius : {0.3F, 0.1F, 0.0F}) {
        leg.tracks[0].radius = radius;
        // The encounter is slightly later, so that curves are slightly longer and offsets slightly smaller.
        const std::vector<float> offsets = leg.offsets();
        ASSERT_EQ(offsets.size(), least.size());
        for (std::size_t i = 0; i < offsets.size(); ++i) {
            EXPECT_NEAR(offsets[i], least[i], 0.01F) << radius;
        }
    }
}

TEST(FlightBorder, AnObstacleThatIsASphereIsPassedAsATrackThatStands)
{
    Leg leg;
    leg.add(Vec3(30.0F, 0.5F, 50.0F), 1.5F);
    const std::vector<float> track = leg.offsets();
    leg.tracks.clear();
    leg.obstacles = {{1, geometry::make_sphere(Vec3(30.0F, 0.5F, 50.0F), 1.5F)}};
    const std::vector<float> sphere = leg.offsets();
    ASSERT_FALSE(track.empty());
    ASSERT_EQ(sphere.size(), track.size());
    for (std::size_t i = 0; i < sphere.size(); ++i) {
        EXPECT_NEAR(sphere[i], track[i], 1e-3F);
    }
}

TEST(FlightBorder, ATrackStampedAheadIsNotTakenForSmaller)
{
    // It comes from the side and grows; the set of available candidates never grows at a later stamp.
    std::size_t fewer = 0;
    for (float acceleration = 0.0F; acceleration < 2.0F; acceleration += 0.1F) {
        Leg leg;
        leg.settings.evaluate_all = true;
        leg.settings.retries = 0;
        leg.rules.latency = 0.0F;
        world::Track& track = leg.add(Vec3(30.0F, -24.0F, 50.0F), 0.5F);
        track.velocity = Vec3(0.0F, 4.0F, 0.0F);
        track.max_acceleration = acceleration;
        const auto available = [&] {
            const PlanStatus status = leg.plan();
            EXPECT_TRUE(status == PlanStatus::found || status == PlanStatus::none_available) << acceleration;
            return std::count_if(leg.last.candidates.begin(), leg.last.candidates.end(), [](const Candidate& c) {
                return c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
            });
        };
        const auto now = available();
        track.stamp = TimePoint{leg.now.us + 3'000'000};
        const auto ahead = available();
        EXPECT_LE(ahead, now) << acceleration;
        fewer += now < static_cast<std::ptrdiff_t>(leg.last.candidates.size()) ? 1U : 0U;
    }
    EXPECT_GT(fewer, 3U) << "it is in the way of some";
}

TEST(FlightBorder, AnUncertainThreatIsAsNearAsItsBody)
{
    Leg leg;
    world::Track& track = leg.add(Vec3(16.0F, 0.0F, 50.0F), 0.5F);
    track.sigma_position = 1.5F;
    EXPECT_NE(leg.plan(), PlanStatus::too_close);
}

TEST(FlightBorder, AsManyTracksAsThereIsRoomForAndNoMore)
{
    Leg leg;
    leg.add(Vec3(30.0F, 0.0F, 50.0F), 1.0F);
    while (leg.tracks.size() < kMaxTracks) {
        leg.add(Vec3(30.0F, 400.0F, 50.0F), 1.0F);
    }
    EXPECT_EQ(leg.plan(), PlanStatus::found);
    leg.add(Vec3(30.0F, 400.0F, 50.0F), 1.0F);
    EXPECT_EQ(leg.plan(), PlanStatus::bad_input);
}

TEST(FlightBorder, WithoutWorkNobodyKnowsThatThereIsNoConflict)
{
    Leg leg;
    leg.add(Vec3(30.0F, 0.0F, 50.0F), 1.0F);
    for (std::uint32_t units = 0; units < 60; ++units) {
        leg.budget = WorkBudget{units};
        EXPECT_EQ(leg.plan(), PlanStatus::budget_spent) << units;
    }
}

}  // namespace
}  // namespace jink::geometric
