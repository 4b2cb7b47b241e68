// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step: a permanently blocked path, and reports in a conflict.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/direct_flight.hpp"

namespace jink::app::test {
namespace {

Course east(float speed)
{
    return {[=](Seconds t) { return Vec3(speed * t, 0.0F, 50.0F); }, [=](Seconds) { return Vec3(speed, 0.0F, 0.0F); }};
}

/// A mission that leads through a wall, which a scanner detects.
class WayBlocked : public ::testing::Test {
protected:
    WayBlocked()
    {
        Parameters parameters;
        static_cast<void>(parameters.set(Param::patience, 6.0F));
        flight = std::make_unique<DirectFlight>(east(5.0F), parameters, 1);
        flight->reports_leg = true;
        flight->leg = {Vec3(0, 0, 50), Vec3(500, 0, 50), 5.0F};
        flight->wall_at = 60.0F;
    }
    std::unique_ptr<DirectFlight> flight;
};

TEST_F(WayBlocked, EndsInTheHoldModeAfterThePatienceSaidOnce)
{
    flight->fly(45.0F);
    EXPECT_EQ(flight->mode, link::FlightMode::hold);
    EXPECT_EQ(flight->said("jink: way blocked, autopilot holds"), 1);
    EXPECT_EQ(flight->said("jink: mode changed by others, hands off"), 0) << "the hold is what was asked for";
    EXPECT_LE(flight->said(link::Severity::critical), 1);
    EXPECT_LE(flight->taken.size(), 2U);
    const std::size_t taken = flight->taken.size();
    flight->fly(25.0F);
    EXPECT_EQ(flight->taken.size(), taken) << "the pilot decides";
    EXPECT_EQ(flight->said("jink: way blocked, autopilot holds"), 1);
}

TEST_F(WayBlocked, IsGuardedAgainOnceThePilotChoosesTheMission)
{
    flight->fly(45.0F);
    ASSERT_EQ(flight->mode, link::FlightMode::hold);
    const std::size_t taken = flight->taken.size();
    flight->mode = link::FlightMode::mission;
    flight->fly(45.0F);
    EXPECT_GT(flight->taken.size(), taken);
    EXPECT_LT(flight->state.position.x(), 59.0F) << "the own box stays clear of it";
    EXPECT_EQ(flight->mode, link::FlightMode::hold);
    EXPECT_EQ(flight->said("jink: way blocked, autopilot holds"), 2);
}

/// Hands off as long as it holds; a mode that a pilot chooses in its place is news.
TEST_F(WayBlocked, HandsStayOffInTheHoldAndAPilotsOtherModeIsSaid)
{
    while (flight->time < 45.0F && flight->mode != link::FlightMode::hold) {
        flight->tick();
    }
    ASSERT_EQ(flight->mode, link::FlightMode::hold);
    flight->fly(1.5F);
    for (int i = 0; i < 100; ++i) {
        flight->fly(0.1F);
        ASSERT_EQ(flight->last.control, Control::overruled) << i;
    }
    DirectFlight other(east(5.0F), flight->coprocessor.parameters(), 1);
    other.reports_leg = true;
    other.leg = flight->leg;
    other.wall_at = 60.0F;
    while (other.time < 45.0F && other.said("jink: way blocked, autopilot holds") == 0) {
        other.tick();
    }
    ASSERT_EQ(other.said("jink: way blocked, autopilot holds"), 1);
    other.mode = link::FlightMode::manual;
    other.fly(0.5F);
    EXPECT_EQ(other.said("jink: mode changed by others, hands off"), 1);
}

/// A blocked path ends once the pilot chooses the mission: the next conflict is given back to the mission.
TEST_F(WayBlocked, TheNextConflictIsGivenBackToTheMission)
{
    while (flight->time < 45.0F && flight->mode != link::FlightMode::hold) {
        flight->tick();
    }
    ASSERT_EQ(flight->mode, link::FlightMode::hold);
    flight->fly(2.0F);
    flight->wall_at = 0.0F;
    flight->fly(2.0F);
    flight->mode = link::FlightMode::mission;
    flight->fly(2.0F);
    const std::size_t taken = flight->taken.size();
    const Vec3 ahead(flight->state.position.x() + 70.0F, 0.0F, 50.0F);
    flight->intruders = {{ahead + flight->time * Vec3(5.0F, 0.0F, 0.0F), Vec3(-5.0F, 0.0F, 0.0F), 0.0F}};
    flight->fly(25.0F);
    EXPECT_GT(flight->taken.size(), taken);
    EXPECT_EQ(flight->mode, link::FlightMode::mission);
    EXPECT_EQ(flight->said("jink: way blocked, autopilot holds"), 1);
}

TEST_F(WayBlocked, NeverWithoutPatience)
{
    Parameters parameters = flight->coprocessor.parameters();
    ASSERT_EQ(parameters.set(Param::patience, 0.0F), ParamStatus::ok);
    DirectFlight f(east(5.0F), parameters, 1);
    f.reports_leg = true;
    f.leg = flight->leg;
    f.wall_at = 60.0F;
    f.fly(45.0F);
    EXPECT_EQ(f.said("jink: way blocked, autopilot holds"), 0);
    EXPECT_LE(f.said(link::Severity::critical), 1) << "once per conflict";
}

/// A ground station leads the vehicle away from its mission: the mission's leg does not predict its motion.
TEST(NominalPath, IsTheMeasuredMotionInAnExternalModeThatIsNotOurs)
{
    DirectFlight f(east(5.0F), Parameters{}, 1);
    f.reports_leg = true;
    f.leg = {Vec3(0, 0, 50), Vec3(500, 0, 50), 5.0F};
    f.fly(5.0F);
    ASSERT_TRUE(f.coprocessor.nominal_paths().is_intended());
    f.mode = link::FlightMode::external;
    f.fly(1.5F);
    EXPECT_FALSE(f.coprocessor.nominal_paths().is_intended());
    f.mode = link::FlightMode::mission;
    f.fly(1.5F);
    EXPECT_TRUE(f.coprocessor.nominal_paths().is_intended());
}

TEST(NominalPath, IsTheMissionsLegWhileWeLead)
{
    DirectFlight f(east(5.0F), Parameters{}, 1);
    f.reports_leg = true;
    f.leg = {Vec3(0, 0, 50), Vec3(500, 0, 50), 5.0F};
    f.intruders = {{Vec3(150, 0, 50), Vec3(-5, 0, 0), 0.0F}};
    int led = 0;
    for (int i = 0; i < 300 && f.given_back.empty(); ++i) {
        f.fly(0.1F);
        if (f.mode == link::FlightMode::external) {
            ++led;
            EXPECT_TRUE(f.coprocessor.nominal_paths().is_intended()) << i;
        }
    }
    EXPECT_GT(led, 20);
}

/// Intruders that approach a static vehicle: an escape that keeps clear gives no CRITICAL text.
TEST(WhatIsSaid, NothingCriticalOfAnEscapeThatKeepsClear)
{
    DirectFlight f(east(0.0F), Parameters{}, 1);
    f.reports_leg = true;
    f.leg = {Vec3(0, 0, 50), Vec3(500, 0, 50), 5.0F};
    f.intruders = {{Vec3(-100, 0, 50), Vec3(10, 0, 0), 0.0F}};
    f.fly(30.0F);
    EXPECT_EQ(f.taken.size(), 1U);
    EXPECT_EQ(f.given_back.size(), 1U);
    EXPECT_GT(f.nearest, 2.0F);
    EXPECT_EQ(f.said(link::Severity::critical), 0);
}

}  // namespace
}  // namespace jink::app::test
