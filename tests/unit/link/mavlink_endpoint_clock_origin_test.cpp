// SPDX-License-Identifier: BSD-3-Clause
// What the endpoint makes of the autopilot's reports on its clock and its origin.
#include <gtest/gtest.h>
#include <limits>

#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkEndpointClockAndOrigin = EndpointTest;

TEST_F(MavlinkEndpointClockAndOrigin, OldAndFutureStampsAreRefused)
{
    heartbeat();
    local_position();
    clear();
    LocalPositionNed m;
    m.time_boot_ms = boot_ms() - 1001;
    autopilot(m);
    EXPECT_FALSE(inbox->has_own_state);
    EXPECT_EQ(count().stale_stamp, 1U);
    m.time_boot_ms = boot_ms() + 150;
    autopilot(m);
    EXPECT_EQ(count().stale_stamp, 1U) << "an earlier arrival than ever: the line was slower than thought";
    EXPECT_TRUE(inbox->has_own_state);
    clear();
    m.time_boot_ms = boot_ms() + 5000;
    autopilot(m);
    EXPECT_FALSE(inbox->has_own_state);
    EXPECT_EQ(count().stale_stamp, 2U);
    EXPECT_EQ(count().clock_relocks, 0U);
}

TEST_F(MavlinkEndpointClockAndOrigin, ARestartOfTheAutopilotIsToldAndForgetsItsFrame)
{
    heartbeat();
    origin();
    local_position();
    EXPECT_TRUE(endpoint->has_origin());
    clear();
    LocalPositionNed m;
    for (std::uint32_t i = 0; i < 3; ++i) {  // the boot clock has begun again
        wait(0.02F);
        m.time_boot_ms = 3000 + 20 * i;
        autopilot(m);
        EXPECT_EQ(inbox->has_own_state, i == 2);
    }
    EXPECT_EQ(count().clock_relocks, 1U);
    EXPECT_EQ(count().stale_stamp, 2U);
    EXPECT_FALSE(endpoint->has_origin());
    heartbeat();
    EXPECT_TRUE(inbox->autopilot.rebooted);
    heartbeat();
    EXPECT_TRUE(inbox->autopilot.rebooted) << "not read yet";
    clear();
    heartbeat();
    EXPECT_FALSE(inbox->autopilot.rebooted);
}

TEST_F(MavlinkEndpointClockAndOrigin, AStalledLineIsNoRestartAndItsBacklogIsOld)
{
    heartbeat();
    origin();
    for (int i = 0; i < 50; ++i) {
        wait(0.02F);
        local_position();
    }
    clear();
    // 3 s of silence, then everything at once
    std::vector<std::uint32_t> backlog;
    for (int i = 0; i < 150; ++i) {
        wait(0.02F);
        backlog.push_back(boot_ms());
    }
    for (const std::uint32_t stamp : backlog) {
        LocalPositionNed m;
        m.time_boot_ms = stamp;
        autopilot(m);
        if (inbox->has_own_state) {
            EXPECT_NEAR(static_cast<double>(inbox->own_state.state.stamp.us), stamp * 1000.0 + kBootOffset, 2000.0)
                << "what is old must not look new";
        }
    }
    EXPECT_GE(count().stale_stamp, 99U);
    EXPECT_EQ(count().clock_relocks, 0U);
    EXPECT_TRUE(endpoint->has_origin());
    heartbeat();
    EXPECT_FALSE(inbox->autopilot.rebooted);
}

TEST_F(MavlinkEndpointClockAndOrigin, BootClockWrapsAfter49Days)
{
    heartbeat();
    LocalPositionNed m;
    for (std::uint32_t ms = 0xFFFFFF00U; ms != 0x200U; ms += 0x20U) {
        clear();
        wait(0.032F);
        m.time_boot_ms = ms;
        autopilot(m);
        ASSERT_TRUE(inbox->has_own_state) << ms;
        EXPECT_NEAR(static_cast<double>(inbox->own_state.state.stamp.us), static_cast<double>(now.us), 1000.0);
    }
    EXPECT_EQ(count().clock_relocks, 0U);
}

TEST_F(MavlinkEndpointClockAndOrigin, OriginsByRank)
{
    heartbeat();
    GlobalPositionInt global;
    global.lat = 470000000;
    global.lon = 80000000;
    global.alt = 500000;
    autopilot(global);
    EXPECT_FALSE(endpoint->has_origin()) << "no local position to set it against";
    local_position({100, 0, -10});
    wait(0.5F);
    autopilot(global);
    EXPECT_FALSE(endpoint->has_origin()) << "too far apart in time";
    local_position({100, 0, -10});
    GlobalPositionInt nowhere;
    autopilot(nowhere);
    EXPECT_FALSE(endpoint->has_origin());
    EXPECT_EQ(count().out_of_range, 1U);
    autopilot(global);
    EXPECT_TRUE(endpoint->has_origin());
}

TEST_F(MavlinkEndpointClockAndOrigin, AnotherOriginMovesTrafficOfTheSameStep)
{
    heartbeat();
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    home.altitude = 480000;
    autopilot(home);
    AdsbVehicle other;
    other.ICAO_address = 1;
    other.lat = 473987420;
    other.lon = 85465940;
    other.altitude = 600000;
    other.flags = 3;
    autopilot(other);
    origin();
    other.ICAO_address = 2;
    autopilot(other);
    ASSERT_EQ(inbox->tracks.size(), 2U);
    expect_near(inbox->tracks[0].position, inbox->tracks[1].position, 1e-2F);
    EXPECT_NEAR(inbox->tracks[0].position.z(), 112.0F, 1e-3F);
}

TEST_F(MavlinkEndpointClockAndOrigin, HomeIsAnOriginAndIsTold)
{
    heartbeat();
    HomePosition m;
    m.latitude = 470000000;
    m.longitude = 80000000;
    m.altitude = 500000;
    m.x = 5;
    m.y = 6;
    m.z = -7;
    autopilot(m);
    EXPECT_TRUE(endpoint->has_origin());
    ASSERT_TRUE(inbox->has_home);
    EXPECT_EQ(inbox->home, Vec3(6, 5, 7));
    clear();
    m.x = kNan;
    autopilot(m);
    EXPECT_EQ(count().not_finite, 1U);
    m.x = 0;
    m.latitude = 950000000;
    autopilot(m);
    EXPECT_EQ(count().out_of_range, 1U);
    EXPECT_FALSE(inbox->has_home);
}

TEST_F(MavlinkEndpointClockAndOrigin, NoOriginNearThePolesOrOffTheEarth)
{
    heartbeat();
    origin(900000000, 0, 0);
    origin(-860000000, 0, 0);
    origin(0, 1800000001, 0);
    origin(std::numeric_limits<std::int32_t>::min(), 0, 0);
    HomePosition m;
    m.latitude = 900000000;
    m.x = 1000;
    autopilot(m);
    EXPECT_FALSE(endpoint->has_origin());
    EXPECT_EQ(count().out_of_range, 5U);
}

}  // namespace
}  // namespace jink::link::mavlink
