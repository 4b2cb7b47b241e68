// SPDX-License-Identifier: BSD-3-Clause
// CanBus at its limits: stalls, losses, contents of a NearObject, and the tunnel's counters.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

/// Delivers given frames; records output frames, up to a capacity.
struct CountedPort final : hal::CanPort {
    bool receive(hal::CanFrame& frame) noexcept override
    {
        if (in == 0) {
            return false;
        }
        --in;
        frame = one;
        return true;
    }
    bool send(const hal::CanFrame& frame) noexcept override
    {
        if (room == 0) {
            return false;
        }
        --room;
        out.push_back(frame);
        return true;
    }
    hal::CanHealth health() const noexcept override
    {
        hal::CanHealth health;
        health.state = state;
        return health;
    }
    hal::CanState state = hal::CanState::active;
    hal::CanFrame one;  ///< each that comes
    std::size_t in = 0;
    std::vector<hal::CanFrame> out;
    std::size_t room = 1U << 20U;
};

class CanBusEdges : public testing::Test {
protected:
    CanBusEdges() { port.one.extended = true; }
    void step(std::int64_t us = 20'000)
    {
        now.us += us;
        inbox.clear();
        bus.receive(now, inbox);
        bus.service(now, {link::SystemState::active, false, 0});
        listen();
    }
    void listen()
    {
        for (; heard_ < port.out.size(); ++heard_) {
            heard.hear(from_port(port.out[heard_]), now);
        }
    }
    /// Another node writes into our tunnel.
    void open_tunnel(std::size_t n)
    {
        can::TunnelTargetted m;
        m.protocol = 1;
        m.target = kOurNode;
        m.bytes.resize(n);
        const std::uint8_t transfer = transfer_++ % can::kTransferIds;
        for (const can::Frame& f : can::test::frames_of(m, Listener::kNode, transfer, can::Priority::medium, 0)) {
            port.one = to_port(f);
            port.in = 1;
            bus.receive(now, inbox);
        }
    }

    CountedPort port;
    CanBus bus{port, node_options()};
    link::Inbox inbox;
    TimePoint now{1'000'000};
    Listener heard;
    std::array<std::byte, 300> bytes{};

private:
    std::size_t heard_ = 0;
    std::uint8_t transfer_ = 0;
};

TEST_F(CanBusEdges, ANearObjectSaysItsAnglesInDegreesAndItsDistance)
{
    step();
    ASSERT_TRUE(bus.send_near({-0.5F, 0.25F, 7.0F}));
    listen();
    ASSERT_EQ(heard.near.size(), 1U) << "at once";
    EXPECT_NEAR(heard.near[0].yaw, -28.648F, 0.05F);
    EXPECT_NEAR(heard.near[0].pitch, 14.324F, 0.05F);
    EXPECT_EQ(heard.near[0].distance, 7.0F);
    EXPECT_EQ(heard.near[0].reading, can::Proximity::Reading::good);
    EXPECT_EQ(bus.diagnostics().near_not_sent, 0U);
}

TEST_F(CanBusEdges, WhatWaitedForMoreThanTheStallIsLate)
{
    step();
    port.in = 5;
    step(100'000);
    EXPECT_EQ(bus.diagnostics().frames_late, 0U) << "0.1 s to the microsecond";
    port.in = 5;
    step(100'001);
    EXPECT_EQ(bus.diagnostics().frames_late, 5U);
    port.in = 5;
    step();
    EXPECT_EQ(bus.diagnostics().frames_late, 5U);
    EXPECT_EQ(bus.diagnostics().full_steps, 0U);
}

TEST_F(CanBusEdges, BeforeTheFirstCallNothingIsLate)
{
    port.in = 5;
    step(10'000'000);
    EXPECT_EQ(bus.diagnostics().frames_late, 0U);
}

TEST_F(CanBusEdges, WhatIsLeftOfALateLotIsLateToo)
{
    step();
    port.in = CanBus::kMaxFramesPerStep + 1;
    step(200'000);
    EXPECT_EQ(bus.diagnostics().full_steps, 1U);
    EXPECT_EQ(bus.diagnostics().frames_late, CanBus::kMaxFramesPerStep);
    step();
    EXPECT_EQ(bus.diagnostics().frames_late, CanBus::kMaxFramesPerStep + 1U);
    port.in = 3;
    step();
    EXPECT_EQ(bus.diagnostics().frames_late, CanBus::kMaxFramesPerStep + 1U) << "the port was empty in between";
    // A full step in time is no late one.
    port.in = CanBus::kMaxFramesPerStep;
    step();
    port.in = 2;
    step();
    EXPECT_EQ(bus.diagnostics().full_steps, 2U);
    EXPECT_EQ(bus.diagnostics().frames_late, CanBus::kMaxFramesPerStep + 1U);
}

TEST_F(CanBusEdges, AStallIsLongerThanItsTimeWithoutAFrameTaken)
{
    step();
    open_tunnel(1);
    step();
    port.room = 0;
    ASSERT_EQ(bus.serial().write(std::span(bytes).first(100)), 100U);
    step(50'000);
    step(50'000);
    EXPECT_EQ(bus.diagnostics().stalls, 0U) << "0.1 s to the microsecond";
    EXPECT_NE(bus.endpoint().pending(), nullptr);
    step(1);
    EXPECT_EQ(bus.diagnostics().stalls, 1U);
    EXPECT_EQ(bus.endpoint().pending(), nullptr);
    EXPECT_EQ(bus.diagnostics().losses, 0U);
    port.room = 1000;
    step(900'000);  // idle: later frames wait from then on
    port.room = 0;
    ASSERT_GT(bus.serial().write(std::span(bytes).first(50)), 0U);
    step(50'000);
    EXPECT_EQ(bus.diagnostics().stalls, 1U);
}

TEST_F(CanBusEdges, AFrameTakenIsProgress)
{
    step();
    open_tunnel(1);
    step();
    port.room = 0;
    ASSERT_EQ(bus.serial().write(std::span(bytes).first(100)), 100U);
    for (int i = 0; i < 5; ++i) {
        port.room = 1;
        step(90'000);
    }
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
    EXPECT_NE(bus.endpoint().pending(), nullptr);
}

TEST_F(CanBusEdges, ALossCountsWhereSomethingWaited)
{
    using State = hal::CanState;
    step();
    for (const State lost : {State::down, State::bus_off, State::closed}) {
        port.state = lost;
        EXPECT_TRUE(bus.is_lost());
    }
    for (const State there : {State::active, State::error_passive}) {
        port.state = there;
        EXPECT_FALSE(bus.is_lost());
    }
    port.state = State::down;
    const std::size_t before = port.out.size();
    now.us += 20'000;
    bus.receive(now, inbox);
    EXPECT_EQ(bus.diagnostics().losses, 0U);
    static_cast<void>(bus.send_near({0.0F, 0.0F, 5.0F}));
    EXPECT_EQ(bus.diagnostics().losses, 1U) << "the NearObject that nobody takes";
    EXPECT_EQ(bus.endpoint().pending(), nullptr);
    EXPECT_EQ(port.out.size(), before);
}

TEST_F(CanBusEdges, TheTunnelCountsWhatItGaveAndRefused)
{
    step();
    open_tunnel(40);
    step();
    EXPECT_EQ(bus.serial().read(std::span(bytes).first(15)), 15U);
    EXPECT_EQ(bus.serial().read(bytes), 25U);
    EXPECT_EQ(bus.serial().health().bytes_in, 40U);
    port.room = 0;
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(60)), 60U);
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(60)), 0U) << "frames wait";
    EXPECT_EQ(bus.diagnostics().tunnel_withheld, 1U);
    EXPECT_EQ(bus.serial().health().bytes_out, 60U);
    EXPECT_EQ(bus.serial().health().bytes_refused, 60U);
    EXPECT_EQ(bus.serial().health().overruns, 0U);
}

TEST_F(CanBusEdges, TheTunnelIsLostAndBackByTheController)
{
    using State = hal::CanState;
    EXPECT_EQ(bus.serial().health().state, hal::PortState::open) << "as the controller is";
    step();
    EXPECT_EQ(bus.serial().health().disconnects, 0U);
    EXPECT_EQ(bus.serial().health().reconnects, 0U) << "the first time is none";
    open_tunnel(10);
    port.state = State::error_passive;
    EXPECT_EQ(bus.serial().health().state, hal::PortState::lost);
    step();
    EXPECT_EQ(bus.serial().health().disconnects, 1U);
    EXPECT_EQ(bus.serial().read(bytes), 0U);
    EXPECT_EQ(bus.diagnostics().tunnel_dropped, 10U);
    EXPECT_EQ(bus.serial().health().bytes_in, 0U);
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(5)), 0U);
    EXPECT_EQ(bus.diagnostics().tunnel_withheld, 0U) << "lost, not withheld";
    step();
    EXPECT_EQ(bus.serial().health().disconnects, 1U);
    port.state = State::active;
    step();
    EXPECT_EQ(bus.serial().health().reconnects, 1U);
    step();
    EXPECT_EQ(bus.serial().health().reconnects, 1U);
    open_tunnel(3);
    EXPECT_EQ(bus.serial().read(bytes), 3U);
}

}  // namespace
}  // namespace jink::app
