// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step without permission to steer: the hold in time; and inputs never received.
#include <gtest/gtest.h>

#include "core/vehicle/vehicle.hpp"
#include "tests/unit/app/step_flight.hpp"

namespace jink::app::test {
namespace {

/// Refuses the first request of the external mode; true when the refusal was reported.
bool refuse(StepFlight& f)
{
    f.obeys = false;
    return f.until([&](const StepReport&) {
        if (f.asked_for("external") > 0 && f.last.control != Control::refused) {
            f.wire.in.mode_answers.unchecked_push_back({false, 1});
        }
        return f.last.control == Control::refused;
    });
}

TEST(StepHold, ARefusedVehicleIsHeldWhenItIsTimeToStop)
{
    StepFlight f;
    f.mast = Vec3(0.4F, 60.0F, 50.0F);
    ASSERT_TRUE(refuse(f));
    ASSERT_EQ(f.asked_for("hold"), 0);
    float before = 99.0F;
    float then = 99.0F;
    ASSERT_TRUE(f.until([&](const StepReport& r) {
        before = then;
        then = r.guidance.conflict ? r.guidance.conflict->time_to_loss : 0.0F;
        return f.asked_for("hold") > 0;
    }));
    const Configuration& c = f.coprocessor.parameters().configuration();
    const float needed = vehicle::stopping_time(5.0F, c.limits) + c.supervisor.reserve;
    EXPECT_LE(then, needed + 0.01F);
    EXPECT_GT(before, needed - 0.1F) << "and not long after that";
}

TEST(StepHold, TrafficThatStoppingHelpsAgainstIsStoppedForAndOtherIsNot)
{
    for (const bool crossing : {true, false}) {
        SCOPED_TRACE(crossing);
        StepFlight f;
        f.intruder_velocity = crossing ? Vec3(5.0F, 0.0F, 0.0F) : Vec3(0.0F, -5.0F, 0.0F);
        f.intruder = crossing ? Vec3(-60.0F, 60.0F, 50.0F) : Vec3(0.0F, 120.0F, 50.0F);
        ASSERT_TRUE(refuse(f));
        bool near = false;
        f.until([&](const StepReport& r) {
            near = near || (r.guidance.conflict.has_value() && r.guidance.conflict->time_to_loss < 1.0F);
            return near || f.asked_for("hold") > 0;
        });
        EXPECT_EQ(f.asked_for("hold") > 0, crossing);
        EXPECT_EQ(near, !crossing);
    }
}

/// In front of a closed area stopping is safer, with any other traffic: a following aircraft is not part of the
/// conflict.
TEST(StepHold, InFrontOfAClosedAreaItStopsWhateverOtherTrafficDoes)
{
    StepFlight f;
    f.intruder = f.position + Vec3(0.0F, -40.0F, 0.0F);
    f.intruder_velocity = f.velocity;
    link::Constraint area;
    area.cylinder.circle = {{f.position.x(), f.position.y() + 75.0F}, 10.0F};
    area.cylinder.bottom = 0.0F;
    area.cylinder.top = 500.0F;
    f.coprocessor.set_constraints({&area, 1}, f.now);
    ASSERT_TRUE(refuse(f));
    bool held = false;
    for (int i = 0; i < 600 && !held; ++i) {
        f.tick();
        held = f.asked_for("hold") > 0;
        ASSERT_FALSE(f.last.guidance.conflict.has_value() && f.last.guidance.conflict->time_to_loss < 0.5F)
            << "too late";
    }
    EXPECT_TRUE(held);
}

TEST(StepHold, TheLegIsFlownOnWhileWeLead)
{
    StepFlight f;
    f.wire.in.has_leg = true;
    f.wire.in.leg.leg = {f.position, f.position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    f.mast = Vec3(0.4F, 60.0F, 50.0F);
    ASSERT_TRUE(f.until(StepFlight::ours));
    ASSERT_EQ(f.coprocessor.autopilot()->mode, link::FlightMode::external);
    f.tick();
    EXPECT_TRUE(f.coprocessor.nominal_paths().believes_leg()) << "the external mode is ours";
}

/// The clock begins at zero: an instant that was never set is then not long ago.
TEST(StepHold, WhatWasNeverHeardIsNotFreshAtTheStart)
{
    {
        StepBench b({{Param::k_sigma, 0.0F}, {Param::mode, 1.0F}});
        b.now = {0};
        b.hear_autopilot();
        b.hear_mast(1, Vec3(0.0F, 0.5F, 0.0F));  // at an unreported place
        b.step();
        EXPECT_EQ(b.last.own_source, OwnSource::none);
        EXPECT_FALSE(b.last.guidance.conflict.has_value());
        EXPECT_TRUE(b.has(Fault::own_state_missing));
        b.hear_own().state.stamp = {-5};
        b.step();
        EXPECT_EQ(b.counted().own_states, 1U) << "the first is older than nothing";
    }
    StepBench b({}, StepBench::Bus::there);
    b.now = {0};
    b.hear_bus_own();
    b.step();
    EXPECT_EQ(b.last.own_source, OwnSource::bus);
    EXPECT_EQ(b.counted().bus_states_beside, 0U);
}

TEST(StepHold, AnotherOriginLeavesTheAutopilotsOwnState)
{
    StepBench b({}, StepBench::Bus::there);
    b.fly(2);
    b.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
    b.step();
    EXPECT_EQ(b.last.own_source, OwnSource::autopilot) << "told in the local frame itself";
    EXPECT_EQ(b.bus.origins.size(), 2U);
}

}  // namespace
}  // namespace jink::app::test
