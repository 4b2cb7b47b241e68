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

TEST(HoldChoice, WhatStandsAlreadyCannotStop)
{
    Case still(Vec3(6.0F, 0.0F, 0.0F), 10.0F);
    still.own.velocity = Vec3::Zero();
    EXPECT_FALSE(still.holds());
}

TEST(HoldChoice, APassThatIsWideEnoughIsNotStoppedFor)
{
    EXPECT_FALSE(Case(Vec3(6.0F, 0.0F, 0.0F), 10.0F, 9.0F).holds());
}

}  // namespace
}  // namespace jink::app
