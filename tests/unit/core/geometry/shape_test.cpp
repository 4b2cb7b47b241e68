// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/shape.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/capacity.hpp"
#include "tests/numbers.hpp"

namespace jink::geometry {
namespace {

const std::array<Point3, 4> kTetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

void expect_near(const Vec3& found, const Vec3& expected, float tolerance = 1e-5F)
{
    EXPECT_LE((found - expected).norm(), tolerance) << found.transpose().x() << " " << found.y() << " " << found.z();
}

TEST(Shape, SupportIsTheFarthestPointOfEachKind)
{
    const Vec3 centre(1.0F, 2.0F, 3.0F);
    expect_near(support(make_sphere(centre, 2.0F), {0.0F, 0.0F, 5.0F}), {1.0F, 2.0F, 5.0F});
    expect_near(support(make_box(centre, {1.0F, 2.0F, 3.0F}), {1.0F, -1.0F, 0.1F}), {2.0F, 0.0F, 6.0F});
    const Mat3 quarter = Eigen::AngleAxisf(0.5F * kPi, Vec3::UnitZ()).toRotationMatrix();
    expect_near(support(make_box(centre, {1.0F, 2.0F, 3.0F}, quarter), {1.0F, 1.0F, 1.0F}), {3.0F, 3.0F, 6.0F});
    const Shape capsule = make_capsule({0.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}, 1.0F);
    expect_near(support(capsule, {1.0F, 0.0F, 0.0F}), {5.0F, 0.0F, 0.0F});
    expect_near(support(capsule, {-1.0F, 1.0F, 0.0F}), {-std::sqrt(0.5F), std::sqrt(0.5F), 0.0F});
    const Shape cylinder = make_cylinder({0.0F, 0.0F, 0.0F}, {0.0F, 6.0F, 0.0F}, 2.0F);
    expect_near(support(cylinder, {3.0F, 1.0F, 0.0F}), {2.0F, 6.0F, 0.0F});
    expect_near(support(cylinder, {0.0F, -1.0F, 1e-3F}), {0.0F, 0.0F, 2.0F});
    const Shape hull = make_hull(kTetrahedron, centre, quarter);
    expect_near(support(hull, {0.0F, 1.0F, 0.0F}), {1.0F, 3.0F, 3.0F});
}

TEST(Shape, SupportTakesDirectionsOfAnyLength)
{
    const std::array shapes{make_sphere(Vec3::Zero(), 1.0F), make_box(Vec3::Zero(), {1.0F, 1.0F, 1.0F}),
                            make_capsule(-Vec3::UnitX(), Vec3::UnitX(), 1.0F),
                            make_cylinder(-Vec3::UnitX(), Vec3::UnitX(), 1.0F), make_hull(kTetrahedron, Vec3::Zero())};
    for (const Shape& shape : shapes) {
        const Vec3 expected = support(shape, {1.0F, 2.0F, 3.0F});
        for (const float scale : {1e-37F, 1e-20F, 1e20F, 1e37F}) {
            expect_near(support(shape, scale * Vec3(1.0F, 2.0F, 3.0F)), expected);
        }
        const Vec3 some = support(shape, Vec3::Zero());
        EXPECT_TRUE(is_finite(some));
        EXPECT_LE(some.norm(), bounding_radius(shape));
    }
}

TEST(Shape, SupportNeverLosesToASampleOfTheSolid)
{
    Random random(7);
    const auto any = [&](float side) {
        return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
    };
    for (int n = 0; n < 20'000; ++n) {
        const Vec3 a = any(3.0F);
        const Vec3 b = any(3.0F);
        const float radius = random.uniform(0.0F, 2.0F);
        const Vec3 direction = any(1.0F);
        const float along = random.uniform();
        const Vec3 axis_point = a + along * (b - a);
        const Vec3 sphere = radius * any(1.0F).normalized();
        ASSERT_LE(direction.dot(axis_point + sphere),
                  direction.dot(support(make_capsule(a, b, radius), direction)) + 1e-5F);
        const Vec3 axis = (b - a).normalized();
        const Vec3 flat = sphere - axis * axis.dot(sphere);
        ASSERT_LE(direction.dot(axis_point + flat),
                  direction.dot(support(make_cylinder(a, b, radius), direction)) + 1e-5F);
    }
}

TEST(Shape, BoundingRadiusHoldsEverySupportPoint)
{
    Random random(8);
    for (int n = 0; n < 20'000; ++n) {
        const auto any = [&](float side) {
            return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
        };
        // Axes at the limit of is_valid.
        Mat3 axes = Eigen::AngleAxisf(random.uniform(0.0F, 6.0F), any(1.0F).normalized()).toRotationMatrix();
        const Mat3 turned = axes;
        axes += 2.4e-4F * Mat3(turned * Mat3::Ones());
        const std::array<Point3, 3> vertices{Point3::of(any(2.0F)), Point3::of(any(2.0F)), Point3::of(any(2.0F))};
        Shape capsule = make_capsule(any(2.0F), any(2.0F), random.uniform());
        capsule.axes = axes;
        Shape cylinder = make_cylinder(any(2.0F), any(2.0F), random.uniform());
        cylinder.axes = axes;
        for (const Shape& shape :
             {make_sphere(any(1.0F), random.uniform()), make_box(any(1.0F), any(2.0F).cwiseAbs(), axes), capsule,
              cylinder, make_hull(vertices, any(1.0F), axes)}) {
            ASSERT_TRUE(is_valid(shape));
            ASSERT_LE((support(shape, any(1.0F)) - shape.centre).norm(), bounding_radius(shape) + 1e-6F);
        }
    }
}

TEST(Shape, AxesOfCapsuleAndCylinderRunAlongTheirSegment)
{
    const Vec3 a(1.0F, -2.0F, 3.0F);
    const Vec3 b(-4.0F, 0.5F, 2.0F);
    for (const Shape& shape : {make_capsule(a, b, 0.0F), make_cylinder(a, b, 0.0F)}) {
        expect_near(shape.centre + shape.axes.col(2) * shape.half.z(), b);
        expect_near(shape.centre - shape.axes.col(2) * shape.half.z(), a);
        EXPECT_TRUE(is_valid(shape));
        EXPECT_NEAR(shape.axes.determinant(), 1.0F, 1e-5F);
    }
    // A segment of no length keeps the world's axes.
    EXPECT_TRUE(make_capsule(a, a, 1.0F).axes.isIdentity());
    EXPECT_EQ(make_cylinder(a, a, 1.0F).half.z(), 0.0F);
}

TEST(Shape, IsValidRefusesWhatIsNotASolid)
{
    EXPECT_TRUE(is_valid(make_sphere(Vec3::Zero(), 0.0F)));
    EXPECT_TRUE(is_valid(make_hull(kTetrahedron, Vec3::Zero())));
    EXPECT_FALSE(is_valid(make_sphere(Vec3::Zero(), -1.0F)));
    EXPECT_FALSE(is_valid(make_sphere(Vec3::Zero(), kNan)));
    EXPECT_FALSE(is_valid(make_sphere(Vec3::Zero(), kInfinity)));
    EXPECT_FALSE(is_valid(make_sphere({0.0F, kNan, 0.0F}, 1.0F)));
    EXPECT_FALSE(is_valid(make_box({kInfinity, 0.0F, 0.0F}, Vec3::Ones())));
    EXPECT_FALSE(is_valid(make_box(Vec3::Zero(), {1.0F, -1.0F, 1.0F})));
    EXPECT_FALSE(is_valid(make_box(Vec3::Zero(), {1.0F, 1.0F, kNan})));
    EXPECT_FALSE(is_valid(make_box(Vec3::Zero(), Vec3::Ones(), 1.01F * Mat3::Identity())));
    Mat3 skewed = Mat3::Identity();
    skewed(0, 1) = 0.01F;
    EXPECT_FALSE(is_valid(make_box(Vec3::Zero(), Vec3::Ones(), skewed)));
    skewed(0, 1) = kNan;
    EXPECT_FALSE(is_valid(make_box(Vec3::Zero(), Vec3::Ones(), skewed)));
    EXPECT_FALSE(is_valid(make_capsule({0.0F, 0.0F, kNan}, Vec3::Ones(), 1.0F)));
    EXPECT_FALSE(is_valid(make_hull({}, Vec3::Zero())));
    const std::array<Point3, 2> broken{{{0, 0, 0}, {kNan, 0, 0}}};
    EXPECT_FALSE(is_valid(make_hull(broken, Vec3::Zero())));
    std::array<Point3, kMaxHullVertices + 1> many;
    many.fill({1, 1, 1});
    EXPECT_FALSE(is_valid(make_hull(many, Vec3::Zero())));
    EXPECT_TRUE(is_valid(make_hull(std::span(many).first(kMaxHullVertices), Vec3::Zero())));
    Shape unknown;
    unknown.kind = static_cast<ShapeKind>(17);
    EXPECT_FALSE(is_valid(unknown));
}

TEST(Shape, FitsItsStatedSize) { EXPECT_LE(sizeof(Shape), 88U); }

}  // namespace
}  // namespace jink::geometry
