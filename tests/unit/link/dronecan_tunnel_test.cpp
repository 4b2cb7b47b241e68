// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_node_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

class DronecanTunnel : public DronecanNode {
protected:
    static TunnelTargetted packet(std::string_view text, std::uint8_t target = kOwn, std::int8_t serial = 2)
    {
        TunnelTargetted message;
        message.protocol = static_cast<std::uint8_t>(TunnelProtocol::mavlink2);
        message.target = target;
        message.serial = serial;
        for (const char c : text) {
            message.bytes.unchecked_push_back(static_cast<std::uint8_t>(c));
        }
        return message;
    }
    void give_tunnel(Node& node, Tunnel& tunnel, const TunnelTargetted& message, std::uint8_t source = kAsker)
    {
        const Transfer* const transfer = give(node, message, source);
        ASSERT_NE(transfer, nullptr);
        tunnel.receive(node, *transfer);
    }
    static std::string read_all(Tunnel& tunnel)
    {
        Bytes bytes(2 * Tunnel::kReceiveBytes);
        bytes.resize(tunnel.read(bytes));
        std::string text;
        for (const std::byte b : bytes) {
            text += static_cast<char>(b);
        }
        return text;
    }
    static Bytes bytes_of(std::string_view text)
    {
        Bytes bytes;
        for (const char c : text) {
            bytes.push_back(static_cast<std::byte>(c));
        }
        return bytes;
    }
};

TEST_F(DronecanTunnel, CarriesBytesBothWays)
{
    Node node(fixed());
    Tunnel tunnel;
    EXPECT_EQ(tunnel.write(node, bytes_of("early")), 0U);  // to whom?
    give_tunnel(node, tunnel, packet("hello "));
    give_tunnel(node, tunnel, packet("world"));
    EXPECT_EQ(tunnel.peer(), kAsker);
    EXPECT_EQ(read_all(tunnel), "hello world");
    EXPECT_EQ(read_all(tunnel), "");

    const std::string text(300, 'x');
    EXPECT_EQ(tunnel.write(node, bytes_of(text)), 300U);
    std::string got;
    for (const Heard& h : heard(node)) {
        TunnelTargetted message;
        ASSERT_EQ(decode(h.payload, message), CodecStatus::ok);
        EXPECT_EQ(message.target, kAsker);
        EXPECT_EQ(message.serial, 2);
        EXPECT_EQ(message.protocol, 1);
        got.append(message.bytes.begin(), message.bytes.end());
    }
    EXPECT_EQ(got, text);
    EXPECT_EQ(tunnel.diagnostics().transfers_out, 3U);
}

TEST_F(DronecanTunnel, OfOthersIsNotOurs)
{
    Node node(fixed());
    Tunnel tunnel({kAsker, 2, 1});
    give_tunnel(node, tunnel, packet("a", 43));
    give_tunnel(node, tunnel, packet("b", kOwn, 3));
    give_tunnel(node, tunnel, packet("c"), 11);
    TunnelTargetted gps = packet("d");
    gps.protocol = 2;
    give_tunnel(node, tunnel, gps);
    EXPECT_EQ(tunnel.diagnostics().not_ours, 4U);
    EXPECT_EQ(read_all(tunnel), "");
    Tunnel open;
    give_tunnel(node, open, packet("f", kOwn, -1));  // a port that there is not
    EXPECT_EQ(open.diagnostics().not_ours, 1U);
    EXPECT_EQ(open.peer(), kAnonymous);
    give_tunnel(node, tunnel, packet("e"));
    EXPECT_EQ(read_all(tunnel), "e");
}

TEST_F(DronecanTunnel, APeerThatFellSilentGivesWayToAnother)
{
    Node node(fixed());
    Tunnel tunnel;
    const auto from = [&](std::uint8_t source, float at, std::int8_t serial) {
        const TunnelTargetted message = packet("x", kOwn, serial);
        Bytes payload(TunnelTargetted::kType.max_length);
        std::size_t size = 0;
        ASSERT_EQ(encode(message, payload, size), CodecStatus::ok);
        payload.resize(size);
        Transfer transfer;
        transfer.type = TunnelTargetted::kType;
        transfer.source = source;
        transfer.stamp = TimePoint{0} + at;
        transfer.payload = payload;
        tunnel.receive(node, transfer);
    };
    from(20, 1.0F, 2);
    from(21, 5.9F, 3);
    EXPECT_EQ(tunnel.peer(), 20) << "heard 4.9 s ago";
    EXPECT_EQ(tunnel.diagnostics().not_ours, 1U);
    from(21, 6.1F, 3);
    EXPECT_EQ(tunnel.peer(), 21) << "the autopilot came back with another node id";
    EXPECT_EQ(tunnel.diagnostics().peers_changed, 1U);
    EXPECT_EQ(read_all(tunnel), "x") << "what the former peer began is not continued";
    from(20, 7.0F, 2);
    EXPECT_EQ(tunnel.peer(), 21);

    Tunnel given({20, 2, 1});
    tunnel = given;
    from(20, 1.0F, 2);
    from(21, 100.0F, 2);
    EXPECT_EQ(tunnel.peer(), 20) << "a peer that was given stays";
}

TEST_F(DronecanTunnel, WhatIsNotReadInTimeGivesWayOldestFirst)
{
    Node node(fixed());
    Tunnel tunnel;
    std::string all;
    for (std::size_t i = 0; i <= Tunnel::kReceiveBytes / 64; ++i) {
        const std::string part(64, static_cast<char>('a' + static_cast<char>(i)));
        give_tunnel(node, tunnel, packet(part));
        all += part;
        const std::size_t over = all.size() > Tunnel::kReceiveBytes ? all.size() - Tunnel::kReceiveBytes : 0;
        EXPECT_EQ(tunnel.diagnostics().bytes_overwritten, over);
    }
    EXPECT_EQ(read_all(tunnel), all.substr(64));
}

TEST_F(DronecanTunnel, LeavesRoomToOthersAndTakesNoMoreThanFits)
{
    Node node(fixed());
    Tunnel tunnel({kAsker, 0, 1});
    const std::size_t taken = tunnel.write(node, Bytes(5000));
    EXPECT_GT(taken, 0U);
    EXPECT_LT(taken, 5000U);
    EXPECT_EQ(tunnel.write(node, Bytes(5000)), 0U);
    EXPECT_LE(node.outgoing().size() + Tunnel::kLeftToOthers, kTransmitFrames);
    EXPECT_EQ(node.outgoing().diagnostics().transfers_dropped, 0U);
    node.send_text(Severity::info, std::string(90, 't'));
    EXPECT_EQ(node.outgoing().diagnostics().transfers_dropped, 0U);
}

}  // namespace
}  // namespace jink::link::dronecan
