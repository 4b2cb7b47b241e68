// SPDX-License-Identifier: BSD-3-Clause
// The endpoint's handling of the autopilot's reports on its clock and its origin.
#include <map>

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

TEST_F(MavlinkEndpointClockAndOrigin, ARestartOfTheAutopilotIsReportedAndForgetsItsFrame)
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
    const auto own_global = [&] {
        global.time_boot_ms = boot_ms();
        autopilot(global);
    };
    own_global();
    EXPECT_FALSE(endpoint->has_origin()) << "no local position to set it against";
    local_position({100, 0, -10});
    wait(0.5F);
    own_global();
    EXPECT_FALSE(endpoint->has_origin()) << "too far apart in time";
    local_position({100, 0, -10});
    GlobalPositionInt nowhere;
    nowhere.time_boot_ms = boot_ms();
    autopilot(nowhere);
    EXPECT_FALSE(endpoint->has_origin());
    EXPECT_EQ(count().out_of_range, 1U);
    local_position({100, 0, -10}, {20, 0, -5});
    wait(0.1F);
    own_global();
    ASSERT_TRUE(endpoint->has_origin());
    const Vec3 there = to_local({470000000, 80000000, 500000}, endpoint->origin().value());
    expect_near(there, {0, 102, 10.5F}, 0.1F);
    local_position({110, 0, -10});
    own_global();
    EXPECT_NEAR(to_local({470000000, 80000000, 500000}, endpoint->origin().value()).y(), 110.0F, 0.1F)
        << "the local frame has moved";
    origin();
    EXPECT_EQ(endpoint->origin()->lat, 473977420);
    local_position({100, 0, -10});
    own_global();
    EXPECT_EQ(endpoint->origin()->lat, 473977420) << "of higher rank";
}

TEST_F(MavlinkEndpointClockAndOrigin, AnotherOriginMovesTrafficOfTheSameStep)
{
    heartbeat();
    origin(473977420, 85455940, 480000);
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

TEST_F(MavlinkEndpointClockAndOrigin, HomeIsPlacedByItsCoordinatesAndNotByItsLocalOnes)
{
    heartbeat();
    HomePosition m;
    m.latitude = 473977420;
    m.longitude = 85455940;
    m.altitude = 500000;
    autopilot(m);
    EXPECT_FALSE(endpoint->has_origin()) << "ArduPilot's x, y, z are 0 wherever home is";
    EXPECT_FALSE(inbox->has_home) << "rather not known than wrong";
    origin();
    ASSERT_TRUE(inbox->has_home);
    EXPECT_NEAR(inbox->home.z(), 12.0F, 1e-3F) << "below ground in 200 of 200 flights";
    clear();
    m.x = kNan;
    m.latitude += 10000;
    autopilot(m);
    ASSERT_TRUE(inbox->has_home);
    expect_near(inbox->home, {0, 111.3F, 12}, 0.1F);
    clear();
    m.latitude = 950000000;
    autopilot(m);
    m.latitude = m.longitude = 0;
    autopilot(m);
    EXPECT_EQ(count().out_of_range, 2U);
    EXPECT_FALSE(inbox->has_home);
}

TEST_F(MavlinkEndpointClockAndOrigin, OriginAndHomeThatDoNotComeAreAskedForEveryFourSeconds)
{
    heartbeat();
    endpoint->ask_for_rates(true);
    std::map<float, int> asked;
    const auto run = [&](float seconds) {
        asked.clear();
        for (float t = 0.0F; t < seconds; t += 0.02F) {
            wait(0.02F);
            endpoint->service(now);
            for (const Received& f : sent()) {
                CommandLong m;
                asked[decode(f.frame(), m) && m.command == 512 ? m.param1 : -1.0F] += 1;
            }
        }
    };
    run(3.0F);
    EXPECT_EQ(asked[49.0F], 1);
    EXPECT_EQ(asked[242.0F], 1);
    run(8.0F);
    EXPECT_EQ(asked[49.0F], 2);
    origin();
    run(8.0F);
    EXPECT_EQ(asked[49.0F], 0);
    EXPECT_EQ(asked[242.0F], 2);
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    autopilot(home);
    run(8.0F);
    EXPECT_EQ(asked[242.0F], 0);
    endpoint = std::make_unique<Endpoint>();
    heartbeat();
    run(8.0F);
    EXPECT_EQ(asked[242.0F], 0) << "only when told to ask";
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
    m.longitude = 1;
    autopilot(m);
    EXPECT_FALSE(endpoint->has_origin());
    EXPECT_FALSE(inbox->has_home);
    EXPECT_EQ(count().out_of_range, 4U);
}

}  // namespace
}  // namespace jink::link::mavlink
