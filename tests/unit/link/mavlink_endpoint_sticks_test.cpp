// SPDX-License-Identifier: BSD-3-Clause
// The pilot's sticks as the autopilot reports them, and which vehicles can be steered.
#include <gtest/gtest.h>

#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkEndpointSticks = HeardEndpointTest;

RcChannels centred()
{
    RcChannels m;
    m.chan1_raw = m.chan2_raw = m.chan4_raw = 1500;
    m.chan3_raw = 1250;
    m.chan5_raw = 65535;
    m.chancount = 8;
    return m;
}

TEST_F(MavlinkEndpointSticks, ChannelsOneToFourArePartsOfHalfTheTravel)
{
    heartbeat();
    RcChannels m = centred();
    m.chan1_raw = 2000;
    m.chan2_raw = 1000;
    autopilot(m);
    ASSERT_TRUE(inbox->has_sticks);
    EXPECT_TRUE(inbox->sticks.from_radio);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[0], 1.0F);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[1], -1.0F);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[2], -0.5F);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[3], 0.0F);
}

TEST_F(MavlinkEndpointSticks, LostTransmittersAreNoSticks)
{
    heartbeat();
    std::array<RcChannels, 6> all;
    all.fill(centred());
    all[0].chan1_raw = 0;
    all[1].chan4_raw = 65535;
    all[2].chan3_raw = 950;  // value of a receiver that has lost its transmitter
    all[3].chancount = 0;
    all[4].chan2_raw = 799;
    all[5].chan2_raw = 2201;
    for (const RcChannels& m : all) {
        autopilot(m);
        EXPECT_FALSE(inbox->has_sticks);
    }
}

TEST_F(MavlinkEndpointSticks, JoystickWithAnAxisThatIsNoneIsNone)
{
    heartbeat();
    ManualControl m;
    m.x = 32767;
    autopilot(m);
    EXPECT_FALSE(inbox->has_sticks);
    m.x = -1000;
    m.r = 250;
    autopilot(m);
    ASSERT_TRUE(inbox->has_sticks);
    EXPECT_FALSE(inbox->sticks.from_radio);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[0], -1.0F);
    EXPECT_FLOAT_EQ(inbox->sticks.sticks[3], 0.25F);
}

TEST_F(MavlinkEndpointSticks, OnlyTheAutopilotsCount)
{
    heartbeat();
    from(9, 1, centred());
    EXPECT_FALSE(inbox->has_sticks);
}

TEST_F(MavlinkEndpointSticks, HeartbeatIsAskedForByRequestMessage)
{
    static_cast<void>(sent());
    endpoint->request_heartbeat();
    const auto asked = only<CommandLong>(sent());
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_EQ(asked[0].command, 512);
    EXPECT_EQ(asked[0].param1, 0.0F);
    EXPECT_EQ(asked[0].target_system, kSystem);
    EXPECT_EQ(asked[0].target_component, 1);
}

TEST(MavlinkSteerable, MultirotorsAndHelicoptersOfBothStacks)
{
    for (const std::uint8_t type : {2, 3, 4, 13, 14, 15, 29, 35, 43}) {
        EXPECT_TRUE(is_steerable(AutopilotStack::ardupilot, type, 0)) << int{type};
        EXPECT_TRUE(is_steerable(AutopilotStack::px4, type, 0)) << int{type};
        EXPECT_FALSE(is_steerable(AutopilotStack::unknown, type, 0)) << int{type};
    }
}

TEST(MavlinkSteerable, AVtolOfPx4WhileItHovers)
{
    for (std::uint8_t type = 19; type <= 25; ++type) {
        for (std::uint8_t state = 0; state <= 5; ++state) {
            EXPECT_EQ(is_steerable(AutopilotStack::px4, type, state), state == 3) << int{type} << ' ' << int{state};
            EXPECT_FALSE(is_steerable(AutopilotStack::ardupilot, type, state)) << "a QuadPlane: ArduPlane";
        }
        EXPECT_EQ(vehicle_class(AutopilotStack::ardupilot, type), VehicleClass::plane);
        EXPECT_EQ(vehicle_class(AutopilotStack::px4, type), VehicleClass::copter);
    }
}

TEST(MavlinkSteerable, NothingElse)
{
    for (const int type : {0, 1, 5, 6, 7, 8, 9, 10, 11, 12, 16, 17, 18, 26, 27, 28, 30, 42, 44, 255}) {
        for (const AutopilotStack stack : {AutopilotStack::ardupilot, AutopilotStack::px4}) {
            EXPECT_FALSE(is_steerable(stack, static_cast<std::uint8_t>(type), 3)) << type;
        }
    }
}

TEST_F(MavlinkEndpointSticks, SteerableGoesWithTheHeartbeat)
{
    heartbeat(3, 3, true, 2);
    EXPECT_TRUE(inbox->autopilot.steerable);
    heartbeat(3, 10, true, 1);
    EXPECT_FALSE(inbox->autopilot.steerable);
    ExtendedSysState hovers;
    hovers.vtol_state = 3;
    autopilot(hovers);
    heartbeat(12, 4U << 16U | 4U << 24U, true, 22);
    EXPECT_TRUE(inbox->autopilot.steerable);
}

}  // namespace
}  // namespace jink::link::mavlink
