// SPDX-License-Identifier: BSD-3-Clause
// Closed airspace and storm cells ahead of the planners: found manoeuvres keep out of bodies by the supervisor's
// measure, and a vehicle without an avoidance manoeuvre stops before them.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/avoid/final_check.hpp"
#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/world/barrel.hpp"
#include "core/world/threat_set.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

namespace jink::reach {
namespace {

using oracle::RandomSituation;
using world::Barrel;
using world::PlanStatus;

constexpr std::uint32_t kPlenty = 1'000'000;

Settings barrel_settings()
{
    Settings settings;
    settings.sets = &test::unit_sets();
    return settings;
}

Planner& barrel_planner()
{
    static Planner one{barrel_settings()};
    return one;
}

/// Barrels in place of everything else, some of them on the path.
struct Stormy : RandomSituation {
    explicit Stormy(std::uint64_t seed) : RandomSituation(seed)
    {
        Random random(seed + 77);
        tracks.clear();
        obstacles.clear();
        for (std::uint64_t i = 0, n = 1 + random.below(4); i < n; ++i) {
            const world::Vec2 velocity(random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F));
            const float t = random.uniform(1.0F, 6.0F);
            const world::Vec2 off(random.uniform(-15.0F, 15.0F), random.uniform(-15.0F, 15.0F));
            Barrel barrel;
            barrel.circle.radius = random.uniform(1.0F, 12.0F);
            barrel.circle.centre = (own.position + own.velocity * t).head<2>() + off - velocity * t;
            barrel.velocity = velocity;
            barrel.bottom = own.position.z() - random.uniform(-2.0F, 20.0F);
            barrel.top = barrel.bottom + random.uniform(1.0F, 40.0F);
            barrel.margin = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 5.0F);
            barrels.push_back(barrel);
        }
        airspace.barrels = barrels;
    }
    std::vector<Barrel> barrels;
};

TEST(BarrelPlans, WhatIsFoundKeepsOutOfBodies)
{
    std::size_t found = 0;
    std::size_t outside = 0;
    std::size_t kept_margins = 0;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        const Stormy s(seed);
        WorkBudget budget(kPlenty);
        const bool inside = world::separation_at(s.view(), s.own.position, 0.0F, budget).margin < 0.0F;
        outside += inside ? 0U : 1U;
        world::Manoeuvre manoeuvre;
        const PlanStatus status = barrel_planner().plan(s.view(), budget, manoeuvre);
        if (status != PlanStatus::found) {
            ASSERT_EQ(status, PlanStatus::none_available) << "seed " << seed;
            continue;
        }
        ++found;
        ASSERT_GE(world::least_separation(s.view(), manoeuvre.path, 100.0F, budget).margin, -2e-3F) << "seed " << seed;
        if (barrel_planner().last().run != AvoidanceRun::soft_constraints || inside) {
            continue;
        }
        // In the strictest run margins are kept as well, except before the vehicle responds.
        ++kept_margins;
        const float extra = s.rules.k_sigma * s.own.sigma_position;
        for (float t = s.rules.latency; t < manoeuvre.path.duration(); t += 0.05F) {
            for (Barrel barrel : s.barrels) {
                barrel.circle.radius += barrel.margin;
                ASSERT_GE(
                    world::barrel_distance(s.limits.half_extents, path::sample(manoeuvre.path, t).position, barrel, t) -
                        extra,
                    -2e-3F)
                    << "seed " << seed << " at " << t;
            }
        }
    }
    EXPECT_GT(found, 1000U);
    EXPECT_GT(outside, 1000U);
    EXPECT_GT(kept_margins, 500U);
    std::printf("[ measured ] %zu of 2000 have a way, %zu begin outside, %zu keep margins\n", found, outside,
                kept_margins);
}

/// A level leg to the east, a cell across it 30 m ahead.
struct LegScene {
    explicit LegScene(float radius, float half_height)
    {
        own.position = {0, 0, 50};
        own.velocity = {5, 0, 0};
        reference = {true, {{0, 0, 50}, {300, 0, 50}, 5.0F}};
        barrels.push_back({{{30.0F + radius, 0.0F}, radius}, {0, 0}, 50.0F - half_height, 50.0F + half_height, 2.0F});
        airspace.barrels = barrels;
    }
    [[nodiscard]] world::Situation view() const
    {
        world::Situation s{now, own, limits, airframe, reference, rules};
        static_cast<void>(threats.collect(s, {.airspace = airspace}));
        s.threats = threats.all();
        return s;
    }
    mutable world::ThreatSet threats;  ///< of the newest view
    TimePoint now{1'000'000};
    world::FlightRules rules;
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::Reference reference;
    std::vector<Barrel> barrels;
    world::Airspace airspace;
};

TEST(BarrelPlans, TheGeometricPlannerSaysThatItHasNone)
{
    const LegScene leg(10.0F, 30.0F);
    geometric::Planner planner{geometric::Settings{}};
    world::Manoeuvre manoeuvre;
    WorkBudget budget(kPlenty);
    EXPECT_EQ(planner.plan(leg.view(), budget, manoeuvre), PlanStatus::none_available);
    EXPECT_TRUE(manoeuvre.path.points.empty());
}

/// Flown for `seconds` under the supervisor's command: the least distance from the body.
template <class Supervisor>
float flown(Supervisor& supervisor, LegScene& leg, Seconds seconds)
{
    constexpr Seconds kStep = 0.05F;
    float least = 1e9F;
    for (float t = 0.0F; t < seconds; t += kStep) {
        const avoid::Guidance guidance = supervisor.update(leg.view(), true);
        const Vec3 command = guidance.wants_control ? guidance.velocity : Vec3(5, 0, 0);
        vehicle::advance(leg.own, command, leg.limits, kStep);
        leg.now = leg.now + kStep;
        for (Barrel& barrel : leg.barrels) {
            barrel.circle.centre += barrel.velocity * kStep;
            least = std::min(least, world::barrel_distance(Vec3::Zero(), leg.own.position, barrel, 0.0F));
        }
    }
    return least;
}

TEST(BarrelPlans, TheReachSetsAreAskedNextAndFlyAround)
{
    LegScene leg(8.0F, 100.0F);
    geometric::Planner first{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, first, barrel_planner()};
    EXPECT_GT(flown(supervisor, leg, 25.0F), 0.7F);
    EXPECT_GT(leg.own.position.x(), 50.0F) << "past it";
    EXPECT_GT(supervisor.diagnostics().found_by_next, 0U);
}

TEST(BarrelPlans, WithTheGeometricPlannerAloneItStopsBeforeIt)
{
    LegScene leg(60.0F, 200.0F);
    geometric::Planner only{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, only};
    EXPECT_GT(flown(supervisor, leg, 20.0F), 0.7F);
    EXPECT_LT(leg.own.position.x(), 30.0F);
}

/// One that comes to a vehicle that cannot plan around it: ground is given.
TEST(BarrelPlans, WithTheGeometricPlannerAloneItGivesWayToAStorm)
{
    LegScene leg(30.0F, 200.0F);
    leg.barrels[0].velocity = {-2, 0};
    geometric::Planner only{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, only};
    EXPECT_GT(flown(supervisor, leg, 40.0F), 0.7F);
}

TEST(BarrelPlans, TooManyAreRefused)
{
    LegScene leg(8.0F, 100.0F);
    leg.barrels.resize(kMaxBarrels + 1, leg.barrels[0]);
    leg.airspace.barrels = leg.barrels;
    world::Manoeuvre manoeuvre;
    WorkBudget budget(kPlenty);
    EXPECT_EQ(barrel_planner().plan(leg.view(), budget, manoeuvre), PlanStatus::bad_input);
}

}  // namespace
}  // namespace jink::reach
