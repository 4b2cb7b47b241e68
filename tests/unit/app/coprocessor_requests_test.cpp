// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step: non-finite values, parameters, commands, and the counters.
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/numbers.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

class CoprocessorRequests : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
        f.fly(20);
    }

    template <link::mavlink::Message M>
    void ask(M message)
    {
        message.target_system = wire::kSystem;
        message.target_component = wire::kUs;
        f.feed(message);
        f.fly(1);
    }
    ParamValue read_back(std::string_view name)
    {
        ParamRequestRead m;
        m.param_index = -1;
        m.param_id = wire::param_name(name);
        ask(m);
        const auto answers = f.said_of<ParamValue>();
        EXPECT_EQ(answers.size(), 1U) << name;
        return answers.empty() ? ParamValue{} : answers.front();
    }
    std::vector<ParamValue> set(std::string_view name, float value, std::uint8_t type = 9)
    {
        ParamSet m;
        m.param_id = wire::param_name(name);
        m.param_value = value;
        m.param_type = type;
        ask(m);
        return f.said_of<ParamValue>();
    }
    Odometry odometry()
    {
        Odometry m;
        m.time_usec = static_cast<std::uint64_t>(f.boot_us);
        m.x = f.position.y();
        m.y = f.position.x();
        m.z = -f.position.z();
        m.q = {1.0F, 0.0F, 0.0F, 0.0F};
        m.vx = f.velocity.y();
        m.frame_id = 1;
        m.child_frame_id = 1;
        return m;
    }
    const Diagnostics& counted() const { return f.coprocessor.diagnostics(); }
    void expect_sane()
    {
        EXPECT_TRUE(is_finite(f.coprocessor.own().position));
        EXPECT_TRUE(is_finite(f.coprocessor.own().velocity));
        EXPECT_TRUE(std::isfinite(f.coprocessor.own().yaw));
        EXPECT_TRUE(std::isfinite(f.coprocessor.own().sigma_position));
        EXPECT_TRUE(std::isfinite(f.coprocessor.own().sigma_velocity));
        EXPECT_EQ(f.last.faults, 0U);
        EXPECT_FALSE(f.last.guidance.conflict.has_value());
        EXPECT_FALSE(f.last.setpoint_sent);
    }

    Flight f;
};

TEST_F(CoprocessorRequests, NoNumberInLocalPositionIsCountedAndChangesNothing)
{
    using Member = float LocalPositionNed::*;
    for (const Member member : {&LocalPositionNed::x, &LocalPositionNed::y, &LocalPositionNed::z, &LocalPositionNed::vx,
                                &LocalPositionNed::vy, &LocalPositionNed::vz}) {
        for (const float poison : {kNan, kInfinity, -kInfinity}) {
            const std::uint32_t before = f.endpoint.diagnostics().not_finite;
            const std::uint32_t taken = counted().own_states;
            const Vec3 position = f.coprocessor.own().position;
            f.own_state = false;
            LocalPositionNed m = wire::local_position(f.boot_ms(), f.position, f.velocity);
            m.*member = poison;
            f.feed(m);
            f.fly(1);
            EXPECT_EQ(f.endpoint.diagnostics().not_finite, before + 1);
            EXPECT_EQ(counted().own_states, taken);
            EXPECT_EQ(f.coprocessor.own().position, position);
            expect_sane();
            f.own_state = true;
            f.fly(1);
        }
    }
}

TEST_F(CoprocessorRequests, NoNumberInOdometryIsCountedWhereItMattersAndNeverHarms)
{
    f.own_state = false;
    f.feed(odometry());
    f.fly(1);
    ASSERT_EQ(f.last.faults, 0U);
    const auto poisoned = [&](auto&& poke, bool refused, const std::string& what) {
        for (const float poison : {kNan, kInfinity, -kInfinity}) {
            const std::uint32_t before = f.endpoint.diagnostics().not_finite;
            const std::uint32_t taken = counted().own_states;
            Odometry m = odometry();
            poke(m, poison);
            f.feed(m);
            f.fly(1);
            EXPECT_EQ(f.endpoint.diagnostics().not_finite - before, refused ? 1U : 0U) << what << " " << poison;
            EXPECT_EQ(counted().own_states - taken, refused ? 0U : 1U) << what << " " << poison;
            expect_sane();
            f.feed(odometry());
            f.fly(1);
        }
    };
    using Member = float Odometry::*;
    for (const Member member :
         {&Odometry::x, &Odometry::y, &Odometry::z, &Odometry::vx, &Odometry::vy, &Odometry::vz}) {
        poisoned([member](Odometry& m, float v) { m.*member = v; }, true, "position or velocity");
    }
    for (std::size_t i = 0; i < 4; ++i) {
        poisoned([i](Odometry& m, float v) { m.q[i] = v; }, true, "q " + std::to_string(i));
    }
    // Turn rates are not used; a covariance that is no number means "not known".
    for (const Member member : {&Odometry::rollspeed, &Odometry::pitchspeed, &Odometry::yawspeed}) {
        poisoned([member](Odometry& m, float v) { m.*member = v; }, false, "turn rate");
    }
    for (std::size_t i = 0; i < 21; ++i) {
        poisoned([i](Odometry& m, float v) { m.pose_covariance[i] = v; }, false, "pose " + std::to_string(i));
        poisoned([i](Odometry& m, float v) { m.velocity_covariance[i] = v; }, false, "twist " + std::to_string(i));
    }
}

TEST_F(CoprocessorRequests, ListGoesOutOnceInOrderAFewAtATime)
{
    ParamRequestList list;
    ask(list);
    std::vector<ParamValue> all;
    for (int i = 0; i < 40; ++i) {
        const auto some = f.said_of<ParamValue>();
        EXPECT_LE(some.size(), 3U);
        all.insert(all.end(), some.begin(), some.end());
        f.fly(1);
    }
    ASSERT_EQ(all.size(), kParamCount);
    for (std::size_t i = 0; i < kParamCount; ++i) {
        EXPECT_EQ(all[i].param_index, i);
        EXPECT_EQ(all[i].param_count, kParamCount);
        EXPECT_EQ(wire::text_of_id(all[i].param_id), param_table()[i].name);
        EXPECT_EQ(all[i].param_value, param_table()[i].initial);
        EXPECT_EQ(all[i].param_type, 9);
    }
    EXPECT_EQ(f.endpoint.diagnostics().outbox_full, 0U);
}

TEST_F(CoprocessorRequests, ReadByNameAndByIndexAndUnknownOnesAreCounted)
{
    EXPECT_EQ(read_back("VEH_CRUISE").param_value, 5.0F);
    ParamRequestRead m;
    m.param_index = static_cast<std::int16_t>(Param::cruise);
    ask(m);
    ASSERT_EQ(f.said_of<ParamValue>().size(), 1U);
    EXPECT_EQ(wire::text_of_id(f.said_of<ParamValue>().front().param_id), "VEH_CRUISE");
    EXPECT_EQ(counted().params_unknown, 0U);

    m.param_index = static_cast<std::int16_t>(kParamCount);
    ask(m);
    EXPECT_TRUE(f.said_of<ParamValue>().empty());
    m.param_index = -1;
    m.param_id = wire::param_name("VEH_CRUISES");
    ask(m);
    EXPECT_TRUE(f.said_of<ParamValue>().empty());
    EXPECT_TRUE(set("", 1.0F).empty());
    EXPECT_EQ(counted().params_unknown, 3U);
}

TEST_F(CoprocessorRequests, SetIsAnsweredWithTheValueThatStands)
{
    auto answer = set("VEH_CRUISE", 7.5F);
    ASSERT_EQ(answer.size(), 1U);
    EXPECT_EQ(answer[0].param_value, 7.5F);
    EXPECT_EQ(f.coprocessor.parameters().configuration().limits.cruise_speed, 7.5F);
    EXPECT_EQ(counted().params_set, 1U);

    std::uint32_t refused = 0;
    const auto expect_refused = [&](std::string_view name, float value, float stands, std::uint8_t type = 9) {
        const auto answers = set(name, value, type);
        ASSERT_EQ(answers.size(), 1U) << name;
        EXPECT_EQ(answers[0].param_value, stands) << name << " " << value;
        EXPECT_EQ(counted().params_refused, ++refused) << name << " " << value;
        EXPECT_EQ(read_back(name).param_value, stands);
    };
    expect_refused("VEH_CRUISE", kNan, 7.5F);
    expect_refused("VEH_CRUISE", kInfinity, 7.5F);
    expect_refused("VEH_CRUISE", 0.0F, 7.5F);
    expect_refused("VEH_CRUISE", 1000.0F, 7.5F);
    expect_refused("VEH_CRUISE", 6.0F, 7.5F, 6);  // INT32: its bits are no number to go by
    expect_refused("JNK_MODE", 1.5F, 2.0F);
    expect_refused("GEO_OFFSETS", 5.0F, 4.0F);  // in range, but odd
    expect_refused("GEO_K_S", 0.85F, 0.3F);     // in range, but nothing is left for closeness
    EXPECT_EQ(counted().params_set, 1U);
}

TEST_F(CoprocessorRequests, SetTakesEffectInThePlannerAtOnce)
{
    ASSERT_EQ(set("JNK_LOOKAHEAD", 12.0F).size(), 1U);
    EXPECT_EQ(f.coprocessor.parameters().configuration().rules.lookahead, 12.0F);
    ASSERT_EQ(set("JNK_MODE", 0.0F).size(), 1U);
    EXPECT_EQ(f.last.state, link::SystemState::standby);
}

TEST_F(CoprocessorRequests, AsksForRatesUntilReportedNotTo)
{
    const auto asked = [&] {
        std::size_t n = 0;
        for (int i = 0; i < 100; ++i) {
            f.fly(1);
            for (const CommandLong& m : f.said_of<CommandLong>()) {
                n += m.command == 511 ? 1U : 0U;
            }
        }
        return n;
    };
    EXPECT_GT(asked(), 0U) << "this autopilot tells no attitude";
    EXPECT_EQ(set("JNK_ASK_RATES", 0.0F).size(), 1U);
    EXPECT_EQ(asked(), 0U);
    EXPECT_EQ(set("JNK_ASK_RATES", 1.0F).size(), 1U);
    EXPECT_GT(asked(), 0U);
}

TEST_F(CoprocessorRequests, HeartbeatIsSentOnRequestAndOtherCommandsAreUnsupported)
{
    const auto answer = [&](std::uint16_t command, float param1) {
        CommandLong m;
        m.command = command;
        m.param1 = param1;
        ask(m);
        const auto acks = f.said_of<CommandAck>();
        EXPECT_EQ(acks.size(), 1U) << command;
        if (acks.empty()) {
            return -1;
        }
        EXPECT_EQ(acks[0].command, command);
        EXPECT_EQ(acks[0].target_system, wire::kSystem);
        EXPECT_EQ(acks[0].target_component, wire::kAutopilot);
        return static_cast<int>(acks[0].result);
    };
    for (int i = 0; i < 5; ++i) {  // five within a tenth of a second: more than once a second brings by itself
        EXPECT_EQ(answer(512, 0.0F), static_cast<int>(link::CommandResult::accepted));
        EXPECT_EQ(f.said_of<Heartbeat>().size(), 1U);
    }
    EXPECT_EQ(counted().commands_refused, 0U);
    EXPECT_EQ(answer(512, 33.0F), static_cast<int>(link::CommandResult::denied));
    EXPECT_EQ(answer(512, kNan), static_cast<int>(link::CommandResult::denied));
    std::uint32_t refused = 2;
    for (const int command : {0, 16, 176, 246, 400, 511, 513, 65535}) {
        EXPECT_EQ(answer(static_cast<std::uint16_t>(command), 0.0F),
                  static_cast<int>(link::CommandResult::unsupported));
        EXPECT_EQ(counted().commands_refused, ++refused);
    }
    EXPECT_EQ(counted().commands, 5U + refused);

    CommandLong elsewhere;
    elsewhere.command = 512;
    elsewhere.target_system = wire::kSystem;
    elsewhere.target_component = wire::kUs - 1;
    f.feed(elsewhere);
    f.fly(1);
    EXPECT_TRUE(f.said_of<CommandAck>().empty());
    EXPECT_EQ(counted().commands, 5U + refused);
}

/// By REQUEST_MESSAGE, and by the command that is older; every other form is denied and sends nothing.
TEST_F(CoprocessorRequests, TheVersionIsSentOnRequest)
{
    const auto result = [&](std::uint16_t command, float param1) {
        CommandLong m;
        m.command = command;
        m.param1 = param1;
        ask(m);
        const auto acks = f.said_of<CommandAck>();
        EXPECT_EQ(acks.size(), 1U);
        return acks.empty() ? -1 : static_cast<int>(acks[0].result);
    };
    unsigned major = 0;
    unsigned minor = 0;
    unsigned patch = 0;
    ASSERT_EQ(std::sscanf(JINK_TEST_VERSION, "%u.%u.%u", &major, &minor, &patch), 3);
    for (const auto& [command, param1] : {std::pair{512, 148.0F}, std::pair{520, 1.0F}}) {
        EXPECT_EQ(result(static_cast<std::uint16_t>(command), param1), static_cast<int>(link::CommandResult::accepted));
        const auto versions = f.said_of<AutopilotVersion>();
        ASSERT_EQ(versions.size(), 1U) << command;
        EXPECT_EQ(versions[0].flight_sw_version, (major << 24U) + (minor << 16U) + (patch << 8U))
            << "major, minor, patch, a byte each; development";
        EXPECT_EQ(versions[0].capabilities, 8192U | 131072U) << "MAVLink 2, and parameters by their value";
        EXPECT_EQ(versions[0].uid, 0U);
        EXPECT_EQ(versions[0].uid2, decltype(versions[0].uid2){});
        EXPECT_EQ(versions[0].middleware_sw_version, 0U);
        EXPECT_EQ(versions[0].os_sw_version, 0U);
    }
    for (const auto& [command, param1] :
         {std::pair{512, 147.0F}, std::pair{512, 148.5F}, std::pair{520, 0.0F}, std::pair{520, kNan}}) {
        EXPECT_EQ(result(static_cast<std::uint16_t>(command), param1), static_cast<int>(link::CommandResult::denied));
        EXPECT_TRUE(f.said_of<AutopilotVersion>().empty());
    }
    EXPECT_EQ(counted().commands, 6U);
    EXPECT_EQ(counted().commands_refused, 4U);
}

/// A board's longest step, in a text with the next HEARTBEAT however often it is asked for; denied where none counts.
TEST_F(CoprocessorRequests, TheLongestStepIsReportedOnRequest)
{
    CommandLong m;
    m.command = 512;
    m.param1 = 253.0F;
    const auto result = [&] {
        ask(m);
        const auto acks = f.said_of<CommandAck>();
        return acks.size() == 1 ? static_cast<int>(acks[0].result) : -1;
    };
    const auto reported = [&] {
        int count = 0;
        for (const Statustext& text : f.said_of<Statustext>()) {
            count += std::string_view(text.text.data()).starts_with("jink: longest step 123456 cycles") ? 1 : 0;
        }
        return count;
    };
    EXPECT_EQ(result(), static_cast<int>(link::CommandResult::denied));
    for (const std::uint32_t cycles : {70'000U, 123'456U, 80'000U}) {
        f.coprocessor.note_cycles(cycles, 168);
    }
    EXPECT_EQ(result(), static_cast<int>(link::CommandResult::accepted));
    int texts = reported();
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(result(), static_cast<int>(link::CommandResult::accepted));
        texts += reported();
    }
    for (int i = 0; i < 60; ++i) {
        f.fly(1);
        texts += reported();
    }
    EXPECT_GE(texts, 1);
    EXPECT_LE(texts, 2) << "22 requests within less than half a second";
}

TEST_F(CoprocessorRequests, CountsStepsOwnStatesAndRefusesOldOnes)
{
    const Diagnostics before = counted();
    f.fly(10);
    EXPECT_EQ(counted().steps, before.steps + 10);
    EXPECT_EQ(counted().own_states, before.own_states + 10);
    f.own_state = false;
    const Vec3 position = f.coprocessor.own().position;
    f.feed(wire::local_position(f.boot_ms() - 300, Vec3(1.0F, 2.0F, 3.0F)));
    f.fly(1);
    EXPECT_EQ(counted().own_state_refused, before.own_state_refused + 1);
    EXPECT_EQ(counted().own_states, before.own_states + 10);
    EXPECT_EQ(f.coprocessor.own().position, position);
}

TEST_F(CoprocessorRequests, EstimatorResetForgetsObstaclesAndKeepsTraffic)
{
    f.own_state = false;
    f.ring = 20.0F;
    f.obstacles = {f.position + Vec3(200.0F, 0.0F, 0.0F)};
    for (int i = 0; i < 20; ++i) {
        f.feed(odometry());
        f.fly(1);
    }
    ASSERT_GT(f.last.tracks, 0U);
    ASSERT_GT(f.last.obstacles, 0U);
    ASSERT_EQ(counted().estimator_resets, 0U);
    f.ring = 0.0F;
    f.obstacles.clear();
    Odometry jumped = odometry();
    jumped.reset_counter = 1;
    f.feed(jumped);
    f.fly(1);
    EXPECT_EQ(counted().estimator_resets, 1U);
    EXPECT_GT(f.last.tracks, 0U);
    EXPECT_EQ(f.last.obstacles, 0U);
}

TEST_F(CoprocessorRequests, CountsScansReadingsAndTraffic)
{
    f.feed(wire::attitude(f.boot_ms(), 0.0F));
    DistanceSensor down;
    down.time_boot_ms = f.boot_ms();
    down.min_distance = 10;
    down.max_distance = 10000;
    down.current_distance = 5000;
    down.orientation = 25;
    f.feed(down);
    f.fly(1);
    EXPECT_EQ(counted().readings, 1U);
    EXPECT_EQ(counted().scans, 0U);
    EXPECT_EQ(counted().tracks_in, 0U);
    f.ring = 35.0F;
    f.obstacles = {f.position + Vec3(200.0F, 0.0F, 0.0F), f.position + Vec3(-200.0F, 0.0F, 0.0F)};
    f.fly(10);
    EXPECT_EQ(counted().scans, 2U);
    EXPECT_EQ(counted().tracks_in, 2U);
}

}  // namespace
}  // namespace jink::app::test
