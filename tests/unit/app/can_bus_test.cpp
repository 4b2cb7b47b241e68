// SPDX-License-Identifier: BSD-3-Clause
// CanBus alone: frames from and to a controller, and refusal of outdated frames.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

// Where both ends copy frames by the same two functions, a mistake in one may undo that in the other: each by itself.
constexpr bool copies_all(bool extended, bool remote)
{
    can::Frame ours;
    hal::CanFrame theirs;
    ours.id = theirs.id = extended ? 0x1ABCDEF2 : 0x5A3;
    ours.extended = theirs.extended = extended;
    ours.remote = theirs.remote = remote;
    ours.length = theirs.length = 7;
    for (unsigned i = 0; i < can::Frame::kBytes; ++i) {
        ours.data[i] = theirs.data[i] = std::byte(0x11 * (i + 1));
    }
    const hal::CanFrame out = to_port(ours);
    return from_port(theirs) == ours && out.id == theirs.id && out.extended == extended && out.remote == remote &&
           !out.fd && !out.bit_rate_switch && out.length == 7 && out.data == theirs.data;
}
static_assert(copies_all(true, false) && copies_all(true, true) && copies_all(false, false) && copies_all(false, true));

/// A controller operated by the test: delivers given frames, records output frames with their times.
class FakePort final : public hal::CanPort {
public:
    bool receive(hal::CanFrame& frame) noexcept override
    {
        if (in.empty()) {
            return false;
        }
        frame = in.front();
        in.erase(in.begin());
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
    hal::CanHealth health() const noexcept override { return health_; }

    hal::CanHealth health_{hal::CanState::active};
    std::vector<hal::CanFrame> in;
    std::vector<hal::CanFrame> out;
    std::size_t room = 1U << 20U;
};

class CanBusTest : public testing::Test {
protected:
    void step(Seconds gap = 0.02F)
    {
        now.us += std::llround(gap * 1e6F);
        inbox.clear();
        bus.receive(now, inbox);
        bus.service(now, {link::SystemState::active, false, 0});
        for (; heard_ < port.out.size(); ++heard_) {
            heard.hear(from_port(port.out[heard_]), now);
        }
    }
    template <class M>
    void arrive(const M& message, std::uint8_t node = 20, std::uint8_t destination = 0)
    {
        const std::uint8_t transfer = transfers_[node]++ % can::kTransferIds;
        for (const can::Frame& f : can::test::frames_of(message, node, transfer, can::Priority::medium, destination)) {
            port.in.push_back(to_port(f));
        }
    }
    void arrive_bytes(std::size_t n)
    {
        can::TunnelTargetted m;
        m.protocol = 1;
        m.target = kOurNode;
        m.bytes.resize(n);
        arrive(m, Listener::kNode);
    }

    FakePort port;
    CanBus bus{port, node_options()};
    link::Inbox inbox;
    TimePoint now{1'000'000};
    Listener heard;
    std::array<std::byte, 300> bytes{};

private:
    std::size_t heard_ = 0;
    std::array<std::uint8_t, 128> transfers_{};
};

TEST_F(CanBusTest, IsANodeOnTheBus)
{
    step();
    ASSERT_EQ(heard.statuses.size(), 1U);
    arrive(can::GetNodeInfoRequest{}, Listener::kNode, kOurNode);
    step();
    ASSERT_EQ(heard.infos.size(), 1U);
    EXPECT_EQ(heard.infos[0].hardware.unique_id, node_options().unique_id);
    for (int i = 0; i < 500; ++i) {
        step();
    }
    EXPECT_EQ(heard.statuses.size(), 11U) << "one a second";
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
}

TEST_F(CanBusTest, TellsWhetherItIsOnlyAdvising)
{
    bus.receive(now, inbox);
    bus.service(now, {link::SystemState::boot, true, 0x4321});
    ASSERT_EQ(port.out.size(), 1U);
    heard.hear(from_port(port.out[0]), now);
    ASSERT_EQ(heard.statuses.size(), 1U);
    EXPECT_EQ(heard.statuses[0].health, can::Health::warning);
    EXPECT_EQ(heard.statuses[0].mode, can::Mode::operational);
    EXPECT_EQ(heard.statuses[0].vendor_status, 0x4321);
}

TEST_F(CanBusTest, TakesABoundedNumberOfFramesPerStep)
{
    for (std::size_t i = 0; i < CanBus::kMaxFramesPerStep + 100; ++i) {
        arrive(BusBench::attitude(0.0F), static_cast<std::uint8_t>(1 + i % 40));
    }
    const std::size_t all = port.in.size();
    step();
    EXPECT_EQ(all - port.in.size(), CanBus::kMaxFramesPerStep);
    EXPECT_EQ(bus.diagnostics().full_steps, 1U);
    EXPECT_EQ(bus.diagnostics().frames_late, 0U);
}

TEST_F(CanBusTest, DropsWhatWaitedWhileNobodyStepped)
{
    step();
    for (int i = 0; i < 150; ++i) {  // 1200 frames: three steps' worth
        arrive(BusBench::fix(Vec3::Zero()), 20);
    }
    const std::size_t all = port.in.size();
    ASSERT_GT(all, 2 * CanBus::kMaxFramesPerStep);
    step(0.11F);
    EXPECT_FALSE(inbox.has_bus_state) << "of unknown age";
    while (!port.in.empty()) {
        step();
        EXPECT_FALSE(inbox.has_bus_state) << "from before, in a later step";
    }
    EXPECT_EQ(bus.diagnostics().frames_late, all);
    arrive(BusBench::fix(Vec3::Zero()), 20);
    step();
    EXPECT_TRUE(inbox.has_bus_state) << "and what comes then is taken";
    arrive(BusBench::fix(Vec3::Zero()), 20);
    step(0.1F);
    EXPECT_TRUE(inbox.has_bus_state) << "a late step is none of these";
}

TEST_F(CanBusTest, TheTunnelIsASerialPort)
{
    step();
    EXPECT_EQ(bus.serial().health().state, hal::PortState::open);
    EXPECT_EQ(bus.serial().write(bytes), 0U) << "nobody is there yet";
    arrive_bytes(100);
    step();
    EXPECT_EQ(bus.serial().read(bytes), 100U);
    EXPECT_EQ(bus.serial().read(bytes), 0U);
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(200)), 200U);
    step();
    ASSERT_EQ(heard.tunnelled.size(), 2U);
    EXPECT_EQ(heard.tunnelled[0].target, Listener::kNode);
    EXPECT_EQ(heard.tunnelled[0].bytes.size() + heard.tunnelled[1].bytes.size(), 200U);
    const hal::PortHealth health = bus.serial().health();
    EXPECT_EQ(health.bytes_in, 100U);
    EXPECT_EQ(health.bytes_out, 200U);
    EXPECT_EQ(health.bytes_refused, bytes.size());
}

TEST_F(CanBusTest, OnABusThatTakesNothingBytesWaitWithWhoeverWritesThem)
{
    arrive_bytes(1);
    step();
    port.room = 3;
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(100)), 100U) << "17 frames, 3 of them gone";
    for (int i = 0; i < 4; ++i) {
        step();
        EXPECT_EQ(bus.serial().write(std::span(bytes).first(100)), 0U);
        EXPECT_FALSE(bus.send_near({0.0F, 0.0F, 5.0F}));
    }
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
    EXPECT_EQ(bus.diagnostics().tunnel_withheld, 4U);
    EXPECT_EQ(bus.diagnostics().near_not_sent, 4U);
    const std::size_t gone = port.out.size();
    step(0.021F);
    EXPECT_EQ(bus.diagnostics().stalls, 1U) << "0.1 s without a frame taken";
    port.room = 1000;
    step();
    for (std::size_t i = gone; i < port.out.size(); ++i) {
        EXPECT_NE(can::unpack(port.out[i].id).type, can::TunnelTargetted::kType.id) << "older than 0.1 s";
    }
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(100)), 100U) << "and it goes on";
}

TEST_F(CanBusTest, ASlowBusIsNoStall)
{
    arrive_bytes(1);
    step();
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(120)), 120U);
    port.out.clear();
    port.room = 0;
    EXPECT_EQ(bus.serial().write(std::span(bytes).first(120)), 120U);
    for (int i = 0; i < 30; ++i) {
        port.room = 1;
        step(0.05F);
    }
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
    EXPECT_GE(port.out.size(), 19U);
}

TEST_F(CanBusTest, NothingOldGoesOutAfterALoss)
{
    arrive_bytes(1);
    step();
    for (const hal::CanState lost : {hal::CanState::down, hal::CanState::bus_off, hal::CanState::closed}) {
        port.room = 2;
        EXPECT_EQ(bus.serial().write(std::span(bytes).first(100)), 100U);
        port.health_.state = lost;
        EXPECT_TRUE(bus.is_lost());
        EXPECT_EQ(bus.serial().health().state, hal::PortState::lost);
        const std::uint32_t losses = bus.diagnostics().losses;
        step();
        EXPECT_EQ(bus.diagnostics().losses, losses + 1);
        EXPECT_EQ(bus.endpoint().pending(), nullptr);
        EXPECT_EQ(bus.serial().write(bytes), 0U);
        const std::size_t gone = port.out.size();
        port.room = 1000;
        port.health_.state = hal::CanState::active;
        step();
        for (std::size_t i = gone; i < port.out.size(); ++i) {
            EXPECT_NE(can::unpack(port.out[i].id).type, can::TunnelTargetted::kType.id);
        }
    }
    EXPECT_EQ(bus.serial().health().disconnects, 3U);
    EXPECT_EQ(bus.serial().health().reconnects, 3U);
}

TEST_F(CanBusTest, AControllerThatNobodyAnswersCarriesNoMavlink)
{
    arrive_bytes(1);
    step();
    static_cast<void>(bus.serial().read(bytes));
    port.health_.state = hal::CanState::error_passive;
    EXPECT_EQ(bus.serial().health().state, hal::PortState::lost);
    EXPECT_FALSE(bus.is_lost()) << "what is heard is heard";
    EXPECT_EQ(bus.serial().write(bytes), 0U);
    arrive_bytes(50);
    step(1.0F);
    arrive_bytes(50);
    step();
    EXPECT_EQ(bus.serial().read(bytes), 0U);
    EXPECT_EQ(bus.diagnostics().tunnel_dropped, 50U) << "nor are they read when they are old";
    EXPECT_EQ(heard.statuses.size(), 2U) << "the node goes on trying";
    port.health_.state = hal::CanState::active;
    step();
    EXPECT_EQ(bus.serial().read(bytes), 0U);
}

TEST_F(CanBusTest, FdFramesAreRefusedAndCounted)
{
    hal::CanFrame frame;
    frame.extended = true;
    frame.fd = true;
    frame.length = 8;
    port.in.push_back(frame);
    frame.length = 64;
    port.in.push_back(frame);
    step();
    EXPECT_EQ(bus.diagnostics().frames_foreign, 2U);
    EXPECT_EQ(bus.endpoint().node().receiver_diagnostics().bad_length, 2U);
    frame.fd = false;
    frame.length = 8;
    port.in.push_back(frame);
    step();
    EXPECT_EQ(bus.diagnostics().frames_foreign, 2U) << "a classic one is none";
}

/// Without waiting frames nothing is late or lost, for any pause between calls.
TEST_F(CanBusTest, WithoutFramesThatWaitThereIsNoStallAndNoLoss)
{
    step();
    step();
    now.us += 300'000;
    bus.service(now, {link::SystemState::active, false, 0});
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
    port.health_.state = hal::CanState::bus_off;
    now.us += 20'000;
    bus.service(now, {link::SystemState::active, false, 0});
    EXPECT_EQ(bus.diagnostics().losses, 0U);
    EXPECT_EQ(bus.diagnostics().stalls, 0U);
}

TEST_F(CanBusTest, AsksForANodeIdWhereItHasNone)
{
    CanBus nobody(port, node_options(can::kAnonymous));
    TimePoint t{1'000'000};
    for (int i = 0; i < 100; ++i) {
        t = t + 0.02F;
        nobody.receive(t, inbox);
        nobody.service(t, {link::SystemState::boot, false, 0});
    }
    ASSERT_GE(port.out.size(), 1U);
    for (const hal::CanFrame& frame : port.out) {
        EXPECT_EQ(can::unpack(frame.id).source, can::kAnonymous);
    }
    EXPECT_EQ(nobody.serial().write(bytes), 0U);
}

}  // namespace
}  // namespace jink::app
