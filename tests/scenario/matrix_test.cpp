// SPDX-License-Identifier: BSD-3-Clause
// The matrix itself: every behaviour is flown to its end without an intruder, and every intruder would hit.
#include "toolchain/sim/matrix.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/scenario_file.hpp"

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

TEST(Matrix, ATurnIsReportedByTheFirstMessageAfterIt)
{
    for (const Conditions conditions : {Conditions::calm, Conditions::rough}) {
        const Scenario turning = matrix_scenario(Flyer::arducopter, Behaviour::leg, Meeting::at_turn, 4, conditions);
        const Record turned = fly_in_process(turning);
        const double period = 1.0 / turning.traffic.rate;
        EXPECT_LT(turned.reported.front(), turning.threats.front().turns.front().at);
        EXPECT_GE(turned.course_reported.front(), turning.threats.front().turns.front().at);
        EXPECT_LE(turned.course_reported.front(), turning.threats.front().turns.front().at + 3.0 * period);
        const Record straight =
            fly_in_process(matrix_scenario(Flyer::arducopter, Behaviour::leg, Meeting::head_on, 4, conditions));
        EXPECT_EQ(straight.course_reported.front(), straight.reported.front());
    }
}

// Half of the cells: the autopilots take turns.
TEST(Matrix, EveryIntruderHitsAVehicleThatFliesOn)
{
    std::size_t turn = 0;
    for (const Behaviour behaviour : kBehaviours) {
        for (const Meeting meeting : kMeetings) {
            const Flyer flyer = kFlyers[++turn % kFlyers.size()];
            if (can_fly(flyer, behaviour)) {
                const Scenario scenario = matrix_scenario(flyer, behaviour, meeting, 11);
                EXPECT_LT(fly_alone(scenario).closest.surface, 0.5) << scenario.name;
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

TEST(Matrix, AReplacedMissionIsFlownAndReported)
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

/// A wall of pillars 2 m apart across the leg, as high as one likes, seen by a level range scan.
Scenario wall_flight(const std::string& stack, int pillars)
{
    return parse_scenario("stack: " + stack + R"(
duration: 100
to_goal: true
vehicle: {omega: 3.3, max_acceleration: 2.5, max_vertical_acceleration: 2.5, max_climb: 2.5, max_descent: 1.5}
mission: [[0, 0, 30], [100, 0, 30]]
scan: {rate: 10, range: 25}
parameters: {VEH_ACC: 2.5, VEH_LAG: 0.55, VEH_ACC_Z: 2.5, VEH_CLIMB: 2.5, VEH_DESCENT: 1.5}
expect: {outcome: [avoided, braked]}
threats:
  - {name: wall, radius: 1.0, half_height: 40, position: [45, 0, 30], sensed_by: scan,
     grid: {step: 2.0, direction: [0, 1, 0], up: 1, across: )" +
                              std::to_string(pillars) + "}}\n",
                          "wall_" + stack);
}

TEST(WallByScan, OneOf22MetresIsPassedAndTheMissionFinished)
{
    for (const char* const stack : {"ardupilot", "px4"}) {
        const Record record = fly_in_process(wall_flight(stack, 11));
        EXPECT_GT(record.closest.surface, 1.0) << stack;
        EXPECT_GT(record.goal_at, 0.0) << stack;
        EXPECT_EQ(record.final_mode, Mode::mission) << stack;
    }
}

TEST(WallByScan, BeforeOneWithoutAnEndControlIsGivenBackWithAText)
{
    for (const char* const stack : {"ardupilot", "px4"}) {
        const Record record = fly_in_process(wall_flight(stack, 41));
        const auto& texts = record.heard.texts;
        EXPECT_GT(record.closest.surface, 1.0) << stack;
        EXPECT_TRUE(record.final_mode == Mode::hold || record.final_mode == Mode::brake) << stack;
        EXPECT_TRUE(std::any_of(texts.begin(), texts.end(), [](const Text& text) {
            return text.text == "jink: way blocked, autopilot holds";
        })) << stack;
        EXPECT_TRUE(std::none_of(texts.begin(), texts.end(), [](const Text& text) { return text.severity <= 2; }));
    }
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
