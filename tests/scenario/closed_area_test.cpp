// SPDX-License-Identifier: BSD-3-Clause
// Closed areas of the simulator: distances, files, and the outcome of flying into one.
#include <gtest/gtest.h>

#include "toolchain/sim/closed_area.hpp"

#include <cmath>

#include "core/base/random.hpp"
#include "firmware/link/mavlink/constraint_message.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/area_sender.hpp"
#include "toolchain/sim/daemon.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/scenario_writer.hpp"
#include "toolchain/sim/world.hpp"

namespace jink::sim {
namespace {

const std::string kAcross = R"(
duration: 40
mission: [[0, 0, 30], [100, 0, 30]]
closed_areas: [{name: cell, centre: [60, -30, 0], velocity: [0, 2.5, 0], radius: 10, bottom: 0, top: 90, margin: 4}]
expect: {outcome: avoided}
)";

TEST(ClosedArea, DistanceIsThatOfTheNearestPointOfTheCylinder)
{
    const ClosedArea area{"a", 5.0, -2.0, 8.0, 0.0, Vec(3, 4, 0), Vec(1, -1, 0)};
    EXPECT_NEAR(surface_distance(area, 2.0, Vec(15, 2, 3)), 5.0, 1e-9);
    EXPECT_NEAR(surface_distance(area, 2.0, Vec(5, 2, 11)), 3.0, 1e-9);
    EXPECT_NEAR(surface_distance(area, 2.0, Vec(13, 2, 12)), 5.0, 1e-9) << "3 beside, 4 above";
    EXPECT_NEAR(surface_distance(area, 2.0, Vec(5, 2, 0)), -2.0, 1e-9) << "down and out";
    EXPECT_NEAR(surface_distance(area, 0.0, Vec(7, 4, 3)), -1.0, 1e-9) << "sideways";
}

TEST(ClosedArea, WhatFliesOnIntoOneCollides)
{
    const Scenario scenario = parse_scenario(kAcross, "across.yaml");
    const Record record = fly_alone(scenario);
    EXPECT_EQ(record.outcome, Outcome::collision);
    EXPECT_LT(record.closest_area, -1.0);
}

TEST(ClosedArea, TheCoprocessorAcknowledgesAndKeepsOut)
{
    const Record record = fly_in_process(parse_scenario(kAcross, "across.yaml"));
    EXPECT_GE(record.closest_area, 0.7);
    EXPECT_LT(record.closest_area, 40.0);
    EXPECT_TRUE(record.outcome == Outcome::avoided || record.outcome == Outcome::braked);
}

TEST(ClosedArea, IsReadAndWrittenAndReadAgain)
{
    const Scenario first = parse_scenario(kAcross, "across.yaml");
    ASSERT_EQ(first.areas.size(), 1U);
    const Scenario again = parse_scenario(scenario_text(first, ""), "across.yaml");
    ASSERT_EQ(again.areas.size(), 1U);
    const ClosedArea& area = again.areas[0];
    EXPECT_EQ(area.name, "cell");
    EXPECT_EQ(area.centre, Vec(60, -30, 0));
    EXPECT_EQ(area.velocity, Vec(0, 2.5, 0));
    EXPECT_EQ(area.radius, 10.0);
    EXPECT_EQ(area.bottom, 0.0);
    EXPECT_EQ(area.top, 90.0);
    EXPECT_EQ(area.margin, 4.0);
}

TEST(ClosedArea, WhatIsWrongIsNamed)
{
    const auto refusal = [](const std::string& area) {
        try {
            static_cast<void>(parse_scenario("mission: [[0, 0, 30], [100, 0, 30]]\nexpect: {outcome: clear}\n"
                                             "closed_areas: [{" +
                                                 area + "}]\n",
                                             "some.yaml"));
        } catch (const BadScenario& e) {
            return std::string(e.what());
        }
        return std::string("accepted");
    };
    const std::string good = "centre: [0, 0, 0], radius: 5, bottom: 0, top: 9";
    EXPECT_EQ(refusal(good), "accepted");
    EXPECT_NE(refusal("radius: 5, bottom: 0, top: 9").find("centre"), std::string::npos);
    EXPECT_NE(refusal("centre: [0, 0, 0], radius: 0, bottom: 0, top: 9").find("radius"), std::string::npos);
    EXPECT_NE(refusal("centre: [0, 0, 0], radius: 5, bottom: 9, top: 0").find("lies below"), std::string::npos);
    EXPECT_NE(refusal(good + ", velocity: [0, 0, 1]").find("level"), std::string::npos);
    EXPECT_NE(refusal(good + ", colour: 1").find("colour"), std::string::npos);
}

TEST(AreaSender, RepeatsWhatIsNotAnsweredAndThenFallsSilent)
{
    const std::vector<ClosedArea> areas{ClosedArea{.name = "a", .top = 9.0}, ClosedArea{.name = "b", .top = 9.0}};
    AreaSender sender(areas);
    link::mavlink::Parser parser;
    FrameWriter answers;
    const auto parts_at = [&](Micros now) {
        std::vector<link::ConstraintPart> parts;
        const std::vector<std::byte> bytes = sender.send(now);
        std::span<const std::byte> rest = bytes;
        while (const auto frame = parser.next(rest)) {
            link::mavlink::Tunnel m;
            parts.emplace_back();
            EXPECT_TRUE(decode(*frame, m) && read_constraint(m, {now}, parts.back()));
        }
        return parts;
    };
    const auto answer = [&](std::uint8_t index, link::ConstraintResult result) {
        link::mavlink::Tunnel m = link::mavlink::constraint_answer({1, index, result});
        m.target_system = kGroundStation.system;
        m.target_component = kGroundStation.component;
        answers.bytes().clear();
        answers.write(m, {1, 196});
        sender.receive(answers.bytes(), 0);
    };
    ASSERT_EQ(parts_at(0).size(), 2U);
    EXPECT_TRUE(parts_at(kSecond / 10).empty()) << "not yet";
    answer(1, link::ConstraintResult::kept);
    const auto again = parts_at(kSecond / 2);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].index, 0);
    EXPECT_EQ(again[0].count, 2);
    EXPECT_EQ(again[0].constraint.stamp.us, 0) << "where the area was when the flight began";
    EXPECT_NE(sender.fault(), "");
    answer(0, link::ConstraintResult::in_force);
    EXPECT_TRUE(parts_at(kSecond).empty());
    EXPECT_EQ(sender.fault(), "");
}

TEST(AreaSender, ARefusalOrSilenceIsAFaultOfTheFlight)
{
    const std::vector<ClosedArea> areas{ClosedArea{.name = "storm", .top = 9.0}};
    AreaSender sender(areas);
    static_cast<void>(sender.send(0));
    EXPECT_EQ(sender.fault(), "closed area storm was not acknowledged");
    FrameWriter answers;
    link::mavlink::Tunnel m = link::mavlink::constraint_answer({1, 0, link::ConstraintResult::out_of_range});
    m.target_system = kGroundStation.system;
    m.target_component = kGroundStation.component;
    answers.write(m, {1, 196});
    sender.receive(answers.bytes(), 0);
    EXPECT_EQ(sender.fault(), "closed area storm was refused, result 3");
    EXPECT_EQ(AreaSender({}).fault(), "");
}

/// If the vehicle learns of a closed area only nearby, it has less time than the scenario specifies.
TEST(AreaSender, ALateAcknowledgementIsAFault)
{
    const std::vector<ClosedArea> areas{ClosedArea{.name = "storm", .top = 9.0}};
    AreaSender sender(areas);
    FrameWriter answers;
    link::mavlink::Tunnel m = link::mavlink::constraint_answer({1, 0, link::ConstraintResult::in_force});
    m.target_system = kGroundStation.system;
    m.target_component = kGroundStation.component;
    answers.write(m, {1, 196});
    sender.receive(answers.bytes(), 4 * kSecond);
    EXPECT_EQ(sender.fault(), "closed areas were in force after 4 s only");
}

/// One scenario without an input does not prevent the others: it is excluded by name.
TEST(NamedScenarios, OnlyThoseWithALidarHaveNoInputOnDaemonAndImages)
{
    std::size_t with_areas = 0;
    std::size_t left_out = 0;
    for (const auto& file : scenario_files(JINK_SCENARIOS)) {
        const Scenario scenario = load_scenario(file);
        with_areas += scenario.areas.empty() ? 0U : 1U;
        left_out += no_input_for(scenario).empty() ? 0U : 1U;
        EXPECT_EQ(no_input_for(scenario), scenario.lidar ? "a LiDAR is simulated in process only" : "") << file;
    }
    EXPECT_GE(with_areas, 1U);
    EXPECT_GE(left_out, 1U);
}

TEST(NamedScenarios, ThePublishedPlannerIsFlownInProcessOnly)
{
    Scenario scenario = parse_scenario(kAcross, "across.yaml");
    EXPECT_EQ(no_input_for(scenario), "");
    scenario.planner = PlannerKind::source;
    EXPECT_EQ(no_input_for(scenario), "'planner: source' is flown in process only");
}

}  // namespace
}  // namespace jink::sim
