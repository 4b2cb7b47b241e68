// SPDX-License-Identifier: BSD-3-Clause
// Messages that come too seldom are asked for, at a bounded rate, until they come.
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/stream_requests.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

struct Asked {
    std::map<std::uint32_t, std::vector<float>> at;  ///< times per message [s]
};

/// Runs for a while at 50 Hz; each message of `rates` is heard so many times a second.
Asked run(StreamRequests& streams, float seconds, const std::map<std::uint32_t, float>& rates = {}, float from = 100.0F)
{
    Asked asked;
    std::map<std::uint32_t, float> due;
    for (int tick = 0; tick < static_cast<int>(seconds * 50.0F); ++tick) {
        const TimePoint now{static_cast<std::int64_t>(static_cast<double>(from) * 1e6) + tick * 20'000};
        for (const auto& [id, rate] : rates) {
            for (due[id] += rate * 0.02F; due[id] >= 1.0F; due[id] -= 1.0F) {
                streams.heard(id);
            }
        }
        if (const auto request = streams.next(now)) {
            EXPECT_GT(request->interval_us, 0);
            asked.at[request->message_id].push_back(static_cast<float>(tick) * 0.02F);
        }
    }
    return asked;
}

const std::map<std::uint32_t, float> kAll{{32, 50.0F}, {31, 10.0F}, {42, 2.0F},  {245, 1.0F},
                                          {49, 0.2F},  {242, 0.2F}, {246, 1.0F}, {29, 1.0F}};

TEST(MavlinkStreamRequests, NothingIsAskedForThatComes)
{
    StreamRequests streams;
    EXPECT_TRUE(run(streams, 120.0F, kAll).at.empty());
}

TEST(MavlinkStreamRequests, EverythingIsAskedForThatDoesNotAtMostOnceASecond)
{
    StreamRequests streams;
    const Asked asked = run(streams, 60.0F);
    EXPECT_EQ(asked.at.size(), StreamRequests::kMessages);
    for (const auto& [id, times] : asked.at) {
        EXPECT_GE(times.front(), 1.0F) << id;
        EXPECT_LE(times.size(), 7U) << id << ": five tries, and then every 30 s";
        for (std::size_t i = 1; i < times.size(); ++i) {
            EXPECT_GE(times[i] - times[i - 1], 0.99F) << id;
        }
    }
    EXPECT_EQ(asked.at.at(32).size(), 6U);
    EXPECT_NEAR(asked.at.at(32)[5] - asked.at.at(32)[4], StreamRequests::kRest, 1.0F);
}

/// An ArduPilot without ADS-B answers each request for ADSB_VEHICLE with a text to the pilot.
TEST(MavlinkStreamRequests, RefusedTrafficIsNotAskedForAgainButPositionIs)
{
    for (const std::uint32_t missing : {246U, 29U, 32U}) {
        auto rates = kAll;
        rates.erase(missing);
        StreamRequests streams;
        ASSERT_EQ(run(streams, 6.5F, rates).at.count(missing), 1U);
        streams.refused();
        EXPECT_EQ(run(streams, 100.0F, rates, 106.5F).at.count(missing), missing == 32U ? 1U : 0U) << missing;
        streams.restart();
        EXPECT_EQ(run(streams, 6.5F, rates, 300.0F).at.count(missing), 1U) << "another autopilot";
    }
}

TEST(MavlinkStreamRequests, TooSeldomIsAskedForToo)
{
    auto rates = kAll;
    rates[32] = 4.0F;  // a common value of ArduPilot's SRx_POSITION
    StreamRequests streams;
    const Asked asked = run(streams, 10.0F, rates);
    EXPECT_EQ(asked.at.size(), 1U);
    EXPECT_EQ(asked.at.at(32).size(), 5U);
}

TEST(MavlinkStreamRequests, OtherMessagesThatBringTheSameCount)
{
    auto rates = kAll;
    rates.erase(32);
    rates.erase(31);
    rates[331] = 30.0F;
    StreamRequests streams;
    EXPECT_TRUE(run(streams, 30.0F, rates).at.empty());
}

TEST(MavlinkStreamRequests, ComingStopsTheAskingAndARestartBeginsItAnew)
{
    StreamRequests streams;
    EXPECT_FALSE(run(streams, 3.5F).at.empty());
    EXPECT_TRUE(run(streams, 20.0F, kAll, 103.5F).at.count(32) == 0);
    EXPECT_EQ(run(streams, 8.0F, {}, 123.5F).at.at(32).size(), 5U);
    streams.restart();
    EXPECT_EQ(run(streams, 8.0F, {}, 140.0F).at.at(32).size(), 5U);
}

TEST(MavlinkStreamRequests, EndpointAsksOnlyWhenReportedToAndAKnownAutopilotIsThere)
{
    Wire wire;
    const auto asks = [&] {
        std::vector<CommandLong> all;
        for (int i = 0; i < 100; ++i) {
            wire.wait(0.02F);
            wire.endpoint.service(wire.now);
            const auto some = wire.said_of<CommandLong>();
            all.insert(all.end(), some.begin(), some.end());
        }
        return all;
    };
    EXPECT_TRUE(asks().empty());
    wire.endpoint.ask_for_rates(true);
    EXPECT_TRUE(asks().empty()) << "nobody there";
    wire.hear(heartbeat());
    wire.hear(origin());
    HomePosition home;
    home.latitude = 1;
    wire.hear(home);
    const auto asked = asks();
    ASSERT_GE(asked.size(), 2U);
    EXPECT_EQ(wire.diagnostics().rate_requests, asked.size());
    EXPECT_EQ(asked[0].command, 511);
    EXPECT_EQ(asked[0].param1, 32.0F);
    EXPECT_EQ(asked[0].param2, 20000.0F);
    EXPECT_EQ(asked[0].target_system, kSystem);
    EXPECT_EQ(asked[0].target_component, kAutopilot);
    CommandAck ack;
    ack.command = 511;
    ack.target_system = kSystem;
    ack.target_component = kUs;
    for (const std::uint8_t result : {0, 5, 2, 3, 4}) {
        ack.result = result;
        wire.hear(ack);
    }
    EXPECT_EQ(wire.diagnostics().rates_refused, 3U);
    EXPECT_TRUE(wire.inbox.mode_answers.empty());
    wire.endpoint.ask_for_rates(false);
    EXPECT_TRUE(asks().empty());
}

}  // namespace
}  // namespace jink::link::mavlink
