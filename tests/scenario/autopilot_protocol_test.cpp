// SPDX-License-Identifier: BSD-3-Clause
// Missions, heartbeats, home and set-points, as in the recordings and PX4's sources.
#include "tests/scenario/autopilot_line.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

TEST(SimAutopilot, TheMissionIsHandedOutAsEachStackDoes)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        const bool ardupilot = s->stack == Stack::ardupilot;
        Line line(*s);
        line.run(0.6);
        const auto current = line.heard<MissionCurrent>();
        ASSERT_TRUE(current);
        EXPECT_EQ(current->seq, ardupilot ? 2 : 1);
        line.send(MissionRequestList{1, 1, 0});
        const auto count = line.heard<MissionCount>();
        ASSERT_TRUE(count);
        EXPECT_EQ(count->count, ardupilot ? 3 : 2);
        EXPECT_EQ(count->opaque_id, current->mission_id);
        for (std::uint16_t k = 0; k < count->count; ++k) {
            line.send(MissionRequestInt{k, 1, 1, 0});
            ASSERT_TRUE(line.heard<MissionItemInt>());
            EXPECT_EQ(line.heard<MissionItemInt>()->seq, k);
        }
        const auto item = line.heard<MissionItemInt>();
        EXPECT_EQ(item->frame, ardupilot ? 3 : 6);
        EXPECT_EQ(item->z, 30.0F);
        EXPECT_EQ(item->current, 1);
        line.send(MissionAck{1, 1, 0, 0, 0});
        line.run(6.0);
        EXPECT_TRUE(line.autopilot.critical_texts().empty());
    }
}

TEST(SimAutopilot, ArdupilotHandsOutSingleItems)
{
    Line line(kArdupilotFlight);
    line.send(MissionRequestInt{2, 1, 1, 0});
    ASSERT_TRUE(line.heard<MissionItemInt>());
    EXPECT_EQ(line.heard<MissionItemInt>()->seq, 2);
    line.forget();
    line.send(MissionRequestInt{7, 1, 1, 0});
    EXPECT_FALSE(line.heard<MissionItemInt>());
    EXPECT_TRUE(line.heard<MissionAck>());
    EXPECT_TRUE(line.autopilot.critical_texts().empty());
}

TEST(SimAutopilot, Px4AnswersItemsOutOfOrderWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionRequestList{1, 1, 0});
    line.send(MissionRequestInt{1, 1, 1, 0});
    EXPECT_FALSE(line.heard<MissionItemInt>());
    ASSERT_TRUE(line.heard<Statustext>());
    EXPECT_EQ(line.heard<Statustext>()->severity, 2);
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "WPM: REJ. CMD: Req. WP was unexpected");
    line.send(MissionRequestInt{0, 1, 1, 0});  // the transfer is over
    EXPECT_FALSE(line.heard<MissionItemInt>());
    line.run(10.0);
    EXPECT_EQ(line.autopilot.critical_texts().size(), 1U);
}

TEST(SimAutopilot, Px4EndsATransferThatRestsWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionRequestList{1, 1, 0});
    line.run(3.0);
    line.send(MissionRequestInt{0, 1, 1, 0});
    line.run(4.9);
    EXPECT_TRUE(line.autopilot.critical_texts().empty());
    line.run(0.2);
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "Operation timeout");
}

TEST(SimAutopilot, Px4AnswersAMissionAckOfAStrangerWithACriticalText)
{
    Line line(kPx4Flight);
    line.send(MissionAck{1, 1, 0, 0, 0});
    ASSERT_EQ(line.autopilot.critical_texts().size(), 1U);
    EXPECT_EQ(line.autopilot.critical_texts()[0], "REJ. WP CMD: partner id mismatch");
}

// Counted in the recordings: PX4 103 in 103 s with every change of mode; ArduCopter 246 in 237 s.
TEST(SimAutopilot, ArdupilotTellsAChangeOfModeAtOncePx4WithItsNextHeartbeat)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        const bool px4 = s->stack == Stack::px4;
        Line line(*s);
        line.run(1.5, true);
        line.forget();
        ASSERT_EQ(line.ask(px4 ? 6.0F : 4.0F), 0);
        EXPECT_EQ(line.count<Heartbeat>(), px4 ? 0 : 1);
        EXPECT_EQ(line.count<CommandAck>(), px4 ? 2 : 1);
        line.run(0.6, true);
        EXPECT_EQ(line.count<Heartbeat>(), px4 ? 1 : 2);
    }
}

TEST(SimAutopilot, AHeartbeatIsSentWhenAskedForAndItsIntervalIsFixedInPx4)
{
    for (const Scenario* s : {&kArdupilotFlight, &kPx4Flight}) {
        Line line(*s);
        line.run(0.5);
        line.forget();
        CommandLong m;
        m.command = 512;
        m.target_system = m.target_component = 1;
        line.send(m);
        EXPECT_EQ(line.count<Heartbeat>(), 1);
        EXPECT_EQ(line.heard<CommandAck>()->result, 0);
        m.command = 511;
        line.send(m);
        EXPECT_EQ(line.heard<CommandAck>()->result, s->stack == Stack::px4 ? 4 : 0);
    }
}

TEST(SimAutopilot, HomeLiesApartFromTheOrigin)
{
    for (const Scenario* given : {&kArdupilotFlight, &kPx4Flight}) {
        const bool px4 = given->stack == Stack::px4;
        Scenario s = *given;
        s.home = Vec(30.0, -20.0, 12.0);
        Line line(s);
        line.run(0.1);
        const auto home = line.heard<HomePosition>();
        const auto origin = line.heard<GpsGlobalOrigin>();
        ASSERT_TRUE(home && origin);
        EXPECT_NEAR(home->altitude - origin->altitude, 12'000, px4 ? 1'000 : 0);
        EXPECT_NEAR(static_cast<double>(home->latitude - origin->latitude) * 0.0111, -20.0, 0.1);
        // ArduPilot's local values are 0 always.
        EXPECT_NEAR(static_cast<double>(home->y), px4 ? 30.0 : 0.0, 1e-6);
        EXPECT_NEAR(static_cast<double>(home->z), px4 ? -12.0 : 0.0, px4 ? 1.0 : 0.0);
        line.send(MissionRequestList{1, 1, 0});
        line.send(MissionRequestInt{0, 1, 1, 0});
        if (px4) {
            EXPECT_EQ(line.heard<MissionItemInt>()->z, 18.0F);  // above home
        }
    }
}

TEST(SimAutopilot, Px4TellsItsControllersSetpointAndNotTheLeg)
{
    Line line(kPx4Flight);
    line.run(5.0);
    const auto target = line.heard<PositionTargetLocalNed>();
    const auto own = line.heard<LocalPositionNed>();
    ASSERT_TRUE(target && own);
    EXPECT_EQ(target->type_mask, 0);
    EXPECT_NEAR(static_cast<double>(target->y), static_cast<double>(own->y), 1.0);
    EXPECT_NEAR(static_cast<double>(target->vy), 5.0, 0.1);
    ASSERT_EQ((line.run(1.0, true), line.ask(6.0F)), 0);
    line.run(0.2, true);
    EXPECT_EQ(line.heard<PositionTargetLocalNed>()->type_mask, 7);
    EXPECT_TRUE(std::isnan(line.heard<PositionTargetLocalNed>()->x));
}

}  // namespace
}  // namespace jink::sim
