// SPDX-License-Identifier: BSD-3-Clause
// Bounds of the airspace and changed parameters in Coprocessor: decisions obey both, from the same step on.
#include <gtest/gtest.h>

#include "core/vehicle/vehicle.hpp"
#include "tests/unit/app/step_flight.hpp"

namespace jink::app::test {
namespace {

using Changes = std::vector<std::pair<Param, float>>;

Parameters with(const Changes& changes)
{
    Parameters parameters;
    for (const auto& [param, value] : changes) {
        EXPECT_EQ(parameters.set(param, value), ParamStatus::ok);
    }
    return parameters;
}

/// Command of reciprocal avoidance, which decides by velocities alone, in front of a static mast 15 m ahead and
/// slightly to the avoided side. Zero: no command, because its command is refused.
Vec3 command(const Changes& changes, const Vec3& off, const Vec3& home = Vec3::Zero())
{
    Changes all{{Param::methods, 4.0F}, {Param::k_sigma, 0.0F}, {Param::bounds, 0.0F}};
    all.insert(all.end(), changes.begin(), changes.end());
    const auto b = std::make_unique<StepBench>(with(all));
    b->wire.in.has_home = true;
    b->wire.in.home = home;
    b->fly(1);
    b->hear_mast(1, b->position + Vec3(0.0F, 15.0F, 0.0F) + off);
    b->fly(1);
    EXPECT_TRUE(b->last.guidance.conflict.has_value());
    EXPECT_GT(b->last.work, 0U);
    EXPECT_EQ(b->last.work, b->last.guidance.work);
    return b->last.guidance.wants_control ? b->last.guidance.velocity : Vec3(Vec3::Zero());
}

TEST(StepBounds, ACommandStaysBelowTheCeilingAboveHome)
{
    const Vec3 below(0.0F, 0.0F, -0.6F);
    EXPECT_GT(command({}, below).z(), 0.4F) << "over it";
    EXPECT_GT(command({{Param::ceiling, 51.1F}}, below).z(), 0.4F) << "the ceiling is off";
    EXPECT_LT(command({{Param::bounds, 2.0F}, {Param::ceiling, 51.1F}}, below).z(), 0.2F);
    EXPECT_GT(command({{Param::bounds, 2.0F}, {Param::ceiling, 80.0F}}, below).z(), 0.4F);
    const Vec3 low(0.0F, 0.0F, -30.0F);
    EXPECT_LT(command({{Param::bounds, 2.0F}, {Param::ceiling, 81.1F}}, below, low).z(), 0.2F) << "above home";
    EXPECT_GT(command({{Param::bounds, 3.0F}, {Param::ceiling, 120.0F}, {Param::floor, 40.0F}}, below).z(), 0.4F)
        << "the floor is no ceiling";
}

TEST(StepBounds, ACommandStaysAboveTheFloorAboveHome)
{
    const Vec3 above(0.0F, 0.0F, 0.6F);
    EXPECT_LT(command({}, above).z(), -0.4F) << "under it";
    EXPECT_LT(command({{Param::floor, 48.9F}}, above).z(), -0.4F) << "the floor is off";
    EXPECT_GT(command({{Param::bounds, 1.0F}, {Param::floor, 48.9F}}, above).z(), -0.2F);
    EXPECT_GT(command({{Param::bounds, 1.0F}, {Param::floor, 18.9F}}, above, Vec3(0, 0, 30.0F)).z(), -0.2F);
}

TEST(StepBounds, ACommandStaysWithinTheKeepInDistanceOfHome)
{
    const Vec3 left(-0.6F, 0.0F, 0.0F);
    const Vec3 home(-200.0F, 0.0F, 0.0F);
    EXPECT_GT(command({}, left, home).x(), 0.4F) << "past it on the right";
    EXPECT_GT(command({{Param::keep_in, 203.9F}}, left, home).x(), 0.4F) << "it is off";
    EXPECT_LT(command({{Param::bounds, 4.0F}, {Param::keep_in, 203.9F}}, left, home).x(), 0.2F);
    EXPECT_GT(command({{Param::bounds, 4.0F}, {Param::keep_in, 203.9F}}, left).x(), 0.4F)
        << "about home, wherever it is";
}

void set_by_wire(StepBench& b, std::string_view name, float value)
{
    b.wire.in.params.unchecked_push_back({});
    link::ParamRequest& r = b.wire.in.params.back();
    r.kind = link::ParamRequestKind::set;
    std::copy(name.begin(), name.end(), r.name.begin());
    r.value = value;
    r.value_finite = true;
}

/// 60 m at 5 m/s are 12 s.
TEST(StepChanges, TheSupervisorLooksAsFarAheadAsItIsReportedFromTheSameStepOn)
{
    StepBench b({{Param::mode, 1.0F}, {Param::k_sigma, 0.0F}});
    b.velocity = Vec3::Zero();
    b.fly(1);
    b.velocity = Vec3(0.0F, 5.0F, 0.0F);
    b.hear_mast(1, b.position + Vec3(0.0F, 60.0F, 0.0F));
    b.fly(1);
    EXPECT_FALSE(b.last.guidance.conflict.has_value());
    set_by_wire(b, "JNK_LOOKAHEAD", 20.0F);
    b.fly(1);
    EXPECT_TRUE(b.last.guidance.conflict.has_value());
}

TEST(StepChanges, TheNewLatencyIsInTheFlightRules)
{
    StepBench b;
    set_by_wire(b, "GEO_LATENCY", 0.35F);
    b.step();
    EXPECT_EQ(b.coprocessor.parameters().configuration().rules.latency, 0.35F);
}

TEST(StepChanges, RestoredValuesAreInForceBeforeTheFirstStep)
{
    StepBench b;
    ParamValues values = b.coprocessor.parameters().values();
    values[static_cast<std::size_t>(Param::lookahead)] = 11.0F;
    values[static_cast<std::size_t>(Param::ask_rates)] = 0.0F;
    EXPECT_EQ(b.coprocessor.restore_parameters(values), 0U);
    EXPECT_EQ(b.coprocessor.parameters().configuration().rules.lookahead, 11.0F);
    EXPECT_EQ(b.wire.rates, false);
    values[static_cast<std::size_t>(Param::track_age)] = 1000.0F;
    values[static_cast<std::size_t>(Param::lookahead)] = 12.0F;
    EXPECT_EQ(b.coprocessor.restore_parameters(values), 1U) << "out of range; the others count";
    EXPECT_EQ(b.coprocessor.parameters().configuration().rules.lookahead, 12.0F);
    EXPECT_EQ(b.coprocessor.initial_parameters(), Parameters().values());
}

TEST(StepDisarmed, IsWhatAFreshHeartbeatSaysAndNothingElse)
{
    StepBench b;
    EXPECT_FALSE(b.coprocessor.is_disarmed(b.now)) << "nobody has said so";
    EXPECT_FALSE(b.coprocessor.is_disarmed({1'000'000})) << "soon after the start of the clock too";
    b.hear_autopilot().armed = false;
    b.hear_own();
    b.step();
    const TimePoint heard = b.coprocessor.autopilot()->stamp;
    EXPECT_TRUE(b.coprocessor.is_disarmed({heard.us + 1'500'000}));
    EXPECT_FALSE(b.coprocessor.is_disarmed({heard.us + 1'500'001})) << "may have armed since";
    b.hear_autopilot();
    b.step();
    EXPECT_FALSE(b.coprocessor.is_disarmed(b.now));
}

/// VEH_ACC brakes a copter of 5 m/s within 1.3 s and a plane, which stays in the air, never: it is the airspeed that
/// counts for the plane's limits.
TEST(StepLimits, APlaneIsPlannedForAtTheSpeedThatItFlies)
{
    const auto nearest_turn = [](float speed) {
        StepBench b(with({{Param::fixed_wing, 1.0F}, {Param::k_sigma, 0.0F}, {Param::cruise, 12.0F}}));
        b.velocity = Vec3(0.0F, speed, 0.0F);
        b.hear_mast(1, b.position + Vec3(0.0F, 60.0F, 0.0F), 5.0F);
        b.fly(1);
        EXPECT_TRUE(b.last.guidance.conflict.has_value());
        return b.last.guidance.velocity.norm();
    };
    EXPECT_NEAR(nearest_turn(12.0F), 12.0F, 0.5F);
    EXPECT_NEAR(nearest_turn(18.0F), 18.0F, 0.5F) << "commands at its own airspeed";
}

}  // namespace
}  // namespace jink::app::test
