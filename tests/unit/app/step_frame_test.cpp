// SPDX-License-Identifier: BSD-3-Clause
// Frames of reference in Coprocessor::step: another origin, the bus's own state beside the autopilot's.
#include <gtest/gtest.h>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

constexpr link::GlobalPosition kBenchOrigin{473977420, 85455940, 488000};

std::unique_ptr<StepBench> bus_bench(std::initializer_list<std::pair<Param, float>> changes = {})
{
    return std::make_unique<StepBench>(changes, StepBench::Bus::there);
}

TEST(StepOrigin, AnotherOneMovesTheTracks)
{
    const auto b = bus_bench();
    b->wire.where = kBenchOrigin;
    b->hear_track(1, Vec3(100.0F, 200.0F, 50.0F)).velocity = Vec3::Zero();
    b->fly(1);
    const Vec3 before = b->coprocessor.tracks(b->now)[0].position;
    EXPECT_EQ(b->counted().origin_changes, 0U) << "the first is no change";
    b->wire.where->lat += 10'000;  // 111.3 m north on our sphere: pi / 180 * 1e-3 * 6378137 m
    b->wire.where->alt -= 5'000;
    b->fly(1);
    ASSERT_EQ(b->coprocessor.tracks(b->now).size(), 1U);
    const Vec3 moved = b->coprocessor.tracks(b->now)[0].position - before;
    EXPECT_NEAR(moved.x(), 0.0F, 0.01F);
    EXPECT_NEAR(moved.y(), -111.319F, 0.01F);
    EXPECT_NEAR(moved.z(), 5.0F, 0.01F);
    EXPECT_EQ(b->counted().origin_changes, 1U);
    b->wire.where.reset();
    b->fly(1);
    b->wire.where = kBenchOrigin;
    b->fly(1);
    EXPECT_EQ(b->counted().origin_changes, 2U) << "against the last one that was known";
    EXPECT_NEAR(b->coprocessor.tracks(b->now)[0].position.y(), before.y(), 0.01F);
    EXPECT_EQ(b->counted().tracks_not_moved, 0U);
}

TEST(StepFrame, FromTheFirstHeartbeatOnItIsTheAutopilots)
{
    const auto b = bus_bench();
    b->hear_bus_own();
    b->bus.tracks.push_back(b->track_report(1, Vec3(0.0F, 80.0F, 50.0F)));
    b->step();
    EXPECT_EQ(b->last.own_source, OwnSource::bus);
    EXPECT_EQ(b->last.tracks, 1U);
    EXPECT_TRUE(b->bus.origins.empty()) << "a frame of the bus's own";

    b->hear_autopilot();
    b->hear_bus_own();
    b->bus.tracks.push_back(b->track_report(1, Vec3(0.0F, 80.0F, 50.0F)));
    b->hear_track(2, Vec3(50.0F, 0.0F, 50.0F));  // of the link, behind it in the inbox
    b->step();
    EXPECT_EQ(b->last.own_source, OwnSource::none) << "placed in a frame that is no more";
    EXPECT_EQ(b->last.tracks, 0U) << "nothing is planned without a place";
    EXPECT_EQ(b->last.work, 0U);
    ASSERT_EQ(b->coprocessor.tracks(b->now).size(), 1U);
    EXPECT_EQ(b->coprocessor.tracks(b->now)[0].id, 2U) << "what the link told stays";
    EXPECT_EQ(b->counted().bus_reports_dropped, 2U);
    EXPECT_EQ(b->counted().frame_changes, 1U);
    EXPECT_EQ(b->counted().bus_states, 1U);
    ASSERT_EQ(b->bus.origins.size(), 1U);
    EXPECT_FALSE(b->bus.origins[0].has_value());

    b->hear_bus_own();
    b->step();
    EXPECT_EQ(b->bus.origins.size(), 1U) << "nothing new";
    EXPECT_EQ(b->last.own_source, OwnSource::bus) << "for advice";
    EXPECT_TRUE(b->has(Fault::own_state_missing));

    // Another origin: the bus's objects are placed again, the tracks stay.
    b->wire.where = kBenchOrigin;
    b->hear_bus_own();
    b->step();
    ASSERT_EQ(b->bus.origins.size(), 2U);
    EXPECT_EQ(b->bus.origins[1], kBenchOrigin);
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    EXPECT_EQ(b->counted().frame_changes, 1U) << "the frame is the same";
    EXPECT_EQ(b->counted().bus_reports_dropped, 3U);
    EXPECT_EQ(b->coprocessor.tracks(b->now).size(), 1U);

    b->hear_autopilot().rebooted = true;
    b->hear_bus_own();
    b->step();
    EXPECT_EQ(b->bus.origins.size(), 3U) << "asked anew after a restart";
    EXPECT_EQ(b->counted().bus_reports_dropped, 4U);
}

TEST(StepBusState, StandsInForTheAutopilotsAndNeverBesideIt)
{
    const auto b = bus_bench();
    b->fly(1);
    b->fly(1);
    b->hear_bus_own().state.position = b->position + Vec3(3.0F, 0.0F, 0.0F);
    b->hear_own();
    b->step();
    EXPECT_EQ(b->counted().bus_states_beside, 1U);
    EXPECT_EQ(b->last.own_source, OwnSource::autopilot);
    EXPECT_EQ(b->coprocessor.own().position, b->position);
    // 0.5 s after the autopilot's last, and a microsecond later.
    b->step(480'000);
    b->hear_bus_own();
    b->step(20'000);
    EXPECT_EQ(b->counted().bus_states_beside, 2U);
    EXPECT_EQ(b->counted().bus_states, 0U);
    b->coming_us = 1;
    b->hear_bus_own();
    b->step(1);
    EXPECT_EQ(b->counted().bus_states, 1U);
    EXPECT_EQ(b->last.own_source, OwnSource::bus);
    EXPECT_TRUE(b->has(Fault::own_state_stale)) << "faults are about the autopilot's";
}

TEST(StepBusState, IsRefusedFromTheFutureAndWhenOlder)
{
    const auto b = bus_bench();
    b->hear_bus_own(-0.0501F);
    b->step();
    EXPECT_EQ(b->counted().bus_states_refused, 1U);
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    const TimePoint stamp = b->hear_bus_own(-0.05F).state.stamp;
    b->step();
    EXPECT_EQ(b->counted().bus_states, 1U);
    b->hear_bus_own().state.stamp = {stamp.us - 1};
    b->step();
    EXPECT_EQ(b->counted().bus_states_refused, 2U);
    b->hear_bus_own().state.stamp = stamp;
    b->step();
    EXPECT_EQ(b->counted().bus_states, 2U) << "of the same instant";
    EXPECT_EQ(b->counted().bus_states_refused, 2U);
}

TEST(StepBusState, AResetOfTheReceiverForgetsPlacesWhereItCounts)
{
    const auto b = bus_bench();
    const auto tell = [&](bool reset) {
        b->hear_bus_own().estimator_reset = reset;
        b->step();
        return b->counted().estimator_resets;
    };
    EXPECT_EQ(tell(true), 0U) << "nothing was known before";
    b->bus.tracks.push_back(b->track_report(1, Vec3(0.0F, 80.0F, 50.0F)));
    EXPECT_EQ(tell(false), 0U);
    EXPECT_EQ(b->last.tracks, 1U);
    EXPECT_EQ(tell(true), 1U);
    EXPECT_EQ(b->last.tracks, 0U);
    b->fly(2);  // the autopilot's own state is there
    b->hear_track(2, Vec3(0.0F, 80.0F, 50.0F));
    b->fly(1);
    b->hear_own();
    EXPECT_EQ(tell(true), 1U);
    EXPECT_EQ(b->last.tracks, 1U);
    for (int i = 0; i < 30; ++i) {
        b->step();
    }
    EXPECT_EQ(tell(true), 1U) << "the place before it was the autopilot's";
    EXPECT_EQ(b->last.own_source, OwnSource::bus);
}

/// The limit in PlacesAgree: 30 m, k_sigma times both stated errors, and a second of flight.
TEST(StepBusState, PlacesThatDifferAreSaidOnceUntilTheyAgree)
{
    const auto b = bus_bench({{Param::k_sigma, 2.0F}});
    b->fly(1);
    const auto tell = [&](float apart, float own_sigma, float fix_sigma) {
        link::OwnStateReport& fix = b->hear_bus_own();
        fix.state.position = b->position + Vec3(apart, 0.0F, 0.0F);
        fix.state.velocity = Vec3(0.0F, 3.0F, 4.0F);
        fix.state.sigma_position = fix_sigma;
        b->hear_own().state.sigma_position = own_sigma;
        b->step();
        return b->counted().places_disagree;
    };
    EXPECT_EQ(tell(40.9F, 1.0F, 2.0F), 0U) << "30 + 2 (1 + 2) + 5";
    EXPECT_EQ(tell(41.1F, 1.0F, 2.0F), 1U);
    EXPECT_EQ(tell(60.0F, 1.0F, 2.0F), 1U) << "still";
    EXPECT_EQ(tell(10.0F, 1.0F, 2.0F), 1U);
    EXPECT_EQ(tell(35.1F, 0.0F, 0.0F), 2U);
    EXPECT_EQ(tell(34.9F, 0.0F, 0.0F), 2U);
    EXPECT_EQ(b->said("jink: CAN and autopilot differ on own place"), 2);
    EXPECT_EQ(b->bus.texts.size(), 2U);
}

/// Compared at the instant of the fix: the own state is flown on to it, OWN_AGE at most.
TEST(StepBusState, PlacesAreComparedAtTheSameInstant)
{
    for (const float apart : {25.0F, 45.0F}) {
        const auto b = bus_bench({{Param::own_age, 0.05F}, {Param::k_sigma, 0.0F}});
        b->velocity = Vec3(0.0F, 300.0F, 0.0F);
        b->fly(1);
        b->step(100'000);
        b->hear_own(0.05F);
        link::OwnStateReport& fix = b->hear_bus_own(-0.05F);
        // 0.1 s before the fix the vehicle was at `position`; half of that is flown on: 15 m.
        fix.state.position = b->position + Vec3(0.0F, 15.0F + apart, 0.0F);
        fix.state.velocity = Vec3::Zero();
        b->step();
        EXPECT_EQ(b->counted().places_disagree, apart > 30.0F ? 1U : 0U);
        EXPECT_EQ(b->counted().bus_states_beside, 1U);
    }
}

}  // namespace
}  // namespace jink::app::test
