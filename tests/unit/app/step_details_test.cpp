// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step, sentence by sentence of its contract: lines, frames, closed areas, requests and bench settings.
#include <gtest/gtest.h>

#include "firmware/app/method_orders.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/app/reach_sets.hpp"
#include "tests/unit/app/step_flight.hpp"
#include "tests/unit/app/telling_bench.hpp"

namespace jink::app::test {
namespace {

const Vec3 kMastInTheWay(0.4F, 60.0F, 50.0F);

TEST(StepDetails, NothingIsAskedForOnALostLine)
{
    StepFlight f;
    f.mast = kMastInTheWay;
    ASSERT_TRUE(f.until(StepFlight::ours));
    f.tick();
    f.port.state = hal::PortState::lost;
    for (int i = 0; i < 20; ++i) {
        f.tick();
    }
    EXPECT_EQ(f.asked_for("hold"), 0) << "it would wait for the line";
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().hold_requests, 0U);
    EXPECT_EQ(f.coprocessor.takeover_diagnostics().lost_by_fault, 1U);
}

TEST(StepDetails, ALineThatIsLostWithoutATakeOverIsNotSaidToHaveCostOne)
{
    StepBench b;
    b.fly(60);
    b.port.state = hal::PortState::lost;
    b.fly(10);
    b.port.state = hal::PortState::open;
    b.fly(60);
    EXPECT_EQ(b.said("jink: line lost while avoiding, control dropped"), 0);
}

/// Copters of ArduPilot refuse a mode for good: asked again at once, not after the time for a confirmation.
TEST(StepDetails, ADenialIsAnsweredByAnotherRequestAtOnceAndAnAcceptanceIsNot)
{
    for (const bool accepted : {false, true}) {
        StepFlight f;
        f.mast = kMastInTheWay;
        f.obeys = false;
        ASSERT_TRUE(f.until([&](const StepReport&) { return f.asked_for("external") == 1; }));
        f.wire.in.mode_answers.unchecked_push_back({accepted, 1});
        for (int i = 0; i < 25; ++i) {
            f.tick();
        }
        EXPECT_EQ(f.asked_for("external"), accepted ? 1 : 2) << "within half a second";
    }
}

TEST(StepDetails, ARequestThatWaitsForTheLineIsTakenBackWhenAnAnswerIsNotToBeHadAnyMore)
{
    StepFlight f;
    f.mast = kMastInTheWay;
    f.obeys = false;
    ASSERT_TRUE(f.until([&](const StepReport&) { return f.asked_for("external") == 1; }));
    const int dropped = f.wire.requests_dropped;
    for (int i = 0; i < 12; ++i) {
        f.tick();
    }
    EXPECT_EQ(f.wire.requests_dropped, dropped);
    f.coming_us = 10'000;
    f.hear_own();
    f.step(10'000);
    EXPECT_EQ(f.wire.requests_dropped, dropped + 1) << "kAnswer to the microsecond";
}

TEST(StepDetails, EveryRequestedHeartbeatIsSentWhateverElseIsAskedInTheStep)
{
    StepBench b;
    b.fly(10);
    const std::size_t beats = b.wire.heartbeats.size();
    for (const float message : {0.0F, 7.0F}) {
        b.wire.in.commands.unchecked_push_back({});
        b.wire.in.commands.back().command = 512;
        b.wire.in.commands.back().params[0] = message;
    }
    b.fly(1);
    EXPECT_EQ(b.wire.heartbeats.size(), beats + 1);
}

TEST(StepDetails, TrafficStampedInTheFutureIsRefused)
{
    StepBench b;
    link::TrackReport& r = b.hear_track(1, Vec3(100.0F, 0.0F, 50.0F));
    r.stamp = r.stamp + 5.0F;
    b.fly(1);
    EXPECT_EQ(b.last.tracks, 0U);
    EXPECT_EQ(b.counted().tracks_in, 1U);
}

link::ConstraintPart closed_part(std::uint8_t set, std::uint8_t index, std::uint8_t count, float north)
{
    link::ConstraintPart part;
    part.constraint.cylinder.circle = {{0.0F, north}, 5.0F};
    part.constraint.cylinder.bottom = 0.0F;
    part.constraint.cylinder.top = 100.0F;
    part.set = set;
    part.index = index;
    part.count = count;
    part.from_system = part.from_component = 9;
    return part;
}

TEST(StepDetails, AnIncompleteSetOfClosedAreasOpensNothing)
{
    StepBench b({{Param::mode, 1.0F}, {Param::k_sigma, 0.0F}, {Param::lookahead, 20.0F}});
    b.fly(1);
    b.wire.in.constraints.unchecked_push_back(closed_part(1, 0, 1, 45.0F));
    b.fly(1);
    ASSERT_TRUE(b.last.guidance.conflict.has_value());
    b.wire.in.constraints.unchecked_push_back(closed_part(2, 0, 2, -500.0F));
    b.fly(1);
    EXPECT_EQ(b.wire.constraints.back(), link::ConstraintResult::kept);
    EXPECT_EQ(b.last.cylinders, 1U);
    EXPECT_TRUE(b.last.guidance.conflict.has_value()) << "the area that is in force";
    const std::uint32_t reported = b.coprocessor.constraint_diagnostics().reported;
    b.wire.in.constraints.unchecked_push_back(closed_part(2, 1, 2, -600.0F));
    b.fly(1);
    EXPECT_EQ(b.last.cylinders, 2U);
    EXPECT_FALSE(b.last.guidance.conflict.has_value());
    EXPECT_EQ(b.coprocessor.constraint_diagnostics().reported, reported + 2);
    link::ConstraintPart wrong = closed_part(3, 0, 1, 0.0F);
    wrong.constraint.cylinder.circle.radius = -1.0F;
    b.wire.in.constraints.unchecked_push_back(wrong);
    b.fly(1);
    EXPECT_EQ(b.coprocessor.constraint_diagnostics().reported, reported + 2) << "nothing new";
}

TEST(StepDetails, WithoutAnAutopilotThereIsNoCeilingAndNoHomeToKeepNearTo)
{
    for (const float bounds : {0.0F, 2.0F, 4.0F}) {
        StepBench b({{Param::methods, 4.0F},
                     {Param::k_sigma, 0.0F},
                     {Param::bounds, bounds},
                     {Param::ceiling, 51.1F},
                     {Param::keep_in, 10.0F}});
        b.hear_own();
        b.step();
        b.hear_own();
        b.hear_mast(1, b.position + Vec3(0.0F, 15.0F, -0.6F));
        b.step();
        ASSERT_TRUE(b.last.guidance.conflict.has_value());
        EXPECT_TRUE(b.last.guidance.wants_control);
        EXPECT_GT(b.last.guidance.velocity.z(), 0.4F) << bounds;
    }
}

TEST(StepDetails, AHeartbeatIsNoReasonToPlaceTheBusAnew)
{
    StepBench b({}, StepBench::Bus::there);
    b.fly(2);
    ASSERT_EQ(b.bus.origins.size(), 1U);
    b.bus.tracks.push_back(b.track_report(1, Vec3(0.0F, 80.0F, 50.0F)));
    b.hear_autopilot();
    b.hear_own();
    b.step();
    EXPECT_EQ(b.last.tracks, 1U);
    EXPECT_EQ(b.bus.origins.size(), 1U);
    b.hear_autopilot().rebooted = true;
    b.step();
    EXPECT_EQ(b.bus.origins.size(), 2U);
    b.bus.tracks.push_back(b.track_report(1, Vec3(0.0F, 80.0F, 50.0F)));
    b.hear_own();
    b.step();
    EXPECT_EQ(b.last.tracks, 1U) << "the restart is over";
    EXPECT_EQ(b.bus.origins.size(), 2U);
}

TEST(StepDetails, AdvisingAloneIsSaidOnceAndNeverBesideAnAutopilot)
{
    StepBench b({}, StepBench::Bus::there);
    for (int i = 0; i < 4; ++i) {
        b.hear_bus_own();
        b.step();
        EXPECT_TRUE(b.bus.statuses.back().advising_only);
        EXPECT_EQ(b.said("jink: no autopilot heard, advising only"), 1) << i;
    }
    b.hear_autopilot();
    b.hear_bus_own();
    b.step();
    b.hear_bus_own();
    b.step();
    ASSERT_EQ(b.last.own_source, OwnSource::bus);
    EXPECT_FALSE(b.bus.statuses.back().advising_only);
}

TEST(StepDetails, NothingNearIsReportedFromAPlaceThatIsOld)
{
    StepBench b({{Param::tell_near, 1.0F}, {Param::own_age, 0.1F}}, StepBench::Bus::there);
    b.fly(1);
    b.step(250'000);
    b.hear_mast(1, b.position + Vec3(20.0F, 0.0F, 0.0F));
    b.step(250'000);
    ASSERT_EQ(b.last.own_source, OwnSource::none);
    EXPECT_TRUE(b.bus.near.empty());
}

/// For studies on a bench: settings that no parameter reaches stay until a parameter changes.
TEST(StepDetails, SettingsOfABenchStayUntilTheNextChangeOfAParameter)
{
    StepBench b;
    for (int round = 0; round < 2; ++round) {
        geometric::Settings settings = b.coprocessor.planner().settings();
        settings.flip_penalty = 0.9F;
        ASSERT_TRUE(b.coprocessor.planner().configure(settings));
        b.fly(2);
        EXPECT_EQ(b.coprocessor.planner().settings().flip_penalty, 0.9F) << round;
        b.wire.in.params.unchecked_push_back({});
        link::ParamRequest& r = b.wire.in.params.back();
        r.kind = link::ParamRequestKind::set;
        const std::string_view name = "TRK_AGE";
        std::copy(name.begin(), name.end(), r.name.begin());
        r.value = 4.0F + static_cast<float>(round);
        r.value_finite = true;
        b.fly(1);
        EXPECT_EQ(b.coprocessor.planner().settings().flip_penalty, Configuration{}.planner.flip_penalty) << round;
    }
}

/// Until the autopilot follows, the stream repeats the present motion at its own rate, also in gusts.
TEST(StepDetails, AProvingStreamKeepsItsRateInGusts)
{
    StepBench b({{Param::standby, 1.0F}});
    int sent = 0;
    for (int i = 0; i < 100; ++i) {
        b.velocity = Vec3(i % 2 == 0 ? 2.0F : -2.0F, 5.0F, 0.0F);
        if (i % 25 == 0) {
            b.hear_autopilot().stack = link::AutopilotStack::px4;
        }
        b.hear_own();
        sent += b.step().setpoint_sent ? 1 : 0;
    }
    EXPECT_GE(sent, 9);
    EXPECT_LE(sent, 11) << "2 s at 5 Hz";
}

/// The cloud used by reach sets: where directions are hidden, they find no trajectory.
TEST(StepDetails, ReachSetsPlanByThePictureTheyAreGiven)
{
    struct Sink final : link::CloudSink {
        void begin_scan(const link::CloudScan& /*scan*/) noexcept override {}
        void add(link::Ray /*ray*/, const Vec3& /*point*/) noexcept override {}
        void end_scan(std::uint32_t /*points_lost*/) noexcept override {}
    };
    struct NoClouds final : Clouds {
        void give_to(world::ObstacleTable& /*table*/) noexcept override {}
        link::CloudSink& link_points() noexcept override { return sink; }
        void forward_to(link::CloudSink& /*to*/) noexcept override {}
        void serve(TimePoint /*now*/, const CloudView& /*view*/) noexcept override {}
        Sink sink;
    };
    for (const bool blind : {false, true}) {
        NoClouds clouds;
        const auto picture = std::make_unique<ReachPicture>(reach_sets());
        const auto t = teller({{Param::methods, 2.0F}, {Param::mode, 1.0F}});
        t->coprocessor.use_clouds(clouds);
        t->coprocessor.let_reach_sets_see(*picture);
        t->fly(60);
        t->put_ahead(40.0F, Vec3::Zero(), Vec3(0.0F, 0.4F, 0.0F));
        bool found = false;
        for (int i = 0; i < 200; ++i) {
            if (blind) {
                link::CloudScan scan;
                scan.stamp = t->now;
                scan.ray_pitch_level = scan.ray_pitch_vertical = 0.02F;
                scan.max_range = 50.0F;
                picture->begin_scan(scan);
                picture->end_scan(0);
            }
            t->step();
            const world::Manoeuvre* flying = t->coprocessor.flying();
            found = found || (flying != nullptr && flying->by == kReach);
        }
        EXPECT_EQ(found, !blind);
    }
}

}  // namespace
}  // namespace jink::app::test
