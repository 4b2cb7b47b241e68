// SPDX-License-Identifier: BSD-3-Clause
// Named scenes. Unless a test says otherwise the vehicle is at (0, 0, 30) on a level leg east, at 5 m/s; it climbs and
// descends at 3 m/s.
#include "core/world/cost_to_go_field.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/unit/core/world/field_scene.hpp"

namespace jink::world {
namespace {

using test::field_of;
using test::FieldScene;
using test::kOwn;
using test::lost;

/// All places that a vehicle comes by that follows the way in steps of about `distance`.
std::vector<Vec3> way_from(const CostToGoField& field, Vec3 at, float distance = 3.0F)
{
    std::vector<Vec3> way{at};
    while (const std::optional<Vec3> next = field.way_around(at, distance)) {
        at = *next;
        way.push_back(at);
        if (way.size() > 200) {
            ADD_FAILURE() << "it does not end";
            break;
        }
    }
    return way;
}

template <class Value>
float most_of(const std::vector<Vec3>& way, const Value& value)
{
    float most = value(way.front());
    for (const Vec3& at : way) {
        most = std::max(most, value(at));
    }
    return most;
}

TEST(CostToGoField, LeadsBackOutOfAPocket)
{
    FieldScene scene;
    scene.pocket();
    const auto field = field_of(scene);
    // 10 m back, out by 10 m, and forward again.
    EXPECT_GT(lost(*field, kOwn), 4.0F);
    EXPECT_GT(lost(*field, kOwn + Vec3(6, 0, 0)), lost(*field, kOwn) + 1.0F) << "deeper in it";
    EXPECT_EQ(lost(*field, Vec3(16, 0, 30)), 0.0F) << "past it";
    const std::optional<Vec3> first = field->way_around(kOwn, 6.0F);
    ASSERT_TRUE(first);
    EXPECT_LT(first->x(), -3.0F);
    const auto way = way_from(*field, kOwn);
    EXPECT_LT(-most_of(way, [](const Vec3& at) { return -at.x(); }), -11.0F);
    EXPECT_GT(most_of(way, [](const Vec3& at) { return std::abs(at.y()); }), 9.0F);
}

/// Walls at any angle to the grid are tight, for a small vehicle too: nothing slips diagonally between two cells.
TEST(CostToGoField, ThinWallsAreTightAtAnyAngle)
{
    for (const float half : {0.2F, 0.5F, 1.0F}) {
        for (int degrees = 0; degrees < 360; degrees += 9) {
            FieldScene scene;
            scene.limits.half_extents = Vec3(half, half, 0.1F);
            const float yaw = static_cast<float>(degrees) * kPi / 180.0F;
            const Vec3 along = Eigen::AngleAxisf(yaw, Vec3::UnitZ()) * Vec3::UnitX();
            scene.leg(kOwn, kOwn + 100.0F * along);
            scene.pocket(yaw);
            const auto field = field_of(scene);
            EXPECT_GT(lost(*field, kOwn), 3.0F) << half << " m, " << degrees;
            const std::optional<Vec3> first = field->way_around(kOwn, 8.0F);
            ASSERT_TRUE(first) << half << " m, " << degrees;
            EXPECT_LT((*first - kOwn).dot(along), -3.0F) << half << " m, " << degrees;
        }
    }
}

TEST(CostToGoField, GoesThroughAGap)
{
    FieldScene scene;
    scene.box(Vec3(12, 34, 30), Vec3(0.5F, 30, 40));
    scene.box(Vec3(12, -26, 30), Vec3(0.5F, 22, 40));
    scene.box(Vec3(12, -60, 30), Vec3(0.5F, 6, 40));
    const auto field = field_of(scene);
    EXPECT_LT(lost(*field, kOwn), 0.1F) << "8 m wide, ahead";
    scene.box(Vec3(12, 0, 30), Vec3(0.5F, 5, 40));
    scene.obstacles[1].shape = geometry::make_box(Vec3(12, -32, 30), Vec3(0.5F, 16, 40));
    const auto closed = field_of(scene);
    EXPECT_GT(lost(*closed, kOwn), 1.0F);
    const auto way = way_from(*closed, kOwn);
    EXPECT_NEAR(way.back().y(), -10.5F, 4.5F) << "before the gap";
    EXPECT_GT(way.back().x(), 6.0F);
}

/// 60 m wide and 5 m higher than the vehicle: over it, unless a ceiling forbids that.
TEST(CostToGoField, GoesOverAWallUnlessACeilingForbidsIt)
{
    FieldScene scene;
    scene.box(Vec3(14, 0, 15), Vec3(1, 24, 20));
    const auto over = field_of(scene);
    const auto high = way_from(*over, kOwn);
    EXPECT_GE(most_of(high, [](const Vec3& at) { return at.z(); }), 36.5F);
    EXPECT_LT(most_of(high, [](const Vec3& at) { return std::abs(at.y()); }), 20.0F);
    // 2 * 7.5 m of climb at 3 m/s.
    EXPECT_NEAR(lost(*over, kOwn), 5.0F, 1.0F);
    scene.airspace.has_ceiling = true;
    scene.airspace.ceiling = 36.0F;
    const auto beside = field_of(scene);
    EXPECT_GT(lost(*beside, kOwn), lost(*over, kOwn) + 0.5F);
    const auto level = way_from(*beside, kOwn);
    EXPECT_LT(most_of(level, [](const Vec3& at) { return at.z(); }), 34.0F);
    EXPECT_GT(most_of(level, [](const Vec3& at) { return std::abs(at.y()); }), 24.0F);
}

TEST(CostToGoField, GoesUnderABridgeUnlessAFloorForbidsIt)
{
    FieldScene scene;
    scene.box(Vec3(14, 0, 45), Vec3(1, 24, 17));
    const auto under = field_of(scene);
    EXPECT_LE(-most_of(way_from(*under, kOwn), [](const Vec3& at) { return -at.z(); }), 26.0F);
    scene.airspace.has_floor = true;
    scene.airspace.floor = 25.0F;
    const auto beside = field_of(scene);
    EXPECT_GT(-most_of(way_from(*beside, kOwn), [](const Vec3& at) { return -at.z(); }), 26.4F);
}

TEST(CostToGoField, KeepsInsideTheFence)
{
    FieldScene scene;
    // Nearer to go round in the north.
    scene.box(Vec3(12, -3, 30), Vec3(1, 10, 40));
    EXPECT_GT(most_of(way_from(*field_of(scene), kOwn), [](const Vec3& at) { return at.y(); }), 8.0F);
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(12, -95, 0);
    scene.airspace.keep_in_radius = 103.0F;  // to y = 8 at x = 12
    const auto field = field_of(scene);
    const auto way = way_from(*field, kOwn);
    EXPECT_LT(most_of(way, [](const Vec3& at) { return at.y(); }), 6.5F);
    EXPECT_GT(most_of(way, [](const Vec3& at) { return -at.y(); }), 14.0F);
}

TEST(CostToGoField, GoesRoundAClosedAreaAndOverALowOne)
{
    FieldScene scene;
    scene.cylinder(Vec2(14, 0), 8.0F);
    scene.cylinders[0].top = 100.0F;
    const auto round = way_from(*field_of(scene), kOwn);
    EXPECT_GT(most_of(round, [](const Vec3& at) { return std::abs(at.y()); }), 8.0F);
    scene.cylinders[0].circle = {Vec2(36, 0), 24.0F};
    scene.cylinders[0].top = 32.0F;
    const auto over = way_from(*field_of(scene), kOwn);
    EXPECT_GE(most_of(over, [](const Vec3& at) { return at.z(); }), 33.5F);
    EXPECT_LT(most_of(over, [](const Vec3& at) { return std::abs(at.y()); }), 4.0F);
    scene.cylinders[0].top = 25.0F;
    EXPECT_EQ(lost(*field_of(scene), kOwn), 0.0F) << "below the way";
}

/// An upright capsule is as tall as it is, and a tilted one too.
TEST(CostToGoField, MastsBlockAllOfTheirHeight)
{
    for (const float tilt : {0.0F, 0.01F}) {
        FieldScene scene;
        scene.obstacle(geometry::make_capsule(Vec3(10, 0, 0), Vec3(10 + tilt, 0, 90), 1.0F));
        const auto field = field_of(scene);
        EXPECT_GT(lost(*field, kOwn), 0.1F) << tilt;
        EXPECT_GT(lost(*field, kOwn + Vec3(0, 0, 10)), 0.1F) << tilt;
        EXPECT_GT(lost(*field, kOwn - Vec3(0, 0, 10)), 0.1F) << tilt;
    }
}

TEST(CostToGoField, LeadsToTheRoutesEndBehindAHouse)
{
    FieldScene scene;
    scene.leg(Vec3(-10, 0, 30), Vec3(20, 0, 30));
    scene.box(Vec3(10, 0, 20), Vec3(3, 6, 30));
    const auto field = field_of(scene);
    EXPECT_GT(lost(*field, kOwn), 0.5F);
    EXPECT_LT(lost(*field, kOwn), 4.0F) << "not by way of the grid's sides";
    EXPECT_EQ(lost(*field, Vec3(20, 0, 30)), 0.0F);
    EXPECT_EQ(lost(*field, Vec3(18, 4, 30)), 0.0F);
    const Vec3 last = way_from(*field, kOwn).back();
    EXPECT_LT(std::abs(last.y()), 11.0F);
    EXPECT_GT(last.x(), 2.0F);
    // From beyond the end the way leads back.
    scene.box(Vec3(26, 0, 20), Vec3(1, 6, 30));
    const auto back = field_of(scene);
    const std::optional<Vec3> way = back->way_around(Vec3(30, 0, 30), 4.0F);
    ASSERT_TRUE(way);
    EXPECT_GT(std::abs(way->y()), 1.5F);
    EXPECT_LT(way_from(*back, Vec3(30, 0, 30)).back().x(), 28.5F);
}

/// Where the end lies in an obstacle, the free cells nearest to it are led to.
TEST(CostToGoField, LeadsUpToAGoalInsideAnObstacle)
{
    FieldScene scene;
    scene.leg(Vec3(-10, 0, 30), Vec3(18, 0, 30));
    scene.box(Vec3(22, 0, 20), Vec3(6, 14, 40));
    const auto field = field_of(scene);
    EXPECT_LT(lost(*field, kOwn), 0.1F);
    EXPECT_LT(lost(*field, Vec3(12, 0, 30)), 0.1F);
    EXPECT_GT(lost(*field, Vec3(30, 0, 30)), 1.0F) << "behind it: round to this side, which is the nearest";
}

/// A leg straight up or down leaves the grid by its top or its bottom.
TEST(CostToGoField, VerticalLegsLeaveByTheTopOrTheBottom)
{
    for (const float up : {-1.0F, 1.0F}) {
        FieldScene scene;
        scene.leg(kOwn, kOwn + Vec3(0, 0, 100.0F * up));
        scene.box(Vec3(20, 0, 30), Vec3(2, 2, 40));
        const auto aside = field_of(scene);
        EXPECT_NEAR(lost(*aside, kOwn), 0.0F, 1e-3F);
        EXPECT_FALSE(aside->way_around(kOwn, 6.0F));
        scene.box(kOwn + Vec3(0, 0, 8.0F * up), Vec3(6, 3, 1));
        const auto roof = field_of(scene);
        // 5 m out and back at 5 m/s.
        EXPECT_NEAR(lost(*roof, kOwn), 2.4F, 1.0F);
        EXPECT_GT(most_of(way_from(*roof, kOwn), [](const Vec3& at) { return std::abs(at.y()); }), 3.9F);
    }
}

}  // namespace
}  // namespace jink::world
