// SPDX-License-Identifier: BSD-3-Clause
#include "hal/counter_clock.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "hal/stm32/independent_watchdog.hpp"
#include "hal/stm32f4/clock_tree.hpp"

namespace jink::hal {
namespace {

TEST(CounterClock, FollowsItsCounterAcrossWraps)
{
    for (const auto direction : {CounterClock::Direction::up, CounterClock::Direction::down}) {
        volatile std::uint32_t counter = 0xFFFFFF00;
        CounterClock clock(counter, direction, 25'000'000);
        Random random(5);
        std::uint64_t ticks = 0;
        for (int i = 0; i < 10'000; ++i) {
            const auto passed = static_cast<std::uint32_t>(random.below(0xFFFFFFFF));
            ticks += passed;
            counter = direction == CounterClock::Direction::up ? counter + passed : counter - passed;
            ASSERT_EQ(clock.now_us(), static_cast<std::int64_t>(ticks / 25));
        }
    }
}

TEST(CounterClock, CountsSlowTicksWhole)
{
    volatile std::uint32_t counter = 0;
    CounterClock clock(counter, CounterClock::Direction::up, 1000);
    counter = 3;
    EXPECT_EQ(clock.now_us(), 3000);
}

/// Clock control that starts as far as configured.
struct RccModel {
    std::uint32_t control = 0x83, pll = 0x24003010, configuration = 0, flash = 0;
    bool has_crystal = true, has_pll = true, switches = true;
    bool flash_was_ready = true;  ///< the wait states were there before the clock rose
};
struct ByRcc {
    RccModel* m;
    std::uint32_t read(std::uint32_t offset) const
    {
        switch (offset) {
        case 0x00: return m->control;
        case 0x04: return m->pll;
        case 0x08: return m->configuration;
        default: ADD_FAILURE(); return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        switch (offset) {
        case 0x00:
            m->control = value & ~((1U << 17U) | (1U << 25U));
            m->control |= (value & (1U << 16U)) != 0 && m->has_crystal ? 1U << 17U : 0U;
            m->control |= (value & (1U << 24U)) != 0 && m->has_pll ? 1U << 25U : 0U;
            break;
        case 0x04: m->pll = value; break;
        case 0x08:
            m->configuration = value & ~0xCU;
            m->configuration |= m->switches ? (value & 3U) << 2U : 0U;
            m->flash_was_ready = m->flash_was_ready && ((value & 3U) != 2U || (m->flash & 7U) == 5U);
            break;
        default: ADD_FAILURE();
        }
    }
};
struct ByFlash {
    RccModel* m;
    std::uint32_t read(std::uint32_t) const { return m->flash; }
    void write(std::uint32_t, std::uint32_t value) const { m->flash = value; }
};

/// Output of the PLL by the manual's formula (RM0090, 7.3.2).
double pll_output(const RccModel& m)
{
    const double input = (m.pll & (1U << 22U)) != 0 ? 8e6 : 16e6;
    const double divided = input / (m.pll & 0x3FU);
    const unsigned p = 2 * (((m.pll >> 16U) & 3U) + 1);
    return divided * ((m.pll >> 6U) & 0x1FFU) / p;
}

TEST(ClockTree, ReachesFullSpeedFromTheCrystal)
{
    RccModel model;
    const stm32::Clocks clocks = stm32f4::start_clocks(ByRcc{&model}, ByFlash{&model});
    EXPECT_EQ(clocks.source, stm32::ClockSource::crystal);
    EXPECT_EQ(clocks.processor, 168'000'000U);
    EXPECT_EQ(clocks.apb1, 42'000'000U);
    EXPECT_EQ(clocks.apb2, 84'000'000U);
    EXPECT_EQ(clocks.timer, 84'000'000U);
    EXPECT_DOUBLE_EQ(pll_output(model), 168e6);
    EXPECT_TRUE(model.flash_was_ready);
    EXPECT_EQ((model.configuration >> 10U) & 7U, 5U);  // APB1 by 4
    EXPECT_EQ((model.configuration >> 13U) & 7U, 4U);  // APB2 by 2
}

TEST(ClockTree, GoesOnWithoutACrystalWithoutAPllAndWithoutClockControl)
{
    RccModel no_crystal;
    no_crystal.has_crystal = false;
    EXPECT_EQ(stm32f4::start_clocks(ByRcc{&no_crystal}, ByFlash{&no_crystal}).source, stm32::ClockSource::internal_pll);
    EXPECT_DOUBLE_EQ(pll_output(no_crystal), 168e6);

    RccModel no_pll;
    no_pll.has_pll = false;
    const stm32::Clocks slow = stm32f4::start_clocks(ByRcc{&no_pll}, ByFlash{&no_pll});
    EXPECT_EQ(slow.source, stm32::ClockSource::internal);
    EXPECT_EQ(slow.processor, 16'000'000U);
    EXPECT_EQ(slow.apb2, 16'000'000U);
    EXPECT_EQ(slow.timer, 16'000'000U);

    RccModel no_switch;
    no_switch.switches = false;
    EXPECT_EQ(stm32f4::start_clocks(ByRcc{&no_switch}, ByFlash{&no_switch}).processor, 16'000'000U);

    RccModel nothing;
    nothing.control = 0;
    const stm32::Clocks emulated = stm32f4::start_clocks(ByRcc{&nothing}, ByFlash{&nothing});
    EXPECT_EQ(emulated.source, stm32::ClockSource::emulator);
    EXPECT_EQ(emulated.processor, 168'000'000U);
}

struct WatchdogModel {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> writes;
};
struct ByWatchdog {
    WatchdogModel* m;
    std::uint32_t read(std::uint32_t) const { return 3; }  // the slow clock never takes it over
    void write(std::uint32_t offset, std::uint32_t value) const { m->writes.emplace_back(offset, value); }
};

TEST(IndependentWatchdog, IsStartedUnlockedSetAndFed)
{
    WatchdogModel model;
    stm32::IndependentWatchdog<ByWatchdog> watchdog{ByWatchdog{&model}};
    watchdog.start(250);
    watchdog.feed();
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected{{0, 0xCCCC}, {0, 0x5555}, {4, 3},
                                                                        {8, 250},    {0, 0xAAAA}, {0, 0xAAAA}};
    EXPECT_EQ(model.writes, expected);
}

}  // namespace
}  // namespace jink::hal
