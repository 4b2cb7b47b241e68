// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/world/route_way.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world::test {

/// A route that a test adds legs and turns to, flown at 5 m/s from the origin.
struct RoutePiecesTest : testing::Test {
    RoutePiecesTest()
    {
        scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
        scene.reference = world::Reference(route, scene.reference.speed);
    }
    void leg(const Vec3& from, const Vec3& to) { ASSERT_EQ(route.add_leg(from, to), path::RouteStatus::ok); }
    /// Level, from the end of the route about a centre to its left, or to its right where `angle` is negative.
    void turn(float radius, float angle)
    {
        const path::RoutePoint end = route.at(route.length());
        const Vec3 left = Vec3::UnitZ().cross(end.along);
        const Vec3 centre = end.position + (angle > 0.0F ? radius : -radius) * left;
        ASSERT_EQ(route.add_arc(end.position, centre, Vec3::UnitZ(), angle), path::RouteStatus::ok);
    }
    [[nodiscard]] Way way() const { return way_of(scene.situation()); }
    [[nodiscard]] detail::RoutePieces pieces(const Way& of, Seconds lookahead) const
    {
        return detail::RoutePieces(scene.situation(), of, lookahead);
    }
    /// Consecutive pieces, each with a duration, until the look-ahead.
    static void follow_on(const detail::RoutePieces& all, Seconds lookahead)
    {
        ASSERT_GT(all.size(), 0U);
        ASSERT_LE(all.size(), detail::kWayPieces);
        for (std::size_t i = 0; i < all.size(); ++i) {
            EXPECT_EQ(all[i].start, i == 0 ? 0.0F : all[i - 1].end) << i;
            EXPECT_GT(all[i].end, all[i].start) << i;
        }
        EXPECT_EQ(all[all.size() - 1].end, lookahead);
    }
    /// How far the middle of a chord of `length` lies off a circle.
    static float sagitta(float radius, float length) { return radius * (1.0F - std::cos(0.5F * length / radius)); }

    path::Route route;
    Scene scene;
};

}  // namespace jink::world::test
