// SPDX-License-Identifier: BSD-3-Clause
// Cost tables against the formulas in double, over random curves on random legs.
#include "core/cost/tables.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"
#include "firmware/vehicles/uav2/cost_tables.hpp"
#include "firmware/vehicles/uav2/vehicle.hpp"
#include "tests/oracle/cost_oracle.hpp"

namespace jink::cost::tables {
namespace {

using oracle::P3;
using oracle::operator*;
using oracle::operator+;
using oracle::operator-;

/// Inputs are rounded to float; and heights over a low limit are many times the length over the speed.
constexpr double kRounding = 3e-6;

double wide(float value) { return static_cast<double>(value); }

/// Offset for D = w = 1, by family.
double unit_offset(std::size_t family, double u)
{
    const double v = family > 0 && u > 1.0 ? 2.0 - u : u;
    return family < 2 ? 3.0 * v * v - 2.0 * v * v * v
                      : 10.0 * std::pow(v, 3) - 15.0 * std::pow(v, 4) + 6.0 * std::pow(v, 5);
}

struct Case {
    CurveQuery query;
    std::vector<P3> points;
    std::vector<double> x, y;
};

/// Any family, plane, ratio of the domain and leg; distances of 0.5 to 60 m.
Case draw(Random& random, const Tables& tables)
{
    Case c;
    CurveQuery& q = c.query;
    q.family = static_cast<std::size_t>(random.below(3));
    q.distance = random.uniform(0.5F, 60.0F);
    q.offset = random.uniform(-kLargestRatio, kLargestRatio) * q.distance;
    constexpr double kHalf = 0.5 * std::numbers::pi;
    // A leg in five is level or a plane upright: the most common cases.
    const double elevation = random.below(5) == 0 ? 0.0 : wide(random.uniform(-1.0F, 1.0F)) * kHalf;
    const double plane = random.below(5) == 0 ? kHalf : wide(random.uniform(0.0F, 2.0F)) * kHalf;
    const double heading = wide(random.uniform(0.0F, 6.0F));
    const P3 along{std::cos(elevation) * std::cos(heading), std::cos(elevation) * std::sin(heading),
                   std::sin(elevation)};
    const P3 level{-std::sin(heading), std::cos(heading), 0.0};
    const P3 up = oracle::cross(along, level);
    const P3 side = std::cos(plane) * level + std::sin(plane) * up;
    q.along_z = static_cast<float>(along[2]);
    q.side_z = static_cast<float>(side[2]);
    const double length = q.family == 0 ? 1.5 : 2.0;
    for (int i = 0; i < tables.waypoints; ++i) {
        const double u = length * i / (tables.waypoints - 1);
        c.x.push_back(wide(q.distance) * u);
        c.y.push_back(wide(q.offset) * unit_offset(q.family, u));
        c.points.push_back(c.x.back() * along + c.y.back() * side);
    }
    return c;
}

double length_of(const oracle::Flight& flight)
{
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < flight.p.size(); ++i) {
        sum += oracle::length(flight.p[i + 1] - flight.p[i]);
    }
    return sum;
}

oracle::Vehicle figures_of(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe)
{
    oracle::Vehicle figures;
    figures.climb = wide(limits.max_climb);
    figures.descent = wide(limits.max_descent);
    figures.mass = wide(airframe.mass);
    figures.drag = wide(airframe.drag_coefficient);
    figures.area = wide(airframe.effective_area);
    figures.density = wide(airframe.air_density);
    return figures;
}

void expect_within(double found, double exact, float bound, const char* what, std::uint64_t seed)
{
    EXPECT_NEAR(found, exact, std::abs(exact) * (wide(bound) + kRounding)) << what << ", seed " << seed;
}

void hold_against_formulas(const Tables& tables, oracle::Vehicle figures, bool with_energy, std::uint64_t seed)
{
    Random random(seed);
    Case c = draw(random, tables);
    constexpr std::array<float, 3> kShares{1.0F, 0.6F, 0.3F};
    c.query.speed = kShares[random.below(3)] * tables.cruise_speed;
    figures.speed = wide(c.query.speed);
    const oracle::Flight flight = oracle::fly(c.points, figures);
    const Bounds& bounds = tables.families[c.query.family].bounds;
    const auto found = estimate(tables, c.query);
    ASSERT_TRUE(found) << seed;
    expect_within(wide(found->length), length_of(flight), bounds.length, "length", seed);
    expect_within(wide(found->time), flight.t.back(), bounds.time, "time", seed);
    expect_within(wide(found->smoothness), oracle::smoothness(c.x, c.y), bounds.smoothness, "smoothness", seed);
    if (with_energy) {
        const auto joules = energy(tables, c.query);
        ASSERT_TRUE(joules) << seed;
        expect_within(wide(*joules), oracle::energy(flight, figures), bounds.energy, "energy", seed);
    }
}

TEST(CostTables, TheDefaultVehicleIsWithinItsBounds)
{
    const oracle::Vehicle figures = figures_of({}, {});
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        hold_against_formulas(kDefault, figures, true, seed);
    }
}

TEST(CostTables, TheSecondVehicleIsWithinItsBounds)
{
    const oracle::Vehicle figures = figures_of(vehicle::uav2_limits(), vehicle::uav2_airframe());
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        hold_against_formulas(kUav2, figures, true, seed);
    }
}

TEST(CostTables, LengthAndTimeHoldForAnyLimits)
{
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        Random random(seed * 31);
        vehicle::VehicleLimits limits;
        limits.cruise_speed = random.uniform(0.5F, 30.0F);
        limits.max_climb = limits.cruise_speed * random.uniform(0.05F, 1.2F);
        limits.max_descent = limits.cruise_speed * random.uniform(0.05F, 1.2F);
        hold_against_formulas(with_limits(kDefault, limits, {}), figures_of(limits, {}), false, seed);
    }
}

TEST(CostTables, TheSideCountsOnlyWhereTheWorldsVerticalDoes)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        CurveQuery q = draw(random, kDefault).query;
        q.speed = 5.0F;
        const auto here = estimate(kDefault, q);
        q.offset = -q.offset;
        q.side_z = -q.side_z;
        const auto there = estimate(kDefault, q);
        ASSERT_TRUE(here && there);
        EXPECT_EQ(here->length, there->length) << seed;
        EXPECT_EQ(here->time, there->time) << seed;
        EXPECT_EQ(here->smoothness, there->smoothness) << seed;
        EXPECT_EQ(energy(kDefault, q),
                  energy(kDefault, {q.family, -q.offset, q.distance, q.speed, q.along_z, -q.side_z}))
            << seed;
    }
}

TEST(CostTables, FurtherAsideIsLongerSlowerAndSharper)
{
    for (std::size_t family = 0; family < kDefault.families.size(); ++family) {
        for (const float side_z : {0.0F, 0.5F, -1.0F}) {
            CurveQuery q{family, 0.0F, 10.0F, 5.0F, 0.0F, side_z};
            Estimate before = *estimate(kDefault, q);
            for (int i = 1; i <= 1280; ++i) {
                q.offset = 0.01F * static_cast<float>(i);
                const Estimate now = *estimate(kDefault, q);
                EXPECT_GT(now.length, before.length - 1e-5F) << family << ' ' << i;
                EXPECT_GT(now.time, before.time - 1e-5F) << family << ' ' << i;
                before = now;
            }
        }
    }
}

TEST(CostTables, TimeAndLengthGrowWithTheDistanceAndSmoothnessFalls)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        CurveQuery q = draw(random, kUav2).query;
        q.speed = 9.0F;
        const auto once = estimate(kUav2, q);
        q.distance *= 4.0F;
        q.offset *= 4.0F;
        const auto four = estimate(kUav2, q);
        ASSERT_TRUE(once && four);
        EXPECT_EQ(four->length, 4.0F * once->length) << seed;
        EXPECT_EQ(four->time, 4.0F * once->time) << seed;
        EXPECT_EQ(4.0F * four->smoothness, once->smoothness) << seed;
    }
}

}  // namespace
}  // namespace jink::cost::tables
