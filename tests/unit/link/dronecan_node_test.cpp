// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_node_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

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

}  // namespace
}  // namespace jink::link::dronecan
