// SPDX-License-Identifier: BSD-3-Clause
// The clocks of the STM32H743 against a model of RCC, PWR and the flash's wait states (ST RM0433, 4.3.8, 6.8 and 8.7).
#include "hal/stm32h7/clock_tree.hpp"

#include <gtest/gtest.h>

namespace jink::hal {
namespace {

using stm32::ClockSource;
using stm32h7::ExternalClock;

/// Register values after a reset, and what the board has.
struct ClockModel {
    std::uint32_t control = 0x25, configuration = 0, d1 = 0, d2 = 0, d3 = 0;
    std::uint32_t sources = 0x02020200, settings = 0x01FF0000, dividers = 0x01010280;
    std::uint32_t supply = 0x6, scale = 0x4000;
    std::uint32_t access = 0x37;
    bool supply_is_locked = false;  ///< written since power-on
    bool voltage_comes = true, scale_comes = true, has_pll = true, switches = true, takes_waits = true;
    bool has_crystal = true, has_fed_clock = false;
    int faults = 0;

    [[nodiscard]] bool external_runs() const
    {
        const bool fed = (control & 1U << 18U) != 0;
        return (control & 1U << 16U) != 0 && (fed ? has_fed_clock : has_crystal);
    }
    [[nodiscard]] bool pll_runs() const
    {
        const bool source_runs = (sources & 3U) == 0 || ((sources & 3U) == 2 && external_runs());
        return (control & 1U << 24U) != 0 && has_pll && source_runs;
    }
    [[nodiscard]] bool at_scale1() const { return scale_comes && scale >> 14U == 3U && supply_is_set(); }
    [[nodiscard]] bool supply_is_set() const { return supply_is_locked && (supply & 3U) == 2U; }

    /// By the manual's formula (8.5) [Hz]: the processor's clock after the switch.
    [[nodiscard]] double pll_output() const
    {
        const double input = (sources & 3U) == 2 ? 8e6 : 64e6;
        const double reference = input / (sources >> 4U & 0x3FU);
        const unsigned range = settings >> 2U & 3U;
        EXPECT_EQ(range, reference < 2e6 ? 0U : reference < 4e6 ? 1U : reference < 8e6 ? 2U : 3U);
        const double oscillator = reference * ((dividers & 0x1FFU) + 1);
        EXPECT_EQ(settings & 2U, 0U) << "wide range";
        EXPECT_GE(oscillator, 192e6);
        EXPECT_LE(oscillator, 836e6);
        EXPECT_NE(settings & 1U << 16U, 0U) << "output P is on";
        EXPECT_EQ((dividers >> 9U & 0x7FU) % 2, 1U) << "P is even";
        return oscillator / ((dividers >> 9U & 0x7FU) + 1);
    }
    void switch_clock(std::uint32_t value)
    {
        configuration = value & ~(7U << 3U);
        if ((value & 7U) != 3U || !pll_runs() || !switches) {
            return;
        }
        configuration |= 3U << 3U;
        // What the faster clock needs must be there before.
        faults += at_scale1() ? 0 : 1;
        faults += access == 0x22 ? 0 : 1;
        faults += (d1 & 0xFU) == 8U ? 0 : 1;      // AXI at half of the processor's clock
        faults += (d1 >> 4U & 7U) == 4U ? 0 : 1;  // and each APB at half of that
        faults += (d2 & 0x770U) == 0x440U ? 0 : 1;
        faults += (d3 & 0x70U) == 0x40U ? 0 : 1;
        faults += (d1 >> 8U & 8U) == 0U ? 0 : 1;
    }
};

struct RccBlock {
    ClockModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        switch (offset) {
        case 0x00: return m->control | (m->external_runs() ? 1U << 17U : 0U) | (m->pll_runs() ? 1U << 25U : 0U);
        case 0x10: return m->configuration;
        case 0x28: return m->sources;
        case 0x2C: return m->settings;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        const bool pll_is_on = (m->control & 1U << 24U) != 0;
        const bool external_is_on = (m->control & 1U << 16U) != 0;
        switch (offset) {
        case 0x00:
            EXPECT_TRUE((value & 1U) != 0) << "the internal oscillator drives the processor";
            EXPECT_TRUE(!external_is_on || ((value ^ m->control) & 1U << 18U) == 0) << "the bypass is set before";
            EXPECT_FALSE(!external_is_on && (value & 1U << 16U) != 0 && ((value ^ m->control) & 1U << 18U) != 0)
                << "and not with the same write";
            m->control = value & ~(1U << 17U | 1U << 25U);
            break;
        case 0x10: m->switch_clock(value); break;
        case 0x18: m->d1 = value; break;
        case 0x1C: m->d2 = value; break;
        case 0x20: m->d3 = value; break;
        case 0x28:
            EXPECT_FALSE(pll_is_on);
            EXPECT_EQ((value ^ m->sources) & ~0x3F3U, 0U) << "the other two are as they were";
            m->sources = value;
            break;
        case 0x2C:
            EXPECT_FALSE(pll_is_on);
            EXPECT_EQ((value ^ m->settings) & ~0xFU, 0U);
            m->settings = value;
            break;
        case 0x30:
            EXPECT_FALSE(pll_is_on);
            m->dividers = value;
            break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
};
struct PowerBlock {
    ClockModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        switch (offset) {
        case 0x04: return m->voltage_comes && m->supply_is_set() ? 1U << 13U : 0U;
        case 0x0C: return m->supply;
        case 0x18: return m->scale | (m->at_scale1() ? 1U << 13U : 0U);
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        if (offset == 0x0C) {
            m->supply = m->supply_is_locked ? m->supply : value;
            m->supply_is_locked = true;
        } else if (offset == 0x18) {
            m->scale = value & 0xC000U;
        } else {
            ADD_FAILURE() << "not written: " << offset;
        }
    }
};
struct AccessBlock {
    ClockModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        EXPECT_EQ(offset, 0U);
        return m->access;
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        EXPECT_EQ(offset, 0U);
        m->access = m->takes_waits ? value : m->access;
    }
};

stm32::Clocks start(ClockModel& m, ExternalClock external = ExternalClock::crystal)
{
    const stm32::Clocks clocks = start_clocks(RccBlock{&m}, PowerBlock{&m}, AccessBlock{&m}, external);
    EXPECT_EQ(m.faults, 0) << "everything was there before the clock rose";
    return clocks;
}

void expect_full(const stm32::Clocks& clocks, const ClockModel& m)
{
    EXPECT_EQ(clocks.processor, 400'000'000U);
    EXPECT_EQ(clocks.apb1, 100'000'000U);
    EXPECT_EQ(clocks.apb2, 100'000'000U);
    EXPECT_EQ(clocks.timer, 200'000'000U) << "twice a divided bus";
    EXPECT_DOUBLE_EQ(m.pll_output(), 400e6);
    EXPECT_EQ(m.configuration, 3U | 3U << 3U);
    EXPECT_TRUE(m.at_scale1());
}

TEST(ClockTreeH7, ReachesFullSpeedFromTheCrystal)
{
    ClockModel model;
    const stm32::Clocks clocks = start(model);
    EXPECT_EQ(clocks.source, ClockSource::crystal);
    EXPECT_EQ(model.control & 1U << 18U, 0U);
    expect_full(clocks, model);
}

TEST(ClockTreeH7, ReachesFullSpeedFromAClockThatIsFed)
{
    ClockModel model;
    model.has_crystal = false;
    model.has_fed_clock = true;
    const stm32::Clocks clocks = start(model, ExternalClock::fed);
    EXPECT_EQ(clocks.source, ClockSource::crystal);
    expect_full(clocks, model);
}

TEST(ClockTreeH7, ReachesFullSpeedAfterAResetThatKeepsTheSupplyLocked)
{
    ClockModel model;
    model.supply_is_locked = true;
    model.supply = 2;
    expect_full(start(model), model);
}

TEST(ClockTreeH7, ReachesFullSpeedFromTheCrystalAfterAResetThatKeepsTheBypass)
{
    ClockModel model;
    model.control |= 1U << 18U;
    const stm32::Clocks clocks = start(model);
    EXPECT_EQ(clocks.source, ClockSource::crystal);
    EXPECT_EQ(model.control & 1U << 18U, 0U);
    expect_full(clocks, model);
}

TEST(ClockTreeH7, ReachesFullSpeedWithoutAnExternalClock)
{
    for (const ExternalClock external : {ExternalClock::crystal, ExternalClock::fed}) {
        ClockModel model;
        model.has_crystal = external == ExternalClock::fed;  // what is there does not match what was said
        const stm32::Clocks clocks = start(model, external);
        EXPECT_EQ(clocks.source, ClockSource::internal_pll);
        expect_full(clocks, model);
    }
}

TEST(ClockTreeH7, StaysWithTheInternalOscillatorWhereSomethingIsMissing)
{
    for (bool ClockModel::*const part :
         {&ClockModel::voltage_comes, &ClockModel::scale_comes, &ClockModel::has_pll, &ClockModel::takes_waits}) {
        ClockModel model;
        model.*part = false;
        const stm32::Clocks clocks = start(model);
        EXPECT_EQ(clocks.source, ClockSource::internal);
        EXPECT_EQ(clocks.processor, 64'000'000U);
        EXPECT_EQ(clocks.apb1, 64'000'000U);
        EXPECT_EQ(clocks.timer, 64'000'000U);
        EXPECT_EQ(model.configuration, 0U);
        EXPECT_EQ(model.d1 | model.d2 | model.d3, 0U) << "buses as they were";
    }
    ClockModel model;
    model.switches = false;
    const stm32::Clocks clocks = start(model);
    EXPECT_EQ(clocks.source, ClockSource::internal);
    EXPECT_EQ(clocks.processor, 64'000'000U);
    EXPECT_EQ(clocks.apb1, 16'000'000U) << "the buses are divided already";
    EXPECT_EQ(clocks.timer, 32'000'000U);
}

}  // namespace
}  // namespace jink::hal
