// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/give_way.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/path/follower.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::Alert;

/// 200 m up on a long leg at 12 m/s, aircraft kept well clear of.
struct HighFlight : Flight {
    HighFlight()
    {
        scene.limits.cruise_speed = 12.0F;
        scene.leg(Vec3(0, 0, 200), Vec3(20000, 0, 200), 12.0F);
        scene.own.position = Vec3(0, 0, 200);
        scene.own.velocity = Vec3(12, 0, 0);
        scene.airspace.has_floor = true;
        scene.airspace.floor = 0.0F;
        scene.rules.well_clear.radius = 609.6F;
    }
    void aircraft(const Vec3& from_here, const Vec3& velocity)
    {
        scene.track(scene.own.position + from_here, velocity, 5.0F).manned = true;
    }
    [[nodiscard]] float nearness(const world::Volume& volume) const
    {
        float least = 100.0F;
        for (const world::Track& t : scene.tracks) {
            least = std::min(least, world::nearest(t.position - scene.own.position, Vec3::Zero(), volume, 0.0F).least);
        }
        return least;
    }
};

constexpr world::Volume kVolume{609.6F, 76.2F};

/// What a flight of `seconds` came to.
struct Flown {
    float nearest = 100.0F;
    float lowest = 1e9F;
    bool gave_way = false;
    bool given_back = false;
    Alert alert = Alert::none;
};

template <class S>
Flown fly(HighFlight& f, S& supervisor, Seconds seconds)
{
    constexpr Seconds kTick = 0.1F;
    Flown out;
    bool in_control = false;
    for (Seconds t = 0.0F; t < seconds; t += kTick) {
        const Guidance g = f.update(supervisor, in_control);
        out.gave_way = out.gave_way || g.by == kGivesWay;
        out.given_back = out.given_back || (in_control && !g.wants_control);
        out.alert = std::max(out.alert, g.alert);
        in_control = g.wants_control;
        if (in_control) {
            f.pass(g.velocity, kTick);
        } else {
            const world::Way way = world::way_of(f.scene.situation());
            f.pass(way.direction * way.speed, kTick);
        }
        out.nearest = std::min(out.nearest, f.nearness(kVolume));
        out.lowest = std::min(out.lowest, f.scene.own.position.z());
    }
    return out;
}

TEST(GivingWay, KeepsWellClearOfAnAircraftAndGoesBack)
{
    for (const Vec3& velocity : {Vec3(-60, 0, 0), Vec3(-40, 40, 0), Vec3(-30, -30, 0), Vec3(-45, 0, 3)}) {
        HighFlight f;
        // They would meet after 50 s.
        f.aircraft(Vec3(12.0F * 50.0F, 0, 0) - 50.0F * velocity, velocity);
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        const Flown flown = fly(f, supervisor, 150.0F);
        EXPECT_TRUE(flown.gave_way);
        EXPECT_GE(flown.nearest, 1.0F) << velocity.x() << " " << velocity.y() << " " << velocity.z();
        EXPECT_TRUE(flown.given_back);
        EXPECT_EQ(supervisor.state(), State::watching);
        EXPECT_LT((f.scene.own.position - Vec3(f.scene.own.position.x(), 0, 200)).norm(), 2.0F) << "on its leg again";
        EXPECT_EQ(supervisor.diagnostics().gave_way, 1U);
    }
}

/// Whether well clear is lost beside an aircraft that flies along a circle through the vehicle's place after 30 to 60
/// s.
bool is_lost_beside_a_turn(std::uint64_t seed, bool shown)
{
    constexpr Seconds kTick = 0.1F;
    Random random(seed);
    const Seconds meets = random.uniform(30.0F, 60.0F);
    const float rate = random.uniform(0.03F, 0.1F) * (random.below(2) == 0 ? 1.0F : -1.0F);
    const float course = random.uniform(-kPi, kPi);
    const float speed = random.uniform(25.0F, 60.0F);
    HighFlight f;
    Vec3 velocity(speed * std::cos(course), speed * std::sin(course), 0.0F);
    const auto turn = [&](float by) { velocity += by * kTick * Vec3(-velocity.y(), velocity.x(), 0.0F); };
    Vec3 from_here(12.0F * meets, 0.0F, 0.0F);
    for (Seconds t = 0.0F; t < meets; t += kTick) {
        from_here -= velocity * kTick;
        turn(-rate);
    }
    if (from_here.head<2>().norm() < 700.0F) {
        return false;
    }
    f.aircraft(from_here, velocity);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    bool in_control = false;
    bool lost = false;
    for (Seconds t = 0.0F; t < meets + 20.0F; t += kTick) {
        f.scene.tracks[0].velocity = velocity;
        f.scene.tracks[0].turn_rate = shown ? rate : 0.0F;
        const Guidance g = f.update(supervisor, in_control);
        in_control = g.wants_control;
        const world::Way way = world::way_of(f.scene.situation());
        f.pass(in_control ? g.velocity : Vec3(way.direction * way.speed), kTick);
        turn(rate);
        lost = lost || f.nearness(kVolume) < 1.0F;
    }
    return lost;
}

TEST(GivingWay, HowAnAircraftTurnsIsReckonedWith)
{
    int blind = 0;
    int seeing = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        blind += is_lost_beside_a_turn(seed, false) ? 1 : 0;
        seeing += is_lost_beside_a_turn(seed, true) ? 1 : 0;
    }
    EXPECT_GT(blind, 20) << "of 100";
    EXPECT_LT(2 * seeing, blind);
}

TEST(GivingWay, NotToDronesAndNotWhereTheRuleIsOff)
{
    for (const bool manned : {false, true}) {
        HighFlight f;
        f.aircraft(Vec3(3000, 0, 0), Vec3(-60, 0, 0));
        f.scene.tracks[0].manned = manned;
        f.scene.rules.well_clear.radius = manned ? 0.0F : 609.6F;
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        const Guidance g = f.update(supervisor, false);
        EXPECT_FALSE(g.wants_control);
        EXPECT_EQ(g.alert, Alert::none);
    }
}

TEST(GivingWay, FirstSeenNearbyStaysFarFromANearMidAir)
{
    // 2 km ahead and head-on: 28 s.
    HighFlight f;
    f.aircraft(Vec3(2000, 0, 0), Vec3(-60, 0, 0));
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    float nearest = 100.0F;
    bool in_control = false;
    for (int i = 0; i < 600; ++i) {
        const Guidance g = f.update(supervisor, in_control);
        in_control = g.wants_control;
        f.pass(in_control ? g.velocity : Vec3(12, 0, 0), 0.1F);
        nearest = std::min(nearest, f.nearness(world::kNearMidAir));
    }
    EXPECT_GT(nearest, 1.5F);
}

TEST(GivingWay, StaysAboveTheFloorAndBelowTheCeiling)
{
    HighFlight f;
    f.scene.leg(Vec3(0, 0, 40), Vec3(20000, 0, 40), 12.0F);
    f.scene.own.position.z() = 40.0F;
    f.scene.airspace.has_ceiling = true;
    f.scene.airspace.ceiling = 60.0F;
    f.aircraft(Vec3(3600, 0, 30), Vec3(-60, 0, 0));
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    float highest = 0.0F;
    bool in_control = false;
    float lowest = 100.0F;
    for (int i = 0; i < 900; ++i) {
        const Guidance g = f.update(supervisor, in_control);
        in_control = g.wants_control;
        f.pass(in_control ? g.velocity : Vec3(12, 0, 0), 0.1F);
        highest = std::max(highest, f.scene.own.position.z());
        lowest = std::min(lowest, f.scene.own.position.z());
    }
    EXPECT_GE(lowest, 1.0F);
    EXPECT_LE(highest, 59.0F);
    EXPECT_LT(lowest, 10.0F) << "down, below the aircraft";
}

/// Updates of a flight in which nothing gave way; `vertical` counts the commands that climb or descend.
int refusals(HighFlight& f, int updates, int& vertical)
{
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    bool in_control = false;
    int refused = 0;
    for (int i = 0; i < updates; ++i) {
        const Guidance g = f.update(supervisor, in_control);
        in_control = g.wants_control;
        refused += g.by == kGivesWay ? 0 : 1;
        vertical += std::abs(g.velocity.z()) > 0.1F ? 1 : 0;
        f.pass(in_control ? g.velocity : f.scene.own.velocity, 0.1F);
    }
    return refused;
}

/// In the way of a fast aircraft that comes down, a slow vehicle has one way out: down. What is offered of it passes
/// its check all the way, and most of the height is used.
TEST(GivingWay, DescendsToTheFloorWithoutRefusal)
{
    Random random(31);
    for (int i = 0; i < 100; ++i) {
        HighFlight f;
        const float height = random.uniform(15.0F, 30.0F);
        f.scene.limits.cruise_speed = 3.0F;
        f.scene.leg(Vec3(0, 0, height), Vec3(20000, 0, height), 3.0F);
        f.scene.own.position.z() = height;
        f.scene.own.velocity = Vec3(3, 0, 0);
        f.scene.limits.max_descent = 3.0F;
        f.scene.limits.max_vertical_acceleration = random.uniform(1.0F, 4.0F);
        f.scene.limits.velocity_lag = random.uniform(0.1F, 0.6F);
        f.aircraft(Vec3(900.0F, random.uniform(-20.0F, 20.0F), 60.0F), Vec3(-60.0F, 0.0F, -3.0F));
        int vertical = 0;
        EXPECT_EQ(refusals(f, 140, vertical), 0) << "case " << i << ", from " << height << " m";
        EXPECT_LT(f.scene.own.position.z(), 3.0F + 0.5F * height) << "case " << i;
        EXPECT_GE(f.scene.own.position.z(), f.scene.limits.half_extents.z()) << "case " << i;
    }
}

/// A wing cannot stop: its check ends with some seconds straight on, and the height has to last for them.
TEST(GivingWay, AWingNearTheFloorOrTheCeilingIsOfferedWhatPassesItsCheck)
{
    Random random(32);
    int vertical = 0;
    for (int i = 0; i < 100; ++i) {
        HighFlight f;
        const float height = random.uniform(15.0F, 60.0F);
        f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
        f.scene.limits.cruise_speed = random.uniform(12.0F, 25.0F);
        f.scene.limits.max_vertical_acceleration = random.uniform(1.0F, 4.0F);
        f.scene.limits.velocity_lag = random.uniform(0.1F, 0.6F);
        f.scene.leg(Vec3(0, 0, height), Vec3(20000, 0, height), f.scene.limits.cruise_speed);
        f.scene.own.position.z() = height;
        f.scene.own.velocity = Vec3(f.scene.limits.cruise_speed, 0, 0);
        f.scene.airspace.has_ceiling = true;
        f.scene.airspace.ceiling = 75.0F;
        f.aircraft(Vec3(1500.0F, random.uniform(-20.0F, 20.0F), random.uniform(-60.0F, 60.0F)),
                   Vec3(-60.0F, 0.0F, 0.0F));
        EXPECT_EQ(refusals(f, 200, vertical), 0) << "case " << i << ", from " << height << " m";
    }
    EXPECT_GT(vertical, 5000) << "of 20 000 commands";
}

/// Contact comes before well clear: whatever gives way is clear of all else, as the final check has it.
TEST(GivingWay, NeverTowardsWhatIsThereBesides)
{
    Random random(20250);
    int gave_way = 0;
    for (int i = 0; i < 400; ++i) {
        HighFlight f;
        f.aircraft(
            Vec3(random.uniform(500.0F, 3000.0F), random.uniform(-400.0F, 400.0F), random.uniform(-60.0F, 60.0F)),
            Vec3(random.uniform(-70.0F, -20.0F), random.uniform(-20.0F, 20.0F), random.uniform(-3.0F, 3.0F)));
        for (int k = 0; k < 12; ++k) {
            const Vec3 near(random.uniform(-40.0F, 60.0F), random.uniform(-40.0F, 40.0F),
                            random.uniform(-30.0F, 30.0F));
            f.scene.obstacle(geometry::make_sphere(f.scene.own.position + near, random.uniform(1.0F, 8.0F)));
        }
        FakeMethod method = never();
        const Settings settings = quick();
        Supervisor supervisor(settings, method);
        const Guidance g = f.update(supervisor, false);
        if (g.by != kGivesWay) {
            continue;
        }
        ++gave_way;
        WorkBudget budget(world::test::kPlenty);
        const world::Separation checked = check_manoeuvre(f.scene.situation(), *supervisor.flying(), settings, budget);
        EXPECT_GE(checked.margin, 0.0F) << "case " << i;
        EXPECT_EQ(checked.margin, g.margin);
    }
    EXPECT_GT(gave_way, 100);
}

TEST(GivingWay, AsManyAircraftAsTracksStayWithinTheWorkOfAnUpdate)
{
    Random random(7);
    HighFlight f;
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        f.aircraft(Vec3(random.uniform(-3000.0F, 3000.0F), random.uniform(-3000.0F, 3000.0F), 0.0F),
                   Vec3(random.uniform(-60.0F, 60.0F), random.uniform(-60.0F, 60.0F), 0.0F));
    }
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_NE(g.alert, Alert::none);
    EXPECT_TRUE(g.wants_control);
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 0U);
}

TEST(GivingWay, WithoutUnitsSaysNothing)
{
    HighFlight f;
    f.aircraft(Vec3(2000, 0, 0), Vec3(-60, 0, 0));
    const world::Situation s = f.scene.situation();
    world::Manoeuvre out;
    for (const std::uint32_t units : {0U, 10U, 200U, 900U}) {
        WorkBudget budget(units);
        EXPECT_FALSE(choose_give_way(s, Vec3(12, 0, 0), nullptr, quick(), budget, out).has_value()) << units;
    }
    WorkBudget plenty(world::test::kPlenty);
    EXPECT_TRUE(choose_give_way(s, Vec3(12, 0, 0), nullptr, quick(), plenty, out).has_value());
}

TEST(GivingWay, AFixedWingTurnsOrClimbs)
{
    HighFlight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 20.0F;
    f.scene.leg(Vec3(0, 0, 200), Vec3(20000, 0, 200), 20.0F);
    f.scene.own.velocity = Vec3(20, 0, 0);
    f.aircraft(Vec3(3000, 0, 0), Vec3(-40, 0, 0));
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_EQ(g.by, kGivesWay);
    EXPECT_GT(g.velocity.head<2>().norm(), 15.0F) << "it cannot stand";
}

}  // namespace
}  // namespace jink::avoid
