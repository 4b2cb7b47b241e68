// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

TEST(DronecanTransmitQueue, DropsTheOldestTransfersWholeWhenFull)
{
    const auto push = [](TransmitQueue& queue, std::uint8_t transfer, std::size_t length) {
        return queue.push(TransferHead{LogMessage::kType, Priority::medium, 1, 0, transfer}, long_payload(1, length));
    };
    for (const std::size_t count : {kTransmitFrames - 1, kTransmitFrames, kTransmitFrames + 1}) {
        TransmitQueue queue;
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_TRUE(push(queue, static_cast<std::uint8_t>(i % kTransferIds), 5));
        }
        EXPECT_EQ(queue.size(), std::min(count, kTransmitFrames));
        EXPECT_EQ(queue.diagnostics().transfers_dropped, count > kTransmitFrames ? 1U : 0U);
        EXPECT_EQ(unpack(queue.front()->data[5]).transfer, count > kTransmitFrames ? 1 : 0);
    }
    // A partly sent transfer is dropped with all its remaining frames.
    TransmitQueue queue;
    EXPECT_TRUE(push(queue, 0, 40));  // 6 frames
    queue.pop();
    for (std::size_t i = queue.size(); i < kTransmitFrames; ++i) {
        EXPECT_TRUE(push(queue, 1, 5));
    }
    EXPECT_TRUE(push(queue, 2, 5));
    EXPECT_EQ(queue.size(), kTransmitFrames - 4);
    EXPECT_TRUE(unpack(queue.front()->data[5]).start);
    EXPECT_EQ(unpack(queue.front()->data[5]).transfer, 1);
    EXPECT_EQ(queue.diagnostics().transfers_dropped, 1U);
    EXPECT_EQ(queue.diagnostics().frames, 1U);
    queue.clear();
    EXPECT_EQ(queue.front(), nullptr);
    queue.pop();
    EXPECT_EQ(queue.diagnostics().frames, 1U);
}

TEST(DronecanTransmitQueue, RefusesWhatCannotBeSent)
{
    TransmitQueue queue;
    EXPECT_FALSE(queue.push({GetNodeInfoResponse::kType, Priority::medium, 1, 2, 0}, Bytes(kMaxPayload + 1)));
    EXPECT_FALSE(queue.push({Allocation::kType, Priority::medium, kAnonymous, 0, 0}, Bytes(8)));
    EXPECT_FALSE(queue.push({GetNodeInfoRequest::kType, Priority::medium, kAnonymous, 2, 0}, {}));
    EXPECT_EQ(queue.diagnostics().transfers_refused, 3U);
    EXPECT_EQ(queue.size(), 0U);
    EXPECT_TRUE(queue.push({GetNodeInfoResponse::kType, Priority::medium, 1, 2, 0}, Bytes(kMaxPayload)));
    EXPECT_EQ(queue.size(), kMaxFramesOfTransfer);
    EXPECT_TRUE(queue.push({Allocation::kType, Priority::medium, kAnonymous, 0, 0}, Bytes(7)));
}

}  // namespace
}  // namespace jink::link::dronecan
