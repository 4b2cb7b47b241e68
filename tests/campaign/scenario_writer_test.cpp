// SPDX-License-Identifier: BSD-3-Clause
// A flight from a written file is the flight itself, bit by bit.
#include "toolchain/sim/scenario_writer.hpp"

#include <gtest/gtest.h>

#include "toolchain/sim/encounter.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/report.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {
namespace {

std::string record_of(const Scenario& scenario)
{
    return run_text({report_on(scenario, fly_in_process(scenario), false)}, true);
}

TEST(ScenarioWriter, ReplaysEncountersOfBothPlannersToTheSameRecord)
{
    for (const std::uint64_t seed : {std::uint64_t{22}, std::uint64_t{179}, std::uint64_t{8'000'000'003}}) {
        for (const PlannerKind planner : {PlannerKind::product, PlannerKind::source}) {
            const Scenario drawn = encounter_scenario(seed, {planner, {}});
            const Scenario read = parse_scenario(scenario_text(drawn, "two\nlines"), drawn.name + ".yaml");
            EXPECT_EQ(read.planner, planner);
            EXPECT_EQ(record_of(read), record_of(drawn)) << drawn.name;
            EXPECT_EQ(scenario_text(read), scenario_text(drawn));
        }
    }
}

TEST(ScenarioWriter, KeepsEverythingThatAFileCanSay)
{
    Scenario s;
    s.name = "all";
    s.title = "yes: a \"title\", with # and 12";
    s.seed = 18'446'744'073'709'551'615U;
    s.stack = Stack::px4;
    s.planner = PlannerKind::source;
    s.duration = 12.345678901234567;
    s.promise = 0.1 + 0.2;
    s.body_radius = 1.0 / 3.0;
    s.floor = -2.5;
    s.vehicle = {7.1, 4.2, 0.8, 4.4, 2.2, 2.9, 2.8, 1.1, 0.6};
    s.mission = {Vec(0, 0, 10), Vec(1e-7, 100, 10), Vec(-3, 1.0 / 7.0, 20)};
    s.start_position = Vec(1, 2, 3);
    s.start_velocity = Vec(-1, 0.5, 0);
    Threat flies;
    flies.name = "flies";
    flies.radius = 1.5;
    flies.position = Vec(10, 20, 30.3);
    flies.velocity = Vec(1, -2, 0);
    flies.turns = {{3.5, Vec(0, 1, 0)}, {7.25, Vec(2, 0, 0)}};
    flies.appears_at = 2.2;
    Threat stands;
    stands.name = "stands";
    stands.half_height = 4.0;
    stands.sensed_by = SensedBy::scan;
    stands.appears_when_own_within = 8.0;
    stands.collision_point = Vec(4, 5, 6);
    s.threats = {flies, stands};
    s.traffic = {.rate = 4.0,
                 .sigma_position = 0.3,
                 .sigma_velocity = 0.2,
                 .sigma_drift = 1.5,
                 .drift_time = 7.0,
                 .latency = 0.15,
                 .jitter = 0.05,
                 .dropout = 0.1};
    s.scan = {8.0, 25.0, 0};
    s.parameters = {{"TRK_RADIUS", 1.5}, {"GEO_FLIP", 0.25}, {"TRK_SIGMA_P", 0.7}};
    s.faults.pilot_takes_over = 5.0;
    s.faults.pilot_mode = Mode::pilot;
    s.faults.pilot_velocity = Vec(1, 0, 0);
    s.faults.refuse_external = true;
    s.faults.offboard_proof = 1.5;
    s.faults.reboot_at = 4.0;
    s.faults.reboot_lasts = 2.0;
    s.faults.clock_jump_at = 3.0;
    s.faults.clock_jump_by = -1.0;
    s.faults.cable_pulled_at = 2.0;
    s.faults.cable_pulled_for = 1.0;
    s.expect = {{Outcome::avoided, Outcome::failed}, true, Mode::mission, 3, true};

    const Scenario read = parse_scenario(scenario_text(s), "all.yaml");
    EXPECT_EQ(scenario_text(read), scenario_text(s));
    EXPECT_EQ(read.title, s.title);
    EXPECT_EQ(read.seed, s.seed);
    EXPECT_EQ(read.duration, s.duration);
    EXPECT_EQ(read.promise, s.promise);
    EXPECT_EQ(read.body_radius, s.body_radius);
    EXPECT_EQ(read.floor, s.floor);
    EXPECT_EQ(read.vehicle.max_course_rate, s.vehicle.max_course_rate);
    EXPECT_EQ(read.vehicle.drag, s.vehicle.drag);
    EXPECT_TRUE(read.mission == s.mission);
    EXPECT_TRUE(read.start_velocity == s.start_velocity);
    ASSERT_EQ(read.threats.size(), 2U);
    EXPECT_TRUE(read.threats[0].turns[1].velocity == flies.turns[1].velocity);
    EXPECT_EQ(read.threats[0].appears_at, flies.appears_at);
    EXPECT_EQ(read.threats[1].appears_when_own_within, stands.appears_when_own_within);
    EXPECT_EQ(read.parameters, s.parameters);
    EXPECT_EQ(read.faults.clock_jump_by, s.faults.clock_jump_by);
    EXPECT_EQ(read.faults.pilot_mode, s.faults.pilot_mode);
    EXPECT_EQ(read.expect.outcomes, s.expect.outcomes);
    EXPECT_EQ(read.expect.final_mode, s.expect.final_mode);
    EXPECT_EQ(read.expect.flips_at_most, s.expect.flips_at_most);
    EXPECT_EQ(read.expect.goal_reached, s.expect.goal_reached);
}

}  // namespace
}  // namespace jink::sim
