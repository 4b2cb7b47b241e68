// SPDX-License-Identifier: BSD-3-Clause
// The matrix itself: every behaviour is flown to its end when nobody is in the way, and every intruder would hit.
#include "toolchain/sim/matrix.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "toolchain/sim/in_process.hpp"

namespace jink::sim {
namespace {

TEST(Matrix, MissionsAreFlownToTheirGoalWithoutACoprocessor)
{
    for (const Flyer flyer : kFlyers) {
        for (const Behaviour behaviour : kBehaviours) {
            if (!can_fly(flyer, behaviour) || !is_mission(behaviour)) {
                continue;
            }
            const Nominal nominal = nominal_flight(flyer, behaviour, 3);
            const Record record = fly_alone(nominal.scenario);
            EXPECT_GT(record.goal_at, nominal.meets_at) << nominal.scenario.name;
        }
    }
}

TEST(Matrix, EveryIntruderHitsAVehicleThatFliesOn)
{
    for (const Flyer flyer : kFlyers) {
        for (const Behaviour behaviour : kBehaviours) {
            for (const Meeting meeting : kMeetings) {
                if (can_fly(flyer, behaviour)) {
                    const Scenario scenario = matrix_scenario(flyer, behaviour, meeting, 11);
                    EXPECT_LT(fly_alone(scenario).closest.surface, 0.5) << scenario.name;
                }
            }
        }
    }
}

TEST(Matrix, LoiterTurnsAreCirclesOfTheirRadius)
{
    const Nominal nominal = nominal_flight(Flyer::arducopter, Behaviour::turns, 5);
    const Record record = fly_alone(nominal.scenario);
    const Item& turns = nominal.scenario.flight->items[1];
    int on_circle = 0;
    for (const Sample& sample : record.samples) {
        const double distance = (sample.position - turns.place).head<2>().norm();
        on_circle += std::abs(distance - turns.value) < 2.0 ? 1 : 0;
    }
    // Two turns of 20 m radius at 5 m/s: 50 s, sampled at 50 Hz.
    EXPECT_NEAR(on_circle / 50.0, 50.0, 8.0);
}

TEST(Matrix, AReplacedMissionIsFlownAndTold)
{
    Nominal nominal = nominal_flight(Flyer::px4, Behaviour::upload, 2);
    const Record record = fly_alone(nominal.scenario);
    EXPECT_GT(record.goal_at, 0.0);
    EXPECT_EQ(nominal.scenario.mission.back(), nominal.scenario.flight->uploaded.back().place);
    EXPECT_NE(nominal.scenario.mission.back(), nominal.scenario.flight->items.back().place);
}

TEST(Matrix, SpeedChangesAreFlown)
{
    const Nominal nominal = nominal_flight(Flyer::px4, Behaviour::speed_change, 2);
    const Record record = fly_alone(nominal.scenario);
    double fastest = 0.0;
    for (const Sample& sample : record.samples) {
        fastest = std::max(fastest, sample.velocity.norm());
    }
    EXPECT_NEAR(fastest, 10.0, 0.7);
}

TEST(Matrix, NamesAreDistinct)
{
    std::set<std::string_view> names;
    for (const Behaviour behaviour : kBehaviours) {
        names.insert(to_string(behaviour));
    }
    EXPECT_EQ(names.size(), kBehaviours.size());
}

}  // namespace
}  // namespace jink::sim
