// SPDX-License-Identifier: BSD-3-Clause
// Parts of a log and their acknowledgements.
#include <gtest/gtest.h>

#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

using MavlinkEndpointLog = HeardEndpointTest;

TEST_F(MavlinkEndpointLog, PartsOfALogGoToTheirReceiver)
{
    std::vector<std::byte> bytes(kMaxLogPart);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::byte>(i + 1);
    }
    ASSERT_TRUE(endpoint->send_log({255, 190, 513, 7, false, bytes}));
    const LoggingData m = sent_one<LoggingData>();
    EXPECT_EQ(m.target_system, 255);
    EXPECT_EQ(m.target_component, 190);
    EXPECT_EQ(m.sequence, 513);
    EXPECT_EQ(m.length, kMaxLogPart);
    EXPECT_EQ(m.first_message_offset, 7);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        ASSERT_EQ(static_cast<std::byte>(m.data[i]), bytes[i]);
    }
    ASSERT_TRUE(endpoint->send_log({9, 8, 514, kNoMessageBegins, true, std::span(bytes).first(3)}));
    const LoggingDataAcked acked = sent_one<LoggingDataAcked>();
    EXPECT_EQ(acked.target_system, 9);
    EXPECT_EQ(acked.target_component, 8);
    EXPECT_EQ(acked.sequence, 514);
    EXPECT_EQ(acked.length, 3);
    EXPECT_EQ(acked.first_message_offset, 255);
    EXPECT_EQ(acked.data[2], 3);
    EXPECT_EQ(acked.data[3], 0) << "what is not used is zero";
    while (endpoint->send_log({255, 190, 0, 0, false, bytes})) {
        ASSERT_LE(endpoint->pending().size(), Endpoint::kTransmitBytes);
    }
    EXPECT_GT(endpoint->pending().size(), Endpoint::kTransmitBytes - kMaxLogFrame);
    EXPECT_EQ(count().outbox_full, 1U);
}

TEST_F(MavlinkEndpointLog, AcknowledgementsOfALogArePassedOnWhereTheyAreOurs)
{
    LoggingAck m;
    m.sequence = 40000;
    m.target_system = kSystem;
    m.target_component = kUs;
    from(255, 190, m);
    ASSERT_EQ(inbox->log_acks.size(), 1U);
    EXPECT_EQ(inbox->log_acks[0].sequence, 40000);
    EXPECT_EQ(inbox->log_acks[0].from_system, 255);
    EXPECT_EQ(inbox->log_acks[0].from_component, 190);
    m.target_component = 1;  // QGroundControl's, which acknowledges to the autopilot
    from(255, 190, m);
    m.target_component = kUs;
    m.target_system = kSystem + 1;
    from(255, 190, m);
    EXPECT_EQ(inbox->log_acks.size(), 1U);
    EXPECT_EQ(count().frames_ignored, 2U);
    m.target_system = kSystem;
    for (std::size_t i = 0; i < inbox->log_acks.capacity(); ++i) {
        from(255, 190, m);
    }
    EXPECT_EQ(count().inbox_full, 1U);
    inbox->clear();
    EXPECT_TRUE(inbox->log_acks.empty());
}

}  // namespace
}  // namespace jink::link::mavlink
