// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/hold_choice.hpp"

#include <gtest/gtest.h>

namespace jink::app {
namespace {

/// 5 m/s to the north; the conflict is `ahead` metres ahead, at the time that the vehicle takes to get there.
struct Case {
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    world::Conflict conflict;
    world::Track track;

    Case(const Vec3& threat_velocity, float ahead, float miss = 0.3F)
    {
        own.velocity = Vec3(0.0F, 5.0F, 0.0F);
        conflict.time_to_closest = ahead / 5.0F;
        conflict.miss_distance = miss;
        track.velocity = threat_velocity;
        track.position = Vec3(miss, ahead, 0.0F) - threat_velocity * conflict.time_to_closest;
    }
    [[nodiscard]] bool holds() const { return is_stopping_safer(own, limits, conflict, &track); }
};

TEST(HoldChoice, InFrontOfWhatStandsItHolds)
{
    const Case standing(Vec3::Zero(), 8.0F);
    EXPECT_TRUE(standing.holds());
    EXPECT_TRUE(is_stopping_safer(standing.own, standing.limits, standing.conflict, nullptr)) << "an obstacle, an area";
}

TEST(HoldChoice, InFrontOfWhatStandsItHoldsAlsoWhereItComesToRestBesideIt)
{
    EXPECT_TRUE(Case(Vec3::Zero(), 3.0F).holds()) << "3.75 m to stop";
    EXPECT_TRUE(Case(Vec3(0.0F, -0.4F, 0.0F), 3.0F).holds()) << "what creeps stands";
    EXPECT_TRUE(Case(Vec3::Zero(), 10.0F, 9.0F).holds()) << "however wide the pass";
    EXPECT_FALSE(Case(Vec3(0.0F, -0.6F, 0.0F), 3.0F).holds()) << "it comes nearer";
}

TEST(HoldChoice, BeforeACrossingItHolds)
{
    EXPECT_TRUE(Case(Vec3(6.0F, 0.0F, 0.0F), 10.0F).holds());
    EXPECT_TRUE(Case(Vec3(-6.0F, 0.0F, 0.0F), 10.0F).holds());
    EXPECT_TRUE(Case(Vec3(0.0F, 0.0F, -3.0F), 10.0F).holds()) << "from above";
}

TEST(HoldChoice, InTheWayOfAnIntruderTheMissionGoesOn)
{
    EXPECT_FALSE(Case(Vec3(0.0F, -8.0F, 0.0F), 20.0F).holds()) << "head-on: a vehicle that stands is hit as well";
    EXPECT_FALSE(Case(Vec3(0.0F, 12.0F, 0.0F), 10.0F).holds()) << "from behind";
}

TEST(HoldChoice, IntruderThatComesHalfAMinuteAfterTheStopCounts)
{
    Case late(Vec3(0.0F, -1.0F, 0.0F), 10.0F);
    late.track.position = Vec3(0.0F, 25.0F, 0.0F);  // 3.75 m and 1.6 s to stop
    EXPECT_FALSE(late.holds()) << "20 s later";
    late.track.position.y() = 50.0F;
    EXPECT_TRUE(late.holds()) << "45 s later";
}

TEST(HoldChoice, WhatStandsAlreadyCannotStop)
{
    Case still(Vec3(6.0F, 0.0F, 0.0F), 10.0F);
    still.own.velocity = Vec3::Zero();
    EXPECT_FALSE(still.holds());
    still.own.velocity.y() = 0.9F * vehicle::kStandstillSpeed;
    EXPECT_FALSE(still.holds());
    still.own.velocity.y() = vehicle::kStandstillSpeed;
    EXPECT_TRUE(still.holds()) << "it does not stand yet";
}

TEST(HoldChoice, APassThatIsWideEnoughIsNotStoppedFor)
{
    EXPECT_FALSE(Case(Vec3(6.0F, 0.0F, 0.0F), 10.0F, 9.0F).holds());
}

TEST(HoldChoice, GainItselfIsEnoughAndLessIsNot)
{
    Case behind(Vec3(0.0F, -2.0F, 0.0F), 10.0F);
    behind.track.position = Vec3(0.0F, -4.0F, 0.0F);  // 4 m behind and going away: never nearer than now
    behind.conflict.miss_distance = 4.0F - kHoldBetter;
    EXPECT_TRUE(behind.holds());
    behind.conflict.miss_distance = 4.001F - kHoldBetter;
    EXPECT_FALSE(behind.holds());
}

TEST(HoldChoice, WhatFliesAtHalfAMetrePerSecondDoesNotStand)
{
    Case slow(Vec3(0.0F, -0.5F, 0.0F), 3.0F);
    EXPECT_FALSE(slow.holds()) << "it comes nearer to where the vehicle rests";
    slow.track.velocity.y() = -0.499F;
    EXPECT_TRUE(slow.holds());
}

TEST(HoldChoice, ClosestPassWhileItBrakesCounts)
{
    // It crosses 1 m ahead within the first tenths of a second; afterwards it is far away.
    Case early(Vec3(20.0F, 0.0F, 0.0F), 10.0F);
    early.track.position = Vec3(-4.0F, 2.0F, 0.0F);
    early.conflict.miss_distance = 0.5F;
    EXPECT_FALSE(early.holds());
    early.track.position = Vec3(-4.0F, 20.0F, 0.0F);
    EXPECT_TRUE(early.holds()) << "the same pass, far ahead";
}

TEST(HoldChoice, TrafficAboveCountsByItsHeight)
{
    Case above(Vec3(0.0F, -8.0F, 0.0F), 20.0F);
    above.track.position.z() += 5.0F;
    EXPECT_TRUE(above.holds()) << "5 m above where it rests";
    above.track.position.z() -= 4.0F;
    EXPECT_FALSE(above.holds());
}

}  // namespace
}  // namespace jink::app
