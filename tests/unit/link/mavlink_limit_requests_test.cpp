// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's limits: what is asked, what counts as an answer, and what follows from it.
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/limit_requests.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using Outcome = LimitRequests::Outcome;
using Values = std::map<std::string, float>;

const Values kBefore47{{"WPNAV_ACCEL", 250.0F}, {"WPNAV_ACCEL_Z", 100.0F}, {"PSC_JERK_XY", 5.0F}};
const Values kSince47{{"WP_ACC", 2.5F}, {"WP_ACC_Z", 1.0F}, {"PSC_JERK_NE", 5.0F}};
const Values kNewest{{"WP_ACC", 2.5F}, {"WP_ACC_Z", 1.0F}, {"PSC_NE_JERK", 5.0F}};
const Values kPx4{{"MPC_Z_VEL_MAX_UP", 3.0F}, {"MPC_Z_VEL_MAX_DN", 1.5F}};

struct Asked {
    std::vector<std::string> names;
    std::vector<Seconds> at;
};

/// At 50 Hz; the autopilot answers what it knows, in the same tick.
Asked run(LimitRequests& requests, AutopilotStack stack, const Values& known, Seconds seconds, Seconds from = 100.0F)
{
    Asked asked;
    for (int tick = 0; tick < static_cast<int>(seconds * 50.0F); ++tick) {
        const TimePoint now{static_cast<std::int64_t>(from) * 1'000'000 + tick * 20'000};
        const std::optional<std::string_view> name = requests.next(stack, now);
        if (!name) {
            continue;
        }
        asked.names.emplace_back(*name);
        asked.at.push_back(static_cast<float>(tick) * 0.02F);
        if (const auto value = known.find(asked.names.back()); value != known.end()) {
            EXPECT_EQ(requests.heard(stack, *name, value->second), Outcome::changed);
        }
    }
    return asked;
}

TEST(MavlinkLimitRequests, EveryVersionOfArduCopterTellsItsLimitsWithinFourSeconds)
{
    for (const Values& version : {kBefore47, kSince47, kNewest}) {
        LimitRequests requests;
        const Asked asked = run(requests, AutopilotStack::ardupilot, version, 60.0F);
        const ReportedLimits limits = requests.limits();
        EXPECT_EQ(limits.acceleration, 2.5F);
        EXPECT_EQ(limits.vertical_acceleration, 1.0F);
        EXPECT_FLOAT_EQ(limits.lag, 0.6F) << "2.5 m/s2 over 5 m/s3, and the attitude's";
        EXPECT_EQ(limits.climb, 0.0F) << "its speeds in GUIDED are those of the set-points";
        EXPECT_EQ(limits.descent, 0.0F);
        EXPECT_LE(asked.at.back(), 4.0F) << "nothing is asked that has been told";
        EXPECT_LE(asked.names.size(), 7U);
    }
}

TEST(MavlinkLimitRequests, Px4TellsItsRatesAlone)
{
    LimitRequests requests;
    const Asked asked = run(requests, AutopilotStack::px4, kPx4, 60.0F);
    EXPECT_EQ(asked.names, (std::vector<std::string>{"MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN"}));
    const ReportedLimits limits = requests.limits();
    EXPECT_EQ(limits.climb, 3.0F);
    EXPECT_EQ(limits.descent, 1.5F);
    EXPECT_EQ(limits.acceleration, 0.0F);
    EXPECT_EQ(limits.lag, 0.0F);
}

TEST(MavlinkLimitRequests, WhoDoesNotAnswerIsAskedThreeTimesAndThenEveryHalfMinute)
{
    for (const AutopilotStack stack : {AutopilotStack::ardupilot, AutopilotStack::px4}) {
        LimitRequests requests;
        const Asked asked = run(requests, stack, {}, 600.0F);
        std::map<std::string, int> times;
        for (std::size_t i = 0; i < asked.names.size(); ++i) {
            ++times[asked.names[i]];
            EXPECT_GE(i == 0 ? 1.0F : asked.at[i] - asked.at[i - 1], 0.99F * LimitRequests::kPeriod);
        }
        const std::size_t first = 3 * times.size();
        ASSERT_GT(asked.names.size(), first);
        EXPECT_LE(asked.at[first - 1], 12.0F);
        for (std::size_t i = first + 1; i < asked.at.size(); ++i) {
            EXPECT_GE(asked.at[i] - asked.at[i - 1], 0.99F * LimitRequests::kRest);
        }
        for (const auto& [name, n] : times) {
            EXPECT_GE(n, 4) << name << ": none is forgotten";
        }
    }
    LimitRequests requests;
    EXPECT_TRUE(run(requests, AutopilotStack::unknown, {}, 60.0F).names.empty());
}

TEST(MavlinkLimitRequests, ALateAnswerAndOneUnaskedCountAndAfterARestartAllIsAskedAgain)
{
    LimitRequests requests;
    EXPECT_EQ(requests.heard(AutopilotStack::px4, "MPC_Z_VEL_MAX_DN", 1.0F), Outcome::changed) << "never asked";
    EXPECT_EQ(requests.heard(AutopilotStack::px4, "MPC_Z_VEL_MAX_DN", 1.0F), Outcome::unchanged);
    EXPECT_EQ(run(requests, AutopilotStack::px4, kPx4, 60.0F).names, std::vector<std::string>{"MPC_Z_VEL_MAX_UP"});
    EXPECT_EQ(requests.heard(AutopilotStack::px4, "MPC_Z_VEL_MAX_DN", 2.0F), Outcome::changed);
    requests.restart();
    EXPECT_EQ(requests.limits().descent, 2.0F) << "holds until the restarted one says otherwise";
    std::vector<std::string> again;
    for (int tick = 0; tick < 100; ++tick) {
        if (const auto name = requests.next(AutopilotStack::px4, {1'000'000'000 + tick * 20'000})) {
            again.emplace_back(*name);
            static_cast<void>(requests.heard(AutopilotStack::px4, *name, kPx4.at(again.back())));
        }
    }
    EXPECT_EQ(again.size(), 2U);
    EXPECT_EQ(requests.limits().descent, 1.5F);
}

TEST(MavlinkLimitRequests, WhatNoLimitCanBeIsRefusedAndChangesNothing)
{
    constexpr float kInf = std::numeric_limits<float>::infinity();
    LimitRequests requests;
    for (const float value :
         {0.0F, -1.5F, 0.19F, 101.0F, 1e30F, kInf, -kInf, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(requests.heard(AutopilotStack::px4, "MPC_Z_VEL_MAX_DN", value), Outcome::refused) << value;
    }
    EXPECT_EQ(requests.limits().descent, 0.0F);
    EXPECT_EQ(requests.heard(AutopilotStack::ardupilot, "WPNAV_ACCEL", 19.0F), Outcome::refused) << "0.19 m/s2";
    EXPECT_EQ(requests.heard(AutopilotStack::ardupilot, "WPNAV_ACCE", 250.0F), Outcome::not_a_limit);
    EXPECT_EQ(requests.heard(AutopilotStack::ardupilot, "WPNAV_ACCEL_", 250.0F), Outcome::not_a_limit);
    EXPECT_EQ(requests.heard(AutopilotStack::ardupilot, "", 250.0F), Outcome::not_a_limit);
    EXPECT_EQ(requests.heard(AutopilotStack::ardupilot, "MPC_Z_VEL_MAX_DN", 1.5F), Outcome::not_a_limit);
    EXPECT_EQ(requests.heard(AutopilotStack::unknown, "WPNAV_ACCEL", 250.0F), Outcome::not_a_limit);
    static_cast<void>(requests.heard(AutopilotStack::ardupilot, "PSC_JERK_XY", 5.0F));
    EXPECT_EQ(requests.limits().lag, 0.0F) << "of what acceleration?";
    static_cast<void>(requests.heard(AutopilotStack::ardupilot, "WPNAV_ACCEL", 10000.0F));
    EXPECT_EQ(requests.limits().lag, LimitRequests::kMaxLag) << "20 s";
}

ParamValue value_of(std::string_view name, float value)
{
    ParamValue m;
    m.param_id = param_name(name);
    m.param_value = value;
    m.param_type = 9;
    m.param_count = 1;
    m.param_index = 0xFFFF;  // ArduPilot's answer to a request by name
    return m;
}

std::vector<ParamRequestRead> asked_by(Wire& wire, int ticks)
{
    std::vector<ParamRequestRead> all;
    for (int i = 0; i < ticks; ++i) {
        wire.wait(0.02F);
        wire.endpoint.service(wire.now);
        const auto some = wire.said_of<ParamRequestRead>();
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

TEST(MavlinkEndpointLimits, TheAutopilotOfAMultirotorIsAskedByName)
{
    Wire wire;
    wire.endpoint.ask_for_rates(true);
    EXPECT_TRUE(asked_by(wire, 100).empty()) << "nobody there";
    wire.hear(heartbeat());
    const std::vector<ParamRequestRead> asked = asked_by(wire, 30);
    ASSERT_EQ(asked.size(), 2U);
    EXPECT_EQ(text_of_id(asked[0].param_id), "WPNAV_ACCEL");
    EXPECT_EQ(asked[0].param_index, -1);
    EXPECT_EQ(asked[0].target_system, kSystem);
    EXPECT_EQ(asked[0].target_component, kAutopilot);
    wire.endpoint.ask_for_rates(false);
    EXPECT_TRUE(asked_by(wire, 100).empty());
}

TEST(MavlinkEndpointLimits, NoPlaneAndNobodyUnknownIsAsked)
{
    for (const Heartbeat& of : {heartbeat(10, true, 3, 1), heartbeat(0, true, 0, 2), heartbeat(0, true, 3, 10)}) {
        Wire wire;
        wire.endpoint.ask_for_rates(true);
        wire.hear(of);
        EXPECT_TRUE(asked_by(wire, 200).empty()) << static_cast<int>(of.type);
    }
}

TEST(MavlinkEndpointLimits, AnAnswerCountsFromTheAutopilotAloneAndAsAFloat)
{
    Wire wire;
    wire.hear(heartbeat());
    wire.hear(value_of("WPNAV_ACCEL", 250.0F), kSystem, 190);
    wire.hear(value_of("WPNAV_ACCEL", 250.0F), kSystem + 1, kAutopilot);
    ParamValue integer = value_of("WPNAV_ACCEL", 250.0F);
    integer.param_type = 6;
    wire.hear(integer);
    EXPECT_FALSE(wire.inbox.has_limits);
    wire.hear(value_of("WPNAV_ACCEL", -250.0F));
    EXPECT_FALSE(wire.inbox.has_limits);
    EXPECT_EQ(wire.diagnostics().out_of_range, 1U);
    const std::uint32_t ignored = wire.diagnostics().frames_ignored;
    wire.hear(value_of("INS_GYR_ID", 1.0F));
    EXPECT_EQ(wire.diagnostics().frames_ignored, ignored + 1);
    wire.hear(value_of("WPNAV_ACCEL", 250.0F));
    EXPECT_TRUE(wire.inbox.has_limits);
    EXPECT_EQ(wire.inbox.limits.acceleration, 2.5F);
    wire.inbox.clear();
    wire.hear(value_of("WPNAV_ACCEL", 250.0F));
    EXPECT_FALSE(wire.inbox.has_limits) << "nothing new";
    wire.hear(value_of("WPNAV_ACCEL_Z", 100.0F));
    EXPECT_EQ(wire.inbox.limits.acceleration, 2.5F) << "all that is known, each time";
    EXPECT_EQ(wire.inbox.limits.vertical_acceleration, 1.0F);
}

}  // namespace
}  // namespace jink::link::mavlink
