// SPDX-License-Identifier: BSD-3-Clause
// NominalPaths: the speed along the leg, state kept from a take-over on, and which of both paths is flown.
#include "firmware/app/nominal_paths.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/world/conflict.hpp"
#include "tests/oracle/reference_ends.hpp"

namespace jink::app {
namespace {

class NominalKept : public ::testing::Test {
protected:
    NominalKept() { own.position = Vec3(0.0F, 0.0F, 50.0F); }
    void tick(bool in_control = false)
    {
        now = now + 0.02F;
        own.position += 0.02F * own.velocity;
        own.stamp = now;
        paths.update(own, own, has_leg ? &leg : nullptr, limits, in_control);
    }
    void fly(const Vec3& velocity, Seconds span, bool in_control = false)
    {
        own.velocity = velocity;
        for (int i = 0; i < static_cast<int>(std::lround(span * 50.0F)); ++i) {
            tick(in_control);
        }
    }
    /// Along the circle of 10 m about its centre, at 5 m/s, to the left.
    void circle(Seconds span, bool in_control = false)
    {
        for (int i = 0; i < static_cast<int>(std::lround(span * 50.0F)); ++i) {
            heading += 0.01F;
            own.velocity = Vec3(5.0F * std::cos(heading), 5.0F * std::sin(heading), 0.0F);
            tick(in_control);
        }
    }
    [[nodiscard]] float meant() const { return paths.primary().speed; }

    NominalPaths paths;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    world::Leg leg{Vec3(0, 0, 50), Vec3(2000, 0, 50), 0.0F};
    bool has_leg = true;
    float heading = 0.0F;
    TimePoint now{1'000'000};
};

TEST_F(NominalKept, SpeedIsTheMissionsThenTheMeasuredThenTheParameters)
{
    limits.cruise_speed = 4.0F;
    fly(Vec3::Zero(), 0.1F);
    EXPECT_EQ(meant(), 4.0F) << "the parameter's";
    fly(Vec3(7, 0, 0), 2.0F);
    fly(Vec3::Zero(), 2.0F);
    EXPECT_NEAR(meant(), 7.0F, 1e-3F) << "the last steady one";
    leg.speed = 6.0F;
    tick();
    EXPECT_EQ(meant(), 6.0F) << "the mission's";
    leg.speed = 0.0F;
    tick();
    EXPECT_NEAR(meant(), 7.0F, 1e-3F);
}

/// Slowly around something, and back on the leg: the mission still flies as fast as before.
TEST_F(NominalKept, WhatWasSteadyUnderOurCommandsIsNotTheMissionsSpeed)
{
    fly(Vec3(7, 0, 0), 2.0F);
    fly(Vec3(1.4F, 0, 0), 3.0F, true);
    for (int i = 0; i < 40; ++i) {
        fly(Vec3(1.4F, 0, 0), 0.02F);
        EXPECT_NEAR(meant(), 7.0F, 1e-3F) << i;
    }
    fly(Vec3(1.4F, 0, 0), 0.02F, true);
    EXPECT_NEAR(meant(), 7.0F, 1e-3F) << "taken over again";
    fly(Vec3(1.4F, 0, 0), 2.0F);
    EXPECT_NEAR(meant(), 1.4F, 1e-3F) << "the autopilot flies so for a second";
}

TEST_F(NominalKept, SteadyIsWithinHalfAMetrePerSecondForASecond)
{
    limits.cruise_speed = 4.0F;
    const auto after = [&](float spread) {
        paths.reset();
        for (int i = 0; i < 30; ++i) {
            fly(Vec3(8.0F + (i % 4 < 2 ? 0.0F : spread), 0, 0), 0.1F);
        }
        fly(Vec3::Zero(), 0.1F);
        return meant();
    };
    EXPECT_EQ(after(0.55F), 4.0F) << "not steady: the parameter's";
    EXPECT_EQ(after(0.5F), 4.0F) << "nor closer together than that";
    EXPECT_NEAR(after(0.45F), 8.225F, 0.1F) << "the mean";
    EXPECT_NEAR(after(0.55F), 8.225F, 0.1F) << "that of the flight before";
}

TEST_F(NominalKept, SteadySpeedIsThatOfMotionAlongABelievedLeg)
{
    limits.cruise_speed = 4.0F;
    fly(Vec3(0, 8, 0), 1.4F);
    fly(Vec3::Zero(), 2.0F);
    EXPECT_EQ(meant(), 4.0F) << "across the leg";
    fly(Vec3(0.9F, 0, 0), 3.0F);
    EXPECT_EQ(meant(), 4.0F) << "slower than kMoving";
    fly(Vec3(0, 8, 0), 3.0F);
    ASSERT_FALSE(paths.believes_leg());
    fly(Vec3(8, 0, 0), 0.9F);
    ASSERT_FALSE(paths.believes_leg());
    fly(Vec3::Zero(), 0.1F);
    leg.start.y() = leg.end.y() = own.position.y();
    tick();
    EXPECT_EQ(meant(), 4.0F) << "a doubted leg";
}

TEST_F(NominalKept, SpeedFlownNowCountsWhereItIsGreaterOrSteady)
{
    leg.speed = 6.0F;
    fly(Vec3(3, 0, 0), 0.3F);
    EXPECT_EQ(meant(), 6.0F) << "slower, but not yet steady";
    fly(Vec3(3, 0, 0), 1.0F);
    EXPECT_NEAR(meant(), 3.0F, 1e-3F);
    fly(Vec3(9, 0, 0), 0.1F);
    EXPECT_NEAR(meant(), 9.0F, 1e-3F) << "greater: at once";
    fly(Vec3(0, 9, 0), 0.1F);
    EXPECT_EQ(meant(), 6.0F) << "across the leg it says nothing";
    fly(Vec3(0.9F, 0, 0), 2.0F);
    EXPECT_EQ(meant(), 6.0F) << "nor does slow motion";
    fly(Vec3(9, 0, 0), 0.1F, true);
    EXPECT_EQ(paths.is_intended(), true);
    EXPECT_EQ(meant(), 6.0F) << "nor do our commands";
}

TEST_F(NominalKept, SpeedOfALegBeforeCountsForTheNextOne)
{
    fly(Vec3(8, 0, 0), 2.0F);
    leg = {own.position, own.position + Vec3(0, 500, 0), 0.0F};
    fly(Vec3::Zero(), 0.1F);
    EXPECT_NEAR(meant(), 8.0F, 1e-3F);
}

TEST_F(NominalKept, ConflictOnTheMotionIsFlownOnTheMotionAndOneOnTheLegOnTheLeg)
{
    for (const bool on_other : {false, true}) {
        paths.reset();
        fly(Vec3(5, 0, 0), 2.0F);
        EXPECT_TRUE(paths.is_intended());
        paths.note(true, on_other);
        tick(true);
        EXPECT_EQ(paths.is_intended(), !on_other);
        ASSERT_NE(paths.other(), nullptr);
        EXPECT_EQ(end_of(*paths.other()) == leg.end, on_other) << "the other one of both";
        fly(Vec3(5, 0, 0), 0.1F);
        EXPECT_TRUE(paths.is_intended()) << "given back";
    }
}

TEST_F(NominalKept, TicksWithoutAConflictKeepWhichOneItWasOn)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, true);
    tick();
    paths.note(false, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    fly(Vec3(5, 0, 0), 0.1F);
    paths.note(true, false);
    tick(true);
    EXPECT_TRUE(paths.is_intended());
}

TEST_F(NominalKept, ConflictOnTheLegIsNotOneOnTheMotionATickLater)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, false);
    fly(Vec3(5, 0, 0), 0.1F);
    tick(true);
    EXPECT_TRUE(paths.is_intended());
}

TEST_F(NominalKept, DoubtedLegIsNotFlownWhateverTheConflictWasOn)
{
    fly(Vec3(0, 5, 0), 3.0F);
    ASSERT_FALSE(paths.believes_leg());
    paths.note(true, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    EXPECT_EQ(paths.other(), nullptr) << "nor does it have to be clear";
    paths.note(false, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    fly(Vec3(0, 5, 0), 0.1F);
    EXPECT_EQ(paths.other(), nullptr);
}

TEST_F(NominalKept, DoubtForgetsThatAConflictWasOnTheMotion)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, true);
    fly(Vec3(0, 5, 0), 3.0F);
    ASSERT_FALSE(paths.believes_leg());
    leg = {own.position, own.position + Vec3(0, 900, 0), 0.0F};
    tick();
    ASSERT_TRUE(paths.believes_leg());
    tick(true);
    EXPECT_TRUE(paths.is_intended()) << "of that conflict nothing is left";
}

TEST_F(NominalKept, LegIsFlownOnceTheMotionsConflictIsOver)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, true);
    tick(true);
    paths.note(true, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended()) << "the motion's conflict goes on";
    paths.note(false, false);
    EXPECT_TRUE(paths.is_intended()) << "at once";
    tick(true);
    EXPECT_TRUE(paths.is_intended());
}

TEST_F(NominalKept, LegThatIsLostInControlLeavesTheMotionUntilItIsClear)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, false);
    tick(true);
    ASSERT_TRUE(paths.is_intended());
    has_leg = false;
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    paths.note(false, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended()) << "there is no leg";
    has_leg = true;
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    EXPECT_NE(paths.other(), nullptr) << "the leg that came back has to be clear";
    paths.note(true, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended()) << "the motion's conflict goes on";
    paths.note(false, false);
    EXPECT_TRUE(paths.is_intended());
}

/// The motion goes on for a minute; the leg ends at its item.
TEST_F(NominalKept, PastTheEndOfItsLegTheVehicleReturns)
{
    leg.end = Vec3(12, 0, 50);
    fly(Vec3(5, 0, 0), 2.0F);
    paths.note(true, true);
    for (int i = 0; i < 100; ++i) {
        fly(Vec3(5, 0, 0), 0.02F, true);
        paths.note(true, false);
    }
    ASSERT_FALSE(paths.is_intended());
    ASSERT_GT(own.position.x(), leg.end.x() + 5.0F);
    paths.note(false, false);
    tick(true);
    const vehicle::Airframe airframe{};
    const world::FlightRules rules;
    const world::Way way = world::way_of({now, own, limits, airframe, paths.primary(), rules});
    EXPECT_LT(way.direction.x(), -0.99F);
    EXPECT_NEAR(way.length, own.position.x() - leg.end.x(), 0.01F);
}

/// Where the mission is read only after the take-over.
TEST_F(NominalKept, LegThatIsReportedInControlIsFlown)
{
    has_leg = false;
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, false);
    tick(true);
    leg = {own.position, own.position + Vec3(0, 30, 0), 0.0F};
    has_leg = true;
    tick(true);
    paths.note(true, false);
    tick(true);
    EXPECT_FALSE(paths.is_intended());
    ASSERT_NE(paths.other(), nullptr) << "the leg has to be clear too";
    paths.note(false, false);
    tick(true);
    EXPECT_EQ(end_of(paths.primary()), leg.end);
}

TEST_F(NominalKept, CommandsOfOursContradictNoLegNorDoTheyWearItOut)
{
    fly(Vec3(5, 0, 0), 1.0F);
    fly(Vec3(0, 5, 0), 1.4F);
    paths.note(true, false);
    fly(Vec3(0, 5, 0), 5.0F, true);
    EXPECT_TRUE(paths.believes_leg());
    fly(Vec3(0, 5, 0), 1.4F);
    EXPECT_TRUE(paths.believes_leg()) << "the contradiction counts anew";
    fly(Vec3(0, 5, 0), 0.2F);
    EXPECT_FALSE(paths.believes_leg());
    fly(Vec3(0, 5, 0), 2.0F, true);
    fly(Vec3(5, -5, 0), 0.9F);
    EXPECT_FALSE(paths.believes_leg());
    EXPECT_EQ(paths.legs_doubted(), 1U);
}

TEST_F(NominalKept, StraightMotionAfterAKeptTurnIsKeptStraight)
{
    has_leg = false;
    circle(1.5F);
    tick(true);
    ASSERT_TRUE(turns(paths.primary()));
    const Vec3 began = paths.primary().route().at(0.0F).position;
    circle(1.0F, true);
    ASSERT_TRUE(turns(paths.primary()));
    EXPECT_EQ(paths.primary().route().at(0.0F).position, began) << "kept, while the vehicle turns on";
    fly(Vec3(5, 0, 0), 2.0F);
    EXPECT_FALSE(turns(paths.primary()));
    tick(true);
    EXPECT_FALSE(turns(paths.primary()));
    const Vec3 kept = start_of(paths.primary());
    fly(Vec3(0, 5, 0), 1.0F, true);
    EXPECT_EQ(start_of(paths.primary()), kept);
    EXPECT_NEAR(paths.primary().speed, 5.0F, 1e-4F);
}

TEST_F(NominalKept, MotionIsTheOtherPathInControlOfTheLeg)
{
    fly(Vec3(5, 0, 0), 1.0F);
    paths.note(true, false);
    fly(Vec3(0, 3, 0), 0.5F, true);
    ASSERT_TRUE(paths.is_intended());
    ASSERT_NE(paths.other(), nullptr);
    EXPECT_LT((start_of(*paths.other()) - own.position).norm(), 1e-4F);
    EXPECT_LT((paths.other()->route().at(0.0F).along - Vec3::UnitY()).norm(), 1e-4F) << "what is flown now";
}

TEST_F(NominalKept, BeforeAnythingIsKnownThereIsNoPath)
{
    EXPECT_FALSE(paths.primary().valid);
    EXPECT_FALSE(paths.is_intended());
    EXPECT_FALSE(paths.believes_leg());
    EXPECT_EQ(paths.other(), nullptr);
    tick();
    EXPECT_TRUE(paths.primary().valid);
    EXPECT_TRUE(paths.is_intended());
}

}  // namespace
}  // namespace jink::app
