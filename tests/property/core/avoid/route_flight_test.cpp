// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>

#include "core/avoid/supervisor.hpp"
#include "core/geometric/planner.hpp"
#include "tests/oracle/collected.hpp"
#include "tests/oracle/route_oracle.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Flights along routes with bends and corners, the supervisor in control whenever it requests control; otherwise the
// mission flies the route. Judged by the true motion of both.

namespace jink::avoid {
namespace {

using geometry::oracle::case_count;
using geometry::oracle::seed_of;
using jink::oracle::TwinRoute;

struct Flown {
    float least = 1e9F;  ///< margin between the box and the true sphere [m]
    float off = 0.0F;    ///< farthest from the route [m]
    float off_at_end = 0.0F;
    float way_at_end = 0.0F;
    std::uint32_t manoeuvres = 0;
};

Flown fly(const TwinRoute& twin, std::vector<world::Track> tracks, Seconds duration)
{
    constexpr Seconds kTick = 0.05F;
    Settings settings;
    auto planner = std::make_unique<geometric::Planner>(geometric::Settings{});
    auto supervisor = std::make_unique<Supervisor<geometric::Planner>>(settings, *planner);
    vehicle::VehicleLimits limits;
    vehicle::VehicleState own;
    const path::RoutePoint start = twin.route.at(0.0F);
    own.position = start.position;
    own.velocity = 5.0F * start.along;
    world::Reference reference(twin.route, 5.0F);
    const world::Airspace airspace;
    const vehicle::Airframe airframe;
    const world::FlightRules rules;
    Flown flown;
    bool in_control = false;
    for (int tick = 0; tick < static_cast<int>(duration / kTick); ++tick) {
        const TimePoint now{1'000'000 + static_cast<std::int64_t>(tick) * 50'000};
        for (world::Track& track : tracks) {
            track.stamp = now;
        }
        reference.segment = twin.route.abeam_of(own.position, reference.segment).segment;
        const oracle::Collected collected(world::Situation{now, own, limits, airframe, reference, rules},
                                          {tracks, {}, airspace});
        const world::Situation& situation = *collected;
        const Guidance guidance = supervisor->update(situation, in_control);
        in_control = guidance.wants_control;
        const world::Way way = world::way_of(situation);
        const Vec3 mission = way.length > 0.5F ? Vec3(way.direction * way.speed) : Vec3(Vec3::Zero());
        vehicle::advance(own, in_control ? guidance.velocity : mission, limits, kTick);
        for (world::Track& track : tracks) {
            track.position += track.velocity * kTick;
            flown.least = std::min(
                flown.least, geometry::box_distance(limits.half_extents, track.position - own.position) - track.radius);
        }
        const path::Abeam abeam = twin.route.abeam_of(own.position, reference.segment);
        flown.off = std::max(flown.off, abeam.off);
        flown.off_at_end = abeam.off;
        flown.way_at_end = abeam.arc_length;
    }
    flown.manoeuvres = supervisor->diagnostics().manoeuvres;
    return flown;
}

world::Track traffic(const Vec3& position, const Vec3& velocity)
{
    world::Track track;
    track.id = 1;
    track.position = position;
    track.velocity = velocity;
    track.radius = 1.0F;
    return track;
}

/// Traffic comes down the second leg; the encounter is where the mission turns. A prediction along the first leg does
/// not extend behind the corner.
TEST(RouteFlight, TrafficBehindTheCornerIsAvoided)
{
    TwinRoute twin;
    ASSERT_TRUE(twin.leg(Vec3(0, 0, 30), Vec3(60, 0, 30)));
    ASSERT_TRUE(twin.leg(Vec3(60, 0, 30), Vec3(60, 150, 30)));
    // Head-on on the second leg, 20 m behind the corner.
    const Flown flown = fly(twin, {traffic(Vec3(60, 100, 30), Vec3(0, -5, 0))}, 36.0F);
    EXPECT_GE(flown.manoeuvres, 1U);
    EXPECT_GE(flown.least, 0.0F);
    EXPECT_LE(flown.off_at_end, 1.0F);
    EXPECT_GT(flown.way_at_end, 100.0F);
    EXPECT_LE(flown.off, 10.0F);
}

TEST(RouteFlight, CurvedLegsAreFlownWithoutTraffic)
{
    TwinRoute twin;
    ASSERT_TRUE(twin.leg(Vec3(0, 0, 30), Vec3(30, 0, 30)));
    ASSERT_TRUE(twin.arc(Vec3(30, 0, 30), Vec3(30, 15, 30), Vec3::UnitZ(), kPi));
    ASSERT_TRUE(twin.leg(Vec3(30, 30, 30), Vec3(-30, 30, 30)));
    const Flown flown = fly(twin, {}, 26.0F);
    EXPECT_EQ(flown.manoeuvres, 0U);
    EXPECT_LE(flown.off, 1.0F);
    EXPECT_GT(flown.way_at_end, 120.0F);
}

TEST(RouteFlight, RandomRoutesWithTraffic)
{
    const std::uint64_t seed = seed_of(20261134);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t met = 0;
    std::size_t touched = 0;
    std::size_t back = 0;
    std::size_t flights = 0;
    for (std::size_t i = 0; i < case_count(150); ++i) {
        const TwinRoute twin = jink::oracle::random_route(random, Vec3(0, 0, 60), true, 1.0F);
        if (twin.length() < 60.0) {
            continue;
        }
        ++flights;
        const auto way = random.uniform(30.0F, std::min(static_cast<float>(twin.length()), 90.0F));
        const float course = random.uniform(-kPi, kPi);
        const Vec3 velocity = random.uniform(0.0F, 5.0F) * Vec3(std::cos(course), std::sin(course), 0.0F);
        const Vec3 at = twin.route.at(way).position - way / 5.0F * velocity;
        const Flown flown = fly(twin, {traffic(at, velocity)}, std::min(way / 5.0F + 14.0F, 40.0F));
        met += flown.manoeuvres > 0 ? 1U : 0U;
        touched += flown.least < 0.0F ? 1U : 0U;
        back += flown.off_at_end <= 1.5F ? 1U : 0U;
    }
    std::printf("[ measured ] %zu flights, %zu with manoeuvres, %zu touched, %zu back on the route\n", flights, met,
                touched, back);
    EXPECT_GT(met * 2, flights);
    EXPECT_EQ(touched, 0U);
    EXPECT_GT(back * 10, flights * 8);
}

}  // namespace
}  // namespace jink::avoid
