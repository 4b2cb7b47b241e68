// SPDX-License-Identifier: BSD-3-Clause
// Against spherical trigonometry in double precision.
#include "firmware/link/mavlink/geodesy.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "core/base/random.hpp"

namespace jink::link::mavlink {
namespace {

constexpr double kRadius = 6378137.0;
constexpr double kRad = 3.14159265358979323846 / 180.0 * 1e-7;

/// Offset by great circle: distance and bearing from `o`, as east and north.
std::array<double, 2> great_circle(const GlobalPosition& p, const GlobalPosition& o)
{
    const double lat0 = o.lat * kRad;
    const double lat = p.lat * kRad;
    const double dlon = (static_cast<double>(p.lon) - o.lon) * kRad;
    const double bearing = std::atan2(std::sin(dlon) * std::cos(lat),
                                      std::cos(lat0) * std::sin(lat) - std::sin(lat0) * std::cos(lat) * std::cos(dlon));
    const double a =
        std::pow(std::sin((lat - lat0) / 2), 2) + std::cos(lat0) * std::cos(lat) * std::pow(std::sin(dlon / 2), 2);
    const double distance = 2 * kRadius * std::asin(std::sqrt(a));
    return {distance * std::sin(bearing), distance * std::cos(bearing)};
}

TEST(MavlinkGeodesy, SwapsAreTheirOwnInverse)
{
    EXPECT_EQ(swap_ned_enu({1, 2, 3}), Vec3(2, 1, -3));
    EXPECT_EQ(swap_ned_enu(swap_ned_enu({1, 2, 3})), Vec3(1, 2, 3));
    EXPECT_FLOAT_EQ(swap_heading_yaw(0.0F), kPi / 2);
    EXPECT_FLOAT_EQ(swap_heading_yaw(kPi / 2), 0.0F);
    EXPECT_NEAR(swap_heading_yaw(swap_heading_yaw(1.25F)), 1.25F, 1e-6F);
}

/// Largest distance from the great circle for places within 10 km of origins up to `latitude` degrees [m].
double worst_map_error(float latitude)
{
    Random random(21);
    double worst = 0.0;
    for (int i = 0; i < 50'000; ++i) {
        const GlobalPosition origin{static_cast<std::int32_t>(random.uniform(-latitude, latitude) * 1e7F),
                                    static_cast<std::int32_t>(random.uniform(-180.0F, 180.0F) * 1e7F), 100'000};
        const double bearing = static_cast<double>(random.uniform(0.0F, 2 * kPi));
        const double distance = 10'000.0 * std::sqrt(static_cast<double>(random.uniform()));
        // a place there, to the wire's unit, by spherical trigonometry
        const double lat0 = origin.lat * kRad;
        const double c = distance / kRadius;
        const double lat = std::asin(std::sin(lat0) * std::cos(c) + std::cos(lat0) * std::sin(c) * std::cos(bearing));
        const double dlon =
            std::atan2(std::sin(bearing) * std::sin(c) * std::cos(lat0), std::cos(c) - std::sin(lat0) * std::sin(lat));
        const double lon = std::remainder(origin.lon + dlon / kRad, 3.6e9);
        const GlobalPosition p{static_cast<std::int32_t>(std::lround(lat / kRad)),
                               static_cast<std::int32_t>(std::lround(lon)), 150'000};
        const Vec3 local = to_local(p, origin);
        const auto truth = great_circle(p, origin);
        EXPECT_FLOAT_EQ(local.z(), 50.0F);
        worst = std::max(
            worst, std::hypot(static_cast<double>(local.x()) - truth[0], static_cast<double>(local.y()) - truth[1]));
    }
    return worst;
}

TEST(MavlinkGeodesy, AgreesWithTheGreatCircleAsStated)
{
    const double usual = worst_map_error(60.0F);
    const double polar = worst_map_error(85.0F);
    std::printf("local map within 10 km: %.3f m up to 60 degrees of latitude, %.3f m up to 85\n", usual, polar);
    EXPECT_LT(usual, static_cast<double>(kMapError));
    EXPECT_LT(polar, static_cast<double>(kPolarMapError));
}

TEST(MavlinkGeodesy, ThereAndBackIsExactToTheMapsError)
{
    Random random(22);
    for (int i = 0; i < 50'000; ++i) {
        const GlobalPosition origin{static_cast<std::int32_t>(random.uniform(-60.0F, 60.0F) * 1e7F),
                                    static_cast<std::int32_t>(random.uniform(-180.0F, 180.0F) * 1e7F), 0};
        const Vec3 wanted(random.uniform(-7000.0F, 7000.0F), random.uniform(-7000.0F, 7000.0F),
                          random.uniform(-100.0F, 100.0F));
        const auto p = to_global(wanted, origin);
        ASSERT_TRUE(p.has_value());
        ASSERT_TRUE(is_on_earth(*p));
        ASSERT_LT((to_local(*p, origin) - wanted).norm(), kMapError) << i;
    }
}

TEST(MavlinkGeodesy, TheDateLineIsNoWall)
{
    const GlobalPosition west{0, 1799999000, 0};
    const GlobalPosition east{0, -1799999000, 0};
    EXPECT_NEAR(to_local(east, west).x(), 2000 * 0.0111319F, 0.01F);
    EXPECT_NEAR(to_local(west, east).x(), -2000 * 0.0111319F, 0.01F);
    const auto across = to_global({100, 0, 0}, west);
    ASSERT_TRUE(across.has_value());
    EXPECT_LT(across->lon, 0);
    EXPECT_TRUE(is_on_earth(*across));
}

TEST(MavlinkGeodesy, WhatIsOnEarth)
{
    EXPECT_TRUE(is_on_earth({900000000, 1800000000, 0}));
    EXPECT_TRUE(is_on_earth({-900000000, -1800000000, 0}));
    EXPECT_FALSE(is_on_earth({900000001, 0, 0}));
    EXPECT_FALSE(is_on_earth({-900000001, 0, 0}));
    EXPECT_FALSE(is_on_earth({0, 1800000001, 0}));
    EXPECT_FALSE(is_on_earth({0, -1800000001, 0}));
}

TEST(MavlinkGeodesy, NoMapNearThePoles)
{
    EXPECT_FALSE(to_global({0, 0, 0}, {900000000, 0, 0}).has_value());
    EXPECT_FALSE(to_global({0, 0, 0}, {-850000001, 0, 0}).has_value());
    EXPECT_TRUE(to_global({0, 0, 0}, {850000000, 0, 0}).has_value());
    EXPECT_FALSE(to_global({0, 200, 0}, {850000000, 0, 0}).has_value());
    EXPECT_FALSE(to_global({0, 0, 1e6F}, {0, 0, 500'000'000}).has_value());
}

}  // namespace
}  // namespace jink::link::mavlink
