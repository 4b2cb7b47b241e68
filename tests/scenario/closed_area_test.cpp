// SPDX-License-Identifier: BSD-3-Clause
// Closed areas of the simulator: distances, files, and what flying into one is called.
#include <gtest/gtest.h>

#include "toolchain/sim/closed_area.hpp"

#include <cmath>

#include "core/base/random.hpp"
#include "firmware/linux/airspace_file.hpp"
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

TEST(ClosedArea, TheCoprocessorIsToldAndKeepsOut)
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

/// What the daemon is given in a file is what the co-processor in process is told.
TEST(ClosedArea, TheDaemonsFileSaysTheSame)
{
    const Scenario scenario = parse_scenario(kAcross, "across.yaml");
    constexpr double kBegan = 1.79e9;
    constexpr TimePoint kStart{7'000'000};
    files::Complaints complaints;
    const auto read = files::parse_airspace(airspace_text(scenario.areas, kBegan), "a.yaml",
                                            {kBegan + 3.0, {10'000'000}}, complaints);
    ASSERT_TRUE(read) << complaints.size();
    const std::vector<app::Constraint> told = constraints_of(scenario.areas, kStart);
    ASSERT_EQ(read->size(), told.size());
    EXPECT_EQ((*read)[0].stamp, told[0].stamp);
    EXPECT_FALSE((*read)[0].about);
    EXPECT_EQ((*read)[0].barrel.circle.centre, told[0].barrel.circle.centre);
    EXPECT_EQ((*read)[0].barrel.circle.radius, told[0].barrel.circle.radius);
    EXPECT_EQ((*read)[0].barrel.velocity, told[0].barrel.velocity);
    EXPECT_EQ((*read)[0].barrel.bottom, told[0].barrel.bottom);
    EXPECT_EQ((*read)[0].barrel.top, told[0].barrel.top);
    EXPECT_EQ((*read)[0].barrel.margin, told[0].barrel.margin);
}

}  // namespace
}  // namespace jink::sim
