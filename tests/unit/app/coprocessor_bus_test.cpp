// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor with a DroneCAN bus beside its link: where own state comes from, traffic from the bus, output to it, and
// its loss.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

const Vec3 kNorthwards(0.0F, 5.0F, 0.0F);

TEST(CoprocessorBus, OnCanAloneItAdvisesAndSteersNobody)
{
    const auto b = bus_bench({{Param::tell_near, 1.0F}}, true);
    b->f.heartbeats = b->f.own_state = false;
    Vec3 own(0.0F, 0.0F, 50.0F);
    Vec3 other(0.0F, 60.0F, 50.0F);
    bool conflict = false;
    for (int i = 0; i < 250; ++i) {
        own += kNorthwards * 0.02F;
        other -= kNorthwards * 0.02F;
        if (i % 5 == 0) {
            b->give(BusBench::fix(own, kNorthwards));
            b->give(BusBench::attitude(0.0F));
            b->give(BusBench::traffic(other, -kNorthwards), 21);
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
    const auto b = bus_bench({}, true);  // the floor is on by default, 2 m above home
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
    const auto b = bus_bench();
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
        const auto b = bus_bench();
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
    const auto b = bus_bench();
    const auto fixes = [&](int n) {
        StepReport report;
        for (int i = 0; i < n; ++i) {
            b->give(BusBench::fix(b->f.position + Vec3(3.0F, 0.0F, 0.0F), kNorthwards));
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
    const auto b = bus_bench({}, true);
    b->f.heartbeats = b->f.own_state = false;
    b->give(BusBench::fix({0.0F, 0.0F, 50.0F}));
    EXPECT_EQ(b->fly(20).own_source, OwnSource::bus);
    EXPECT_EQ(b->fly(10).own_source, OwnSource::none);
}

TEST(CoprocessorBus, NothingIsSteeredByTheBussOwnState)
{
    const auto b = bus_bench();
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

TEST(CoprocessorBus, PlacesThatCannotBothBeRightAreSaid)
{
    const auto b = bus_bench();
    b->fly(60);
    for (int i = 0; i < 20; ++i) {
        b->give(BusBench::fix(b->f.position + Vec3(60.0F, 0.0F, 0.0F), kNorthwards));
        b->tick();
    }
    EXPECT_EQ(b->f.coprocessor.diagnostics().places_disagree, 1U) << "once";
    EXPECT_TRUE(b->heard.said("differ on own place"));
    EXPECT_NEAR(b->f.coprocessor.own().position.x(), b->f.position.x(), 0.2F);
}

TEST(CoprocessorBus, ALostBusIsAFault)
{
    const auto b = bus_bench();
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
    const auto b = bus_bench();
    b->wire.port(1).become(hal::CanState::down);
    const StepReport report = b->fly(100);
    EXPECT_EQ(report.faults, bit(Fault::bus_lost));
    EXPECT_EQ(report.state, link::SystemState::boot);
}

TEST(CoprocessorBus, WhatIsNearIsReportedOnlyWhenAskedForAndPlaced)
{
    for (const bool on : {false, true}) {
        for (const bool heading : {false, true}) {
            const auto b =
                bus_bench({{Param::tell_near, on ? 1.0F : 0.0F}, {Param::mode, 1.0F}, {Param::track_sigma_p, 0.5F}});
            b->fly(60);
            for (int i = 0; i < 100; ++i) {
                if (heading) {
                    b->f.feed(wire::attitude(b->f.boot_ms(), 0.0F));  // nose east, flying north
                }
                if (i % 10 == 0) {
                    b->give(BusBench::traffic(b->f.position + Vec3(0.0F, 30.0F, 0.0F), kNorthwards), 21);
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
