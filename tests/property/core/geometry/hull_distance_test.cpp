// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/hull_distance.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "tests/property/core/geometry/convex_oracle.hpp"

// Distances against Wolfe's method in double precision (convex_oracle.hpp), which brings a proof of its own: a point of
// the difference and a plane that parts both.

namespace jink::geometry {
namespace {

using oracle::Vec3d;

Vec3d stretched(const Vec3& v, float stretch)
{
    return {double(v.x()), double(v.y()), double(stretch) * double(v.z())};
}

/// Vertices of a hull: round, flat, a needle, a grid with many equal support values, few or many.
std::vector<Vec3> any_hull(Random& random, const Vec3& centre, float size)
{
    std::vector<Vec3> vertices(4 + random.below(28));
    const std::uint64_t kind = random.below(6);
    const Vec3 axis = oracle::in_cube(random, 1.0F);
    for (Vec3& v : vertices) {
        v = oracle::in_cube(random, size);
        switch (kind) {
        case 0: v[static_cast<int>(axis.x() > 0.0F)] *= 1e-4F; break;          // flat
        case 1: v = axis * random.uniform(-size, size) + 1e-3F * v; break;     // needle
        case 2: v = (v / size).array().round().matrix() * size; break;         // corners of a grid
        case 3: v = v.norm() > 0.0F ? Vec3(size * v.normalized()) : v; break;  // on a sphere
        default: break;
        }
        v += centre;
    }
    return vertices;
}

/// Accuracy of a case by the header [m].
double band(const std::vector<Vec3>& vertices, const Vec3& origin, float stretch)
{
    double most = 0;
    for (const Vec3& v : vertices) {
        most = std::max(most, stretched(v - origin, stretch).cwiseAbs().sum());
    }
    return 3e-6 * most;
}

struct HullTally {
    std::size_t apart = 0, touching = 0;
    double worst = 0;  ///< shortfall beyond the resolution, in bands
    std::uint32_t most_turns = 0;
};

void print(const char* what, const HullTally& tally)
{
    std::cout << what << ": apart=" << tally.apart << " touching=" << tally.touching << " worst shortfall "
              << tally.worst << " bands, most turns " << tally.most_turns << '\n';
}

/// The laws: never above the truth, no farther below it than promised, and the plane holds for every vertex.
void check(const Separation& found, const oracle::Bounds& truth, double room, double resolution, HullTally& tally)
{
    ASSERT_LE(double(found.distance), truth.upper);
    const double shortfall = std::max(truth.lower - double(found.distance) - resolution, 0.0);
    ASSERT_LE(shortfall, room) << "distance " << truth.upper << " found " << found.distance;
    tally.worst = std::max(tally.worst, room > 0 ? shortfall / room : 0.0);
    if (found.distance > 0.0F) {
        ++tally.apart;
        ASSERT_NEAR(found.direction.norm(), 1.0F, 1e-6F);
    } else {
        ++tally.touching;
    }
}

float any_stretch(Random& random) { return random.below(2) == 0 ? 1.0F : random.uniform(0.5F, 4.0F); }

/// The last answer, or none, or nonsense.
Vec3 any_start(Random& random, const Separation& last)
{
    switch (random.below(3)) {
    case 0: return last.distance * last.direction;
    case 1: return oracle::in_cube(random, 10.0F);
    default: return Vec3::Zero();
    }
}

/// One point and one hull.
void check_point(Random& random, const Vec3& point, const std::vector<Vec3>& vertices, HullTally& tally,
                 double bands = 1.0)
{
    DistanceQuery query;
    query.stretch = any_stretch(random);
    query.resolution = random.below(2) == 0 ? 1e-4F : 0.0F;
    WorkBudget unlimited(1'000'000);
    const std::vector<Point3> corners = jink::oracle::points_of(vertices);
    query.start = any_start(random, point_hull_distance(point, corners, query, unlimited));
    WorkBudget budget(1'000'000);
    const Separation found = point_hull_distance(point, corners, query, budget);
    const double room = bands * band(vertices, point, query.stretch);
    const auto support = [&](const Vec3d& direction) {
        Vec3d best = stretched(vertices[0], query.stretch) - stretched(point, query.stretch);
        for (const Vec3& v : vertices) {
            const Vec3d w = stretched(v, query.stretch) - stretched(point, query.stretch);
            best = w.dot(direction) > best.dot(direction) ? w : best;
        }
        return best;
    };
    const oracle::Bounds truth = oracle::distance_from_origin(support, 1e-2 * room / bands);
    check(found, truth, room, double(query.resolution), tally);
    for (const Vec3& v : vertices) {
        const Vec3d w = stretched(v, query.stretch) - stretched(point, query.stretch);
        ASSERT_GE(w.dot(found.direction.cast<double>()), double(found.distance));
    }
    tally.most_turns = std::max(tally.most_turns, budget.spent() / distance_turn_units(vertices.size()));
}

TEST(PointHullDistance, AgreesWithWolfesMethodAndItsPlaneHolds)
{
    Random random(oracle::seed_of(11));
    HullTally tally;
    for (std::size_t n = 0; n < oracle::case_count(20'000); ++n) {
        const float size = oracle::power_of_ten(random, -2.0F, 2.0F);
        const Vec3 centre = oracle::in_cube(random, random.below(4) == 0 ? 900.0F : size);
        const std::vector<Vec3> vertices = any_hull(random, centre, size);
        const float far = random.below(8) == 0 ? 1000.0F : 2.0F * size;
        check_point(random, centre + oracle::in_cube(random, far), vertices, tally);
        ASSERT_FALSE(HasFatalFailure()) << "case " << n;
    }
    print("point to hull", tally);
    EXPECT_LT(tally.most_turns, kMaxDistanceTurns);
    EXPECT_GT(tally.touching, oracle::case_count(20'000) / 50);
}

/// Triangles have a closed form: fat ones, thin ones, ones without an area, and points about each region and on them.
TEST(PointHullDistance, OfTrianglesThinOnesTooAgreesWithWolfesMethod)
{
    Random random(oracle::seed_of(15));
    HullTally tally;
    for (std::size_t n = 0; n < oracle::case_count(20'000); ++n) {
        const float size = oracle::power_of_ten(random, -2.0F, 2.0F);
        const Vec3 centre = oracle::in_cube(random, random.below(4) == 0 ? 900.0F : size);
        std::vector<Vec3> vertices(3);
        for (Vec3& v : vertices) {
            v = centre + oracle::in_cube(random, size);
        }
        const float part = random.uniform(-0.5F, 1.5F);
        const std::uint64_t kind = random.below(8);
        switch (kind) {
        case 0: vertices[2] = vertices[0]; break;  // an edge
        case 1: vertices[1] = vertices[2] = vertices[0]; break;
        case 2: vertices[2] = vertices[0] + part * (vertices[1] - vertices[0]); break;  // a line, but for rounding
        case 3: vertices[2] = vertices[0] + oracle::in_cube(random, 1e-3F * size); break;
        default: break;
        }
        Vec3 point = centre + oracle::in_cube(random, random.below(8) == 0 ? 1000.0F : 2.0F * size);
        if (random.below(4) == 0) {
            // On the triangle, its plane or its edges, and a little off.
            const float along = random.uniform(-0.2F, 1.2F);
            point = vertices[0] + along * (vertices[1] - vertices[0]) + part * (vertices[2] - vertices[0]) +
                    oracle::in_cube(random, random.below(2) == 0 ? 0.0F : 1e-3F * size);
        }
        check_point(random, point, vertices, tally, kind < 4 ? 100.0 : 1.0);
        ASSERT_FALSE(HasFatalFailure()) << "case " << n;
    }
    print("point to triangle", tally);
    EXPECT_LT(tally.most_turns, kMaxDistanceTurns);
    EXPECT_GT(tally.touching, oracle::case_count(20'000) / 200);
}

/// Shapes have curved sides, on which the search closes in without end: the reported distance is never above the truth,
/// and not far below it.
TEST(PointShapeDistance, IsBelowTheTruthAndCloseToIt)
{
    Random random(oracle::seed_of(13));
    for (const ShapeKind kind :
         {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::cylinder, ShapeKind::hull}) {
        double worst = 0;
        for (std::size_t n = 0; n < oracle::case_count(4'000); ++n) {
            const float size = oracle::power_of_ten(random, -1.0F, 2.0F);
            const Vec3 centre = oracle::in_cube(random, random.below(4) == 0 ? 900.0F : size);
            std::vector<Point3> vertices;
            Shape shape = oracle::any_shape(random, kind, centre, size, vertices);
            if (kind == ShapeKind::hull && n % 2 == 0) {
                shape.axes = Mat3::Identity();  // searched by its vertices as they are
            }
            const Vec3 point = centre + oracle::in_cube(random, 4.0F * size);
            DistanceQuery query;
            query.stretch = any_stretch(random);
            WorkBudget budget(1'000'000);
            const Separation found = point_shape_distance(point, shape, query, budget);
            // A sphere of the shape's radius is part of the support here: the oracle's own form leaves it out.
            const auto support = [&](const Vec3d& direction) -> Vec3d {
                const Vec3d unstretched(direction.x(), direction.y(), double(query.stretch) * direction.z());
                Vec3d best = oracle::exact_support(shape, unstretched);
                if (kind == ShapeKind::sphere || kind == ShapeKind::capsule) {
                    best += double(shape.radius) * unstretched.normalized();
                }
                best -= point.cast<double>();
                return {best.x(), best.y(), double(query.stretch) * best.z()};
            };
            const double extent = double((point - centre).cwiseAbs().sum() + bounding_radius(shape)) *
                                  std::max(1.0, double(query.stretch));
            const oracle::Bounds truth = oracle::distance_from_origin(support, 1e-6 * extent);
            ASSERT_LE(double(found.distance), truth.upper) << "case " << n;
            worst = std::max(worst, (truth.lower - double(found.distance) - 1e-4) / extent);
            if (found.distance > 0.0F) {
                const Vec3d direction = found.direction.cast<double>();
                ASSERT_GE(direction.dot(support(-direction)), double(found.distance)) << "case " << n;
            }
        }
        std::cout << "point to shape " << int(kind) << ": worst shortfall " << worst << " of its extent\n";
        EXPECT_LT(worst, 1e-5);
    }
}

}  // namespace
}  // namespace jink::geometry
