// SPDX-License-Identifier: BSD-3-Clause
// The fallback at the edges of its contract: exactly clear, about as good as before, straight up and down, turns.
#include <cmath>

#include <gtest/gtest.h>

#include "core/avoid/fallback.hpp"
#include "core/base/random.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;
using world::test::kPlenty;

Fallback chosen_for(const Flight& f, const Fallback* previous = nullptr, const Settings& settings = {})
{
    WorkBudget budget(kPlenty);
    const Situation s = f.scene.situation();
    return choose_fallback(s, world::way_of(s), previous, settings, budget);
}

float margin_under(const Flight& f, const Vec3& command)
{
    WorkBudget budget(kPlenty);
    return command_margin(f.scene.situation(), command, Settings{}, budget);
}

/// The same for the box with rounded corners: a cube of half extent 1 m becomes a sphere.
float rounded_margin_under(const Flight& f, const Vec3& command)
{
    Flight inner = f;
    inner.scene.limits.half_extents.setZero();
    return margin_under(inner, command) - f.scene.limits.half_extents.x();
}

/// Static, with its box exactly on the floor and, with `ceiling`, directly below the ceiling.
Flight between_bounds(bool ceiling)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 29.0F;
    f.scene.airspace.has_ceiling = ceiling;
    f.scene.airspace.ceiling = 31.0F;
    return f;
}

TEST(FallbackEdges, ABrakeThatIsExactlyClearIsTaken)
{
    const Flight f = between_bounds(false);
    const Fallback chosen = chosen_for(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::brake);
    EXPECT_EQ(chosen.margin, 0.0F);
}

TEST(FallbackEdges, AWayOutThatIsExactlyClearStays)
{
    Flight f = between_bounds(false);
    f.scene.track(Vec3(8, 0, 30), Vec3(-4, 0, 0), 1.0F);
    const Fallback before{ManoeuvreKind::velocity, Vec3(0, 5, 0), 0.0F};
    ASSERT_LT(margin_under(f, Vec3::Zero()), 0.0F);
    ASSERT_EQ(margin_under(f, before.command), 0.0F);
    const Fallback chosen = chosen_for(f, &before);
    EXPECT_EQ(chosen.command, before.command);
    EXPECT_EQ(chosen.margin, 0.0F);
}

TEST(FallbackEdges, ContactIsNotHeldOnToWhereAnotherIsExactlyClear)
{
    Flight f = between_bounds(true);
    f.scene.track(Vec3(8, 0, 30), Vec3(-4, 0, 0), 1.0F);
    Fallback before{ManoeuvreKind::velocity, Vec3(0, 5, -0.01F), 0.0F};
    before.margin = margin_under(f, before.command);
    ASSERT_LT(before.margin, 0.0F);
    ASSERT_GT(before.margin, -0.09F);
    const Fallback chosen = chosen_for(f, &before);
    EXPECT_EQ(chosen.margin, 0.0F);
    EXPECT_EQ(chosen.command.z(), 0.0F);
}

/// In the middle of something large nothing is clear.
Flight engulfed()
{
    Flight f;
    f.scene.own.velocity = Vec3(1, 0, 0);
    f.scene.track(Vec3(2, 0.7F, 30.4F), Vec3(-1, 0, 0), 30.0F);
    return f;
}

TEST(FallbackEdges, WhereNothingIsClearTheFormerOneStaysUnlessAnotherIsBetter)
{
    constexpr float kHoldOn = 0.02F;
    const Flight f = engulfed();
    const Fallback first = chosen_for(f);
    ASSERT_LT(first.margin, -0.3F);
    ASSERT_EQ(first.kind, ManoeuvreKind::velocity);
    const float course = std::atan2(first.command.y(), first.command.x());
    const float level = std::hypot(first.command.x(), first.command.y());
    int stays = 0;
    int changes = 0;
    for (int i = 1; i <= 90; ++i) {
        const float turned = course + 0.01F * static_cast<float>(i);
        Fallback before{ManoeuvreKind::velocity,
                        Vec3(level * std::cos(turned), level * std::sin(turned), first.command.z()), 0.0F};
        before.margin = rounded_margin_under(f, before.command);
        const float better = first.margin - before.margin;
        if (std::abs(better - kHoldOn) < 1e-3F || better <= 0.0F) {
            continue;
        }
        const Fallback chosen = chosen_for(f, &before);
        if (better < kHoldOn) {
            EXPECT_EQ(chosen.command, before.command) << better;
            EXPECT_EQ(chosen.margin, before.margin) << better;
            ++stays;
        } else {
            EXPECT_EQ(chosen.command, first.command) << better;
            EXPECT_EQ(chosen.margin, first.margin) << better;
            ++changes;
        }
    }
    EXPECT_GT(stays, 2);
    EXPECT_GT(changes, 2);
}

/// Late intruders that no command keeps out of the box: the command with the greatest margin to the box may lead past a
/// corner, or past a face where another leaves more distance.
TEST(FallbackEdges, WhereTheBoxCannotBeKeptClearTheDistanceDecides)
{
    Random random(20261128);
    int differ = 0;
    for (int i = 0; i < 300; ++i) {
        Flight f;
        f.scene.own.velocity = Vec3(random.uniform(2, 5), random.uniform(-2, 2), random.uniform(-1, 1));
        const Vec3 velocity(random.uniform(-9, -3), random.uniform(-6, 6), random.uniform(-2, 2));
        const float meets = random.uniform(0.5F, 0.9F);
        const Vec3 miss(random.uniform(-0.8F, 0.8F), random.uniform(-0.8F, 0.8F), random.uniform(-0.8F, 0.8F));
        f.scene.track(f.scene.own.position + (f.scene.own.velocity - velocity) * meets + miss, velocity, 1.2F);
        const Fallback chosen = chosen_for(f);
        if (chosen.margin >= 0.0F) {
            continue;
        }
        const float kept = rounded_margin_under(f, chosen.command);
        Vec3 of_box = Vec3::Zero();
        float most = margin_under(f, of_box);
        for (const float climb : {-3.0F, -1.5F, 0.0F, 1.5F, 3.0F}) {
            for (int k = 0; k < 48; ++k) {
                const float course = 2.0F * kPi * static_cast<float>(k) / 48.0F;
                const float level = std::sqrt(25.0F - climb * climb);
                const Vec3 command(level * std::cos(course), level * std::sin(course), climb);
                EXPECT_LT(rounded_margin_under(f, command), kept + 0.25F) << "case " << i;
                const float margin = margin_under(f, command);
                of_box = margin > most ? command : of_box;
                most = std::max(most, margin);
            }
        }
        differ += rounded_margin_under(f, of_box) < kept - 0.1F ? 1 : 0;
    }
    EXPECT_GT(differ, 20);
}

/// A command that is not finite is the worst there is, and never stays.
TEST(FallbackEdges, AFormerCommandThatIsNotFiniteIsNotHeldOnTo)
{
    const Flight f = engulfed();
    for (const float bad : {kNan, kInfinity}) {
        const Fallback before{ManoeuvreKind::velocity, Vec3(bad, 0, 0), 1.0F};
        const Fallback chosen = chosen_for(f, &before);
        EXPECT_TRUE(is_finite(chosen.command));
        EXPECT_EQ(chosen.command, chosen_for(f).command);
    }
}

/// Walls to all sides, and one that comes from above or below: the column alone is free.
Flight in_a_shaft(float from)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    for (int i = 0; i < 12; ++i) {
        const float angle = 2.0F * kPi * static_cast<float>(i) / 12.0F;
        const Vec3 at = Vec3(0, 0, 30) + 3.6F * Vec3(std::cos(angle), std::sin(angle), 0);
        f.scene.obstacle(geometry::make_capsule(at - Vec3(0, 0, 60), at + Vec3(0, 0, 60), 1.2F));
    }
    f.scene.track(Vec3(0, 0, 30.0F + from), Vec3(0, 0, from > 0.0F ? -1.0F : 1.0F), 1.0F);
    return f;
}

/// Straight up and straight down, each as fast as the vehicle may.
TEST(FallbackEdges, StraightDownAtTheDescentLimit)
{
    Flight f = in_a_shaft(4.0F);
    f.scene.limits.max_climb = 4.0F;
    f.scene.limits.max_descent = 2.0F;
    const Fallback chosen = chosen_for(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::velocity);
    EXPECT_GE(chosen.margin, 0.0F);
    EXPECT_EQ(chosen.command, Vec3(0, 0, -2));
}

TEST(FallbackEdges, StraightUpAtTheClimbLimit)
{
    Flight f = in_a_shaft(-4.0F);
    f.scene.limits.max_climb = 2.0F;
    f.scene.limits.max_descent = 4.0F;
    EXPECT_EQ(chosen_for(f).command, Vec3(0, 0, 2));
    EXPECT_GE(chosen_for(f).margin, 0.0F);
    f.scene.limits.max_climb = 20.0F;
    EXPECT_EQ(chosen_for(f).command, Vec3(0, 0, 5)) << "no faster than cruise speed";
    Flight down = in_a_shaft(4.0F);
    down.scene.limits.max_descent = 20.0F;
    EXPECT_EQ(chosen_for(down).command, Vec3(0, 0, -5));
}

/// A vertical path gives no initial course: all courses are still tried.
TEST(FallbackEdges, AVerticalWayHasLevelWaysOutToo)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.limits.max_climb = f.scene.limits.max_descent = 0.5F;
    f.scene.leg(Vec3(0, 0, 30), Vec3(0, 0, 90), 2.0F);
    f.scene.track(Vec3(9, 0, 30), Vec3(-3, 0, 0), 1.0F);
    const Fallback chosen = chosen_for(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::velocity);
    EXPECT_GE(chosen.margin, 1.0F);
    EXPECT_GT(chosen.command.head<2>().norm(), 4.0F);
}

/// The fallback horizon bounds how far commands are compared.
TEST(FallbackEdges, ThreatsBeyondTheHorizonDoNotCount)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.track(Vec3(32, 0, 30), Vec3(-6, 0, 0), 1.0F);  // contact after 5 s
    Settings settings;
    settings.fallback_horizon = 4.0F;
    EXPECT_EQ(chosen_for(f, nullptr, settings).kind, ManoeuvreKind::brake);
    EXPECT_NEAR(chosen_for(f, nullptr, settings).margin, 30.0F - 24.0F, 1e-3F);
    settings.fallback_horizon = 6.0F;
    EXPECT_EQ(chosen_for(f, nullptr, settings).kind, ManoeuvreKind::velocity);
}

/// The previously nearest threat is checked first: an unfavourable track order makes only the first command more
/// expensive.
TEST(FallbackEdges, TheOrderOfTracksCostsOneCheck)
{
    struct Cost {
        std::uint32_t one = 0;
        std::uint32_t all = 0;
    };
    const auto cost = [](std::size_t danger) {
        Flight f;
        f.scene.own.velocity = Vec3::Zero();
        for (std::size_t i = 0; i < 30; ++i) {
            const float angle = 0.2F * static_cast<float>(i);
            f.scene.track(Vec3(0, 0, 30) + 30.0F * Vec3(std::cos(angle), std::sin(angle), 0.0F), Vec3::Zero(), 0.5F);
        }
        f.scene.tracks[danger].position = Vec3(0.4F, 0.2F, 30.1F);
        f.scene.tracks[danger].radius = 9.0F;
        WorkBudget one(kPlenty);
        WorkBudget all(kPlenty);
        const Situation s = f.scene.situation();
        EXPECT_LT(command_margin(s, Vec3::Zero(), Settings{}, one), 0.0F);
        EXPECT_LT(choose_fallback(s, world::way_of(s), nullptr, Settings{}, all).margin, 0.0F);
        return Cost{one.spent(), all.spent()};
    };
    const Cost lucky = cost(0);
    const Cost unlucky = cost(29);
    EXPECT_GT(unlucky.one, lucky.one + 100);
    EXPECT_EQ(unlucky.all - unlucky.one, lucky.all - lucky.one);
    EXPECT_LT(unlucky.all, 15 * unlucky.one) << "39 commands are checked, most of them until they are no better";
}

// --- fixed wings ---

Flight fixed_wing()
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    return f;
}

TEST(FallbackOfAFixedWing, TurnsLeftWhereBothSidesAreAlike)
{
    const Flight f = fixed_wing();
    EXPECT_EQ(chosen_for(f).kind, ManoeuvreKind::hold_turn);
    EXPECT_EQ(chosen_for(f).command, Vec3(0, 0, 1));
}

/// An earlier command without a turn gives no side, climbing or not.
TEST(FallbackOfAFixedWing, AFormerVelocityIsNoTurn)
{
    const Flight f = fixed_wing();
    const Fallback descending{ManoeuvreKind::velocity, Vec3(14, 0, -1), 1.0F};
    EXPECT_EQ(chosen_for(f, &descending).command, Vec3(0, 0, 1));
    const Fallback right{ManoeuvreKind::hold_turn, Vec3(0, 0, -1), 1.0F};
    EXPECT_EQ(chosen_for(f, &right).command, Vec3(0, 0, -1));
}

TEST(FallbackOfAFixedWing, TheLesserEvilIsStillATurn)
{
    Flight f = fixed_wing();
    f.scene.track(Vec3(10, -3, 30), Vec3::Zero(), 15.0F);
    const Fallback chosen = chosen_for(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::hold_turn);
    EXPECT_EQ(chosen.command, Vec3(0, 0, 1)) << "away from its middle";
    EXPECT_LT(chosen.margin, 0.0F);
    EXPECT_GT(chosen.margin, -16.0F);
}

TEST(FallbackOfAFixedWing, LooksAsFarAsTheHorizonAndEscapesByTheSettings)
{
    Flight f = fixed_wing();
    f.scene.track(Vec3(20, 90, 30), Vec3(0, -18, 0), 1.0F);
    Settings settings;
    settings.fallback_horizon = 2.0F;
    EXPECT_GT(chosen_for(f, nullptr, settings).margin, 5.0F);
    // Inside a margin, the turn leads out of it at several metres a second.
    Flight inside = fixed_wing();
    inside.scene.track(Vec3(-4.5F, -2.0F, 30), Vec3::Zero(), 4.0F);
    EXPECT_GE(chosen_for(inside).margin, 0.0F);
    settings = {};
    inside.scene.rules.escape.speed = 10.0F;
    inside.scene.rules.escape.slack = 0.0F;
    inside.scene.own.velocity = Vec3(4, 0, 0);
    inside.scene.limits.cruise_speed = 4.0F;
    EXPECT_LT(chosen_for(inside, nullptr, settings).margin, 0.0F) << "at less than is asked for";
}

// --- the command of a turn ---

/// The command leads the velocity as required by the lag, by 0.7 rad at most.
TEST(TurnCommand, LeadsByTheLagsShareOfAFullTurn)
{
    vehicle::VehicleLimits limits;
    vehicle::VehicleState own;
    own.yaw = 1.0F;
    const auto lead = [&] {
        const Vec3 command = turn_command(own, limits, 1.0F);
        EXPECT_NEAR(command.norm(), limits.cruise_speed, 1e-4F);
        EXPECT_EQ(command.z(), 0.0F);
        return std::atan2(command.y(), command.x());
    };
    limits.cruise_speed = 15.0F;
    limits.max_acceleration = 6.0F;
    limits.max_vertical_acceleration = 1.0F;
    limits.velocity_lag = 0.5F;
    own.velocity = Vec3(15, 0, 2);
    EXPECT_NEAR(lead(), 6.0F * 0.5F / 15.0F, 1e-5F);
    limits.velocity_lag = 0.0F;
    EXPECT_NEAR(lead(), 6.0F * 0.1F / 15.0F, 1e-5F) << "without a lag it turns all the same";
    limits.cruise_speed = 2.0F;
    limits.velocity_lag = 1.0F;
    EXPECT_NEAR(lead(), 0.7F, 1e-5F);
    own.velocity = Vec3(0.05F, 0, 3);
    EXPECT_NEAR(lead(), 1.0F + 0.7F, 1e-5F) << "as good as standing: from where it looks";
    own.velocity = Vec3(0.1F, 0, 0);
    EXPECT_NEAR(lead(), 1.0F + 0.7F, 1e-5F) << "a tenth of a metre a second is standing";
    EXPECT_NEAR(turn_command(own, limits, -1.0F).x(), 2.0F * std::cos(0.3F), 1e-5F);
}

}  // namespace
}  // namespace jink::avoid
