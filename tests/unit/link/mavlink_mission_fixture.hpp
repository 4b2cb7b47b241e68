// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink::test {

inline constexpr std::int32_t kLat = 473977420;
inline constexpr std::int32_t kLon = 85455940;
inline constexpr std::int32_t kNorth1000m = 89832;
inline constexpr std::uint32_t kPx4Mission = (4U << 16U) | (4U << 24U);
inline constexpr std::uint32_t kPx4Hold = (4U << 16U) | (3U << 24U);
inline constexpr std::uint32_t kPx4Offboard = 6U << 16U;
inline constexpr std::uint32_t kAuto = 3, kGuided = 4, kLoiter = 5;

inline MissionItemInt item_of(std::uint16_t command, std::int32_t x, std::int32_t y, float z, std::uint8_t frame = 6)
{
    MissionItemInt m;
    m.command = command;
    m.frame = frame;
    m.x = x;
    m.y = y;
    m.z = z;
    return m;
}
inline MissionItemInt north(float metres, float z = 30.0F, std::uint16_t command = 16)
{
    return item_of(command, kLat + static_cast<std::int32_t>(metres * 1e-3F * kNorth1000m), kLon, z);
}

/// An autopilot that flies a mission and answers mission requests.
class MissionEndpointTest : public HeardEndpointTest {
protected:
    void home(std::int32_t lat = kLat, std::int32_t lon = kLon, std::int32_t alt = 488000)
    {
        HomePosition m;
        m.latitude = lat;
        m.longitude = lon;
        m.altitude = alt;
        autopilot(m);
    }
    void current(std::uint16_t seq, std::uint32_t id = 0)
    {
        MissionCurrent m;
        m.seq = seq;
        m.mission_id = id;
        m.total = static_cast<std::uint16_t>(mission.size());
        autopilot(m);
    }
    void reached(std::uint16_t seq)
    {
        MissionItemReached m;
        m.seq = seq;
        autopilot(m);
    }
    /// Runs for a while at 50 Hz; the autopilot answers requests of its mission.
    void run(float seconds)
    {
        for (float t = 0.0F; t < seconds; t += 0.02F) {
            wait(0.02F);
            endpoint->service(now);
            for (const Received& f : sent()) {
                answer(f);
            }
            local_position(own, velocity);
        }
    }
    void answer(const Received& f)
    {
        MissionRequestList list;
        MissionRequestInt request;
        if (decode(f.frame(), list)) {
            MissionCount m;
            m.count = static_cast<std::uint16_t>(mission.size());
            m.target_system = kSystem;
            m.target_component = kUs;
            autopilot(m);
        } else if (decode(f.frame(), request) && request.seq < mission.size()) {
            MissionItemInt m = mission[request.seq];
            m.seq = request.seq;
            m.target_system = kSystem;
            m.target_component = kUs;
            autopilot(m);
        }
    }
    /// On a mission of these items behind home, flying the first of them.
    void fly(const std::vector<MissionItemInt>& items, std::uint8_t stack = 3)
    {
        mission = {item_of(16, kLat, kLon, 488.0F, 0)};
        mission.insert(mission.end(), items.begin(), items.end());
        heartbeat(stack, stack == 3 ? kAuto : kPx4Mission);
        origin();
        home();
        local_position(own);
        current(1);
        run(0.5F);
    }
    void expect_leg(const Vec3& start, const Vec3& end, float tolerance = 0.1F)
    {
        ASSERT_TRUE(inbox->has_leg);
        expect_near(inbox->leg.leg.start, start, tolerance);
        expect_near(inbox->leg.leg.end, end, tolerance);
    }

    std::vector<MissionItemInt> mission;
    Vec3 own{0, 0, -30};  ///< NED
    Vec3 velocity = Vec3::Zero();
};

}  // namespace jink::link::mavlink::test
