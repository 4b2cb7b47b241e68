// SPDX-License-Identifier: BSD-3-Clause
// Own state, HEARTBEATs and frames in Coprocessor::step: what is taken, refused, carried forward and forgotten.
#include <gtest/gtest.h>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

using Bus = StepBench::Bus;

constexpr link::GlobalPosition kBenchOrigin{473977420, 85455940, 488000};

std::unique_ptr<StepBench> bench(std::initializer_list<std::pair<Param, float>> changes = {}, Bus bus = Bus::none)
{
    return std::make_unique<StepBench>(changes, bus);
}

/// Without growth of threats: a collision course is a matter of lengths alone.
std::unique_ptr<StepBench> exact_bench(Bus bus = Bus::none)
{
    return bench({{Param::k_sigma, 0.0F}, {Param::mode, 1.0F}, {Param::lookahead, 20.0F}}, bus);
}

TEST(StepOwnState, StampedInTheFutureIsRefused)
{
    const auto b = bench();
    b->hear_autopilot();
    b->hear_own(-0.0501F);
    b->step();
    EXPECT_EQ(b->counted().own_state_refused, 1U);
    EXPECT_EQ(b->counted().own_states, 0U);
    EXPECT_TRUE(b->has(Fault::own_state_missing));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    b->hear_own(-0.05F);
    b->step();
    EXPECT_EQ(b->counted().own_state_refused, 1U) << "clocks differ by as much";
    EXPECT_EQ(b->counted().own_states, 1U);
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->last.own_source, OwnSource::autopilot);
}

TEST(StepOwnState, OlderThanWhatIsKnownIsRefused)
{
    const auto b = bench();
    b->fly(2);
    const Vec3 known = b->coprocessor.own().position;
    const TimePoint stamp = b->coprocessor.own().stamp;
    const auto hear = [&](std::int64_t us, float place) {
        link::OwnStateReport& r = b->hear_own();
        r.state.stamp = {us};
        r.state.position = Vec3(place, place, place);
        b->step();
    };
    hear(stamp.us - 1, 9.0F);
    EXPECT_EQ(b->counted().own_state_refused, 1U);
    EXPECT_EQ(b->coprocessor.own().position, known);
    hear(stamp.us, 7.0F);
    EXPECT_EQ(b->counted().own_state_refused, 1U) << "of the same instant";
    EXPECT_EQ(b->coprocessor.own().position, Vec3(7.0F, 7.0F, 7.0F));
    hear(stamp.us + 1000, 8.0F);
    hear(stamp.us + 999, 9.0F);
    EXPECT_EQ(b->coprocessor.own().position, Vec3(8.0F, 8.0F, 8.0F));
    EXPECT_EQ(b->counted().own_state_refused, 2U);
}

/// The own position of `age` ago, flown on to now: 40 m ahead of it stands a mast. Own box and mast take 2 m.
TEST(StepOwnState, IsFlownOnFromItsStampToNow)
{
    for (const float age : {0.0F, 0.1F, 0.3F, 0.5F}) {
        SCOPED_TRACE(age);
        const auto b = exact_bench();
        b->hear_autopilot();
        b->hear_own(age);
        b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
        b->step();
        ASSERT_TRUE(b->last.guidance.has_conflict);
        EXPECT_NEAR(b->last.guidance.conflict.time_to_loss, (40.0F - 2.0F) / 5.0F - age, 0.01F);
    }
}

TEST(StepOwnState, IsNotFlownBackwardsWhereItsStampLiesAhead)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_own(-0.05F);
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    ASSERT_TRUE(b->last.guidance.has_conflict);
    EXPECT_NEAR(b->last.guidance.conflict.time_to_loss, (40.0F - 2.0F) / 5.0F, 0.005F);
}

TEST(StepOwnState, IsAFaultWhenOlderThanItMayBe)
{
    const auto b = bench();
    b->fly(1);
    b->step(480'000);
    b->step(20'000);
    EXPECT_EQ(b->last.faults, 0U) << "0.5 s to the microsecond";
    EXPECT_EQ(b->last.own_source, OwnSource::autopilot);
    b->step(1);
    EXPECT_EQ(b->last.faults, bit(Fault::own_state_stale));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
}

TEST(StepOwnState, WithoutOneNothingIsSeen)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    EXPECT_FALSE(b->last.guidance.has_conflict);
    EXPECT_EQ(b->last.tracks, 0U);
    b->hear_own();
    b->step();
    EXPECT_TRUE(b->last.guidance.has_conflict);
    EXPECT_EQ(b->last.tracks, 1U);
    b->step(600'000);  // too old now
    EXPECT_FALSE(b->last.guidance.has_conflict);
}

TEST(StepOwnState, AResetOfTheEstimatorForgetsPlaces)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_own().estimator_reset = true;
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 0U) << "nothing was known before";
    b->hear_own();
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    ASSERT_EQ(b->last.tracks, 1U);
    b->hear_own().estimator_reset = true;
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 1U);
    EXPECT_EQ(b->last.tracks, 0U);
    EXPECT_FALSE(b->last.guidance.has_conflict);
    EXPECT_EQ(b->last.faults, 0U) << "the new one is known";
}

TEST(StepOwnState, ThatIsNotFiniteSteersNothing)
{
    const auto b = bench({{Param::standby, 1.0F}});
    b->fly(1);
    const std::uint64_t fed = b->watchdog.feeds();
    b->hear_own().state.velocity.y() = std::numeric_limits<float>::quiet_NaN();
    b->step();
    EXPECT_TRUE(b->has(Fault::not_finite));
    EXPECT_EQ(b->last.state, link::SystemState::critical);
    EXPECT_TRUE(b->wire.velocities.empty());
    EXPECT_FALSE(b->last.setpoint_sent);
    EXPECT_EQ(b->watchdog.feeds(), fed) << "an image that computes such a thing is not well";
    EXPECT_EQ(b->counted().setpoints_withheld, 0U) << "no stream was due";
    b->fly(1);
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->watchdog.feeds(), fed + 1);
}

TEST(StepAutopilot, ARestartForgetsWhatTheFormerOneSaid)
{
    const auto b = exact_bench();
    b->fly(2);
    b->wire.in.has_home = true;
    b->wire.in.home = Vec3(1.0F, 2.0F, 3.0F);
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->fly(1);
    ASSERT_EQ(b->coprocessor.home(), Vec3(1.0F, 2.0F, 3.0F));
    ASSERT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    ASSERT_EQ(b->last.tracks, 1U);
    b->hear_autopilot().rebooted = true;
    b->step();
    EXPECT_EQ(b->counted().autopilot_reboots, 1U);
    EXPECT_EQ(b->said("jink: autopilot restarted"), 1);
    EXPECT_TRUE(b->has(Fault::own_state_missing));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    EXPECT_EQ(b->coprocessor.home(), Vec3::Zero());
    b->hear_own();
    b->step();
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->last.tracks, 0U);
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    EXPECT_EQ(b->counted().autopilot_reboots, 1U);
}

TEST(StepAutopilot, IsKnownFromItsFirstHeartbeatOn)
{
    const auto b = bench();
    b->hear_own();
    b->step();
    EXPECT_EQ(b->coprocessor.autopilot(), nullptr);
    EXPECT_EQ(b->last.faults, bit(Fault::no_autopilot));
    b->hear_autopilot();
    b->hear_own();
    b->step();
    ASSERT_NE(b->coprocessor.autopilot(), nullptr);
    EXPECT_EQ(b->coprocessor.autopilot()->custom_mode, 3U);
    EXPECT_EQ(b->last.faults, 0U);
}

TEST(StepAutopilot, IsSilentWhenItsHeartbeatIsOlderThanItMayBe)
{
    const auto b = bench({{Param::heartbeat_age, 1.5F}});
    b->fly(1);
    const auto after = [&](std::int64_t us) {
        b->coming_us = us;
        b->hear_own();
        b->step(us);
        return b->last.faults;
    };
    EXPECT_EQ(after(500'000), 0U);
    EXPECT_EQ(after(500'000), 0U);
    EXPECT_EQ(after(500'000), 0U) << "1.5 s to the microsecond";
    EXPECT_EQ(after(1), bit(Fault::autopilot_silent));
}

TEST(StepLeg, IsBelievedUntilItIsLost)
{
    const auto b = exact_bench();
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(3);
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    b->wire.in.leg_lost = true;
    b->fly(1);
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    EXPECT_EQ(b->counted().legs_dropped, 1U);
    b->wire.in.leg_lost = true;
    b->fly(1);
    EXPECT_EQ(b->counted().legs_dropped, 1U) << "there was none to drop";
    b->wire.in.leg_lost = true;
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(1);
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg()) << "the next leg, told in the same step";
}

TEST(StepLeg, IsNotFlownInAModeOfOthers)
{
    const auto b = exact_bench();
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(2);
    ASSERT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    b->hear_autopilot().mode = link::FlightMode::external;
    b->hear_own();
    b->step();
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    b->hear_autopilot();
    b->hear_own();
    b->step();
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg());
}

TEST(StepOrigin, AnotherOneMovesTheTracks)
{
    const auto b = bench();
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
    const auto b = bench({}, Bus::there);
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

    // Another origin: what the bus knows is placed anew, the tracks stay.
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
    const auto b = bench({}, Bus::there);
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
    const auto b = bench({}, Bus::there);
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
    const auto b = bench({}, Bus::there);
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

/// The limit said in PlacesAgree: 30 m, k_sigma times what both say of their error, and what a second of flight makes.
TEST(StepBusState, PlacesThatDifferAreSaidOnceUntilTheyAgree)
{
    const auto b = bench({{Param::k_sigma, 2.0F}}, Bus::there);
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
        const auto b = bench({{Param::own_age, 0.05F}, {Param::k_sigma, 0.0F}}, Bus::there);
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
