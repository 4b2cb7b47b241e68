// SPDX-License-Identifier: BSD-3-Clause
// The frame of objects that the bus reports: whose origin it has, and when reports are void. The sent Proximity shows
// where an object was placed.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

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

TEST(CoprocessorBusFrame, ThereIsOneFrameAndItIsTheAutopilots)
{
    const auto b = bus_bench({{Param::tell_near, 1.0F}, {Param::track_sigma_p, 0.5F}});
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

TEST(CoprocessorBusFrame, AnotherOriginIsTakenOverWithinTheStep)
{
    const auto b = bus_bench();
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

TEST(CoprocessorBusFrame, ARestartOfTheAutopilotForgetsItsOrigin)
{
    const auto b = bus_bench();
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

}  // namespace
}  // namespace jink::app
