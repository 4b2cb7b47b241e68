// SPDX-License-Identifier: BSD-3-Clause
// Which settings are taken: each range at its ends, and just beyond them.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

struct Range {
    const char* name;
    float& (*of)(Settings&);
    float low;
    float high;
    friend void PrintTo(const Range& r, std::ostream* out) { *out << r.name; }
};

const Range kRanges[] = {
    {"commit", [](Settings& s) -> float& { return s.commit; }, 0.5F, 60.0F},
    {"prediction_step", [](Settings& s) -> float& { return s.prediction_step; }, 0.02F, 0.5F},
    {"fallback_horizon", [](Settings& s) -> float& { return s.fallback_horizon; }, 1.0F, 20.0F},
    {"reserve", [](Settings& s) -> float& { return s.reserve; }, 0.0F, 5.0F},
    {"settle", [](Settings& s) -> float& { return s.settle; }, 0.0F, 10.0F},
    {"clear_extra", [](Settings& s) -> float& { return s.clear_extra; }, 0.0F, 10.0F},
    {"on_leg", [](Settings& s) -> float& { return s.on_leg; }, 0.05F, 50.0F},
    {"blocked_patience", [](Settings& s) -> float& { return s.blocked_patience; }, 0.0F, 600.0F},
    {"back_off_speed", [](Settings& s) -> float& { return s.back_off_speed; }, 0.0F, 5.0F},
    {"back_off_limit", [](Settings& s) -> float& { return s.back_off_limit; }, 0.0F, 600.0F},
    {"least_control", [](Settings& s) -> float& { return s.least_control; }, 0.0F, 60.0F},
    {"patience", [](Settings& s) -> float& { return s.patience; }, 0.0F, 600.0F},
};

struct SettingsRanges : testing::TestWithParam<Range> {
    [[nodiscard]] static bool takes(float value)
    {
        Settings s;
        GetParam().of(s) = value;
        return is_valid(s);
    }
};

TEST_P(SettingsRanges, HoldTheirEndsAndNothingBeyond)
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

INSTANTIATE_TEST_SUITE_P(Of, SettingsRanges, testing::ValuesIn(kRanges),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(SettingsOfBudgets, HoldTheirEnds)
{
    constexpr std::uint32_t kSlice = WorkPerUpdate::kMinSlice;
    const auto takes = [](WorkPerUpdate work, std::uint32_t plan, std::uint32_t kept) {
        Settings s;
        s.work = work;
        s.plan_budget = plan;
        s.kept_for_next = s.kept_for_reactive = kept;
        return is_valid(s);
    };
    EXPECT_TRUE(takes({kSlice + 1000, kSlice}, 1000, 1000)) << "a method may keep all of a plan back for the next";
    EXPECT_TRUE(takes({kSlice + 1000, kSlice}, 100, 100));
    EXPECT_TRUE(takes({kSlice + 1000, kSlice}, 50'000, 100)) << "a plan may take many updates";
    EXPECT_FALSE(takes({kSlice + 1000, kSlice - 1}, 100, 100)) << "a slice has to hold the largest piece of work";
    EXPECT_FALSE(takes({kSlice + 999, kSlice}, 100, 100)) << "the mandatory part needs its own";
    EXPECT_FALSE(takes({0, kSlice}, 100, 100));
    EXPECT_FALSE(takes({0xFFFFFFFF, 0xFFFFFFFF}, 100, 100));
    EXPECT_FALSE(takes({kSlice + 1000, kSlice}, 99, 0));
    EXPECT_FALSE(takes({kSlice + 1000, kSlice}, 500, 501));
}

}  // namespace
}  // namespace jink::avoid
