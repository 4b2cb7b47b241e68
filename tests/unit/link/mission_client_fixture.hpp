// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/mission_client.hpp"

namespace jink::link::mavlink::test {

inline constexpr std::uint16_t kWaypoint = 16;
inline constexpr std::uint16_t kChangeSpeed = 178;

inline MissionItem at(std::int32_t x, std::uint16_t command = kWaypoint)
{
    return {true, 0, command, x, 0, 0.0F, 0.0F};
}

/// A mission client; the test plays its autopilot.
struct MissionClientTest : ::testing::Test {
    MissionClient client;
    TimePoint now{5'000'000};
    MissionProgress progress;

    void wait(float s)
    {
        for (float t = 0.0F; t < s; t += 0.1F) {
            now = now + 0.1F;
            client.heard(now);
        }
    }
    MissionStep next() { return client.next(now); }
    void current(std::uint16_t sequence)
    {
        progress.sequence = sequence;
        client.current(progress, now);
    }
    /// All steps of `seconds`, at 10 Hz.
    std::vector<MissionStep> steps(float seconds)
    {
        std::vector<MissionStep> all;
        for (float t = 0.0F; t < seconds; t += 0.1F) {
            if (const MissionStep step = next(); step != MissionStep::none) {
                all.push_back(step);
            }
            wait(0.1F);
        }
        return all;
    }
    /// Answers a whole transfer, begun by MISSION_REQUEST_LIST, and returns the items requested.
    std::vector<std::uint16_t> read(const std::vector<MissionItem>& mission, std::uint32_t id = 0)
    {
        std::vector<std::uint16_t> requested;
        EXPECT_EQ(next(), MissionStep::list);
        client.count(static_cast<std::uint16_t>(mission.size()), id, now);
        while (next() == MissionStep::item) {
            requested.push_back(client.wanted());
            EXPECT_TRUE(client.item(client.wanted(), mission[client.wanted()], 0.0F, 0.0F, now));
        }
        return requested;
    }
    /// Answers a comparison, which is due.
    void compare(const std::vector<MissionItem>& mission)
    {
        EXPECT_EQ(next(), MissionStep::list);
        client.count(static_cast<std::uint16_t>(mission.size()), 0, now);
        EXPECT_EQ(next(), MissionStep::item);
        EXPECT_EQ(client.wanted(), progress.sequence);
        EXPECT_TRUE(client.item(client.wanted(), mission[client.wanted()], 0.0F, 0.0F, now));
        EXPECT_EQ(next(), MissionStep::none);
    }
    static std::vector<MissionItem> mission_of(std::size_t n)
    {
        std::vector<MissionItem> mission;
        for (std::size_t i = 0; i < n; ++i) {
            mission.push_back(at(static_cast<std::int32_t>(100 + i)));
        }
        return mission;
    }
};

}  // namespace jink::link::mavlink::test
