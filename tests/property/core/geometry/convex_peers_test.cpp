// SPDX-License-Identifier: BSD-3-Clause
// Several opinions on the same cases: the closed forms, the budgeted convex test, and libccd itself (GJK and MPR) on
// support functions of this file. A hull of one vertex with a clearance is a sphere, one of two vertices is a capsule.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include <ccd/ccd.h>

#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometry {
namespace {

using oracle::Passage;
using oracle::Point;

struct PeerCase {
    Vec3 half = Vec3::Zero();
    Vec3 from, to;
    Vec3 a, b;  ///< axis of the capsule; equal for a sphere
    float radius = 0.0F;

    Point own_from() const { return oracle::minus(oracle::to_double(from), oracle::to_double(a)); }
};

PeerCase any_peer_case(Random& random, bool sphere)
{
    PeerCase c;
    c.half = oracle::in_cube(random, 1.0F).cwiseAbs();
    c.from = oracle::in_cube(random, 4.0F);
    c.to = random.below(8) == 0 ? c.from : Vec3(oracle::in_cube(random, 4.0F));
    c.a = oracle::in_cube(random, 4.0F);
    c.b = sphere ? c.a : Vec3(oracle::in_cube(random, 4.0F));
    c.radius = random.uniform(0.0F, 3.0F);
    return c;
}

/// Distance of the swept box from the sphere's centre, in double.
double sphere_distance(const PeerCase& c)
{
    const Passage passage(c.half, {c.from, c.to - c.from}, {c.a, Vec3::Zero()});
    return passage.distance(passage.closest(1.0));
}

// --- libccd as it comes, in double, without a budget

struct SweptCube {
    const PeerCase& c;
};
struct Sphere {
    const PeerCase& c;
};

void swept_cube_support(const void* object, const ccd_vec3_t* d, ccd_vec3_t* out)
{
    const PeerCase& c = static_cast<const SweptCube*>(object)->c;
    double along = 0;
    for (int i = 0; i < 3; ++i) {
        along += (double(c.to[i]) - double(c.from[i])) * d->v[i];
    }
    for (int i = 0; i < 3; ++i) {
        out->v[i] = double(along > 0 ? c.to[i] : c.from[i]) + std::copysign(double(c.half[i]), d->v[i]);
    }
}
void swept_cube_centre(const void* object, ccd_vec3_t* out)
{
    const PeerCase& c = static_cast<const SweptCube*>(object)->c;
    for (int i = 0; i < 3; ++i) {
        out->v[i] = 0.5 * (double(c.from[i]) + double(c.to[i]));
    }
}
void sphere_support(const void* object, const ccd_vec3_t* d, ccd_vec3_t* out)
{
    const PeerCase& c = static_cast<const Sphere*>(object)->c;
    const double length = std::sqrt(ccdVec3Dot(d, d));
    for (int i = 0; i < 3; ++i) {
        out->v[i] = double(c.a[i]) + (length > 0 ? double(c.radius) * d->v[i] / length : 0.0);
    }
}
void sphere_centre(const void* object, ccd_vec3_t* out)
{
    const PeerCase& c = static_cast<const Sphere*>(object)->c;
    ccdVec3Set(out, double(c.a.x()), double(c.a.y()), double(c.a.z()));
}

ccd_t plain_libccd()
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = swept_cube_support;
    ccd.support2 = sphere_support;
    ccd.center1 = swept_cube_centre;
    ccd.center2 = sphere_centre;
    ccd.max_iterations = 1000;
    return ccd;
}

/// How one opinion compares with the double-precision distance less the radius.
struct Opinion {
    const char* name;
    std::size_t agreed = 0, false_contact = 0, false_clear = 0;
    double widest = 0;  ///< largest distance from contact of a disagreement [m]

    void judge(double gap, bool contact)
    {
        if ((gap <= 0) == contact) {
            ++agreed;
            return;
        }
        ++(contact ? false_contact : false_clear);
        widest = std::max(widest, std::abs(gap));
    }
    void print() const
    {
        std::cout << "  " << name << ": agreed " << agreed << ", false contact " << false_contact << ", false clear "
                  << false_clear << ", widest " << widest << " m\n";
    }
};

class ConvexPeers : public ::testing::Test {
protected:
    const std::uint64_t seed = oracle::seed_of(20240641);
    ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
    Random random{seed};
};

/// Coordinates are up to 4 m here: accuracy of the closed forms and the convex test for these.
constexpr double kBand = 1e-4;

TEST_F(ConvexPeers, SweptCubeAgainstSphere)
{
    Opinion closed{"closed form"}, convex{"budgeted convex test"}, gjk{"libccd GJK"}, mpr{"libccd MPR"};
    std::size_t hits = 0;
    const ccd_t ccd = plain_libccd();
    for (std::size_t n = oracle::case_count(200'000); n > 0; --n) {
        PeerCase c = any_peer_case(random, true);
        const double distance = sphere_distance(c);
        if (n % 2 == 0) {  // grazing within a ten-thousandth
            c.radius = static_cast<float>(distance) * (1.0F + random.uniform(-1e-4F, 1e-4F));
        }
        const double gap = distance - double(c.radius);
        hits += gap <= 0 ? 1 : 0;
        const Motion own{c.from, c.to - c.from};
        closed.judge(gap, contact_interval(c.half, own, {c.a, Vec3::Zero()}, c.radius, 1.0F).has_value());
        const std::array<Point3, 1> centre{};
        WorkBudget budget(1000);
        const Contact contact = swept_box_contact(c.half, c.from, c.to, make_hull(centre, c.a), c.radius, budget);
        convex.judge(gap, contact != Contact::clear);
        const SweptCube cube{c};
        const Sphere sphere{c};
        gjk.judge(gap, ccdGJKIntersect(&cube, &sphere, &ccd) != 0);
        mpr.judge(gap, ccdMPRIntersect(&cube, &sphere, &ccd) != 0);
    }
    std::cout << "swept cube/sphere, " << hits << " hits of " << oracle::case_count(200'000)
              << ", half of them grazing:\n";
    for (const Opinion* opinion : {&closed, &convex, &gjk, &mpr}) {
        opinion->print();
    }
    EXPECT_EQ(closed.false_clear, 0U);
    EXPECT_EQ(convex.false_clear, 0U);
    EXPECT_LE(closed.widest, kBand);
    EXPECT_LE(convex.widest, kBand);
    EXPECT_GT(hits, 1000U);
}

TEST_F(ConvexPeers, SweptCubeAgainstCapsule)
{
    Opinion convex{"budgeted convex test against the closed form"};
    std::size_t hits = 0;
    for (std::size_t n = oracle::case_count(200'000); n > 0; --n) {
        PeerCase c = any_peer_case(random, false);
        const float distance = swept_distance(c.half, c.from, c.to, c.a, c.b);
        if (n % 2 == 0) {
            c.radius = distance * (1.0F + random.uniform(-1e-4F, 1e-4F));
        }
        const double gap = double(distance) - double(c.radius);
        hits += gap <= 0 ? 1 : 0;
        const std::array<Point3, 2> axis{Point3{}, Point3::of(c.b - c.a)};
        WorkBudget budget(1000);
        convex.judge(gap,
                     swept_box_contact(c.half, c.from, c.to, make_hull(axis, c.a), c.radius, budget) != Contact::clear);
        WorkBudget more(1000);
        const float found = swept_box_distance(c.half, c.from, c.to, make_hull(axis, c.a), 100.0F, 0.0F, more);
        ASSERT_NEAR(double(found), double(distance), kBand);
    }
    std::cout << "swept cube/capsule, " << hits << " hits of " << oracle::case_count(200'000) << ":\n";
    convex.print();
    EXPECT_LE(convex.widest, kBand);
    EXPECT_GT(hits, 1000U);
}

}  // namespace
}  // namespace jink::geometry
