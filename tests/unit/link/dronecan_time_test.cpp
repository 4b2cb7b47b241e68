// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_node_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

class DronecanTime : public DronecanNode {
protected:
    /// A message of a master whose clock is `ahead` of ours.
    void sync(Node& node, std::uint8_t master, std::uint8_t transfer, std::uint64_t previous)
    {
        GlobalTimeSync message;
        message.previous_transmission = previous;
        static_cast<void>(node.receive(frames_of(message, master, transfer)[0], now));
    }
    std::uint64_t master_time() const { return static_cast<std::uint64_t>(now.us + kAhead); }
    static constexpr std::int64_t kAhead = 77'000'000'000;
};

TEST_F(DronecanTime, TwoMessagesMakeAClock)
{
    Node node(fixed());
    EXPECT_FALSE(node.time().to_local(1, now).has_value());
    sync(node, 5, 0, 0);
    EXPECT_FALSE(node.time().to_local(1, now).has_value());
    const std::uint64_t first = master_time();
    now = now + 1.0F;
    sync(node, 5, 1, first);
    ASSERT_TRUE(node.time().to_local(first, now).has_value());
    EXPECT_EQ(node.time().to_local(master_time(), now)->us, now.us);
    EXPECT_EQ(node.time().diagnostics().updates, 1U);
    now = now + (TimeSlave::kMasterTimeout + 0.01F);
    EXPECT_FALSE(node.time().to_local(master_time(), now).has_value());
    sync(node, 5, 2, first);  // after a silence: from the beginning
    EXPECT_FALSE(node.time().to_local(master_time(), now).has_value());
}

TEST_F(DronecanTime, AGapOrAFirstMessageIsNoPair)
{
    Node node(fixed());
    sync(node, 5, 31, 0);
    now = now + 0.5F;
    sync(node, 5, 1, 123);  // 0 is missing
    EXPECT_EQ(node.time().diagnostics().updates, 0U);
    const std::uint64_t second = master_time();
    now = now + 0.5F;
    sync(node, 5, 2, second);
    EXPECT_EQ(node.time().diagnostics().updates, 1U);
    now = now + 0.5F;
    sync(node, 5, 3, 0);  // states that there was none
    EXPECT_EQ(node.time().diagnostics().not_a_pair, 3U);
    EXPECT_EQ(node.time().to_local(master_time(), now)->us, now.us);  // the last one stays valid
}

TEST_F(DronecanTime, TheLowestMasterIsFollowed)
{
    Node node(fixed());
    sync(node, 5, 0, 0);
    sync(node, 9, 0, 0);
    EXPECT_EQ(node.time().diagnostics().other_masters, 1U);
    EXPECT_EQ(node.time().master(now), 5);
    const std::uint64_t first = master_time();
    now = now + 1.0F;
    sync(node, 5, 1, first);
    sync(node, 3, 0, 0);
    EXPECT_EQ(node.time().master(now), 3);
    EXPECT_EQ(node.time().diagnostics().master_changes, 1U);
    EXPECT_FALSE(node.time().to_local(first, now).has_value());  // the other's clock gives no information on this one's
    now = now + (TimeSlave::kMasterTimeout + 0.01F);
    sync(node, 9, 1, 0);
    EXPECT_EQ(node.time().master(now), 9);
}

TEST_F(DronecanTime, JumpsAreFollowedAndCounted)
{
    Node node(fixed());
    sync(node, 5, 0, 0);
    now = now + 1.0F;
    sync(node, 5, 1, 1'000'000);
    now = now + 1.0F;
    sync(node, 5, 2, 9'000'000);
    EXPECT_EQ(node.time().diagnostics().jumps, 1U);
    EXPECT_EQ(node.time().to_local(9'000'000, now)->us, now.us - 1'000'000);
}

}  // namespace
}  // namespace jink::link::dronecan
