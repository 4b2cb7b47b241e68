// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/fallback.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;
using world::test::kPlenty;

Fallback fallback(const Flight& f, const Fallback* previous = nullptr, std::uint32_t units = kPlenty)
{
    WorkBudget budget(units);
    const Situation s = f.scene.situation();
    return choose_fallback(s, world::way_of(s), previous, Settings{}, budget);
}

float margin_of(const Flight& f, const Vec3& command)
{
    WorkBudget budget(kPlenty);
    return command_margin(f.scene.situation(), command, Settings{}, budget);
}

TEST(ChooseFallback, BrakesWhereThatIsClear)
{
    Flight f;
    f.scene.track(Vec3(12, 0, 30), Vec3::Zero(), 1.0F);
    const Fallback chosen = fallback(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::brake);
    EXPECT_EQ(chosen.margin, margin_of(f, Vec3::Zero()));
}

/// Two that stand and are closed in on by each other, exactly head-on: each goes to its right, one up and one down.
TEST(ChooseFallback, GoesToTheSideOnWhichBothPass)
{
    Vec3 commands[2];
    for (const int i : {0, 1}) {
        const float ahead = i == 0 ? 1.0F : -1.0F;
        Flight f;
        f.scene.leg(Vec3(0, 0, 30), Vec3(100.0F * ahead, 0, 30), 5.0F);
        f.scene.own.position = Vec3(-4.0F * ahead, 0, 30);
        f.scene.own.velocity = Vec3(3.0F * ahead, 0, 0);
        f.scene.own_id = static_cast<world::TrackId>(7 + i);
        world::Track& track = f.scene.track(Vec3(4.0F * ahead, 0, 30), Vec3(-3.0F * ahead, 0, 0), 1.0F);
        track.id = static_cast<world::TrackId>(8 - i);
        track.source = world::TrackSource::datalink;
        track.cooperative = true;
        const Fallback chosen = fallback(f);
        ASSERT_EQ(chosen.kind, ManoeuvreKind::velocity);
        commands[i] = chosen.command;
    }
    EXPECT_LT(commands[0].tail<2>().dot(commands[1].tail<2>()), 0.0F);
    EXPECT_LE(commands[0].y(), 0.1F);
    EXPECT_GE(commands[1].y(), -0.1F);
}

TEST(ChooseFallback, PrefersABrakeThatIsClearToWhatWasFlown)
{
    Flight f;
    f.scene.track(Vec3(12, 0, 30), Vec3::Zero(), 1.0F);
    const Fallback before{ManoeuvreKind::velocity, Vec3(0, 5, 0), 1.0F};
    EXPECT_EQ(fallback(f, &before).kind, ManoeuvreKind::brake);
}

/// Coming at a slow vehicle from ahead and above: neither back nor down alone is fast enough.
TEST(ChooseFallback, BacksAwayAndDown)
{
    Flight f;
    f.scene.own.velocity = Vec3(1, 0, 0);
    f.scene.track(Vec3(4.7F, 0.3F, 31.6F), Vec3(-3.5F, 0, 0), 2.0F);
    for (const Vec3& plain : {Vec3(-5, 0, 0), Vec3(0, 0, -3), Vec3(0, -5, 0), Vec3(0, -4, -3), Vec3(0, 0, 0)}) {
        ASSERT_LT(margin_of(f, plain), 0.0F);
    }
    const Fallback chosen = fallback(f);
    // The flight's chords leave it by up to 25 mm (path::Sagitta): the margin is stated as much lower.
    EXPECT_GT(chosen.margin, 0.2F - 0.025F);
    EXPECT_LT(chosen.command.x(), -3.0F);
    EXPECT_LT(chosen.command.z(), -2.9F);
}

TEST(ChooseFallback, CommandsWhatTheVehicleCanFly)
{
    Random random(20261122);
    for (int i = 0; i < 300; ++i) {
        Flight f;
        f.scene.limits.cruise_speed = random.uniform(1.0F, 20.0F);
        f.scene.limits.max_climb = random.uniform(0.5F, 25.0F);
        f.scene.limits.max_descent = random.uniform(0.5F, 25.0F);
        f.scene.track(f.scene.own.position + Vec3(random.uniform(2, 6), random.uniform(-3, 3), random.uniform(-3, 3)),
                      Vec3(random.uniform(-9, 9), random.uniform(-3, 3), 0), 1.5F);
        const Vec3 command = fallback(f).command;
        ASSERT_LE(command.norm(), f.scene.limits.cruise_speed * 1.00001F) << "case " << i;
        ASSERT_LE(command.z(), f.scene.limits.max_climb * 1.00001F) << "case " << i;
        ASSERT_GE(command.z(), -f.scene.limits.max_descent * 1.00001F) << "case " << i;
    }
}

/// Ending a check once a command is no better does not change the result.
TEST(CheckSeparation, ACutOffSearchTellsTheSameSideOfTheCut)
{
    Random random(20261123);
    int cut_off = 0;
    for (int i = 0; i < 2000; ++i) {
        Flight f;
        for (int n = 0; n < 6; ++n) {
            f.scene.track(Vec3(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(25, 35)),
                          Vec3(random.uniform(-5, 5), random.uniform(-5, 5), 0), 1.0F);
        }
        f.scene.obstacle(geometry::make_sphere(Vec3(random.uniform(-20, 20), random.uniform(-20, 20), 30), 2.0F));
        const Situation s = f.scene.situation();
        path::TimedPath flight;
        path::predict_velocity_command(f.scene.own, Vec3(0, 5, 0), 4.0F, 0.2F, f.scene.limits, flight);
        WorkBudget whole(kPlenty);
        WorkBudget part(kPlenty);
        const float least = world::least_separation(s, flight, 4.0F, whole).margin;
        const float cut = random.uniform(-3.0F, 6.0F);
        const auto first = static_cast<std::uint16_t>(random.below(8));  // 6 and 7: no such track
        const world::Separation found = world::least_separation(
            s, flight, 4.0F, part, {}, {cut, world::kSeparationCap, {world::ThreatKind::track, first}});
        if (least >= cut) {
            ASSERT_EQ(found.margin, least) << "case " << i;
        } else {
            ASSERT_LT(found.margin, cut) << "case " << i;
            ASSERT_GE(found.margin, least) << "case " << i;
            cut_off += part.spent() < whole.spent() ? 1 : 0;
        }
    }
    EXPECT_GT(cut_off, 100);
}

TEST(ChooseFallback, KeepsAWayOutThatIsStillClear)
{
    Flight f;
    f.scene.track(Vec3(14, 0.5F, 30), Vec3(-5, 0, 0), 1.0F);
    const Fallback before{ManoeuvreKind::velocity, Vec3(0, 5, 0), 0.1F};
    ASSERT_GE(margin_of(f, before.command), 0.0F);
    const Fallback chosen = fallback(f, &before);
    EXPECT_EQ(chosen.command, before.command);
    EXPECT_EQ(chosen.margin, margin_of(f, before.command));
}

/// Holding on is for choices that are about as bad; a clear one always wins.
TEST(ChooseFallback, DoesNotHoldOnToContactWhereAnotherIsClear)
{
    Random random(20260731);
    int tried = 0;
    for (int i = 0; i < 4000; ++i) {
        Flight f;
        f.scene.own.velocity = Vec3(random.uniform(-5, 5), random.uniform(-5, 5), 0);
        for (int n = 0; n < 2; ++n) {
            f.scene.track(
                f.scene.own.position + Vec3(random.uniform(-12, 12), random.uniform(-12, 12), random.uniform(-4, 4)),
                Vec3(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-1, 1)), random.uniform(0.5F, 2.0F));
        }
        const Fallback first = fallback(f);
        const Fallback before{ManoeuvreKind::velocity,
                              Vec3(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-2, 2)), 0.0F};
        const Fallback chosen = fallback(f, &before);
        if (first.margin >= 0.0F) {
            ++tried;
            ASSERT_GE(chosen.margin, 0.0F) << "case " << i;
        }
        ASSERT_TRUE(chosen.margin >= 0.0F || chosen.margin >= first.margin - 0.31F) << "case " << i;
        const float real =
            chosen.kind == ManoeuvreKind::brake ? margin_of(f, Vec3::Zero()) : margin_of(f, chosen.command);
        if (chosen.margin >= 0.0F) {
            ASSERT_EQ(chosen.margin, real) << "case " << i;
        } else {
            ASSERT_LT(real, 0.0F) << "case " << i;
        }
    }
    EXPECT_GT(tried, 500);
}

TEST(ChooseFallback, AFixedWingsTurnIsPaidForAndNotTrustedWithout)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_GT(fallback(f).margin, 0.0F);
    const Fallback chosen = fallback(f, nullptr, 20 * units::kTurnStep - 1);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::hold_turn);
    EXPECT_LT(chosen.margin, 0.0F);
}

/// For any budget: never a margin above that of the same command with a complete check.
TEST(ChooseFallback, ASpentBudgetNeverMakesACommandBetter)
{
    Flight f;
    for (const Vec3& at : {Vec3(3, 0, 30), Vec3(-4, 1, 31), Vec3(0, 4, 29), Vec3(1, -4, 30)}) {
        f.scene.track(at, -0.5F * (at - f.scene.own.position), 1.0F);
    }
    WorkBudget ample(kPlenty);
    const Situation s = f.scene.situation();
    static_cast<void>(choose_fallback(s, world::way_of(s), nullptr, Settings{}, ample));
    ASSERT_GT(ample.spent(), 1000U);
    for (std::uint32_t n = 0; n <= ample.spent(); n += 7) {
        const Fallback chosen = fallback(f, nullptr, n);
        ASSERT_LE(chosen.margin, margin_of(f, chosen.command)) << n;
    }
}

TEST(ChooseFallback, WithoutABudgetItBrakes)
{
    Flight f;
    f.scene.track(Vec3(3, 0, 30), Vec3(-5, 0, 0), 1.0F);
    const Fallback chosen = fallback(f, nullptr, 0);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::brake);
    EXPECT_LT(chosen.margin, 0.0F);
}

/// A wall across the way as an obstacle that reaches nearer than it is, as far as the vehicle: all commands begin in
/// it.
Flight in_a_thick_wall(float depth)
{
    Flight f;
    f.scene.own.velocity = Vec3(4, 0, 0);
    f.scene.obstacle(geometry::make_box(f.scene.own.position + Vec3(8.0F - depth, 0, 0), Vec3(8, 15, 30)));
    return f;
}

// Regression: any depth counted as the same, and a vehicle went on into the wall.
TEST(ChooseFallback, InAnObstacleItTakesTheShortWayOut)
{
    for (const float depth : {0.0F, 0.3F, 0.6F, 1.0F, 1.4F}) {
        const Fallback chosen = fallback(in_a_thick_wall(depth));
        EXPECT_TRUE(chosen.kind == ManoeuvreKind::brake || chosen.command.x() < 0.0F) << depth;
    }
}

TEST(ChooseFallback, WithAnyBudgetItGoesNoDeeperIntoAnObstacle)
{
    for (const float depth : {0.0F, 0.6F, 1.2F}) {
        const Flight f = in_a_thick_wall(depth);
        WorkBudget ample(kPlenty);
        const Situation s = f.scene.situation();
        static_cast<void>(choose_fallback(s, world::way_of(s), nullptr, Settings{}, ample));
        const Fallback ahead{ManoeuvreKind::velocity, Vec3(5, 0, 0), -1.0F};
        for (std::uint32_t n = 0; n <= ample.spent(); n += 11) {
            ASSERT_LE(fallback(f, nullptr, n).command.x(), 0.0F) << n << " units, " << depth;
        }
        EXPECT_LE(fallback(f, &ahead).command.x(), 0.0F) << "nor goes on into it: " << depth;
    }
}

TEST(ChooseFallback, AFixedWingsMarginIsWhatItsTurnKeeps)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    f.scene.track(Vec3(40, -3, 30), Vec3::Zero(), 3.0F);
    const Fallback first = fallback(f);
    ASSERT_EQ(first.kind, ManoeuvreKind::hold_turn);
    EXPECT_GT(first.command.z(), 0.0F) << "left";
    const Fallback second = fallback(f, &first);
    EXPECT_EQ(second.command, first.command);
    EXPECT_EQ(second.margin, first.margin) << "holding on does not make it any clearer";
}

// Regression: only both turns were checked, and the wing turned into a static obstacle beside it.
TEST(ChooseFallback, AFixedWingBetweenTwoThreatsGoesStraightOn)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    for (const float side : {-20.0F, 20.0F}) {
        f.scene.track(f.scene.own.position + Vec3(30, side, 0), Vec3::Zero(), 10.0F);
    }
    const Fallback chosen = fallback(f);
    ASSERT_EQ(chosen.kind, ManoeuvreKind::velocity);
    EXPECT_GT(chosen.margin, 5.0F);
    EXPECT_NEAR(chosen.command.y(), 0.0F, 1e-3F);
    const Fallback second = fallback(f, &chosen);
    EXPECT_EQ(second.command, chosen.command) << "stays";
}

TEST(ChooseFallback, AFixedWingBelowAWallClimbsOrDescends)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.limits.max_climb = f.scene.limits.max_descent = 3.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    for (int i = -6; i <= 6; ++i) {
        f.scene.track(f.scene.own.position + Vec3(45, 6.0F * static_cast<float>(i), 1.0F), Vec3::Zero(), 4.0F);
    }
    const Fallback chosen = fallback(f);
    EXPECT_EQ(chosen.kind, ManoeuvreKind::velocity);
    EXPECT_LT(chosen.command.z(), -1.0F) << "under what stands a metre above its height";
}

TEST(ChooseFallback, AFixedWingHoldsOnToATurnThatIsAboutAsGood)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    f.scene.track(Vec3(40, 0.05F, 30), Vec3::Zero(), 3.0F);
    for (const float sense : {1.0F, -1.0F}) {
        const Fallback before{ManoeuvreKind::hold_turn, Vec3(0, 0, sense), 0.0F};
        EXPECT_EQ(fallback(f, &before).command.z(), sense);
    }
}

/// The commanded turn is flown: within the acceleration limit, and around.
TEST(TurnCommand, TurnsAtTheLateralLimit)
{
    for (const float sense : {1.0F, -1.0F}) {
        vehicle::VehicleLimits limits;
        limits.cruise_speed = 15.0F;
        vehicle::VehicleState own;
        own.velocity = Vec3(15, 0, 0);
        float turned = 0.0F;
        for (int i = 0; i < 100; ++i) {
            const Vec3 before = own.velocity;
            vehicle::advance(own, turn_command(own, limits, sense), limits, 0.05F);
            turned +=
                std::atan2(before.x() * own.velocity.y() - before.y() * own.velocity.x(), before.dot(own.velocity));
        }
        // 5 m/s2 at 15 m/s is a third of a radian each second.
        EXPECT_NEAR(turned * sense, 5.0F * 5.0F / 15.0F, 0.25F);
        EXPECT_NEAR(own.velocity.norm(), 15.0F, 0.8F);
    }
    vehicle::VehicleState still;
    still.yaw = 0.5F * kPi;
    EXPECT_GT(turn_command(still, {}, 1.0F).y(), 3.0F) << "standing, it turns from where it looks";
}

}  // namespace
}  // namespace jink::avoid
