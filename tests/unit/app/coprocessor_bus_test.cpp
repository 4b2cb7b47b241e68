// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor with a DroneCAN bus beside its link: where own state comes from, the frame of placed objects, output to
// the bus, parameters. The sent Proximity shows where an object was placed.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

const Vec3 kNorth(0.0F, 5.0F, 0.0F);

bool has(const StepReport& report, Fault fault) { return (report.faults & bit(fault)) != 0; }

std::unique_ptr<BusBench> bench(std::initializer_list<std::pair<Param, float>> changes = {}, bool tunnel = false)
{
    return std::make_unique<BusBench>(with(changes), tunnel);
}

/// The only object reported by Proximity, level distance north and east of the vehicle; nothing: none, or several.
std::optional<float> only_distance(BusBench& b, int ticks = 12)
{
    b.heard.near.clear();
    b.fly(ticks);
    const bool same =
        !b.heard.near.empty() && std::all_of(b.heard.near.begin(), b.heard.near.end(), [&](const auto& m) {
            return std::abs(m.distance - b.heard.near.front().distance) < 2.0F;
        });
    return same ? std::optional(b.heard.near.back().distance) : std::nullopt;
}

TEST(CoprocessorBus, OnCanAloneItAdvisesAndSteersNobody)
{
    const auto b = bench({{Param::tell_near, 1.0F}}, true);
    b->f.heartbeats = b->f.own_state = false;
    Vec3 own(0.0F, 0.0F, 50.0F);
    Vec3 other(0.0F, 60.0F, 50.0F);
    bool conflict = false;
    for (int i = 0; i < 250; ++i) {
        own += kNorth * 0.02F;
        other -= kNorth * 0.02F;
        if (i % 5 == 0) {
            b->give(BusBench::fix(own, kNorth));
            b->give(BusBench::attitude(0.0F));
            b->give(BusBench::traffic(other, -kNorth), 21);
        }
        const StepReport report = b->tick();
        ASSERT_TRUE(has(report, Fault::no_autopilot));
        ASSERT_EQ(report.control, Control::autopilot);
        ASSERT_FALSE(report.setpoint_sent);
        ASSERT_EQ(report.state, link::SystemState::boot);
        conflict = conflict || report.guidance.conflict.has_value();
    }
    EXPECT_TRUE(conflict);
    EXPECT_TRUE(b->heard.said("no autopilot heard, advising only"));
    EXPECT_TRUE(b->heard.said("conflict, traffic in"));
    EXPECT_EQ(b->heard.statuses.back().health, can::Health::warning);
    EXPECT_EQ(b->heard.statuses.back().mode, can::Mode::operational);
    EXPECT_EQ(b->heard.statuses.back().vendor_status, bit(Fault::no_autopilot) | bit(Fault::own_state_missing));
    ASSERT_FALSE(b->heard.near.empty());
    EXPECT_NEAR(b->heard.near.back().yaw, 0.0F, 1.0F) << "ahead";
    EXPECT_TRUE(b->heard.tunnelled.empty());
    EXPECT_EQ(b->f.coprocessor.takeover_diagnostics().requests, 0U);
}

TEST(CoprocessorBus, WithoutAHomeThereAreNoBounds)
{
    const auto b = bench({}, true);  // the floor is on by default, 2 m above home
    b->f.heartbeats = b->f.own_state = false;
    b->give(BusBench::fix({0.0F, 0.0F, 50.0F}));
    b->fly(1);
    for (int i = 0; i < 50; ++i) {  // 30 m below the first fix
        if (i % 5 == 0) {
            b->give(BusBench::fix({0.0F, 0.0F, 20.0F}, {0.0F, 0.0F, -3.0F}));
        }
        const StepReport report = b->tick();
        ASSERT_EQ(report.own_source, OwnSource::bus);
        ASSERT_FALSE(report.guidance.conflict.has_value());
    }
}

TEST(CoprocessorBus, TrafficFromTheBusIsAvoidedOverTheSerialLine)
{
    const auto b = bench();
    b->fly(60);
    const Vec3 where = b->f.position + Vec3(0.0F, 45.0F, 0.0F);
    bool ours = false;
    for (int i = 0; i < 400 && !ours; ++i) {
        if (i % 10 == 0) {
            can::TrafficReport m = BusBench::traffic(where);
            m.traffic_type = can::TrafficReport::kPointObstacle;
            b->give(m, 21);
        }
        const StepReport report = b->tick();
        ASSERT_EQ(report.faults, 0U);
        ours = report.control == Control::ours;
    }
    EXPECT_TRUE(ours);
    b->fly(3);  // a frame takes its time
    EXPECT_TRUE(b->heard.said("has control")) << "what is said to the autopilot is said to the bus";
}

/// Ahead at our height, reported 48 m higher: above the ellipsoid.
TEST(CoprocessorBus, TrafficFromTheBusAboveTheEllipsoidIsInConflictOnceTheLinkKnowsTheUndulation)
{
    for (const bool known : {false, true}) {
        const auto b = bench();
        b->fly(60);
        if (known) {
            GpsRawInt gps;
            gps.alt = 538'000;
            gps.alt_ellipsoid = 586'000;
            gps.fix_type = 3;
            b->f.feed(gps);
        }
        const Vec3 reported = b->f.position + Vec3(0.0F, 45.0F, 48.0F);
        bool conflict = false;
        for (int i = 0; i < 100; ++i) {
            if (i % 10 == 0) {
                can::TrafficReport m = BusBench::traffic(reported);
                m.traffic_type = can::TrafficReport::kPointObstacle;
                m.altitude_type = can::TrafficReport::kGeometricAltitude;
                b->give(m, 21);
            }
            const StepReport report = b->tick();
            conflict = conflict || report.guidance.conflict.has_value();
            ASSERT_EQ(report.uncertain_heights, known && report.tracks > 0 ? 1U : 0U);
        }
        EXPECT_EQ(conflict, known);
    }
}

TEST(CoprocessorBus, TheAutopilotsOwnStateWinsWhileItIsFresh)
{
    const auto b = bench();
    const auto fixes = [&](int n) {
        StepReport report;
        for (int i = 0; i < n; ++i) {
            b->give(BusBench::fix(b->f.position + Vec3(3.0F, 0.0F, 0.0F), kNorth));
            report = b->tick();
        }
        return report;
    };
    b->fly(60);
    StepReport report = fixes(50);
    EXPECT_EQ(report.own_source, OwnSource::autopilot);
    EXPECT_EQ(report.faults, 0U);
    EXPECT_NEAR(b->f.coprocessor.own().position.x(), b->f.position.x(), 0.2F);
    EXPECT_GE(b->f.coprocessor.diagnostics().bus_states_beside, 49U);
    EXPECT_EQ(b->f.coprocessor.diagnostics().bus_states, 0U);

    b->f.own_state = false;  // OWN_AGE is 0.5 s
    report = fixes(24);
    EXPECT_EQ(report.own_source, OwnSource::autopilot);
    report = fixes(5);
    EXPECT_EQ(report.own_source, OwnSource::bus) << "the watch goes on";
    EXPECT_TRUE(has(report, Fault::own_state_stale)) << "but nothing is steered by it";
    EXPECT_EQ(report.state, link::SystemState::critical);
    EXPECT_NEAR(b->f.coprocessor.own().position.x(), b->f.position.x() + 3.0F, 0.2F);

    b->f.own_state = true;
    report = fixes(1);
    EXPECT_EQ(report.own_source, OwnSource::autopilot);
    EXPECT_EQ(report.faults, 0U);
    report = fixes(100);
    EXPECT_EQ(b->f.coprocessor.diagnostics().places_disagree, 0U) << "3 m is what receivers differ by";
}

TEST(CoprocessorBus, OldOwnStateOfTheBusIsNoOwnState)
{
    const auto b = bench({}, true);
    b->f.heartbeats = b->f.own_state = false;
    b->give(BusBench::fix({0.0F, 0.0F, 50.0F}));
    EXPECT_EQ(b->fly(20).own_source, OwnSource::bus);
    EXPECT_EQ(b->fly(10).own_source, OwnSource::none);
}

TEST(CoprocessorBus, NothingIsSteeredByTheBussOwnState)
{
    const auto b = bench();
    b->f.obstacles = {{0.0F, 60.0F, 50.0F}};
    ASSERT_TRUE(b->f.until([](const StepReport& r) { return r.control == Control::ours; }));
    b->clock.advance(b->f.now.us - b->clock.now_us());
    b->f.own_state = false;
    int steered = 0;
    for (int i = 0; i < 200; ++i) {
        b->give(BusBench::fix(b->f.position, b->f.velocity));
        const StepReport report = b->tick();
        steered += i > 26 && (report.setpoint_sent || report.control == Control::ours) ? 1 : 0;
    }
    EXPECT_EQ(steered, 0);
    EXPECT_GT(b->f.coprocessor.diagnostics().bus_states, 100U);
}

TEST(CoprocessorBus, ThereIsOneFrameAndItIsTheAutopilots)
{
    const auto b = bench({{Param::tell_near, 1.0F}, {Param::track_sigma_p, 0.5F}});
    // Until the first HEARTBEAT: about the first fix, 300 m from the autopilot's origin.
    b->f.heartbeats = b->f.own_state = false;
    const Vec3 start(300.0F, 0.0F, 50.0F);
    const auto traffic_ahead = [&] { b->give(BusBench::traffic(start + Vec3(0.0F, 20.0F, 0.0F)), 21); };
    b->give(BusBench::attitude(0.0F));
    b->give(BusBench::fix(start));
    b->tick();
    traffic_ahead();
    ASSERT_TRUE(only_distance(*b));
    EXPECT_NEAR(b->heard.near.back().distance, 20.0F - 1.0F - 1.5F, 0.5F) << "radius and three sigmas off";

    // An autopilot appears with an unknown origin: earlier reports are void, and nothing is placed.
    b->f.position = start;
    b->f.velocity = Vec3::Zero();
    b->f.mode = wire::kCopterLoiter;
    const std::uint32_t refused = b->bus.endpoint().diagnostics().no_origin;
    b->f.feed(wire::heartbeat(wire::kCopterLoiter, true, 3));
    b->give(BusBench::fix(start));
    traffic_ahead();
    StepReport report = b->tick();
    EXPECT_EQ(report.tracks, 0U) << "placed before the HEARTBEAT of the same step";
    EXPECT_EQ(report.own_source, OwnSource::none);
    EXPECT_EQ(b->f.coprocessor.diagnostics().bus_reports_dropped, 2U);
    EXPECT_EQ(b->f.coprocessor.diagnostics().frame_changes, 1U);
    b->give(BusBench::fix(start));
    traffic_ahead();
    b->f.feed(wire::local_position(b->f.boot_ms(), start, Vec3::Zero()));
    report = b->tick();
    EXPECT_EQ(report.tracks, 0U);
    EXPECT_EQ(b->bus.endpoint().diagnostics().no_origin, refused + 2);

    // The origin comes, and with it the places.
    b->f.feed(wire::origin());
    b->tick();
    b->heard.near.clear();
    for (int i = 0; i < 12; ++i) {
        b->give(BusBench::attitude(0.0F));
        b->f.feed(wire::attitude(b->f.boot_ms(), 0.0F));
        b->f.feed(wire::local_position(b->f.boot_ms(), start, Vec3::Zero()));
        traffic_ahead();
        report = b->tick();
    }
    EXPECT_EQ(report.own_source, OwnSource::autopilot);
    EXPECT_EQ(report.tracks, 1U);
    ASSERT_FALSE(b->heard.near.empty());
    EXPECT_NEAR(b->heard.near.back().distance, 20.0F - 1.0F - 1.0F, 1.0F);
    EXPECT_EQ(b->f.coprocessor.diagnostics().frame_changes, 1U);
}

TEST(CoprocessorBus, AnotherOriginIsTakenOverWithinTheStep)
{
    const auto b = bench();
    b->fly(60);
    ASSERT_EQ(b->fly(1).tracks, 0U);
    GpsGlobalOrigin moved;
    moved.latitude = kFlightOrigin.lat + 100'000;  // 1113 m north
    moved.longitude = kFlightOrigin.lon;
    moved.altitude = kFlightOrigin.alt;
    b->f.feed(moved);
    b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 30.0F, 0.0F)), 21);
    EXPECT_EQ(b->tick().tracks, 0U) << "placed by the old one";
    EXPECT_EQ(b->f.coprocessor.diagnostics().bus_reports_dropped, 1U);
    b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 30.0F, 0.0F)), 21);
    const StepReport report = b->tick();
    EXPECT_EQ(report.tracks, 1U);
    EXPECT_FALSE(report.guidance.conflict.has_value()) << "a kilometre behind, by the new one";
}

TEST(CoprocessorBus, ARestartOfTheAutopilotForgetsItsOrigin)
{
    const auto b = bench();
    b->fly(60);
    b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 100.0F, 0.0F)), 21);
    ASSERT_EQ(b->fly(2).tracks, 1U);
    b->f.boot_us = 1'000'000;
    b->f.ticks = 1;  // the next heartbeat and origin are a second away
    StepReport report;
    int placed = 0;
    const std::uint32_t refused = b->bus.endpoint().diagnostics().no_origin;
    for (int i = 0; i < 48; ++i) {
        if (i > 5) {  // its clock has gone back
            EXPECT_FALSE(b->f.endpoint.has_origin());
            b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 100.0F, 0.0F), Vec3::Zero(), 77), 21);
        }
        report = b->tick();
        placed += report.tracks > 1 ? 1 : 0;
    }
    EXPECT_EQ(placed, 0);
    EXPECT_GT(b->bus.endpoint().diagnostics().no_origin, refused + 20);
}

TEST(CoprocessorBus, PlacesThatCannotBothBeRightAreSaid)
{
    const auto b = bench();
    b->fly(60);
    for (int i = 0; i < 20; ++i) {
        b->give(BusBench::fix(b->f.position + Vec3(60.0F, 0.0F, 0.0F), kNorth));
        b->tick();
    }
    EXPECT_EQ(b->f.coprocessor.diagnostics().places_disagree, 1U) << "once";
    EXPECT_TRUE(b->heard.said("differ on own place"));
    EXPECT_NEAR(b->f.coprocessor.own().position.x(), b->f.position.x(), 0.2F);
}

TEST(CoprocessorBus, ALostBusIsAFault)
{
    const auto b = bench();
    b->f.obstacles = {{0.0F, 60.0F, 50.0F}};
    ASSERT_TRUE(b->f.until([](const StepReport& r) { return r.control == Control::ours; }));
    b->clock.advance(b->f.now.us - b->clock.now_us());
    b->wire.port(1).become(hal::CanState::down);
    StepReport report = b->tick();
    EXPECT_EQ(report.faults, bit(Fault::bus_lost));
    EXPECT_EQ(report.state, link::SystemState::critical);
    EXPECT_FALSE(report.setpoint_sent);
    EXPECT_NE(report.control, Control::ours);
    b->wire.port(1).become(hal::CanState::active);
    report = b->tick();
    EXPECT_EQ(report.faults, 0U);
}

TEST(CoprocessorBus, ABusThatWasNeverThereIsWaitedFor)
{
    const auto b = bench();
    b->wire.port(1).become(hal::CanState::down);
    const StepReport report = b->fly(100);
    EXPECT_EQ(report.faults, bit(Fault::bus_lost));
    EXPECT_EQ(report.state, link::SystemState::boot);
}

TEST(CoprocessorBus, ParametersAreServed)
{
    const auto b = bench({{Param::mode, 1.0F}, {Param::lookahead, 9.0F}});
    const auto set = [&](std::string_view name, std::int64_t whole, float real, can::ParamValue::Tag tag) {
        can::GetSetRequest m;
        for (const char c : name) {
            m.name.unchecked_push_back(static_cast<std::uint8_t>(c));
        }
        m.value.tag = tag;
        m.value.integer = whole;
        m.value.real = real;
        b->ask(m);
        b->fly(2);
        return b->heard.params.back();
    };
    using Tag = can::ParamValue::Tag;
    const auto& counted = b->f.coprocessor.diagnostics();
    const Parameters& now = b->f.coprocessor.parameters();
    can::GetSetResponse answer = set("JNK_LOOKAHEAD", 0, 12.5F, Tag::real);
    EXPECT_EQ(answer.value.real, 12.5F);
    EXPECT_EQ(answer.initial.real, 9.0F) << "what erase brings";
    EXPECT_EQ(answer.low.real, 1.0F);
    EXPECT_EQ(answer.high.real, 60.0F);
    EXPECT_EQ(now.get(Param::lookahead), 12.5F);
    EXPECT_EQ(now.configuration().rules.lookahead, 12.5F);
    EXPECT_EQ(b->f.coprocessor.parameters().configuration().rules.lookahead, 12.5F) << "taken over in the step";
    EXPECT_EQ(counted.params_set, 1U);
    answer = set("JNK_LOOKAHEAD", 0, 61.0F, Tag::real);
    EXPECT_EQ(answer.value.real, 12.5F);
    EXPECT_EQ(counted.params_refused, 1U);
    answer = set("JNK_MODE", 0, 0.0F, Tag::integer);
    EXPECT_EQ(answer.value.integer, 0);
    EXPECT_EQ(counted.params_set, 2U);
    answer = set("NO_SUCH_NAME", 0, 0.0F, Tag::integer);
    EXPECT_TRUE(answer.name.empty());
    can::GetSetRequest by_index;
    by_index.index = kParamCount;
    b->ask(by_index);
    b->fly(2);
    EXPECT_TRUE(b->heard.params.back().name.empty());
    for (std::uint16_t i = 0; i < kParamCount; ++i) {
        by_index.index = i;
        b->ask(by_index);
        b->fly(2);
        const can::GetSetResponse& m = b->heard.params.back();
        ASSERT_EQ(std::string(m.name.begin(), m.name.end()), param_table()[i].name);
        ASSERT_EQ(m.value.tag, param_table()[i].integer ? Tag::integer : Tag::real);
    }
    can::ExecuteOpcodeRequest opcode;
    opcode.opcode = can::ExecuteOpcodeRequest::kSave;
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "there is nowhere to save to";
    b->f.coprocessor.note_stored(now.generation());
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    static_cast<void>(set("JNK_LOOKAHEAD", 0, 13.0F, Tag::real));
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "a change since then is not stored yet";
    b->f.coprocessor.note_stored(now.generation());
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    opcode.opcode = can::ExecuteOpcodeRequest::kErase;
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    EXPECT_EQ(now.get(Param::mode), 1.0F) << "not the table's 2: nobody asked for more than advice";
    EXPECT_EQ(now.get(Param::lookahead), 9.0F);
    opcode.opcode = can::ExecuteOpcodeRequest::kSave;
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "a restart would bring what was erased";
}

TEST(CoprocessorBus, EraseBringsBackTheInitialValuesNotThoseThatWereStored)
{
    const auto b = bench({{Param::lookahead, 9.0F}});
    ParamValues stored = b->f.coprocessor.initial_parameters();
    stored[static_cast<std::size_t>(Param::lookahead)] = 12.0F;
    EXPECT_EQ(b->f.coprocessor.restore_parameters(stored), 0U);
    EXPECT_EQ(b->f.coprocessor.parameters().get(Param::lookahead), 12.0F);
    EXPECT_EQ(b->f.coprocessor.parameters().configuration().rules.lookahead, 12.0F) << "before the first step";
    can::GetSetRequest ask;
    ask.index = static_cast<std::uint16_t>(Param::lookahead);
    b->ask(ask);
    b->fly(2);
    EXPECT_EQ(b->heard.params.back().value.real, 12.0F);
    EXPECT_EQ(b->heard.params.back().initial.real, 9.0F);
    can::ExecuteOpcodeRequest opcode;
    opcode.opcode = can::ExecuteOpcodeRequest::kErase;
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    EXPECT_EQ(b->f.coprocessor.parameters().get(Param::lookahead), 9.0F);
}

TEST(CoprocessorBus, WhatIsNearIsReportedOnlyWhenAskedForAndPlaced)
{
    for (const bool on : {false, true}) {
        for (const bool heading : {false, true}) {
            const auto b =
                bench({{Param::tell_near, on ? 1.0F : 0.0F}, {Param::mode, 1.0F}, {Param::track_sigma_p, 0.5F}});
            b->fly(60);
            for (int i = 0; i < 100; ++i) {
                if (heading) {
                    b->f.feed(wire::attitude(b->f.boot_ms(), 0.0F));  // nose east, flying north
                }
                if (i % 10 == 0) {
                    b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 30.0F, 0.0F), kNorth), 21);
                }
                b->tick();
            }
            EXPECT_EQ(b->heard.near.empty(), !on || !heading);
            for (const can::Proximity& m : b->heard.near) {
                EXPECT_NEAR(m.yaw, -90.0F, 2.0F) << "to the left of the nose";
                EXPECT_NEAR(m.pitch, 0.0F, 1.0F);
                EXPECT_GE(m.distance, 30.0F - 1.0F - 1.6F) << "radius, three sigmas";
                EXPECT_LE(m.distance, 29.0F);
                EXPECT_EQ(m.sensor, 0U);
            }
            if (on && heading) {
                EXPECT_NEAR(static_cast<double>(b->heard.near.size()), 10.0, 2.0) << "five times a second, for 2 s";
            }
        }
    }
}

}  // namespace
}  // namespace jink::app
