// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_node_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

class DronecanAllocation : public DronecanNode {
protected:
    /// Steps until the node has sent something; the request.
    Allocation next_request(Node& node)
    {
        for (int step = 0; step < 100; ++step) {
            now.us += 20'000;
            node.service(now, SystemState::boot);
            const std::vector<Heard> all = heard(node);
            if (!all.empty()) {
                EXPECT_EQ(all.size(), 1U);
                EXPECT_EQ(all[0].source, kAnonymous);
                Allocation request;
                EXPECT_EQ(decode(all[0].payload, request), CodecStatus::ok);
                return request;
            }
        }
        ADD_FAILURE() << "no request within 2 s";
        return {};
    }
    static NodeOptions dynamic()
    {
        NodeOptions options = fixed();
        options.node = kAnonymous;
        options.preferred = 60;
        return options;
    }
    Allocation confirmed(std::size_t bytes, std::uint8_t id = 0)
    {
        Allocation reply;
        reply.node = id;
        for (std::size_t i = 0; i < bytes; ++i) {
            reply.unique_id.unchecked_push_back(fixed().unique_id[i]);
        }
        return reply;
    }
};

TEST_F(DronecanAllocation, GetsANodeIdInThreeSteps)
{
    Node node(dynamic());
    Allocation request = next_request(node);
    EXPECT_TRUE(request.first_part);
    EXPECT_EQ(request.node, 60);
    EXPECT_EQ(request.unique_id.size(), 6U);
    EXPECT_EQ(request.unique_id[0], 0xA0);
    give(node, confirmed(6));
    request = next_request(node);
    EXPECT_FALSE(request.first_part);
    EXPECT_EQ(request.unique_id.size(), 6U);
    EXPECT_EQ(request.unique_id[0], 0xA6);
    give(node, confirmed(12));
    request = next_request(node);
    EXPECT_FALSE(request.first_part);
    EXPECT_EQ(request.unique_id.size(), 4U);
    EXPECT_EQ(request.unique_id[0], 0xAC);
    EXPECT_EQ(node.id(), kAnonymous);
    give(node, confirmed(16, 61));
    EXPECT_EQ(node.id(), 61);
    node.service(now, SystemState::active);
    EXPECT_TRUE(answer<NodeStatus>(node).has_value());
    // Later allocations are other nodes' business.
    give(node, confirmed(16, 62));
    EXPECT_EQ(node.id(), 61);
}

TEST_F(DronecanAllocation, WaitsAsLongAsTheProtocolSays)
{
    Node node(dynamic());
    const TimePoint start = now;
    next_request(node);
    EXPECT_GE(now - start, 0.6F);
    EXPECT_LE(now - start, 1.04F);
    for (int i = 0; i < 20; ++i) {  // unanswered: from the beginning
        const TimePoint last = now;
        EXPECT_TRUE(next_request(node).first_part);
        EXPECT_GE(now - last, 0.6F);
        EXPECT_LE(now - last, 1.04F);
    }
    const TimePoint last = now;
    give(node, confirmed(6));
    EXPECT_FALSE(next_request(node).first_part);
    EXPECT_LE(now - last, 0.44F);
}

TEST_F(DronecanAllocation, OthersStartTheWaitAnewAndTheirIdsAreNotOurs)
{
    Node node(dynamic());
    next_request(node);
    give(node, confirmed(6));
    Allocation other = confirmed(12);
    other.unique_id[11] ^= 1U;
    const TimePoint last = now;
    give(node, other);  // not ours: from the beginning
    EXPECT_TRUE(next_request(node).first_part);
    EXPECT_GE(now - last, 0.6F);
    give(node, confirmed(6));
    Allocation request = other;
    request.unique_id.resize(6);
    give(node, request, kAnonymous);  // another client's, though its bytes are ours
    EXPECT_TRUE(next_request(node).first_part);
    other = confirmed(16, 61);
    other.unique_id[15] ^= 1U;
    give(node, other);
    EXPECT_EQ(node.id(), kAnonymous);
    give(node, confirmed(16, 0));  // an answer without a node id is ignored
    EXPECT_EQ(node.id(), kAnonymous);
    give(node, Allocation{});
    EXPECT_EQ(node.id(), kAnonymous);
}

TEST_F(DronecanAllocation, AFixedIdStays)
{
    Node node(fixed());
    give(node, confirmed(16, 61));
    EXPECT_EQ(node.id(), kOwn);
}

TEST_F(DronecanAllocation, UntilThenNothingElseIsSaid)
{
    Node node(dynamic());
    node.send_text(Severity::info, "hello");
    EXPECT_EQ(node.diagnostics().anonymous, 1U);
    give(node, GetNodeInfoRequest{});
    EXPECT_EQ(node.outgoing().front(), nullptr);
    EXPECT_EQ(node.diagnostics().answers, 0U);
}

}  // namespace
}  // namespace jink::link::dronecan
