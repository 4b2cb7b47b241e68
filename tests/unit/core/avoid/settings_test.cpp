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
    {"clutter_radius", [](Settings& s) -> float& { return s.clutter_radius; }, 1.0F, 200.0F},
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
    const auto takes = [](std::uint32_t budget, std::uint32_t plan, std::uint32_t kept) {
        Settings s;
        s.budget = budget;
        s.plan_budget = plan;
        s.kept_for_next = kept;
        return is_valid(s);
    };
    EXPECT_TRUE(takes(1000, 1000, 1000)) << "a plan may have all of it, and keep all of that back";
    EXPECT_TRUE(takes(1000, 100, 100));
    EXPECT_FALSE(takes(999, 100, 100));
    EXPECT_FALSE(takes(1000, 99, 0));
    EXPECT_FALSE(takes(1000, 1001, 0));
    EXPECT_FALSE(takes(1000, 500, 501));
}

TEST(MethodOrder, HoldsEachIdOnceAndNeverZero)
{
    MethodOrder order;
    EXPECT_TRUE(order.empty());
    EXPECT_EQ(order.size(), 0U);
    EXPECT_FALSE(order.contains(0)) << "0 is the end of it";
    EXPECT_FALSE(order.try_add(0));
    for (std::uint8_t id = 1; id <= kMaxMethods; ++id) {
        EXPECT_TRUE(order.try_add(id));
        EXPECT_FALSE(order.try_add(id)) << "again";
        EXPECT_EQ(order.size(), id);
        EXPECT_TRUE(order.contains(id));
    }
    EXPECT_FALSE(order.try_add(kMaxMethods + 1)) << "full";
    EXPECT_EQ(order.ids().size(), kMaxMethods);
    EXPECT_EQ(order.ids().back(), kMaxMethods);
    const std::uint8_t one = 1;
    const std::uint8_t two = 2;
    EXPECT_EQ(MethodOrder(two, one, two), MethodOrder(two, one)) << "an id that comes again counts once";
    EXPECT_NE(MethodOrder(two, one), MethodOrder(one, two));
}

TEST(Settings, ThatAreRefusedChangeNothing)
{
    FakeMethod method = never();
    Settings first;
    first.commit = 11.0F;
    Supervisor supervisor(first, method);
    Settings bad;
    bad.commit = 12.0F;
    bad.clear_extra = -1.0F;
    EXPECT_FALSE(supervisor.configure(bad));
    EXPECT_EQ(supervisor.settings().commit, 11.0F);
    EXPECT_EQ(supervisor.settings().clear_extra, first.clear_extra);
    bad.clear_extra = 1.0F;
    EXPECT_TRUE(supervisor.configure(bad));
    EXPECT_EQ(supervisor.settings().commit, 12.0F);
    EXPECT_EQ(supervisor.settings().clear_extra, 1.0F);
}

}  // namespace
}  // namespace jink::avoid
