// SPDX-License-Identifier: BSD-3-Clause
// What the STM32F4 and H7 share, against models of their registers: clocks of peripherals, pins, the timer. And the AXI
// SRAM of the H7.
#include <array>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "hal/stm32/microsecond_timer.hpp"
#include "hal/stm32/pin_pair.hpp"
#include "hal/stm32h7/axi_sram.hpp"

namespace jink::hal {
namespace {

/// Registers that hold what is written, and the accesses to them in their order.
struct PlainBlock {
    std::map<std::uint32_t, std::uint32_t>* values;
    std::vector<std::pair<std::uint32_t, bool>>* accesses;  ///< offset, whether it was a write

    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        accesses->emplace_back(offset, false);
        return (*values)[offset];
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        accesses->emplace_back(offset, true);
        (*values)[offset] = value;
    }
};

struct Plain {
    std::map<std::uint32_t, std::uint32_t> values;
    std::vector<std::pair<std::uint32_t, bool>> accesses;
    PlainBlock block() { return {&values, &accesses}; }
};

TEST(ClockEnable, AddsItsBitsAndWaitsByARead)
{
    Plain rcc;
    rcc.values[0xE8] = 0x80000001;
    stm32::enable_clock(rcc.block(), 0xE8, 1U << 18U);
    EXPECT_EQ(rcc.values[0xE8], 0x80040001U);
    EXPECT_EQ(rcc.accesses, (std::vector<std::pair<std::uint32_t, bool>>{{0xE8, false}, {0xE8, true}, {0xE8, false}}));
}

/// Of each pin: mode, pull, function.
std::vector<std::array<std::uint32_t, 3>> pins_of(const std::map<std::uint32_t, std::uint32_t>& port)
{
    std::vector<std::array<std::uint32_t, 3>> pins;
    for (std::uint32_t pin = 0; pin < 16; ++pin) {
        pins.push_back({port.at(0x00) >> (2 * pin) & 3U, port.at(0x0C) >> (2 * pin) & 3U,
                        port.at(pin < 8 ? 0x20 : 0x24) >> (4 * (pin % 8)) & 0xFU});
    }
    return pins;
}

TEST(PinPair, ConnectsItsTwoPinsAndLeavesTheOthersAlone)
{
    Random random(3);
    for (std::uint32_t first = 0; first <= 14; ++first) {
        for (const std::uint32_t pulled_up : {first, first + 1}) {
            if (first == 7) {
                continue;  // not a pair
            }
            Plain rcc;
            Plain port;
            for (const std::uint32_t offset : {0x00U, 0x0CU, 0x20U, 0x24U}) {
                port.values[offset] = static_cast<std::uint32_t>(random.next());
            }
            auto expected = pins_of(port.values);
            expected[first] = {2, pulled_up == first ? 1U : 0U, 7};
            expected[first + 1] = {2, pulled_up == first ? 0U : 1U, 7};
            stm32::start_pins(rcc.block(), port.block(), {0xE0, 1U << 3U, 0xE8, 1U << 18U, first, 7, pulled_up});
            EXPECT_EQ(rcc.values[0xE0], 1U << 3U);
            EXPECT_EQ(rcc.values[0xE8], 1U << 18U);
            EXPECT_EQ(pins_of(port.values), expected) << first;
            // The function first: in the other order the pins would carry function 0 at first.
            EXPECT_EQ(port.accesses.back(), (std::pair<std::uint32_t, bool>{0x00, true}));
            EXPECT_EQ(port.values.size(), 4U) << "no other register";
        }
    }
}

TEST(MicrosecondTimer, DividesItsClockToAMegahertzAndTurnsThrough32Bits)
{
    for (const std::uint32_t clock : {16'000'000U, 84'000'000U, 200'000'000U}) {
        Plain timer;
        stm32::start_microseconds(timer.block(), clock);
        EXPECT_EQ(clock / (timer.values[0x28] + 1), 1'000'000U);
        EXPECT_EQ(timer.values[0x2C], 0xFFFFFFFFU);
        EXPECT_EQ(timer.values[0x00], 1U);
        // The prescaler is loaded by the event, before the timer runs.
        EXPECT_EQ(timer.accesses, (std::vector<std::pair<std::uint32_t, bool>>{
                                      {0x28, true}, {0x2C, true}, {0x14, true}, {0x00, true}}));
    }
}

TEST(AxiSram, IsReadOneAccessAtATimeOnRevisionsThatReadWrongDataOtherwise)
{
    for (const std::uint32_t revision : {0x1001U, 0x1003U, 0x2001U, 0x2003U}) {  // Z, Y, X, V
        Plain debug;
        Plain matrix;
        debug.values[0] = revision << 16U | 0x6450U;
        stm32h7::settle_axi_sram(debug.block(), matrix.block());
        EXPECT_EQ(matrix.values.size(), revision < 0x2000 ? 1U : 0U) << revision;
        EXPECT_EQ(matrix.values[0x8108], revision < 0x2000 ? 1U : 0U) << revision;
    }
}

}  // namespace
}  // namespace jink::hal
