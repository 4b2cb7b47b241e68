// SPDX-License-Identifier: BSD-3-Clause
// Nearest points, against the solids' extreme points.
#include <array>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/geometry/shape.hpp"

namespace jink::geometry {
namespace {

Vec3 any(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Shape any_shape(Random& random)
{
    const Vec3 a = any(random, 20.0F);
    const float radius = random.uniform(0.1F, 4.0F);
    const Vec3 axis = any(random, 1.0F).normalized();
    const Vec3 other = axis.unitOrthogonal();
    Mat3 axes;
    axes << other, axis.cross(other), axis;
    switch (random.below(4)) {
    case 0: return make_sphere(a, radius);
    case 1: return make_capsule(a, a + any(random, 6.0F), radius);
    case 2: return make_box(a, Vec3::Constant(0.1F) + any(random, 3.0F).cwiseAbs(), axes);
    default: return make_cylinder(a, a + axis * random.uniform(0.5F, 6.0F), radius);
    }
}

TEST(NearestPoint, NoPointOfTheSolidIsNearer)
{
    Random random(11);
    for (int i = 0; i < 20'000; ++i) {
        const Shape shape = any_shape(random);
        const Vec3 from = any(random, 30.0F);
        const Vec3 nearest = nearest_point(shape, from);
        const float distance = (nearest - from).norm();
        // Along the direction to the nearest point no part of the solid is nearer; in any other direction the solid's
        // extreme point towards us is not nearer either.
        if (distance > 0.0F) {
            const Vec3 towards = (from - nearest) / distance;
            const float reach = (support(shape, towards) - from).dot(-towards);
            ASSERT_GE(reach, distance - 1e-3F);
            ASSERT_LE(reach, distance + 1e-3F) << "and the nearest point is of the solid";
        }
    }
}

TEST(NearestPoint, InsideIsNoDistance)
{
    Random random(12);
    for (int i = 0; i < 1000; ++i) {
        const Shape shape = any_shape(random);
        EXPECT_LE((nearest_point(shape, shape.centre) - shape.centre).norm(), 1e-5F);
    }
}

TEST(NearestPoint, PointOnTheSurfaceOrWithinIsNearestToItself)
{
    const Vec3 inside(0.5F, 0.2F, -0.3F);
    const Shape shapes[] = {make_sphere(Vec3::Zero(), 1.0F), make_box(Vec3::Zero(), Vec3::Ones()),
                            make_capsule(Vec3(0, 0, -2), Vec3(0, 0, 2), 1.0F),
                            make_cylinder(Vec3(0, 0, -2), Vec3(0, 0, 2), 1.0F)};
    for (const Shape& shape : shapes) {
        EXPECT_LT((nearest_point(shape, inside) - inside).norm(), 1e-6F);
        EXPECT_LT((nearest_point(shape, Vec3(1.0F, 0.0F, 0.0F)) - Vec3(1.0F, 0.0F, 0.0F)).norm(), 1e-6F);
        EXPECT_LT((nearest_point(shape, Vec3(3.0F, 0.0F, 0.0F)) - Vec3(1.0F, 0.0F, 0.0F)).norm(), 1e-6F);
    }
    const std::array<Point3, 4> corners{{{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 2}}};
    const Shape hull = make_hull(corners, Vec3(10.0F, 0.0F, 0.0F));
    const Vec3 nearest = nearest_point(hull, Vec3::Zero());
    EXPECT_LE(nearest.x(), 8.0F) << "its bounding sphere: nearer than it is";
    EXPECT_GE(nearest.x(), 7.99F);
    EXPECT_EQ(nearest.tail<2>().norm(), 0.0F);
}

TEST(NearestPoint, OfACapsuleLiesOnItsCapsBeyondItsEnds)
{
    const Shape capsule = make_capsule(Vec3(10, 0, -2), Vec3(10, 0, 2), 1.0F);
    for (const float end : {-1.0F, 1.0F}) {
        const Vec3 nearest = nearest_point(capsule, Vec3(10.0F, 3.0F, end * 6.0F));
        EXPECT_LT((nearest - Vec3(10.0F, 0.6F, end * 2.8F)).norm(), 1e-5F)
            << "3 aside and 4 along from the cap's centre";
        EXPECT_LT((nearest_point(capsule, Vec3(10.0F, 0.0F, end * 9.0F)) - Vec3(10.0F, 0.0F, end * 3.0F)).norm(),
                  1e-5F);
    }
}

TEST(NearestPoint, OfABoxLiesOnItsFacesEdgesAndCorners)
{
    const Shape box = make_box(Vec3(1, 2, 3), Vec3(2, 3, 4));
    EXPECT_EQ(nearest_point(box, Vec3(10, 20, 30)), Vec3(3, 5, 7));
    EXPECT_EQ(nearest_point(box, Vec3(-10, -20, -30)), Vec3(-1, -1, -1));
    EXPECT_EQ(nearest_point(box, Vec3(10, 2, 3)), Vec3(3, 2, 3));
    EXPECT_EQ(nearest_point(box, Vec3(0.5F, 1.5F, -9.0F)), Vec3(0.5F, 1.5F, -1.0F));
}

TEST(NearestPoint, OfACylinderLiesOnItsSideItsFacesAndItsRims)
{
    const Shape cylinder = make_cylinder(Vec3(10, 0, -2), Vec3(10, 0, 2), 1.0F);
    for (const float end : {-1.0F, 1.0F}) {
        const Vec3 rim = nearest_point(cylinder, Vec3(10.0F, 4.0F, end * 6.0F));
        EXPECT_LT((rim - Vec3(10.0F, 1.0F, end * 2.0F)).norm(), 1e-5F);
        const Vec3 face = nearest_point(cylinder, Vec3(10.2F, 0.3F, end * 6.0F));
        EXPECT_LT((face - Vec3(10.2F, 0.3F, end * 2.0F)).norm(), 1e-5F);
        const Vec3 side = nearest_point(cylinder, Vec3(10.0F, 4.0F, end));
        EXPECT_LT((side - Vec3(10.0F, 1.0F, end)).norm(), 1e-5F);
    }
}

}  // namespace
}  // namespace jink::geometry
