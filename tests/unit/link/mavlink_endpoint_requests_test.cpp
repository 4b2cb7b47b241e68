// SPDX-License-Identifier: BSD-3-Clause
// Requests to us, our requests and reports: modes, commands, parameters, time, sending.
#include <gtest/gtest.h>
#include <limits>

#include "firmware/link/mavlink/text.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
constexpr std::uint16_t kDoSetMode = 176;

class MavlinkEndpointRequests : public HeardEndpointTest {
protected:
    CommandLong command(std::uint16_t number)
    {
        CommandLong m;
        m.command = number;
        m.target_system = kSystem;
        m.target_component = kUs;
        return m;
    }
};

TEST_F(MavlinkEndpointRequests, ModesAreRequestedAsTheStackWantsThem)
{
    endpoint->request_external_mode();
    CommandLong m = sent_one<CommandLong>();
    EXPECT_EQ(m.command, kDoSetMode);
    EXPECT_EQ(m.target_system, kSystem);
    EXPECT_EQ(m.target_component, 1);
    EXPECT_EQ(m.param1, 129.0F) << "custom mode, armed as now";
    EXPECT_EQ(m.param2, 4.0F) << "GUIDED";
    EXPECT_EQ(m.param3, 0.0F);
    endpoint->request_hold_mode();
    EXPECT_EQ(sent_one<CommandLong>().param2, 17.0F) << "BRAKE";
    endpoint->request_mode(3);
    EXPECT_EQ(sent_one<CommandLong>().param2, 3.0F);

    heartbeat(3, 10, false, 1);
    endpoint->request_external_mode();
    m = sent_one<CommandLong>();
    EXPECT_EQ(m.param1, 1.0F) << "disarmed";
    EXPECT_EQ(m.param2, 15.0F) << "GUIDED of a plane";

    heartbeat(12, 4U << 16U | 4U << 24U);
    endpoint->request_external_mode();
    m = sent_one<CommandLong>();
    EXPECT_EQ(m.param2, 6.0F) << "OFFBOARD";
    EXPECT_EQ(m.param3, 0.0F);
    endpoint->request_mode(4U << 16U | 4U << 24U);
    m = sent_one<CommandLong>();
    EXPECT_EQ(m.param2, 4.0F);
    EXPECT_EQ(m.param3, 4.0F);
}

TEST_F(MavlinkEndpointRequests, AnswersToModeRequestsAreReported)
{
    CommandAck ack;
    ack.command = kDoSetMode;
    ack.target_system = kSystem;
    ack.target_component = kUs;
    autopilot(ack);
    ack.result = 4;
    autopilot(ack);
    ack.result = 5;  // in progress: no answer yet
    autopilot(ack);
    ack.result = 0;
    ack.target_system = ack.target_component = 0;  // an old autopilot does not say whom
    autopilot(ack);
    ASSERT_EQ(inbox->mode_answers.size(), 3U);
    EXPECT_TRUE(inbox->mode_answers[0].accepted);
    EXPECT_FALSE(inbox->mode_answers[1].accepted);
    EXPECT_EQ(inbox->mode_answers[1].result, 4);
    EXPECT_TRUE(inbox->mode_answers[2].accepted);

    ack.target_system = 255;  // the ground station's
    ack.target_component = 190;
    autopilot(ack);
    ack.target_system = kSystem;
    ack.target_component = kUs;
    ack.command = 400;
    autopilot(ack);
    ack.command = kDoSetMode;
    from(kSystem, 2, ack);
    EXPECT_EQ(count().frames_ignored, 3U);
    EXPECT_EQ(inbox->mode_answers.size(), 3U);
    autopilot(ack);
    autopilot(ack);
    EXPECT_EQ(count().inbox_full, 1U);
}

TEST_F(MavlinkEndpointRequests, CommandsToUsArePassedOnAndAnswered)
{
    CommandLong m = command(512);
    m.param1 = kNan;
    m.param7 = 7.0F;
    from(255, 190, m);
    ASSERT_EQ(inbox->commands.size(), 1U);
    const CommandRequest& request = inbox->commands[0];
    EXPECT_EQ(request.command, 512);
    EXPECT_TRUE(std::isnan(request.params[0])) << "NaN means: not said";
    EXPECT_EQ(request.params[6], 7.0F);
    EXPECT_EQ(request.from_system, 255);
    EXPECT_EQ(request.from_component, 190);
    endpoint->acknowledge(request, CommandResult::unsupported);
    const CommandAck ack = sent_one<CommandAck>();
    EXPECT_EQ(ack.command, 512);
    EXPECT_EQ(ack.result, 3);
    EXPECT_EQ(ack.target_system, 255);
    EXPECT_EQ(ack.target_component, 190);
}

TEST_F(MavlinkEndpointRequests, CommandsToOthersAreNotOurs)
{
    for (const auto& [system, component] : {std::pair{kSystem, std::uint8_t{0}}, std::pair{kSystem, std::uint8_t{1}},
                                            std::pair{std::uint8_t{0}, kUs}, std::pair{std::uint8_t{8}, kUs}}) {
        CommandLong m = command(400);
        m.target_system = system;
        m.target_component = component;
        from(255, 190, m);
    }
    EXPECT_TRUE(inbox->commands.empty()) << "a refusal of ours would be taken for the autopilot's";
    EXPECT_EQ(count().frames_ignored, 4U);
    for (std::size_t i = 0; i < inbox->commands.capacity() + 2; ++i) {
        from(255, 190, command(1));
    }
    EXPECT_EQ(count().inbox_full, 2U);
}

TEST_F(MavlinkEndpointRequests, ParametersAreReadListedAndSet)
{
    ParamRequestList list;
    list.target_system = kSystem;
    from(255, 190, list);
    list.target_component = kUs;
    from(255, 190, list);
    ParamRequestRead read;
    read.target_system = kSystem;
    read.target_component = kUs;
    read.param_index = 5;
    from(255, 190, read);
    read.param_index = -1;
    ASSERT_TRUE(set_text(read.param_id, "CA_MODE"));
    from(255, 190, read);
    ParamSet set;
    set.target_system = kSystem;
    set.target_component = kUs;
    set.param_value = 2.5F;
    set.param_type = 9;
    ASSERT_TRUE(set_text(set.param_id, "ABCDEFGHIJKLMNOP"));
    from(255, 190, set);
    ASSERT_EQ(inbox->params.size(), 5U);
    EXPECT_EQ(inbox->params[0].kind, ParamRequestKind::list);
    EXPECT_EQ(inbox->params[1].kind, ParamRequestKind::list);
    EXPECT_EQ(inbox->params[2].kind, ParamRequestKind::read_by_index);
    EXPECT_EQ(inbox->params[2].index, 5);
    EXPECT_EQ(inbox->params[3].kind, ParamRequestKind::read_by_name);
    EXPECT_EQ(text_of(inbox->params[3].name), "CA_MODE");
    EXPECT_EQ(inbox->params[4].kind, ParamRequestKind::set);
    EXPECT_EQ(text_of(inbox->params[4].name), "ABCDEFGHIJKLMNOP");
    EXPECT_EQ(inbox->params[4].value, 2.5F);
    EXPECT_TRUE(inbox->params[4].value_finite);
}

TEST_F(MavlinkEndpointRequests, ValuesThatAreNoFiniteRealAreMarked)
{
    ParamSet set;
    set.target_system = kSystem;
    set.target_component = kUs;
    set.param_type = 9;
    for (const float bad : {kNan, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
        set.param_value = bad;
        from(255, 190, set);
    }
    set.param_value = 1.0F;
    for (const std::uint8_t type : {0, 1, 6, 10, 255}) {  // bits of an integer, perhaps
        set.param_type = type;
        from(255, 190, set);
    }
    ASSERT_EQ(inbox->params.size(), 8U);
    for (const ParamRequest& request : inbox->params) {
        EXPECT_FALSE(request.value_finite);
        EXPECT_EQ(request.value, 0.0F);
    }
}

TEST_F(MavlinkEndpointRequests, ParametersOfOthersAreNotOurs)
{
    ParamRequestList list;
    list.target_system = kSystem;
    list.target_component = 1;
    from(255, 190, list);
    ParamRequestRead read;
    read.target_system = kSystem;
    from(255, 190, read);
    ParamSet set;
    set.target_system = 8;
    set.target_component = kUs;
    from(255, 190, set);
    EXPECT_TRUE(inbox->params.empty());
    EXPECT_EQ(count().frames_ignored, 3U);
    read.target_component = kUs;
    for (std::size_t i = 0; i < inbox->params.capacity() + 1; ++i) {
        from(255, 190, read);
    }
    EXPECT_EQ(count().inbox_full, 1U);
}

TEST_F(MavlinkEndpointRequests, TimeIsAskedForOnceASecondAndReportedWhenAsked)
{
    const auto requests = only<Timesync>(serve(5.0F));
    EXPECT_GE(requests.size(), 5U);
    EXPECT_LE(requests.size(), 6U);
    EXPECT_EQ(requests[0].tc1, 0);
    EXPECT_EQ(requests[0].target_system, kSystem);
    EXPECT_EQ(requests[0].target_component, 1);

    Timesync ask;
    ask.ts1 = 424242;
    autopilot(ask);
    const Timesync answer = sent_one<Timesync>();
    EXPECT_EQ(answer.ts1, 424242);
    EXPECT_EQ(answer.tc1, now.us * 1000);
    EXPECT_EQ(answer.target_system, kSystem);
    EXPECT_EQ(answer.target_component, 1);

    ask.target_system = kSystem;
    ask.target_component = 99;  // for another component
    autopilot(ask);
    from(255, 190, Timesync{});  // the ground station's business is with the autopilot
    EXPECT_TRUE(sent().empty());
    EXPECT_EQ(count().frames_ignored, 2U);
}

TEST_F(MavlinkEndpointRequests, OnlyTheAnswerToOurNewestRequestMovesTheClock)
{
    endpoint->service(now);
    const Timesync request = sent_one<Timesync>();
    Timesync answer;
    answer.ts1 = request.ts1 + 1;
    answer.tc1 = 5'000'000'000;
    autopilot(answer);
    EXPECT_EQ(count().frames_ignored, 1U);
    // 20 ms there and back: the autopilot's 50 s are our 100.010 s
    wait(0.02F);
    answer.ts1 = request.ts1;
    answer.tc1 = 50'000'000'000;
    autopilot(answer);
    EXPECT_EQ(count().frames_ignored, 1U);
    autopilot(answer);
    EXPECT_EQ(count().frames_ignored, 2U) << "once";
    LocalPositionNed m;
    m.time_boot_ms = 50'000;
    autopilot(m);
    ASSERT_TRUE(inbox->has_own_state);
    EXPECT_NEAR(static_cast<double>(inbox->own_state.state.stamp.us), 100'010'000.0, 2.0);
}

TEST_F(MavlinkEndpointRequests, SendsWhatItIsReported)
{
    endpoint->send_heartbeat(SystemState::critical);
    const Heartbeat heart = sent_one<Heartbeat>();
    EXPECT_EQ(heart.type, 18);
    EXPECT_EQ(heart.autopilot, 8);
    EXPECT_EQ(heart.system_status, 5);
    EXPECT_EQ(heart.mavlink_version, 3);

    endpoint->send_velocity({1, 2, 3}, now);  // east, north, up
    const SetPositionTargetLocalNed target = sent_one<SetPositionTargetLocalNed>();
    EXPECT_EQ(target.vx, 2.0F);
    EXPECT_EQ(target.vy, 1.0F);
    EXPECT_EQ(target.vz, -3.0F);
    EXPECT_EQ(target.type_mask, 0x0DC7);
    EXPECT_EQ(target.coordinate_frame, 1);
    EXPECT_EQ(target.target_system, kSystem);
    EXPECT_EQ(target.target_component, 1);
    EXPECT_EQ(target.time_boot_ms, 100'000U);

    CollisionWarning warning;
    warning.id = 42;
    warning.time_to_closest = 2.5F;
    warning.vertical_miss = 1.0F;
    warning.horizontal_miss = 3.0F;
    warning.action = CollisionAction::move_horizontally;
    warning.level = ThreatLevel::high;
    endpoint->send_collision(warning);
    const Collision collision = sent_one<Collision>();
    EXPECT_EQ(collision.id, 42U);
    EXPECT_EQ(collision.time_to_minimum_delta, 2.5F);
    EXPECT_EQ(collision.altitude_minimum_delta, 1.0F);
    EXPECT_EQ(collision.horizontal_minimum_delta, 3.0F);
    EXPECT_EQ(collision.action, 3);
    EXPECT_EQ(collision.threat_level, 2);

    endpoint->send_text(Severity::warning, std::string(60, 'x'));
    const Statustext text = sent_one<Statustext>();
    EXPECT_EQ(text.severity, 4);
    EXPECT_EQ(text_of(text.text), std::string(50, 'x'));

    ParamName name{};
    ASSERT_TRUE(set_text(name, "CA_RADIUS"));
    endpoint->send_param(name, 0.75F, 1, 3);
    const ParamValue value = sent_one<ParamValue>();
    EXPECT_EQ(text_of(value.param_id), "CA_RADIUS");
    EXPECT_EQ(value.param_value, 0.75F);
    EXPECT_EQ(value.param_index, 1);
    EXPECT_EQ(value.param_count, 3);
    EXPECT_EQ(value.param_type, 9);
    EXPECT_EQ(count().frames_out, 5U);
}

TEST_F(MavlinkEndpointRequests, FramesWithoutRoomAreDroppedWholeAndCounted)
{
    std::size_t frames = 0;
    while (count().outbox_full == 0) {
        endpoint->send_text(Severity::info, "a text of a certain length, to fill the buffer up");
        ++frames;
    }
    EXPECT_LE(endpoint->pending().size(), Endpoint::kTransmitBytes);
    EXPECT_EQ(sent().size(), frames - 1) << "whole ones only, and all of those";
    EXPECT_EQ(ears.diagnostics().lost, 0U) << "a frame that was not sent has no number";
    endpoint->send_text(Severity::info, "again");
    endpoint->discard_pending();
    EXPECT_TRUE(endpoint->pending().empty());
}

TEST(MavlinkEndpointSigning, SpeaksAndListensSigned)
{
    Signing::Key key;
    key.fill(std::byte{9});
    Signing ours(key, 1, 1000);
    Signing theirs(key, 2, 1000);
    auto endpoint = std::make_unique<Endpoint>(EndpointOptions{}, &ours);
    auto inbox = std::make_unique<Inbox>();
    Heartbeat m;
    m.autopilot = 3;
    endpoint->receive(frame_of(m, {7, 1, 0}), {1000}, *inbox);
    EXPECT_FALSE(inbox->has_autopilot);
    EXPECT_EQ(endpoint->diagnostics().frames_refused, 1U);
    Bytes frame(kMaxFrame);
    frame.resize(encode_signed(m, {7, 1, 1}, theirs, frame));
    endpoint->receive(frame, {2000}, *inbox);
    EXPECT_TRUE(inbox->has_autopilot);
    endpoint->send_heartbeat(SystemState::active);
    Parser ears(&theirs);
    const auto heard = parse(ears, endpoint->pending());
    ASSERT_EQ(heard.size(), 1U);
    EXPECT_TRUE(heard[0].is_signed);
}

}  // namespace
}  // namespace jink::link::mavlink
