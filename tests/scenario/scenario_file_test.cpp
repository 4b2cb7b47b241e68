// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "toolchain/sim/scenario_file.hpp"

#include <algorithm>
#include <fstream>

namespace jink::sim {
namespace {

const std::string kMin = "mission: [[0, 0, 30], [100, 0, 30]]\nexpect: {outcome: clear}\n";

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
vehicle: {cruise: 6, omega: 4, damping: 1, max_acceleration: 7, max_vertical_acceleration: 4, max_climb: 5, max_descent: 2, max_yaw_rate: 1, max_course_rate: 2, drag: 0.5}
mission: [[0, 0, 30], [100, 0, 30]]
start: {position: [1, 2, 31], velocity: [3, 0, 0]}
threats:
  - {name: a, radius: 2, velocity: [1, 0, 0], passes: {point: [10, 0, 30], at: 5}, turns: [{at: 6, velocity: [0, 1, 0]}], appears_at: 1}
  - {name: b, radius: 0.5, position: [20, 0, 30], grid: {across: 2, up: 3, step: 2, direction: [0, 2, 0]}, appears_when_own_within: 8, collision_point: [20, 0, 30]}
  - {name: c, half_height: 4, position: [30, 0, 30], sensed_by: scan}
traffic: {rate: 10, sigma_position: 0.1, sigma_velocity: 0.2, latency: 0.3, jitter: 0.4, dropout: 0.5}
scan: {rate: 5, range: 20}
parameters: {JNK_SETTLE: 2}
faults: {pilot_takes_over: 3, pilot_mode: home, pilot_velocity: [1, 1, 1], refuse_external: true, offboard_proof: 1.5, reboot_at: 4, reboot_lasts: 2, clock_jump_at: 5, clock_jump_by: -3, cable_pulled_at: 6, cable_pulled_for: 1}
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
    EXPECT_EQ(s.vehicle.drag, 0.5);
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
    EXPECT_EQ(s.faults.offboard_proof, 1.5);
    EXPECT_EQ(s.faults.cable_pulled_for, 1.0);
    EXPECT_EQ(s.expect.outcomes.size(), 2U);
    EXPECT_EQ(s.expect.final_mode, Mode::hold);
    EXPECT_EQ(s.expect.flips_at_most, 2);
}

TEST(ScenarioFile, TheVehicleStartsAtCruiseOnItsLeg)
{
    const Scenario s = parse_scenario(kMin, "some.yaml");
    EXPECT_EQ(s.start_position, Vec(0, 0, 30));
    EXPECT_EQ(s.start_velocity, Vec(5, 0, 0));
    EXPECT_EQ(s.parameters, (std::map<std::string, double>{{"TRK_SIGMA_P", 0.5}})) << "the noise of its sensors";
}

TEST(ScenarioFile, RefusalsNameThePlaceAndTheReason)
{
    EXPECT_EQ(refusal(kMin), "accepted");
    EXPECT_EQ(refusal(kMin + "colour: red\n"), "folder/some.yaml:3:1: unknown key 'colour'");
    EXPECT_EQ(refusal(kMin + "vehicle: {wings: 2}\n"), "folder/some.yaml:3:11: unknown key 'vehicle.wings'");
    EXPECT_EQ(refusal(kMin + "\nstack: betaflight\n"),
              "folder/some.yaml:4:8: stack: 'betaflight' is none of: ardupilot, px4");
    EXPECT_EQ(refusal(kMin + "duration: long\n"), "folder/some.yaml:3:11: duration: 'long' is not a number");
    EXPECT_EQ(refusal(kMin + "duration: 0.5\n"), "folder/some.yaml:3:11: duration: '0.5' is out of range: 1 to 600");
    EXPECT_EQ(refusal(kMin + "seed: -1\n"),
              "folder/some.yaml:3:7: seed: '-1' is not a whole number from 0 to 18446744073709551615");
    EXPECT_EQ(refusal("expect: {outcome: clear}\n"), "folder/some.yaml:1:1: missing key 'mission'");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 0, 30]]\n"), "folder/some.yaml:1:1: missing key 'expect'");
    EXPECT_EQ(refusal("mission: [[0, 0, 30]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1:10: mission: a mission has at least two waypoints");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1:23: mission[1]: three numbers are wanted, not 2");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, x]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1:30: mission[1][2]: 'x' is not a number");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, .nan]]\nexpect: {outcome: clear}\n"),
              "folder/some.yaml:1:30: mission[1][2]: '.nan' is not finite");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, 3]]\nexpect: {outcome: happy}\n"),
              "folder/some.yaml:2:19: expect.outcome: 'happy' is none of: clear, avoided, braked, breach, collision, "
              "failed");
    EXPECT_EQ(refusal("mission: [[0, 0, 30], [1, 2, 3]]\nexpect: {outcome: []}\n"),
              "folder/some.yaml:2:19: expect.outcome: is empty");
    EXPECT_EQ(refusal("a: [1\n").rfind("folder/some.yaml:", 0), 0U);
    EXPECT_EQ(refusal("- 1\n"), "folder/some.yaml:1:1: a mapping of keys to values is wanted, not a list");
}

TEST(ScenarioFile, EverythingThatIsWrongIsNamedInTheOrderOfTheFile)
{
    const std::string text = "mission: [[0, 0, 30]]\n"
                             "duration: 700\n"
                             "threats:\n"
                             "  - {radius: 1}\n"
                             "  - {position: [1, 2, 3], raduis: 2}\n"
                             "  - 7\n"
                             "parameters: {JNK_SETTEL: 1}\n"
                             "faults: {reboot_at: never}\n"
                             "expect: {outcome: fine}\n";
    try {
        static_cast<void>(parse_scenario(text, "some.yaml"));
        FAIL();
    } catch (const BadScenario& bad) {
        std::vector<std::size_t> lines;
        for (const files::Complaint& complaint : bad.complaints()) {
            lines.push_back(complaint.line);
            EXPECT_EQ(complaint.file, "some.yaml");
        }
        EXPECT_EQ(lines, (std::vector<std::size_t>{1, 2, 4, 5, 6, 7, 8, 9})) << bad.what();
        const std::string all = bad.what();
        EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 7);
        EXPECT_NE(all.find("'threats[1].raduis'; did you mean 'radius'?"), std::string::npos) << all;
        EXPECT_NE(all.find("'parameters.JNK_SETTEL'; did you mean 'JNK_SETTLE'?"), std::string::npos) << all;
    }
}

TEST(ScenarioFile, NumbersAreKeptInDouble)
{
    const Scenario s = parse_scenario("mission: [[0.1, 0, 30], [100, 0, 30]]\nduration: 12.3456789012\n"
                                      "threats: [{position: [1.23456789012, 0, 3], radius: 0.7}]\n"
                                      "seed: 18446744073709551615\nexpect: {outcome: clear}\n",
                                      "some.yaml");
    EXPECT_EQ(s.mission[0].x(), 0.1);
    EXPECT_EQ(s.duration, 12.3456789012);
    EXPECT_EQ(s.threats[0].position.x(), 1.23456789012);
    EXPECT_EQ(s.threats[0].radius, 0.7);
    EXPECT_EQ(s.seed, 18446744073709551615U);
}

TEST(ScenarioFile, ThreatsThatCannotBeAreRefused)
{
    const auto threat = [](const std::string& text) { return refusal(kMin + "threats:\n  - " + text + "\n"); };
    const std::string at = "folder/some.yaml:4:";
    EXPECT_EQ(threat("{position: [1, 2, 3]}"), "accepted");
    EXPECT_EQ(threat("{radius: 1}"), at + "5: threats[0].position: a threat has either 'position' or 'passes'");
    EXPECT_EQ(threat("{position: [1, 2, 3], velocity: [1, 0, 0], sensed_by: scan}"),
              at + "59: threats[0].sensed_by: what moves is sensed by traffic");
    EXPECT_EQ(threat("{position: [1, 2, 3], half_height: 3}"),
              at + "40: threats[0].half_height: only a scan sees something tall; traffic and points are spheres");
    EXPECT_EQ(threat("{position: [1, 2, 3], radius: 0}"),
              at + "35: threats[0].radius: '0' is out of range: 0.05 to 500");
    EXPECT_EQ(threat("{position: [1, 2, 3], appears_when_own_within: 3}"),
              at + "5: missing key 'threats[0].collision_point'");
    EXPECT_EQ(threat("{position: [1, 2, 3], turns: [{at: 2, velocity: [1, 0, 0]}, {at: 2, velocity: [1, 0, 0]}]}"),
              at + "70: threats[0].turns[1].at: turns come in order of time, after 0");
    EXPECT_EQ(threat("{passes: {point: [1, 2, 3], at: 5}, turns: [{at: 2, velocity: [1, 0, 0]}]}"),
              at + "14: threats[0].passes: speaks of the time before the first turn");
    EXPECT_EQ(threat("{position: [1, 2, 3], grid: {across: 65, up: 1, step: 1, direction: [0, 1, 0]}}"),
              at + "42: threats[0].grid.across: '65' is out of range: 1 to 64");
    EXPECT_EQ(threat("{position: [1, 2, 3], grid: {across: 13, up: 5, step: 1, direction: [0, 1, 0]}}"),
              at + "33: threats[0].grid: has more than 64 threats");
    EXPECT_EQ(threat("{position: [1, 2, 3], grid: {across: 3, up: 5, step: 1, direction: [0, 0, 0]}}"),
              at + "72: threats[0].grid.direction: has no length");
}

TEST(ScenarioFile, ParametersMustExist)
{
    EXPECT_EQ(refusal(kMin + "parameters:\n  JNK_SETTEL: 1\n"),
              "folder/some.yaml:4:3: unknown key 'parameters.JNK_SETTEL'; did you mean 'JNK_SETTLE'?");
    EXPECT_EQ(refusal(kMin + "parameters:\n  JNK_SETTLE: soon\n"),
              "folder/some.yaml:4:15: parameters.JNK_SETTLE: 'soon' is not a number");
}

TEST(ScenarioFile, ParametersLieWithinTheirRangesAndFitTogether)
{
    const auto wrong = [](const std::string& parameter) {
        return refusal(kMin + "parameters:\n  " + parameter + "\n");
    };
    const std::string at = "folder/some.yaml:4:";
    EXPECT_EQ(wrong("JNK_MODE: 5"), at + "13: parameters.JNK_MODE: '5' is out of range: 0 to 2");
    EXPECT_EQ(wrong("JNK_MODE: 1.5"), at + "13: parameters.JNK_MODE: '1.5' is not a whole number");
    EXPECT_NE(wrong("JNK_LOOKAHEAD: 0").find(at + "18: parameters.JNK_LOOKAHEAD: '0' is out of range: "),
              std::string::npos);
    EXPECT_EQ(wrong("GEO_OFFSETS: 3"), at + "3: parameters: GEO_OFFSETS must be even");
    EXPECT_EQ(wrong("GEO_T_LOW: 9"), at + "3: parameters: GEO_T_HIGH * 1.15 must be greater than GEO_T_LOW");
    EXPECT_EQ(wrong("GEO_OFFSETS: 4"), "accepted");
}

TEST(ScenarioFile, AMissingFileIsSaidSo)
{
    EXPECT_THROW(static_cast<void>(load_scenario("/nowhere/at/all.yaml")), BadScenario);
}

}  // namespace
}  // namespace jink::sim
