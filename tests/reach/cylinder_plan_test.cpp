// SPDX-License-Identifier: BSD-3-Clause
// Closed airspace and storm cells ahead of the planners: found manoeuvres keep out of bodies by the supervisor's
// measure, and a vehicle without an avoidance manoeuvre stops before them.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/avoid/final_check.hpp"
#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/threat_set.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

namespace jink::reach {
namespace {

using oracle::RandomSituation;
using world::Cylinder;
using world::PlanStatus;

constexpr std::uint32_t kPlenty = 1'000'000;

Settings cylinder_settings()
{
    Settings settings;
    settings.sets = &test::unit_sets();
    return settings;
}

Planner& cylinder_planner()
{
    static Planner one{cylinder_settings()};
    return one;
}

/// Cylinders in place of everything else, some of them on the path.
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
            Cylinder cylinder;
            cylinder.circle.radius = random.uniform(1.0F, 12.0F);
            cylinder.circle.centre = (own.position + own.velocity * t).head<2>() + off - velocity * t;
            cylinder.velocity = velocity;
            cylinder.bottom = own.position.z() - random.uniform(-2.0F, 20.0F);
            cylinder.top = cylinder.bottom + random.uniform(1.0F, 40.0F);
            cylinder.margin = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 5.0F);
            cylinders.push_back(cylinder);
        }
        airspace.cylinders = cylinders;
    }
    std::vector<Cylinder> cylinders;
};

TEST(CylinderPlans, WhatIsFoundKeepsOutOfBodies)
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
        const PlanStatus status = cylinder_planner().plan(s.view(), budget, manoeuvre);
        if (status != PlanStatus::found) {
            ASSERT_EQ(status, PlanStatus::none_available) << "seed " << seed;
            continue;
        }
        ++found;
        ASSERT_GE(world::least_separation(s.view(), manoeuvre.path, 100.0F, budget).margin, -2e-3F) << "seed " << seed;
        if (cylinder_planner().last().run != AvoidanceRun::soft_constraints || inside) {
            continue;
        }
        // In the strictest run margins are kept as well, except before the vehicle responds.
        ++kept_margins;
        const float extra = s.rules.k_sigma * s.own.sigma_position;
        for (float t = s.rules.latency; t < manoeuvre.path.duration(); t += 0.05F) {
            for (Cylinder cylinder : s.cylinders) {
                cylinder.circle.radius += cylinder.margin;
                ASSERT_GE(world::cylinder_distance(s.limits.half_extents, path::sample(manoeuvre.path, t).position,
                                                   cylinder, t) -
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
        reference = world::Reference({{0, 0, 50}, {300, 0, 50}, 5.0F});
        cylinders.push_back({{{30.0F + radius, 0.0F}, radius}, {0, 0}, 50.0F - half_height, 50.0F + half_height, 2.0F});
        airspace.cylinders = cylinders;
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
    std::vector<Cylinder> cylinders;
    world::Airspace airspace;
};

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
        for (Cylinder& cylinder : leg.cylinders) {
            cylinder.circle.centre += cylinder.velocity * kStep;
            least = std::min(least, world::cylinder_distance(Vec3::Zero(), leg.own.position, cylinder, 0.0F));
        }
    }
    return least;
}

TEST(CylinderPlans, TheReachSetsAloneFlyAround)
{
    LegScene leg(8.0F, 100.0F);
    avoid::Supervisor supervisor{avoid::Settings{}, cylinder_planner()};
    EXPECT_GT(flown(supervisor, leg, 25.0F), 0.7F);
    EXPECT_GT(leg.own.position.x(), 50.0F) << "past it";
}

TEST(CylinderPlans, TheReachSetsBehindTheGeometricPlannerHarmNoWayAround)
{
    LegScene leg(8.0F, 100.0F);
    geometric::Planner first{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, first, cylinder_planner()};
    EXPECT_GT(flown(supervisor, leg, 25.0F), 0.7F);
    EXPECT_GT(leg.own.position.x(), 50.0F) << "past it";
}

TEST(CylinderPlans, WithTheGeometricPlannerAloneItStopsBeforeIt)
{
    LegScene leg(60.0F, 200.0F);
    geometric::Planner only{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, only};
    EXPECT_GT(flown(supervisor, leg, 20.0F), 0.7F);
    EXPECT_LT(leg.own.position.x(), 30.0F);
}

/// One that comes to a vehicle that cannot plan around it: ground is given.
TEST(CylinderPlans, WithTheGeometricPlannerAloneItGivesWayToAStorm)
{
    LegScene leg(30.0F, 200.0F);
    leg.cylinders[0].velocity = {-2, 0};
    geometric::Planner only{geometric::Settings{}};
    avoid::Supervisor supervisor{avoid::Settings{}, only};
    EXPECT_GT(flown(supervisor, leg, 40.0F), 0.7F);
}

TEST(CylinderPlans, TooManyAreRefused)
{
    LegScene leg(8.0F, 100.0F);
    leg.cylinders.resize(kMaxCylinders + 1, leg.cylinders[0]);
    leg.airspace.cylinders = leg.cylinders;
    world::Manoeuvre manoeuvre;
    WorkBudget budget(kPlenty);
    EXPECT_EQ(cylinder_planner().plan(leg.view(), budget, manoeuvre), PlanStatus::bad_input);
}

}  // namespace
}  // namespace jink::reach
