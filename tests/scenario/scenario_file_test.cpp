// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/scenario_file.hpp"

#include <fstream>

namespace jink::sim {
namespace {

const std::string kLeast = "mission: [[0, 0, 30], [100, 0, 30]]\nexpect: {outcome: clear}\n";

std::string refusal(const std::string& text)
{
    try {
        static_cast<void>(parse_scenario(text, "folder/some.yaml"));
    } catch (const BadScenario& e) {
        return e.what();
    }
    return "accepted";
}

TEST(ScenarioFile, EveryFileOfTheFolderLoads)
{
    const auto files = scenario_files(JINK_SCENARIOS);
    EXPECT_GE(files.size(), 24U);
    bool ardupilot = false;
    bool px4 = false;
    for (const auto& file : files) {
        const Scenario s = load_scenario(file);
        EXPECT_FALSE(s.title.empty()) << file;
        EXPECT_EQ(s.name, file.stem().string());
        ardupilot = ardupilot || s.stack == Stack::ardupilot;
        px4 = px4 || s.stack == Stack::px4;
    }
    EXPECT_TRUE(ardupilot && px4);
}

TEST(ScenarioFile, EverythingIsRead)
{
    const Scenario s = parse_scenario(R"(
title: all of it
seed: 99
stack: px4
duration: 12
promise: 0.8
body_radius: 0.4
floor: 2.5
vehicle: {cruise: 6, omega: 4, damping: 1, max_acceleration: 7, max_vertical_acceleration: 4, max_climb: 5, max_descent: 2, max_yaw_rate: 1, max_course_rate: 2}
mission: [[0, 0, 30], [100, 0, 30]]
start: {position: [1, 2, 31], velocity: [3, 0, 0]}
threats:
  - {name: a, radius: 2, velocity: [1, 0, 0], passes: {point: [10, 0, 30], at: 5}, turns: [{at: 6, velocity: [0, 1, 0]}], appears_at: 1}
  - {name: b, radius: 0.5, position: [20, 0, 30], grid: {across: 2, up: 3, step: 2, direction: [0, 2, 0]}, appears_when_own_within: 8, collision_point: [20, 0, 30]}
  - {name: c, half_height: 4, position: [30, 0, 30], sensed_by: scan}
traffic: {rate: 10, sigma_position: 0.1, sigma_velocity: 0.2, latency: 0.3, jitter: 0.4, dropout: 0.5}
scan: {rate: 5, range: 20}
parameters: {JNK_SETTLE: 2}
faults: {pilot_takes_over: 3, pilot_mode: home, pilot_velocity: [1, 1, 1], refuse_external: true, reboot_at: 4, reboot_lasts: 2, clock_jump_at: 5, clock_jump_by: -3, cable_pulled_at: 6, cable_pulled_for: 1}
expect: {outcome: [avoided, braked], given_back: true, final_mode: hold, flips_at_most: 2}
)",
                                      "all.yaml");
    EXPECT_EQ(s.name, "all");
    EXPECT_EQ(s.title, "all of it");
    EXPECT_EQ(s.seed, 99U);
    EXPECT_EQ(s.stack, Stack::px4);
    EXPECT_EQ(s.duration, 12.0);
    EXPECT_EQ(s.promise, 0.8);
    EXPECT_EQ(s.body_radius, 0.4);
    EXPECT_EQ(s.floor, 2.5);
    EXPECT_EQ(s.vehicle.cruise, 6.0);
    EXPECT_EQ(s.vehicle.max_course_rate, 2.0);
    EXPECT_EQ(s.start_position, Vec(1, 2, 31));
    EXPECT_EQ(s.start_velocity, Vec(3, 0, 0));
    ASSERT_EQ(s.threats.size(), 8U);
    EXPECT_EQ(s.threats[0].position, Vec(5, 0, 30));
    EXPECT_EQ(s.threats[0].turns.size(), 1U);
    EXPECT_EQ(s.threats[0].sensed_by, SensedBy::traffic);
    EXPECT_EQ(s.threats[1].position, Vec(20, -1, 28));
    EXPECT_EQ(s.threats[6].position, Vec(20, 1, 32));
    EXPECT_EQ(s.threats[6].name, "b_2_1");
    EXPECT_EQ(s.threats[1].sensed_by, SensedBy::point);
    EXPECT_EQ(s.threats[1].appears_when_own_within, 8.0);
    EXPECT_EQ(s.threats[7].sensed_by, SensedBy::scan);
    EXPECT_EQ(s.traffic.dropout, 0.5);
    EXPECT_EQ(s.scan.range, 20.0);
    EXPECT_EQ(s.parameters.at("JNK_SETTLE"), 2.0);
    EXPECT_EQ(s.parameters.at("TRK_RADIUS"), 2.0);
    EXPECT_EQ(s.parameters.at("TRK_RADIUS_PT"), 0.5);
    EXPECT_EQ(s.faults.pilot_mode, Mode::home);
    EXPECT_EQ(s.faults.clock_jump_by, -3.0);
    EXPECT_TRUE(s.faults.refuse_external);
    EXPECT_EQ(s.faults.cable_pulled_for, 1.0);
    EXPECT_EQ(s.expect.outcomes.size(), 2U);
    EXPECT_EQ(s.expect.final_mode, Mode::hold);
    EXPECT_EQ(s.expect.flips_at_most, 2);
}

TEST(ScenarioFile, TheVehicleStartsAtCruiseOnItsLeg)
{
    const Scenario s = parse_scenario(kLeast, "some.yaml");
    EXPECT_EQ(s.start_position, Vec(0, 0, 30));
    EXPECT_EQ(s.start_velocity, Vec(5, 0, 0));
    EXPECT_TRUE(s.parameters.empty());
}

TEST(ScenarioFile, RefusalsNameTheLineAndTheReason)
{
    EXPECT_EQ(refusal(kLeast), "accepted");
    EXPECT_EQ(refusal(kLeast + "colour: red\n"), "folder/some.yaml:3: unknown key 'colour'");
    EXPECT_EQ(refusal(kLeast + "vehicle: {wings: 2}\n"), "folder/some.yaml:3: unknown key 'wings'");
    EXPECT_EQ(refusal(kLeast + "\nstack: betaflight\n"), "folder/some.yaml:4: expected one of: ardupilot, px4");
    EXPECT_EQ(refusal(kLeast + "duration: long\n"), "folder/some.yaml:3: 'duration' has a value of the wrong kind");
    EXPECT_EQ(refusal(kLeast + "duration: 0.5\n"), "folder/some.yaml:3: 'duration' must lie between 1 and 600");
    EXPECT_EQ(refusal("expect: {outcome: clear}\n"), "folder/some.yaml:1: 'mission' is missing");
    EXPECT_EQ(refusal("mission: [[0, 0, 30]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1: a mission has at least two waypoints");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1: expected [x, y, z]");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, x]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1: expected a number");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, .nan]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1: expected a finite number");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, 3]]\nexpect: {outcome: happy}\n"),
              "folder/some.yaml:2: expected one of: clear, avoided, braked, breach, collision, failed");
    EXPECT_EQ(refusal("a: [1\n").rfind("folder/some.yaml:", 0), 0U);
    EXPECT_EQ(refusal("- 1\n"), "folder/some.yaml:1: expected a map of keys and values");
}

TEST(ScenarioFile, ThreatsThatCannotBeAreRefused)
{
    const auto threat = [](const std::string& text) { return refusal(kLeast + "threats:\n  - " + text + "\n"); };
    EXPECT_EQ(threat("{position: [1, 2, 3]}"), "accepted");
    EXPECT_EQ(threat("{radius: 1}"), "folder/some.yaml:4: a threat has either 'position' or 'passes'");
    EXPECT_EQ(threat("{position: [1, 2, 3], velocity: [1, 0, 0], sensed_by: scan}"),
              "folder/some.yaml:4: what moves is sensed by traffic");
    EXPECT_EQ(threat("{position: [1, 2, 3], half_height: 3}"),
              "folder/some.yaml:4: only a scan sees something tall; traffic and points are spheres");
    EXPECT_EQ(threat("{position: [1, 2, 3], radius: 0}"), "folder/some.yaml:4: 'radius' must lie between 0.05 and 500");
    EXPECT_EQ(threat("{position: [1, 2, 3], appears_when_own_within: 3}"),
              "folder/some.yaml:4: 'collision_point' is missing");
    EXPECT_EQ(threat("{position: [1, 2, 3], turns: [{at: 2, velocity: [1, 0, 0]}, {at: 2, velocity: [1, 0, 0]}]}"),
              "folder/some.yaml:4: turns come in order of time, after 0");
    EXPECT_EQ(threat("{passes: {point: [1, 2, 3], at: 5}, turns: [{at: 2, velocity: [1, 0, 0]}]}"),
              "folder/some.yaml:4: 'passes' speaks of the time before the first turn");
    EXPECT_EQ(threat("{position: [1, 2, 3], grid: {across: 65, up: 1, step: 1, direction: [0, 1, 0]}}"),
              "folder/some.yaml:4: a grid has 1 to 64 threats and a direction");
}

TEST(ScenarioFile, ParametersMustExist)
{
    EXPECT_EQ(refusal(kLeast + "parameters:\n  JNK_SETTEL: 1\n"),
              "folder/some.yaml:4: there is no parameter 'JNK_SETTEL'");
    EXPECT_EQ(refusal(kLeast + "parameters:\n  JNK_SETTLE: soon\n"), "folder/some.yaml:4: expected a number");
}

TEST(ScenarioFile, AMissingFileIsSaidSo)
{
    EXPECT_THROW(static_cast<void>(load_scenario("/nowhere/at/all.yaml")), BadScenario);
}

}  // namespace
}  // namespace jink::sim
