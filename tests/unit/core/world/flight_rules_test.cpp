// SPDX-License-Identifier: BSD-3-Clause
// Ranges of the flight rules, and that nobody plans by rules out of range.
#include <cmath>
#include <limits>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Range {
    const char* name;
    float& (*of)(FlightRules&);
    float low;
    float high;
    friend void PrintTo(const Range& r, std::ostream* out) { *out << r.name; }
};

const Range kRanges[] = {
    {"lookahead", [](FlightRules& r) -> float& { return r.lookahead; }, 1.0F, 60.0F},
    {"latency", [](FlightRules& r) -> float& { return r.latency; }, 0.0F, 1.0F},
    {"k_sigma", [](FlightRules& r) -> float& { return r.k_sigma; }, 0.0F, 6.0F},
    {"clearance", [](FlightRules& r) -> float& { return r.clearance; }, 0.0F, 10.0F},
    {"escape_slack", [](FlightRules& r) -> float& { return r.escape.slack; }, 0.0F, 1.0F},
    {"escape_speed", [](FlightRules& r) -> float& { return r.escape.speed; }, 0.0F, 10.0F},
    {"position_gain", [](FlightRules& r) -> float& { return r.gains.position_gain; }, 0.0F, 10.0F},
    {"max_correction", [](FlightRules& r) -> float& { return r.gains.max_correction; }, 0.0F, 10.0F},
};

struct FlightRulesRanges : testing::TestWithParam<Range> {
    [[nodiscard]] static FlightRules with(float value)
    {
        FlightRules rules;
        GetParam().of(rules) = value;
        return rules;
    }
    [[nodiscard]] static bool takes(float value) { return is_valid(with(value)); }
};

TEST_P(FlightRulesRanges, HoldTheirEndsAndNothingBeyond)
{
    const Range& range = GetParam();
    EXPECT_TRUE(takes(range.low));
    EXPECT_TRUE(takes(range.high));
    EXPECT_FALSE(takes(std::nextafter(range.low, -kInfinity)));
    EXPECT_FALSE(takes(std::nextafter(range.high, kInfinity)));
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        EXPECT_FALSE(takes(bad)) << bad;
    }
}

TEST_P(FlightRulesRanges, NoMethodPlansBeyondThem)
{
    Scene scene;
    scene.own.position = Vec3(0, 0, 30);
    scene.own.velocity = Vec3(5, 0, 0);
    scene.own.stamp = scene.now;
    scene.leg(Vec3(0, 0, 30), Vec3(200, 0, 30));
    scene.track(Vec3(30, 0, 30), Vec3::Zero());
    geometric::Planner curves{geometric::Settings{}};
    orca::Planner velocities;
    Manoeuvre out;
    const auto status = [&](auto& method) {
        WorkBudget budget(kPlenty);
        return method.plan(scene.situation(), budget, out);
    };
    EXPECT_EQ(status(curves), PlanStatus::found);
    EXPECT_EQ(status(velocities), PlanStatus::found);
    scene.rules = with(std::nextafter(GetParam().high, kInfinity));
    EXPECT_EQ(status(curves), PlanStatus::bad_input);
    EXPECT_EQ(status(velocities), PlanStatus::bad_input);
    scene.rules = with(kNan);
    EXPECT_EQ(status(curves), PlanStatus::bad_input);
    EXPECT_EQ(status(velocities), PlanStatus::bad_input);
}

INSTANTIATE_TEST_SUITE_P(Of, FlightRulesRanges, testing::ValuesIn(kRanges),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace jink::world
