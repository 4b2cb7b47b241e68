// SPDX-License-Identifier: BSD-3-Clause
// The planner's header and notes, sentence by sentence: the filter's settings, and refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/oracle/hull_obstacles.hpp"
#include "tests/unit/core/orca/orca_input.hpp"

namespace jink::orca {
namespace {

using test::OrcaInput;
using world::PlanStatus;

/// The radius of the conflict region of the own vehicle and a track of 1 m: it holds the cylinder of both.
constexpr float kKept = 1.41421356F * (1.41421356F + 1.0F);

/// A vehicle that wants to stay where it is.
class OrcaHover : public OrcaInput {
protected:
    OrcaHover() { hover(); }
    void hover() { scene.leg(scene.own.position - Vec3(100, 0, 0), scene.own.position, 5.0F); }
    /// The fence lies 1 m behind: it is pushed to the east at 0.3 m/s.
    void push_east()
    {
        scene.airspace.has_keep_in = true;
        scene.airspace.home = Vec3(100, 0, 0);
        scene.airspace.keep_in_radius = 100.0F + kHalfWidth - 1.0F;
    }
    bool gives_conflict_way()
    {
        static_cast<void>(command());
        return (planner.last().status & kRelaxedConflict) != 0;
    }
};

// --- the own cylinder ---

TEST_F(OrcaInput, TheCylinderHoldsTheCornersOfALongBox)
{
    for (const Vec3& half : {Vec3(1.2F, 0.5F, 1.0F), Vec3(0.5F, 1.2F, 1.0F)}) {
        scene.limits.half_extents = half;  // its corners are 1.3 m off
        scene.cylinder(world::Vec2(10.0F + 1.3F + 1.2F, 0), 10.0F).top = 60.0F;
        EXPECT_NEAR(command().x(), 1.2F, 1e-3F);
        scene.cylinders.clear();
        scene.airspace.cylinders = {};
        scene.obstacle(geometry::make_box(Vec3(5, 0, 30), Vec3(1, 50, 50)));
        static_cast<void>(command());
        EXPECT_NEAR(planner.last().margin, 4.0F - 1.41421356F * 1.3F, 1e-3F);
        scene.obstacles.clear();
        scene.track(Vec3(30, 0, 30), Vec3::Zero());
        EXPECT_NEAR(nearest(), 30.0F / (1.41421356F * 2.3F), 1e-3F);
        scene.tracks.clear();
    }
}

TEST_F(OrcaInput, ATallBoxIsHeldInHeight)
{
    scene.limits.half_extents = Vec3(1, 1, 1.5F);
    scene.track(Vec3(0, 0, 60), Vec3::Zero());
    // Heights count (1.414 + 1) / (1.5 + 1) times.
    EXPECT_NEAR(nearest(), 30.0F / (1.41421356F * 2.5F), 1e-3F);
    scene.tracks.clear();
    scene.obstacle(geometry::make_box(Vec3(0, 0, 35), Vec3(50, 50, 1)));
    static_cast<void>(command());
    EXPECT_NEAR(planner.last().margin, (4.0F - 1.41421356F * 1.5F) * kHalfWidth / 1.5F, 1e-3F);
}

// --- bounds ---

/// The obstacle horizon: the largest of braking, the delay and a second.
TEST_F(OrcaInput, ABoundIsMetNoSoonerThanBrakingAndTheDelayNeed)
{
    scene.airspace.has_floor = true;
    scene.airspace.floor = 30.0F - 1.0F - 0.4F;
    towards(Vec3(0, 0, -1), 2.0F);
    scene.limits.max_acceleration = 2.5F;
    EXPECT_NEAR(command().z(), -0.4F / 2.0F, 1e-3F) << "2 s of braking";
    scene.limits.max_acceleration = 50.0F;
    EXPECT_NEAR(command().z(), -0.4F, 1e-3F) << "a second at least";
    scene.rules.latency = 0.75F;
    EXPECT_NEAR(command().z(), -0.4F / 2.72F, 1e-3F) << "e times a delay of 1 s";
    scene.limits.velocity_lag = 0.5F;
    EXPECT_NEAR(command().z(), -0.4F / (2.72F * 1.25F), 1e-3F);
}

TEST_F(OrcaInput, ACylinderThatMovesIsMetInItsOwnDirection)
{
    scene.cylinder(0.8F * world::Vec2(12, 9), 10.0F).top = 60.0F;  // 12 m off
    scene.cylinders[0].velocity = world::Vec2(-0.4F, -0.3F);
    towards(Vec3(0.8F, 0.6F, 0));
    const float gap = 12.0F - 0.05F - 10.0F - kHalfWidth;
    EXPECT_NEAR(command().norm(), gap - 0.5F, 1e-3F);
    scene.cylinders[0].velocity = world::Vec2(0, -0.5F);
    // Its centre is at (9.6, 7.15) when the command acts.
    const float off = std::hypot(9.6F, 7.15F);
    const float closing = 0.5F * 7.15F / off;
    EXPECT_NEAR(command().dot(Vec3(9.6F, 7.15F, 0)) / off, off - 10.0F - kHalfWidth - closing, 1e-3F);
    scene.cylinders[0].velocity = world::Vec2(0.3F, -0.4F);
    EXPECT_NEAR(command().norm(), 12.0F - 10.0F - kHalfWidth, 2e-2F) << "sideways it comes no nearer";
}

/// Beside a cylinder's edge above it or below it, the face counts that is farther off.
TEST_F(OrcaInput, OfACylinderTheFaceAboveOrBelowCountsBySide)
{
    scene.cylinder(world::Vec2(0, 0), 50.0F);
    scene.cylinders[0].bottom = 30.0F + 1.0F + 0.6F;
    scene.cylinders[0].top = 31.8F;  // above() is far below zero
    towards(Vec3(0, 0, 1), 2.0F);
    EXPECT_NEAR(command().z(), 0.6F, 1e-3F);
    scene.cylinders[0].top = 30.0F - 1.0F - 0.6F;
    scene.cylinders[0].bottom = 28.2F;
    towards(Vec3(0, 0, -1), 2.0F);
    EXPECT_NEAR(command().z(), -0.6F, 1e-3F);
    // The motion of the vertical side does not affect the level faces.
    scene.cylinders[0].velocity = world::Vec2(20, 0);
    EXPECT_NEAR(command().z(), -0.6F, 1e-3F);
}

/// A vehicle that can hardly move still has settings to stop with: 0.05 m/s is the least top speed.
TEST_F(OrcaInput, ASlowVehicleIsStillPushedOutOfABound)
{
    scene.limits.cruise_speed = 0.02F;
    scene.airspace.has_floor = true;
    scene.airspace.floor = 31.0F;
    towards(Vec3(1, 0, 0), 0.02F);
    EXPECT_NEAR(command().z(), 0.05F, 1e-3F);
}

// --- settings for pairs ---

TEST_F(OrcaInput, TheConflictRegionIsTheCylindersWhateverItsShare)
{
    scene.track(Vec3(30, 0, 30), Vec3::Zero());
    for (const float ratio : {0.5F, 0.7F, 0.95F}) {
        settings.conflict_ratio = ratio;
        EXPECT_NEAR(nearest(), 30.0F / kKept, 1e-3F) << ratio;
    }
}

/// The warning region is larger by the same amount: within it a static vehicle must move away.
TEST_F(OrcaHover, WithinTheWarningRegionItGoesOff)
{
    world::Track& track = scene.track(Vec3(kKept / 0.8F - 0.1F, 0, 30), Vec3::Zero());
    EXPECT_LT(command().x(), -0.02F);
    track.position.x() = kKept / 0.8F + 0.1F;
    EXPECT_NEAR(command().norm(), 0.0F, 1e-3F);
    settings.conflict_ratio = 0.6F;
    EXPECT_LT(command().x(), -0.02F) << "the smaller the share the wider it is";
}

/// At the conflict region's rim the whole separating speed is demanded, half of it where the reaction is shared.
TEST_F(OrcaHover, TheSeparatingSpeedIsWhatTheDelayAndTheAccelerationBear)
{
    world::Track& track = scene.track(Vec3(kKept, 0, 30), Vec3::Zero());
    EXPECT_NEAR(command().x(), -0.3F, 1e-3F) << "0.3 m/s at most";
    track.cooperative = true;
    EXPECT_NEAR(command().x(), -0.15F, 1e-3F);
    track.cooperative = false;
    // Between both regions of two like it, 4 m apart at least: 0.05 of 4 m over 0.95, in e times 0.35 s.
    settings.conflict_ratio = 0.95F;
    EXPECT_NEAR(command().x(), -0.05F * 4.0F / 0.95F / (2.7182818F * 0.35F), 1e-3F);
    scene.limits.max_acceleration = 0.2F;
    EXPECT_NEAR(command().x(), -0.1F, 1e-3F) << "no more than half a second's acceleration";
    settings.reach = 5.0F;
    EXPECT_NEAR(command().x(), -0.2F, 1e-3F) << "nor than a second's";
}

/// Neither closes in faster than both can undo: half of the gap in the time of braking or e times the delay.
TEST_F(OrcaHover, ThePairsBrakingTimeIsWhatBrakingAndTheDelayNeed)
{
    push_east();
    scene.track(Vec3(kKept, 0, 30), Vec3::Zero()).cooperative = true;
    const auto from = [&](float gap) {
        scene.tracks[0].position.x() = kKept + gap;
        return gives_conflict_way();
    };
    EXPECT_TRUE(from(0.59F)) << "a second: at 0.3 m/s half of it is 0.3 m";
    EXPECT_FALSE(from(0.61F));
    scene.limits.max_acceleration = 2.5F;
    EXPECT_TRUE(from(1.19F)) << "2 s of braking";
    EXPECT_FALSE(from(1.21F));
    scene.limits.max_acceleration = 5.0F;
    scene.rules.latency = 0.75F;
    EXPECT_TRUE(from(0.6F * 2.72F - 0.01F)) << "e times 1 s";
    EXPECT_FALSE(from(0.6F * 2.72F + 0.01F));
    settings.conflict = Conflict::present;
    EXPECT_TRUE(from(2.0F)) << "half of the gap within the whole horizon";
}

/// Within the conflict region it is left in a second, or e times the delay.
TEST_F(OrcaHover, TheConflictRegionIsLeftNoFasterThanTheDelayBears)
{
    scene.limits.max_acceleration = 5.0F;
    world::Track& track = scene.track(Vec3(kKept - 0.4F, 0, 30), Vec3::Zero());
    // The warning region's own demand is 0.3 m/s: a wall shows which of the two yields.
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(100, 0, 0);
    const auto broken = [&] {
        scene.airspace.keep_in_radius = 100.0F + kHalfWidth;  // it may not go back
        static_cast<void>(command());
        return planner.last().broken[2];
    };
    EXPECT_NEAR(broken(), 0.3F, 2e-3F);
    scene.rules.latency = 0.75F;
    EXPECT_NEAR(broken(), 0.4F / 2.72F, 2e-3F);
    scene.rules.latency = 0.1F;
    track.position.x() = kKept - 0.2F;
    EXPECT_NEAR(broken(), 0.2F, 2e-3F) << "a second";
}

TEST_F(OrcaHover, CoincidentVehiclesPartByTheirIds)
{
    scene.track(scene.own.position, Vec3::Zero());  // id 1
    scene.own_id = 7;
    EXPECT_LT(command().z(), -0.1F);
    scene.own_id = 0;
    EXPECT_GT(command().z(), 0.1F) << "the smaller id climbs";
}

TEST_F(OrcaInput, TheBiasIsThatOfTheSettings)
{
    scene.own.velocity = Vec3(5, 0, 0);
    // The track flies ahead at the same speed: no further constraint.
    world::Track& track = scene.track(Vec3(14.9F, 0, 30), Vec3(5, 0, 0));
    EXPECT_NEAR(command().y(), -0.25F, 1e-3F) << "0.05 of the speed to the right";
    track.position.x() = 15.1F;
    EXPECT_NEAR(command().y(), 0.0F, 1e-4F) << "15 m are near";
    settings.bias.near = 20.0F;
    settings.bias.sideways = 0.1F;
    EXPECT_NEAR(command().y(), -0.5F, 5e-3F);
}

// --- previous commands ---

/// Commands act after the latency and are followed with the lag of the velocity loop.
TEST_F(OrcaInput, CommandsOnTheirWayAreFollowedWithTheLoopsLag)
{
    scene.rules.latency = 0.4F;
    planner = Planner(settings);
    scene.track(Vec3(0, 60, 30), Vec3::Zero());
    world::Commanded sent{Vec3(0, 4, 0), scene.now - 0.3F};
    scene.commanded = &sent;
    ASSERT_EQ(plan(), PlanStatus::found);
    const float before = planner.last().nearest;
    step(0.1F);
    ASSERT_EQ(plan(), PlanStatus::found);
    const float way = 4.0F * (0.4F - 0.25F * (1.0F - std::exp(-0.4F / 0.25F)));
    EXPECT_NEAR((before - planner.last().nearest) * kKept, way, 3e-3F);
}

TEST_F(OrcaInput, CommandsAreTheMeanOfTheLast)
{
    for (const std::uint16_t smoothing : {std::uint16_t{1}, std::uint16_t{2}}) {
        settings.smoothing = smoothing;
        planner = Planner(settings);
        world::Commanded sent;
        scene.commanded = &sent;
        scene.own.velocity = Vec3::Zero();
        ASSERT_EQ(plan(), PlanStatus::found);
        EXPECT_NEAR(out.command.x(), 2.5F, 1e-3F);
        step(0.1F);
        sent = {out.command, scene.now};
        scene.own.velocity = Vec3(2.5F, 0, 0);
        ASSERT_EQ(plan(), PlanStatus::found);
        EXPECT_NEAR(out.command.x(), smoothing == 1 ? 5.0F : (2.5F + 2.0F * 5.0F) / 3.0F, 1e-3F);
    }
}

/// A pause is no time in which the vehicle was blocked.
TEST_F(OrcaInput, APauseCountsAsHalfASecond)
{
    scene.airspace.has_keep_in = true;  // no path ahead
    scene.airspace.home = Vec3(-100, 0, 0);
    scene.airspace.keep_in_radius = 100.0F + kHalfWidth;
    ASSERT_EQ(plan(), PlanStatus::found);
    step(20.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(planner.last().status & kBlocked, 0U);
    world::Commanded sent;
    scene.commanded = &sent;
    int plans = 0;
    for (PlanStatus status = PlanStatus::found; status == PlanStatus::found && plans < 100; ++plans) {
        step(0.5F);
        sent = {out.command, scene.now};
        status = plan();
    }
    EXPECT_NE(planner.last().status & kBlocked, 0U);
    EXPECT_NEAR(static_cast<float>(plans), 10.0F, 1.0F) << "5 s";
}

/// Before there were two plans a tick is 20 ms.
TEST_F(OrcaInput, TheFirstPlanCountsAsTwentyMilliseconds)
{
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(-100, 0, 0);
    scene.airspace.keep_in_radius = 100.0F + kHalfWidth;
    settings.bias.blocked = 0.019F;
    planner = Planner(settings);
    EXPECT_EQ(plan(), PlanStatus::none_available);
    settings.bias.blocked = 0.021F;
    planner = Planner(settings);
    EXPECT_EQ(plan(), PlanStatus::found);
}

// --- no answer ---

/// The limits of flight are never given up: a wing that would have to fly slower than it can has no answer.
TEST_F(OrcaInput, AWingAmongTooManyObstaclesKeepsItsLeastSpeed)
{
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    scene.own.velocity = Vec3(5, 0, 0);
    ASSERT_EQ(plan(), PlanStatus::found);
    // More obstacles about it than half-spaces: the speed is capped for the rest.
    for (std::size_t i = 0; i < kMaxObstaclePlanes + 1; ++i) {
        const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(kMaxObstaclePlanes + 1);
        const Vec3 at(3.5F * std::cos(angle), 3.5F * std::sin(angle), 30.0F);
        scene.obstacle(geometry::make_sphere(at, 0.1F));
    }
    EXPECT_EQ(plan(), PlanStatus::found);
    EXPECT_NE(planner.last().status & kCapBroken, 0U) << "and says that this is too fast for the rest";
    EXPECT_EQ(planner.last().status & kInfeasibleDynamics, 0U);
    const float flown = out.command.norm();
    EXPECT_GE(flown, 0.9F * scene.limits.cruise_speed - 1e-3F);
    scene.limits.kind = vehicle::VehicleKind::multirotor;
    planner = Planner(settings);
    EXPECT_EQ(plan(), PlanStatus::found);
    EXPECT_LT(out.command.norm(), flown) << "a multirotor slows down";
}

/// Wherever the budget runs out - among bounds, obstacles, hulls, tracks, programs, or along the command -
/// nothing is found.
TEST_F(OrcaInput, ABudgetThatRunsOutAmongObstaclesIsNoAnswer)
{
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.emplace_back((i & 1) != 0 ? 16.0F : 14.0F, (i & 2) != 0 ? 5.0F : -5.0F, (i & 4) != 0 ? 80.0F : 0.0F);
    }
    const oracle::HullObstacles hull({corners});
    scene.obstacles.push_back(hull.all()[0]);
    scene.own.velocity = Vec3(5, 0, 0);
    scene.obstacle(geometry::make_capsule(Vec3(9, 4, 20), Vec3(9, 5, 40), 0.5F));
    scene.obstacle(geometry::make_box(Vec3(8, -5, 30), Vec3(1, 1, 9)));
    scene.airspace.has_floor = true;
    scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    scene.track(Vec3(-20, 20, 31), Vec3(5, -5, 0));
    const auto anew = [&] { planner = Planner(settings); };
    anew();
    ASSERT_EQ(plan(), PlanStatus::found);
    const std::uint32_t needed = spent;
    for (std::uint32_t units = 0; units < needed; ++units) {
        anew();
        ASSERT_EQ(plan(units), PlanStatus::budget_spent) << units;
        ASSERT_EQ(out.path.points.size(), 0U) << units;
        ASSERT_LE(spent, units);
    }
    anew();
    EXPECT_EQ(plan(needed), PlanStatus::found);
}

}  // namespace
}  // namespace jink::orca
