// SPDX-License-Identifier: BSD-3-Clause
// What a node owes the bus: status, answers, a node id, the common clock; and the tunnel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

constexpr std::uint8_t kOwn = 42;
constexpr std::uint8_t kAsker = 10;

ParamName param_name(std::string_view text)
{
    ParamName name{};
    std::copy(text.begin(), text.end(), name.begin());
    return name;
}

/// Two parameters, one of them whole; refuses what is out of range, as the application does.
class Params final : public ParamServer {
public:
    bool read(std::uint16_t index, ParamEntry& entry) const noexcept override
    {
        if (index >= entries.size()) {
            return false;
        }
        entry = entries[index];
        return true;
    }
    bool find(const ParamName& name, std::uint16_t& index) const noexcept override
    {
        for (std::size_t i = 0; i < entries.size(); ++i) {
            if (entries[i].name == name) {
                index = static_cast<std::uint16_t>(i);
                return true;
            }
        }
        return false;
    }
    void write(std::uint16_t index, float value) noexcept override
    {
        ++writes;
        ParamEntry& entry = entries[index];
        if (value >= entry.low && value <= entry.high && (!entry.integer || std::round(value) == value)) {
            entry.value = value;
        }
    }
    bool save() noexcept override { return can_save && ++saves > 0; }
    bool erase() noexcept override { return ++erases > 0; }

    std::array<ParamEntry, 2> entries{
        ParamEntry{param_name("JNK_MODE"), 2.0F, 2.0F, 0.0F, 2.0F, true},
        ParamEntry{param_name("JNK_SIXTEEN_CHAR"), 12.5F, 10.0F, 1.0F, 60.0F, false},
    };
    int writes = 0, saves = 0, erases = 0;
    bool can_save = true;
};

class DronecanNode : public testing::Test {
protected:
    /// Everything that the node has queued, put together by a receiver of its own; payloads by type and kind.
    struct Heard {
        TypeInfo type;
        std::uint8_t source, transfer, priority;
        Bytes payload;
    };
    std::vector<Heard> heard(Node& node, std::uint8_t listener = kAsker)
    {
        static constexpr std::array kListen{NodeStatus::kType,
                                            GetNodeInfoResponse::kType,
                                            GetSetResponse::kType,
                                            Allocation::kType,
                                            ExecuteOpcodeResponse::kType,
                                            LogMessage::kType,
                                            TunnelTargetted::kType,
                                            Proximity::kType};
        Receiver receiver(kListen);
        receiver.set_node(listener);
        std::vector<Heard> all;
        while (node.outgoing().front() != nullptr) {
            if (const Transfer* const t = receiver.accept(*node.outgoing().front(), now)) {
                all.push_back({t->type, t->source, t->transfer, t->priority, {t->payload.begin(), t->payload.end()}});
            }
            node.outgoing().pop();
        }
        return all;
    }
    template <Described M>
    std::optional<M> answer(Node& node, std::uint8_t listener = kAsker)
    {
        M message;
        for (const Heard& h : heard(node, listener)) {
            if (h.type.id == M::kType.id && h.type.kind == M::kType.kind &&
                decode(h.payload, message) == CodecStatus::ok) {
                return message;
            }
        }
        return std::nullopt;
    }
    template <Described M>
    const Transfer* give(Node& node, const M& message, std::uint8_t source = kAsker)
    {
        const Transfer* transfer = nullptr;
        for (const Frame& frame : frames_of(message, source, transfer_, Priority::high, kOwn)) {
            transfer = node.receive(frame, now);
        }
        transfer_ = static_cast<std::uint8_t>((transfer_ + 1U) % kTransferIds);
        return transfer;
    }
    static NodeOptions fixed()
    {
        NodeOptions options;
        options.node = kOwn;
        options.software = {1, 2, SoftwareVersion::kHasCommit, 0xDEADBEEF, 0};
        options.hardware_major = 3;
        for (std::size_t i = 0; i < options.unique_id.size(); ++i) {
            options.unique_id[i] = static_cast<std::uint8_t>(0xA0 + i);
        }
        return options;
    }

    Params params;
    TimePoint now{1'000'000};
    std::uint8_t transfer_ = 0;
};

TEST_F(DronecanNode, StatusOnceASecondAndAtEachChange)
{
    Node node(fixed());
    int sent = 0;
    for (int step = 0; step < 500; ++step) {  // 10 s at 50 Hz
        node.service(now, SystemState::active);
        for (const Heard& h : heard(node)) {
            NodeStatus status;
            ASSERT_EQ(decode(h.payload, status), CodecStatus::ok);
            EXPECT_EQ(status.health, Health::ok);
            EXPECT_EQ(status.mode, Mode::operational);
            EXPECT_EQ(status.uptime, static_cast<std::uint32_t>(step / 50));
            EXPECT_EQ(h.transfer, sent);
            EXPECT_EQ(h.source, kOwn);
            ++sent;
        }
        now.us += 20'000;
    }
    EXPECT_EQ(sent, 10);
    const auto health = [&](SystemState state) {
        node.service(now, state);
        return answer<NodeStatus>(node);
    };
    EXPECT_EQ(health(SystemState::critical)->health, Health::error);
    EXPECT_FALSE(health(SystemState::critical).has_value());
    EXPECT_EQ(health(SystemState::emergency)->health, Health::critical);
    EXPECT_EQ(health(SystemState::boot)->mode, Mode::initialization);
    EXPECT_EQ(health(SystemState::standby)->mode, Mode::operational);
}

TEST_F(DronecanNode, AnswersGetNodeInfo)
{
    Node node(fixed());
    node.service(now, SystemState::critical);
    EXPECT_EQ(heard(node).size(), 1U);
    transfer_ = 17;
    EXPECT_EQ(give(node, GetNodeInfoRequest{}), nullptr);
    const std::vector<Heard> all = heard(node);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].transfer, 17);
    EXPECT_EQ(all[0].priority, static_cast<std::uint8_t>(Priority::high));
    GetNodeInfoResponse info;
    ASSERT_EQ(decode(all[0].payload, info), CodecStatus::ok);
    EXPECT_EQ(info.status.health, Health::error);
    EXPECT_EQ(info.software.major, 1);
    EXPECT_EQ(info.software.commit, 0xDEADBEEF);
    EXPECT_EQ(info.hardware.major, 3);
    EXPECT_EQ(info.hardware.unique_id, fixed().unique_id);
    EXPECT_EQ(std::string(info.name.begin(), info.name.end()), "org.jink.coprocessor");
    EXPECT_EQ(node.diagnostics().answers, 1U);
}

TEST_F(DronecanNode, ReadsParametersByIndexAndName)
{
    Node node(fixed(), &params);
    GetSetRequest request;
    give(node, request);
    std::optional<GetSetResponse> reply = answer<GetSetResponse>(node);
    ASSERT_TRUE(reply);
    EXPECT_EQ(std::string(reply->name.begin(), reply->name.end()), "JNK_MODE");
    EXPECT_EQ(reply->value.tag, ParamValue::Tag::integer);
    EXPECT_EQ(reply->value.integer, 2);
    EXPECT_EQ(reply->high.integer, 2);

    request.index = 0;  // the name wins
    for (const char c : std::string_view("JNK_SIXTEEN_CHAR")) {
        request.name.unchecked_push_back(static_cast<std::uint8_t>(c));
    }
    give(node, request);
    reply = answer<GetSetResponse>(node);
    ASSERT_TRUE(reply);
    EXPECT_EQ(std::string(reply->name.begin(), reply->name.end()), "JNK_SIXTEEN_CHAR");
    EXPECT_EQ(reply->value.tag, ParamValue::Tag::real);
    EXPECT_EQ(reply->value.real, 12.5F);
    EXPECT_EQ(reply->initial.real, 10.0F);
    EXPECT_EQ(reply->low.real, 1.0F);
    EXPECT_EQ(reply->high.real, 60.0F);
}

TEST_F(DronecanNode, ParametersThatThereAreNotHaveNoName)
{
    Node node(fixed(), &params);
    GetSetRequest request;
    request.index = 2;
    give(node, request);
    EXPECT_TRUE(answer<GetSetResponse>(node)->name.empty());
    request.name.unchecked_push_back('X');
    give(node, request);
    EXPECT_TRUE(answer<GetSetResponse>(node)->name.empty());
    request.name.resize(17);  // longer than any
    std::fill(request.name.begin(), request.name.end(), std::uint8_t{'J'});
    give(node, request);
    EXPECT_TRUE(answer<GetSetResponse>(node)->name.empty());
    EXPECT_EQ(node.diagnostics().params_unknown, 3U);
    Node without(fixed());
    give(without, GetSetRequest{});
    EXPECT_TRUE(answer<GetSetResponse>(without)->name.empty());
}

TEST_F(DronecanNode, SetsParametersAndTellsTheValueThatStands)
{
    Node node(fixed(), &params);
    const auto set = [&](std::uint16_t index, const ParamValue& value) {
        GetSetRequest request;
        request.index = index;
        request.value = value;
        give(node, request);
        return answer<GetSetResponse>(node)->value;
    };
    ParamValue value;
    value.tag = ParamValue::Tag::real;
    value.real = 30.0F;
    EXPECT_EQ(set(1, value).real, 30.0F);
    value.real = 61.0F;  // out of its range
    EXPECT_EQ(set(1, value).real, 30.0F);
    value.tag = ParamValue::Tag::integer;
    value.integer = 45;
    EXPECT_EQ(set(1, value).real, 45.0F);
    EXPECT_EQ(set(0, value).integer, 2);
    value.integer = 1;
    EXPECT_EQ(set(0, value).integer, 1);
    value.tag = ParamValue::Tag::boolean;
    value.boolean = 0;
    EXPECT_EQ(set(0, value).integer, 0);
    EXPECT_EQ(params.writes, 6);

    value.tag = ParamValue::Tag::real;
    for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
        value.real = bad;
        EXPECT_EQ(set(1, value).real, 45.0F);
    }
    value.tag = ParamValue::Tag::integer;
    for (const std::int64_t bad :
         {(std::int64_t{1} << 24) + 1, -(std::int64_t{1} << 24) - 1, std::numeric_limits<std::int64_t>::min()}) {
        value.integer = bad;
        EXPECT_EQ(set(1, value).real, 45.0F);
    }
    value.tag = ParamValue::Tag::text;
    EXPECT_EQ(set(1, value).real, 45.0F);
    EXPECT_EQ(params.writes, 6);
    EXPECT_EQ(node.diagnostics().values_refused, 6U);
}

TEST_F(DronecanNode, SavesAndErases)
{
    Node node(fixed(), &params);
    const auto execute = [&](std::uint8_t opcode) {
        ExecuteOpcodeRequest request;
        request.opcode = opcode;
        give(node, request);
        return answer<ExecuteOpcodeResponse>(node)->ok;
    };
    EXPECT_TRUE(execute(ExecuteOpcodeRequest::kSave));
    EXPECT_EQ(params.saves, 1);
    params.can_save = false;
    EXPECT_FALSE(execute(ExecuteOpcodeRequest::kSave));
    EXPECT_TRUE(execute(ExecuteOpcodeRequest::kErase));
    EXPECT_EQ(params.erases, 1);
    EXPECT_FALSE(execute(2));
}

TEST_F(DronecanNode, UndecodableRequestsAreCountedAndNotAnswered)
{
    Node node(fixed(), &params);
    Bytes payload(2);
    payload[1] = std::byte{7};  // no such alternative
    for (const Frame& frame :
         frames_of(TransferHead{GetSetRequest::kType, Priority::medium, kAsker, kOwn, 0}, payload)) {
        EXPECT_EQ(node.receive(frame, now), nullptr);
    }
    EXPECT_EQ(node.diagnostics().undecodable[static_cast<std::size_t>(CodecStatus::bad_tag)], 1U);
    EXPECT_EQ(node.outgoing().front(), nullptr);
}

TEST_F(DronecanNode, Texts)
{
    Node node(fixed());
    node.send_text(Severity::warning, "avoidance active");
    std::optional<LogMessage> message = answer<LogMessage>(node);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->level, LogLevel::warning);
    EXPECT_EQ(std::string(message->source.begin(), message->source.end()), "jink");
    EXPECT_EQ(std::string(message->text.begin(), message->text.end()), "avoidance active");
    node.send_text(Severity::critical, std::string(91, 'x'));
    message = answer<LogMessage>(node);
    EXPECT_EQ(message->level, LogLevel::error);
    EXPECT_EQ(message->text.size(), 90U);
    EXPECT_EQ(node.diagnostics().texts_cut, 1U);
    node.send_text(Severity::info, "");
    EXPECT_EQ(answer<LogMessage>(node)->level, LogLevel::info);
}

TEST_F(DronecanNode, NumbersOutOfRangeAreNotSent)
{
    Node node(fixed());
    Proximity proximity;
    proximity.distance = 1e6F;
    EXPECT_FALSE(node.send(proximity, Priority::medium));
    EXPECT_EQ(node.diagnostics().unsendable, 1U);
    proximity.distance = 10.0F;
    EXPECT_TRUE(node.send(proximity, Priority::medium));
    EXPECT_EQ(answer<Proximity>(node)->distance, 10.0F);
}

TEST_F(DronecanNode, AnotherNodeWithOurIdShows)
{
    Node node(fixed());
    node.service(now, SystemState::active);
    EXPECT_EQ(answer<NodeStatus>(node)->health, Health::ok);
    EXPECT_EQ(node.receive(frames_of(NodeStatus{}, kOwn)[0], now), nullptr);
    EXPECT_EQ(node.diagnostics().id_conflicts, 1U);
    node.service(now, SystemState::active);
    EXPECT_EQ(answer<NodeStatus>(node)->health, Health::warning);
    now = now + (Node::kConflictShown + 0.01F);
    node.service(now, SystemState::active);
    EXPECT_EQ(answer<NodeStatus>(node)->health, Health::ok);
}

/// An allocator: collects the unique id over three requests and hands out a node id, as the protocol has it.
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
    give(node, confirmed(16, 0));  // an answer without a node id is none
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
    sync(node, 5, 3, 0);  // says that there was none
    EXPECT_EQ(node.time().diagnostics().not_a_pair, 3U);
    EXPECT_EQ(node.time().to_local(master_time(), now)->us, now.us);  // the last one stands
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
    EXPECT_FALSE(node.time().to_local(first, now).has_value());  // the other's clock says nothing of this one's
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
