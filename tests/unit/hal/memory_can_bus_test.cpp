// SPDX-License-Identifier: BSD-3-Clause
// The bus in memory must behave as tests assume: arbitration, time on the wire, counted losses.
#include <gtest/gtest.h>

#include "hal/memory/manual_clock.hpp"
#include "hal/memory/memory_can_bus.hpp"

namespace jink::hal {
namespace {

class MemoryCanBusTest : public testing::Test {
protected:
    static CanFrame frame(std::uint32_t id, std::uint8_t length = 8)
    {
        CanFrame f;
        f.id = id;
        f.extended = true;
        f.length = length;
        return f;
    }
    std::vector<std::uint32_t> drain(std::size_t port)
    {
        std::vector<std::uint32_t> ids;
        CanFrame f;
        while (bus->port(port).receive(f)) {
            ids.push_back(f.id);
        }
        return ids;
    }

    ManualClock clock{1000};
    std::unique_ptr<MemoryCanBus> bus = std::make_unique<MemoryCanBus>(clock, 5);
};

TEST_F(MemoryCanBusTest, FramesTakeTheirTimeAndReachAllOthers)
{
    ASSERT_TRUE(bus->port(0).send(frame(7)));
    clock.advance(159);
    EXPECT_TRUE(drain(1).empty()) << "160 bits at 1 Mbit/s";
    clock.advance(1);
    EXPECT_EQ(drain(1), std::vector<std::uint32_t>{7});
    EXPECT_EQ(drain(2), std::vector<std::uint32_t>{7});
    EXPECT_TRUE(drain(0).empty()) << "not to oneself";
}

TEST_F(MemoryCanBusTest, TheLowestIdentifierGoesFirstAndEachPortKeepsItsOrder)
{
    ASSERT_TRUE(bus->port(0).send(frame(9)));
    ASSERT_TRUE(bus->port(0).send(frame(1)));  // behind 9: a controller's queue has an order
    ASSERT_TRUE(bus->port(1).send(frame(5)));
    clock.advance(10'000);
    EXPECT_EQ(drain(2), (std::vector<std::uint32_t>{5, 9, 1}));
}

TEST_F(MemoryCanBusTest, WhatCameLaterDoesNotOvertakeWhatWasOnTheWire)
{
    ASSERT_TRUE(bus->port(0).send(frame(9)));
    clock.advance(100);
    ASSERT_TRUE(bus->port(1).send(frame(1)));
    clock.advance(10'000);
    EXPECT_EQ(drain(2), (std::vector<std::uint32_t>{9, 1}));
}

TEST_F(MemoryCanBusTest, LossesAndRepetitionsHitOneReceiver)
{
    CanFaults faults;
    faults.loss_per_million = 200'000;
    faults.duplicate_per_million = 100'000;
    bus->set_faults(faults);
    std::size_t got = 0;
    std::size_t differ = 0;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        ASSERT_TRUE(bus->port(0).send(frame(i)));
        clock.advance(200);
        const std::size_t a = drain(1).size();
        got += a;
        differ += a != drain(2).size() ? 1U : 0U;
    }
    EXPECT_NEAR(static_cast<double>(got), 5000 * 0.8 * 1.1, 150.0);
    EXPECT_GT(differ, 500U);
}

TEST_F(MemoryCanBusTest, FullQueuesRefuseAndOverrun)
{
    CanFaults faults;
    faults.transmit_frames = 10;
    faults.receive_frames = 4;
    faults.unacknowledged = true;
    bus->set_faults(faults);
    for (std::uint32_t i = 0; i < 12; ++i) {
        EXPECT_EQ(bus->port(0).send(frame(i)), i < 10);
    }
    clock.advance(100'000);
    EXPECT_TRUE(drain(1).empty()) << "nobody answers";
    EXPECT_EQ(bus->port(0).waiting(), 10U);
    faults.unacknowledged = false;
    bus->set_faults(faults);
    clock.advance(100'000);
    EXPECT_EQ(drain(1).size(), 4U);
    EXPECT_EQ(bus->port(1).health().overruns, 6U);
    EXPECT_EQ(bus->port(0).health().frames_refused, 2U);
}

TEST_F(MemoryCanBusTest, APortThatIsOffTheBusLosesWhatWaits)
{
    for (const CanState off : {CanState::down, CanState::bus_off, CanState::closed}) {
        ASSERT_TRUE(bus->port(0).send(frame(1)));
        bus->port(0).become(off);
        EXPECT_FALSE(bus->port(0).send(frame(2)));
        ASSERT_TRUE(bus->port(1).send(frame(3)));
        clock.advance(1000);
        bus->port(0).become(CanState::active);
        EXPECT_TRUE(drain(0).empty());
        EXPECT_TRUE(drain(1).empty());
        EXPECT_EQ(drain(2), std::vector<std::uint32_t>{3});
    }
    const CanHealth health = bus->port(0).health();
    EXPECT_EQ(health.downs, 1U);
    EXPECT_EQ(health.ups, 1U);
    EXPECT_EQ(health.bus_offs, 1U);
    EXPECT_EQ(health.restarts, 1U);
}

TEST_F(MemoryCanBusTest, FdIsNoFrameOfThisBus)
{
    CanFrame fd = frame(1, 12);
    fd.fd = true;
    EXPECT_FALSE(bus->port(0).send(fd));
    EXPECT_EQ(bus->port(0).health().frames_bad, 1U);
}

}  // namespace
}  // namespace jink::hal
