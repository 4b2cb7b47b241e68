// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step on a line that is open and takes nothing, or a few bytes: delayed output must still be true.
#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

constexpr std::uint32_t kPeriodMs = 50;  // 20 set-points a second, the default
constexpr std::size_t kWide = 1U << 20U;

bool holds_control(const StepReport& report) { return report.control == Control::ours; }

class CoprocessorStalledLine : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
        f->fly(60);
        f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
        ASSERT_TRUE(f->until(holds_control));
        f->fly(10);
    }
    [[nodiscard]] std::uint32_t now_ms() const { return static_cast<std::uint32_t>(f->now.us / 1000); }
    [[nodiscard]] const link::LinkDiagnostics& counted() const { return f->endpoint.diagnostics(); }
    std::unique_ptr<Flight> f = std::make_unique<Flight>();
};

TEST_F(CoprocessorStalledLine, NoSetpointOlderThanAPeriodGoesOutWhenItOpensUp)
{
    for (const int stalled_ticks : {1, 2, 3, 7, 25, 150}) {
        f->port.room = 0;
        f->fly(stalled_ticks);
        f->port.room = kWide;
        f->fly(1);
        for (const SetPositionTargetLocalNed& m : f->said_of<SetPositionTargetLocalNed>()) {
            EXPECT_LE(now_ms() - m.time_boot_ms, kPeriodMs) << stalled_ticks;
        }
        EXPECT_LE(f->said_of<SetPositionTargetLocalNed>().size(), 1U) << stalled_ticks;
        f->fly(5);
    }
    EXPECT_GT(counted().setpoints_dropped, 33U);
    EXPECT_GT(counted().heartbeats_dropped, 0U) << "one is enough: the newest";
}

TEST_F(CoprocessorStalledLine, APartlyWrittenSetpointIsCompletedAndTheNextIsFresh)
{
    constexpr std::byte kMessage{84};  // SET_POSITION_TARGET_LOCAL_NED, in the frame's byte 7
    do {
        f->port.room = kWide;
        f->fly(1);
        f->port.room = 0;
        ASSERT_TRUE(f->until([](const StepReport& r) { return r.setpoint_sent; }, 10));
    } while (f->endpoint.pending()[7] != kMessage);  // nothing waits before it
    const std::uint32_t first_ms = now_ms();
    f->port.room = 3;  // three bytes, twice, and then nothing for a second
    f->prepare();
    static_cast<void>(f->step());
    f->port.room = 0;
    f->fly(50);
    f->port.room = kWide;
    f->fly(1);
    const auto setpoints = f->said_of<SetPositionTargetLocalNed>();
    ASSERT_GE(setpoints.size(), 1U);
    ASSERT_LE(setpoints.size(), 2U);
    EXPECT_EQ(setpoints.front().time_boot_ms, first_ms) << "begun, so completed: framing comes first";
    if (setpoints.size() == 2) {
        EXPECT_LE(now_ms() - setpoints.back().time_boot_ms, kPeriodMs);
    }
}

TEST_F(CoprocessorStalledLine, OtherMessagesWait)
{
    f->port.room = 0;
    CommandLong ask;
    ask.command = 400;
    ask.target_system = wire::kSystem;
    ask.target_component = wire::kUs;
    f->feed(ask);
    f->fly(100);
    f->port.room = kWide;
    f->fly(1);
    EXPECT_EQ(f->said_of<CommandAck>().size(), 1U);
    EXPECT_EQ(f->said_of<Heartbeat>().size(), 1U);
}

TEST_F(CoprocessorStalledLine, AFaultTakesTheStreamOutOfTheQueueAtOnce)
{
    f->port.room = 0;
    f->fly(5);
    f->own_state = false;
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults != 0; }, 100));
    f->port.room = kWide;
    f->fly(1);
    EXPECT_TRUE(f->said_of<SetPositionTargetLocalNed>().empty());
    EXPECT_EQ(f->said_of<Heartbeat>().back().system_status, static_cast<std::uint8_t>(link::SystemState::critical));
}

TEST_F(CoprocessorStalledLine, NothingOfTheStreamRemainsAfterTheTakeoverHasEnded)
{
    f->port.room = 0;
    f->fly(5);
    f->mode = wire::kCopterLoiter;  // the pilot
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.control == Control::overruled; }, 60));
    f->port.room = kWide;
    f->fly(1);
    EXPECT_TRUE(f->said_of<SetPositionTargetLocalNed>().empty());
}

TEST_F(CoprocessorStalledLine, ShuttingDownLeavesNoSetpointBehind)
{
    f->port.room = 0;
    f->fly(5);
    f->port.room = kWide;
    f->coprocessor.shut_down(f->now);
    f->react();
    EXPECT_TRUE(f->said_of<SetPositionTargetLocalNed>().empty());
    ASSERT_FALSE(f->requested.empty());
    EXPECT_EQ(f->requested.back(), static_cast<float>(wire::kCopterBrake));
}

TEST(CoprocessorStalledRequest, AModeAskedForAWhileAgoIsNotAskedForLater)
{
    const auto f = std::make_unique<Flight>();
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
    f->fly(60);
    f->port.room = 0;
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.control == Control::requesting; }));
    f->mode = wire::kCopterLoiter;  // the pilot acts before the line does
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.control == Control::overruled; }, 60));
    f->port.room = kWide;
    f->fly(60);
    EXPECT_TRUE(f->requested.empty());
    EXPECT_EQ(f->mode, wire::kCopterLoiter);
    EXPECT_GT(f->endpoint.diagnostics().requests_dropped, 0U);
}

TEST(CoprocessorStalledRequest, ChokedLineKeepsItsFraming)
{
    const auto f = std::make_unique<Flight>();
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
    f->fly(60);
    f->obstacles = {f->position + Vec3(0.4F, 40.0F, 0.0F)};
    Parser ears;
    std::uint32_t oldest = 0;
    for (int i = 0; i < 1200; ++i) {
        f->port.room = static_cast<std::size_t>(1 + (i * 7) % 40);  // a line of about 1 kB/s, uneven
        f->prepare();
        static_cast<void>(f->step());
        std::span<const std::byte> bytes = f->port.written();
        while (const auto frame = ears.next(bytes)) {
            SetPositionTargetLocalNed m;
            if (decode(*frame, m)) {
                oldest = std::max(oldest, static_cast<std::uint32_t>(f->now.us / 1000) - m.time_boot_ms);
            }
        }
        f->react();
    }
    EXPECT_EQ(ears.diagnostics().noise_bytes, 0U);
    EXPECT_GT(ears.diagnostics().accepted, 50U);
    EXPECT_GT(f->setpoints, 10);
    // A period until it is begun, and the ticks that its 65 bytes take on this line.
    EXPECT_LE(oldest, 50U + 120U);
}

}  // namespace
}  // namespace jink::app::test
