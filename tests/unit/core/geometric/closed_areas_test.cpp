// SPDX-License-Identifier: BSD-3-Clause
// A closed area on the leg, or one that moves across it, is flown around as anything else is.
#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "core/world/cylinder.hpp"
#include "tests/unit/core/geometric/flight.hpp"

namespace jink::geometric {
namespace {

using world::Cylinder;
using world::PlanStatus;

Cylinder area_at(float x, float y, float radius)
{
    Cylinder area;
    area.circle = {{x, y}, radius};
    area.top = 120.0F;
    return area;
}

/// Least distance of the own box from the areas' bodies along the path's chords, each where it is then [m].
float least_distance(const Flight& flight, std::span<const Cylinder> areas)
{
    constexpr int kParts = 20;
    float least = std::numeric_limits<float>::infinity();
    const auto& points = flight.out.path.points;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        for (int k = 0; k <= kParts; ++k) {
            const float share = static_cast<float>(k) / kParts;
            const Vec3 at = points[i].position + share * (points[i + 1].position - points[i].position);
            const Seconds when = points[i].time + share * (points[i + 1].time - points[i].time);
            for (const Cylinder& area : areas) {
                least = std::min(least, cylinder_distance(flight.limits.half_extents, at, area, when));
            }
        }
    }
    return least;
}

TEST(PlanAroundClosedAreas, EitherSideIsLevel)
{
    for (const float radius : {1.0F, 2.0F, 5.0F, 10.0F}) {
        for (const float aside : {-0.5F, 0.0F, 0.5F}) {
            SCOPED_TRACE(testing::Message() << radius << " m, " << aside);
            Flight flight;
            const Cylinder area = area_at(35.0F, aside * radius, radius);
            flight.airspace.cylinders = {&area, 1};
            ASSERT_EQ(flight.plan(), PlanStatus::found);
            EXPECT_GE(least_distance(flight, {&area, 1}), 0.0F);
            EXPECT_NEAR(flight.out.side.z(), 0.0F, 1e-3F) << "it reaches from the ground to 120 m";
            EXPECT_NEAR(flight.out.path.points.back().position.y(), 0.0F, 0.1F) << "back on the leg";
        }
    }
}

/// Where one side is closed as well, the other one is taken; where both are, nothing is.
TEST(PlanAroundClosedAreas, ASideThatIsClosedToo)
{
    const std::array<Cylinder, 3> areas{area_at(35.0F, 0.0F, 4.0F), area_at(35.0F, 34.0F, 30.0F),
                                        area_at(35.0F, -34.0F, 30.0F)};
    Flight flight;
    flight.airspace.cylinders = {areas.data(), 2};
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_LT(flight.out.side.y(), 0.0F);
    EXPECT_GE(least_distance(flight, {areas.data(), 2}), 0.0F);
    Flight between;
    between.airspace.cylinders = areas;
    EXPECT_NE(between.plan(), PlanStatus::found);
}

/// One that ends below the leg is passed over as well as beside.
TEST(PlanAroundClosedAreas, TheSoftMarginIsKeptOffToo)
{
    for (const float radius : {1.0F, 4.0F, 10.0F}) {
        for (const float margin : {1.0F, 4.0F, 8.0F}) {
            SCOPED_TRACE(testing::Message() << radius << " m, soft for " << margin << " m");
            Flight flight;
            Cylinder area = area_at(35.0F, 0.3F * radius, radius);
            area.margin = margin;
            flight.airspace.cylinders = {&area, 1};
            ASSERT_EQ(flight.plan(), PlanStatus::found);
            area.circle.radius += margin;
            EXPECT_GE(least_distance(flight, {&area, 1}), 0.0F);
        }
    }
}

TEST(PlanAroundClosedAreas, TheSoftMarginIsEnteredWhereNothingElseIsLeft)
{
    std::array<Cylinder, 3> areas{area_at(35.0F, 0.0F, 4.0F), area_at(35.0F, 36.0F, 24.0F),
                                  area_at(35.0F, -36.0F, 24.0F)};
    areas[0].margin = 12.0F;
    Flight flight;
    flight.airspace.cylinders = areas;
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GE(least_distance(flight, areas), 0.0F);
}

TEST(PlanAroundClosedAreas, ALowOneIsNoConflictAndOneThatJustReachesTheLegIsOne)
{
    Flight flight;
    Cylinder area = area_at(35.0F, 0.0F, 4.0F);
    area.top = 47.0F;
    flight.airspace.cylinders = {&area, 1};
    EXPECT_EQ(flight.plan(), PlanStatus::no_conflict);
    area.top = 50.0F;
    ASSERT_EQ(flight.plan(), PlanStatus::found);
    EXPECT_GE(least_distance(flight, {&area, 1}), 0.0F);
}

/// At rest or moving, with traffic about: what is found keeps clear of every area, where it is then.
TEST(PlanAroundClosedAreas, RandomOnesAreKeptClearOf)
{
    std::mt19937 random(20261130U);
    const auto in = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    int found = 0;
    int met = 0;
    for (int i = 0; i < 400; ++i) {
        Flight flight;
        std::array<Cylinder, 2> areas{area_at(in(28.0F, 45.0F), 0.0F, in(1.0F, 10.0F)),
                                      area_at(in(10.0F, 60.0F), in(-30.0F, 30.0F), in(1.0F, 8.0F))};
        areas[0].velocity = {in(-2.0F, 2.0F), in(-2.0F, 2.0F)};
        areas[0].circle.centre -= 7.0F * areas[0].velocity;  // on the leg when the vehicle comes
        flight.airspace.cylinders = areas;
        if (i % 2 == 1) {
            flight.add(Vec3(in(20.0F, 60.0F), in(-20.0F, 20.0F), 50.0F), Vec3(in(-4.0F, 4.0F), in(-4.0F, 4.0F), 0.0F),
                       1.0F);
        }
        const PlanStatus status = flight.plan();
        met += status == PlanStatus::no_conflict ? 0 : 1;
        if (status == PlanStatus::found) {
            ++found;
            EXPECT_GE(least_distance(flight, areas), -1e-3F) << i;
        }
    }
    std::printf("[ measured ] %d of %d situations solved\n", found, met);
    EXPECT_GT(found, 0.95 * met);
}

}  // namespace
}  // namespace jink::geometric
