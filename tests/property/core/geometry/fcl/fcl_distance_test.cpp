// SPDX-License-Identifier: BSD-3-Clause
// FCL's static distance as an oracle by other hands, and its conservative advancement for the moving test.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <memory>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/distance.h>

#include "core/geometry/convex.hpp"
#include "core/geometry/hull_distance.hpp"
#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/convex_oracle.hpp"
#include "tests/timing/crossing_scene.hpp"

namespace jink::geometry {
namespace {

fcl::Transform3d placed(const Vec3& at, const Mat3& axes = Mat3::Identity())
{
    fcl::Transform3d out = fcl::Transform3d::Identity();
    out.translation() = at.cast<double>();
    out.linear() = axes.cast<double>();
    return out;
}

/// A cube sheared and turned by any affine map: eight vertices, twelve triangles.
std::vector<Point3> sheared_cube(Random& random)
{
    const std::array<Vec3, 3> sides{oracle::in_cube(random, 1.0F), oracle::in_cube(random, 1.0F),
                                    oracle::in_cube(random, 1.0F)};
    std::vector<Point3> vertices;
    for (int i = 0; i < 8; ++i) {
        vertices.push_back(Point3::of(((i & 1) != 0 ? 1.0F : -1.0F) * sides[0] +
                                      ((i & 2) != 0 ? 1.0F : -1.0F) * sides[1] +
                                      ((i & 4) != 0 ? 1.0F : -1.0F) * sides[2]));
    }
    return vertices;
}

std::shared_ptr<fcl::CollisionGeometryd> twin(const Shape& shape)
{
    const double length = 2.0 * double(shape.half.z());
    switch (shape.kind) {
    case ShapeKind::sphere: return std::make_shared<fcl::Sphered>(double(shape.radius));
    case ShapeKind::box: return std::make_shared<fcl::Boxd>(2.0 * shape.half.cast<double>());
    case ShapeKind::capsule: return std::make_shared<fcl::Capsuled>(double(shape.radius), length);
    case ShapeKind::cylinder: return std::make_shared<fcl::Cylinderd>(double(shape.radius), length);
    case ShapeKind::hull: break;
    }
    const auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>();
    for (const Point3& vertex : shape.vertices) {
        vertices->push_back(vertex.vec().cast<double>());
    }
    const auto faces = std::make_shared<std::vector<int>>(
        std::vector<int>{4, 0, 2, 3, 1, 4, 4, 5, 7, 6, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 4, 6, 2, 4, 1, 3, 7, 5});
    return std::make_shared<fcl::Convexd>(vertices, 6, faces);
}

class Fcl : public ::testing::TestWithParam<ShapeKind> {
protected:
    const std::uint64_t seed = oracle::seed_of(20240651);
    ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
    Random random{seed};
};

TEST_P(Fcl, DistanceOfABoxAtRestAgrees)
{
    std::size_t apart = 0, touching = 0;
    double worst = 0;
    for (std::size_t n = oracle::case_count(10'000); n > 0; --n) {
        std::vector<Point3> vertices;
        const Vec3 half = oracle::in_cube(random, 1.0F).cwiseAbs() + Vec3::Constant(0.01F);
        const Vec3 at = oracle::in_cube(random, 3.0F);
        Shape shape = oracle::any_shape(random, GetParam(), oracle::in_cube(random, 3.0F), 1.0F, vertices);
        if (GetParam() == ShapeKind::hull) {
            vertices = sheared_cube(random);
            shape.vertices = vertices;
        }
        const fcl::Boxd box(2.0 * half.cast<double>());
        fcl::DistanceRequestd request;
        request.distance_tolerance = 1e-9;
        fcl::DistanceResultd result;
        const double expected =
            fcl::distance(&box, placed(at), twin(shape).get(), placed(shape.centre, shape.axes), request, result);
        WorkBudget budget(1000);
        const double found = double(swept_box_distance(half, at, at, shape, 100.0F, 0.0F, budget));
        WorkBudget again(1000);
        const Contact contact = swept_box_contact(half, at, at, shape, 0.0F, again);
        if (expected <= 0) {
            ++touching;
            ASSERT_LE(found, 1e-4);
            ASSERT_EQ(contact, Contact::contact);
        } else {
            ++apart;
            worst = std::max(worst, std::abs(found - expected));
            ASSERT_NEAR(found, expected, 5e-5) << n;
            ASSERT_TRUE(contact == Contact::clear || expected < 1e-4) << expected;
        }
    }
    std::cout << "FCL distance: apart=" << apart << " touching=" << touching << " worst difference " << worst << " m\n";
    EXPECT_GT(apart, 100U);
    EXPECT_GT(touching, 10U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Fcl,
                         ::testing::Values(ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder,
                                           ShapeKind::hull));

TEST(FclMoving, ConservativeAdvancementAgreesOnTheCrossingScene)
{
    const timing::CrossingScene scene(oracle::case_count(10'000), oracle::seed_of(42));
    const fcl::Boxd box((2.0F * scene.half).cast<double>());
    const fcl::Sphered sphere(double(scene.radius));
    fcl::ContinuousCollisionRequestd request;
    request.ccd_motion_type = fcl::CCDM_TRANS;
    request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
    std::size_t hits = 0;
    for (const timing::CrossingCase& c : scene.cases) {
        fcl::ContinuousCollisionResultd result;
        fcl::continuousCollide(&box, placed(c.own.position), placed(c.own.position + c.own.velocity), &sphere,
                               placed(c.threat.position), placed(c.threat.position + c.threat.velocity), request,
                               result);
        const auto contact = contact_interval(scene.half, c.own, c.threat, scene.radius, 1.0F);
        // Advancement stops short of the surface: near misses may be hits to it, so a hit is only asked for where we
        // see one.
        if (contact) {
            ++hits;
            const double deep = double(least_distance(scene.half, c.own, c.threat, 1.0F).distance - scene.radius);
            ASSERT_TRUE(result.is_collide || deep > -1e-3) << deep;
            ASSERT_TRUE(!result.is_collide || std::abs(result.time_of_contact - double(contact->first)) < 3e-4 ||
                        deep > -1e-2);
        } else {
            ASSERT_TRUE(!result.is_collide ||
                        least_distance(scene.half, c.own, c.threat, 1.0F).distance < scene.radius + 1e-3F);
        }
    }
    EXPECT_GT(hits, scene.cases.size() / 3);
}

}  // namespace
}  // namespace jink::geometry
