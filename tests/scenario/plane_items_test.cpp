// SPDX-License-Identifier: BSD-3-Clause
// The simulated ArduPlane's mission items and modes, as docs/evidence/recordings.md says.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "toolchain/sim/arduplane.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/matrix.hpp"
#include "toolchain/sim/plane_item_pilot.hpp"

namespace jink::sim {
namespace {

double level_speed(const Sample& sample) { return sample.velocity.head<2>().norm(); }

/// For how long the plane was on a circle, within 4 m [s].
double time_on_circle(const Record& record, const Vec& centre, double radius, double from = 0.0)
{
    int count = 0;
    for (const Sample& sample : record.samples) {
        const double off = (sample.position - centre).head<2>().norm() - radius;
        count += sample.time >= from && std::abs(off) < 4.0 ? 1 : 0;
    }
    return count / 50.0;
}

TEST(PlaneItems, LoiterTurnsAndLoiterTimeAreCircles)
{
    const Nominal turns = nominal_flight(Flyer::arduplane, Behaviour::turns, 5);
    const Item& item = turns.scenario.flight->items[1];
    const double turn = 2.0 * 3.14159 * item.value / 18.0;
    const double flown = time_on_circle(fly_alone(turns.scenario), item.place, item.value);
    EXPECT_GT(flown, turn * item.count - 2.0);
    EXPECT_LT(flown, turn * (item.count + 1) + 5.0) << "one more at most until the course leads to the next place";
    const Nominal wait = nominal_flight(Flyer::arduplane, Behaviour::wait, 5);
    const Item& loiter = wait.scenario.flight->items[1];
    const double waited = time_on_circle(fly_alone(wait.scenario), loiter.place, kPlaneLoiterRadius);
    EXPECT_GT(waited, loiter.value - 3.0) << "WP_LOITER_RAD";
    EXPECT_LT(waited, loiter.value + 30.0);
}

TEST(PlaneItems, ATakeOffKeepsItsCourseAndClimbs)
{
    const Nominal nominal = nominal_flight(Flyer::arduplane, Behaviour::take_off, 4);
    const Scenario& s = nominal.scenario;
    double height = s.start_position.z();
    for (const Sample& sample : fly_alone(s).samples) {
        if (sample.position.z() > s.flight->items[0].place.z()) {
            break;
        }
        EXPECT_GE(sample.position.z(), height - 1e-9);
        height = sample.position.z();
        EXPECT_NEAR((sample.velocity.head<2>() - s.start_velocity.head<2>()).norm(), 0.0, 0.05);
    }
    EXPECT_GT(height, s.home.z() + 65.0);
}

TEST(PlaneItems, ASpeedChangeHoldsUntilTheModeChanges)
{
    const Nominal nominal = nominal_flight(Flyer::arduplane, Behaviour::speed_change, 2);
    const Record alone = fly_alone(nominal.scenario);
    EXPECT_NEAR(level_speed(alone.samples.back()), 22.0, 0.1);
    const Record avoided =
        fly_in_process(matrix_scenario(Flyer::arduplane, Behaviour::speed_change, Meeting::from_left, 2));
    ASSERT_GT(avoided.takeovers, 0U);
    EXPECT_NEAR(level_speed(avoided.samples.back()), 18.0, 0.1) << "Mode::enter resets it";
}

TEST(PlaneItems, LeavingTheMissionInALandingGoesBackToTheItemBefore)
{
    const Nominal nominal = nominal_flight(Flyer::arduplane, Behaviour::land_item, 1);
    PlaneItemPilot pilot(nominal.scenario);
    Truth own;
    own.position = nominal.scenario.flight->items[0].place;
    own.velocity = nominal.scenario.start_velocity;
    static_cast<void>(pilot.command(own));
    ASSERT_EQ(pilot.index(), 1U) << "LAND";
    pilot.leave();
    EXPECT_EQ(pilot.index(), 0U) << "restart_landing_sequence";
    pilot.leave();
    EXPECT_EQ(pilot.index(), 0U) << "of no other item";
}

TEST(PlaneModes, LoiterGuidedAndRtlEndOnCircles)
{
    for (const Behaviour behaviour : {Behaviour::hold, Behaviour::guided, Behaviour::home}) {
        Scenario s = nominal_flight(Flyer::arduplane, behaviour, 3).scenario;
        s.duration = 120.0;
        const Vec centre = behaviour == Behaviour::home   ? s.home
                           : behaviour == Behaviour::hold ? s.start_position
                                                          : s.flight->target;
        const Record record = fly_alone(s);
        EXPECT_NEAR(time_on_circle(record, centre, kPlaneLoiterRadius, 90.0), 30.0, 1.0) << to_string(behaviour);
        EXPECT_NEAR(record.samples.back().position.z() - s.home.z(), 100.0, 1.0);
    }
}

TEST(PlaneModes, WhatArduPlaneHasNotIsNotFlown)
{
    for (const Behaviour behaviour : {Behaviour::spline, Behaviour::home_item, Behaviour::land}) {
        EXPECT_FALSE(can_fly(Flyer::arduplane, behaviour));
    }
    const auto both = [](Behaviour b) { return can_fly(Flyer::arduplane, b) && can_fly(Flyer::px4, b); };
    EXPECT_GE(std::count_if(kBehaviours.begin(), kBehaviours.end(), both), 12);
}

}  // namespace
}  // namespace jink::sim
