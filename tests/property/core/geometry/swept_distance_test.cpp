// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/sweep.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometry {
namespace {

using oracle::Passage;
using oracle::Point;

struct SweptCase {
    Vec3 half = Vec3::Zero();
    Vec3 own_from, own_to, threat_from, threat_to;
};

float run(const SweptCase& c) { return swept_distance(c.half, c.own_from, c.own_to, c.threat_from, c.threat_to); }

/// Least distance of the box from corner + s * threat - t * own: bisection over t on the slope of the least one over s.
double least(const SweptCase& c)
{
    const Point half = oracle::to_double(c.half);
    const Point corner = oracle::minus(oracle::to_double(c.threat_from), oracle::to_double(c.own_from));
    const Point threat = oracle::minus(oracle::to_double(c.threat_to), oracle::to_double(c.threat_from));
    const Point back = oracle::minus(oracle::to_double(c.own_from), oracle::to_double(c.own_to));
    const auto at = [](const Point& from, const Point& along, double t) {
        return Point{from[0] + along[0] * t, from[1] + along[1] * t, from[2] + along[2] * t};
    };
    const auto slope = [&](double t) {
        const Point start = at(corner, back, t);
        const double s = Passage(half, start, threat).closest(1.0);
        return Passage(half, at(start, threat, s), back).slope(0.0);
    };
    const auto value = [&](double t) {
        const Passage passage(half, at(corner, back, t), threat);
        return passage.distance(passage.closest(1.0));
    };
    double low = 0;
    double high = 1;
    for (int i = 0; i < 55; ++i) {
        const double middle = 0.5 * (low + high);
        (slope(middle) < 0 ? low : high) = middle;
    }
    return std::min({value(0.0), value(1.0), value(low), value(high)});
}

double allowed_swept(const SweptCase& c)
{
    return 5e-7 * double(((c.threat_from - c.own_from).cwiseAbs() + (c.threat_to - c.threat_from).cwiseAbs() +
                          (c.own_to - c.own_from).cwiseAbs() + c.half)
                             .sum());
}

SweptCase any_swept_case(Random& random)
{
    const float size = oracle::power_of_ten(random, -3.0F, 2.0F);
    const Vec3 centre = oracle::in_cube(random, random.below(4) == 0 ? 1000.0F : size);
    SweptCase c;
    c.half = oracle::in_cube(random, 0.3F * size).cwiseAbs();
    c.own_from = centre + oracle::in_cube(random, size);
    c.own_to = centre + oracle::in_cube(random, size);
    c.threat_from = centre + oracle::in_cube(random, 1.5F * size);
    c.threat_to = centre + oracle::in_cube(random, 1.5F * size);
    switch (random.below(12)) {
    case 0: c.threat_to = c.threat_from; break;
    case 1: c.own_to = c.own_from; break;
    case 2: c.half = Vec3::Zero(); break;
    case 3:  // parallel, up to rounding
        c.threat_to = c.threat_from + random.uniform(-2.0F, 2.0F) * (c.own_to - c.own_from);
        break;
    case 4:  // nearly parallel: slender parallelograms
        c.threat_to = c.threat_from + random.uniform(-2.0F, 2.0F) * (c.own_to - c.own_from) +
                      size * oracle::power_of_ten(random, -8.0F, -1.0F) * oracle::in_cube(random, 1.0F);
        break;
    case 5: {  // within a plane parallel to a face
        const auto axis = static_cast<int>(random.below(3));
        c.own_to[axis] = c.own_from[axis];
        c.threat_to[axis] = c.threat_from[axis];
        break;
    }
    case 6: c.half[static_cast<int>(random.below(3))] = 0.0F; break;
    case 7:  // the paths cross
        c.threat_to = c.threat_from + 2.0F * (0.5F * (c.own_from + c.own_to) - c.threat_from);
        break;
    case 8:  // along an axis
        c.own_to = c.own_from;
        c.own_to[static_cast<int>(random.below(3))] += size;
        break;
    case 9: {  // a slender parallelogram pierced by, or passing closely, a box smaller than its width
        const Vec3 own = c.own_to - c.own_from;
        const Vec3 threat = random.uniform(-2.0F, 2.0F) * own +
                            size * oracle::power_of_ten(random, -5.0F, -1.0F) * oracle::in_cube(random, 1.0F);
        c.half *= oracle::power_of_ten(random, -7.0F, -2.0F);
        c.threat_from = c.own_from + random.uniform() * own - random.uniform() * threat +
                        size * oracle::power_of_ten(random, -7.0F, -2.0F) * oracle::in_cube(random, 1.0F);
        c.threat_to = c.threat_from + threat;
        break;
    }
    default: break;
    }
    return c;
}

class SweptDistance : public ::testing::Test {
protected:
    const std::uint64_t seed = oracle::seed_of(20240621);
    ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
    Random random{seed};
};

TEST_F(SweptDistance, AgreesWithNestedBisectionInDouble)
{
    double worst = 0;
    std::size_t touching = 0;
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const SweptCase c = any_swept_case(random);
        const double expected = least(c);
        const double found = double(run(c));
        touching += expected == 0.0 ? 1 : 0;
        worst = std::max(worst, std::abs(found - expected) / allowed_swept(c));
        ASSERT_LE(std::abs(found - expected), allowed_swept(c))
            << "case " << n << " found " << found << " expected " << expected << std::hexfloat << "\nhalf "
            << c.half.x() << " " << c.half.y() << " " << c.half.z();
    }
    std::cout << "swept_distance: worst error " << worst << " of the allowed_swept, " << touching << " touching\n";
    EXPECT_GT(touching, oracle::case_count(100'000) / 500);
}

TEST_F(SweptDistance, KeepsItsValueUnderReversalAndExchange)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const SweptCase c = any_swept_case(random);
        const double distance = double(run(c));
        const double slack = 2.0 * allowed_swept(c);
        ASSERT_NEAR(double(run({c.half, c.own_to, c.own_from, c.threat_from, c.threat_to})), distance, slack);
        ASSERT_NEAR(double(run({c.half, c.own_from, c.own_to, c.threat_to, c.threat_from})), distance, slack);
        ASSERT_NEAR(double(run({c.half, c.threat_from, c.threat_to, c.own_from, c.own_to})), distance, slack);
        ASSERT_NEAR(double(run({c.half, -c.own_from, -c.own_to, -c.threat_from, -c.threat_to})), distance, slack);
    }
}

TEST_F(SweptDistance, IsNeverAboveTheDistanceInTime)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const SweptCase c = any_swept_case(random);
        const Approach timed = least_distance(c.half, {c.own_from, c.own_to - c.own_from},
                                              {c.threat_from, c.threat_to - c.threat_from}, 1.0F);
        ASSERT_LE(double(run(c)), double(timed.distance) + 2.0 * allowed_swept(c));
    }
}

TEST_F(SweptDistance, FindsABoxThatOnlyItsCornerOrItsMiddleMeets)
{
    const Vec3 half(1.0F, 1.0F, 1.0F);
    // A wide parallelogram in the plane z = 0.5 pierces the box without any of its edges near it.
    EXPECT_EQ(
        swept_distance(half, {-10.0F, 0.0F, 0.0F}, {10.0F, 0.0F, 0.0F}, {0.0F, -10.0F, 0.5F}, {0.0F, 10.0F, 0.5F}),
        0.0F);
    // The same above the top face.
    EXPECT_FLOAT_EQ(
        swept_distance(half, {-10.0F, 0.0F, 0.0F}, {10.0F, 0.0F, 0.0F}, {0.0F, -10.0F, 3.0F}, {0.0F, 10.0F, 3.0F}),
        2.0F);
    // A slanted one whose nearest feature is the corner (1, 1, 1): plane x + y + z = 6, distance (6 - 3) / sqrt(3).
    const Vec3 u(10.0F, -10.0F, 0.0F);
    const Vec3 v(10.0F, 10.0F, -20.0F);
    const Vec3 foot(2.0F, 2.0F, 2.0F);
    EXPECT_FLOAT_EQ(swept_distance(half, 0.5F * v, -0.5F * v, foot - 0.5F * u, foot + 0.5F * u), std::sqrt(3.0F));
}

TEST_F(SweptDistance, PointSegmentDistanceAgreesWithTernarySearch)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const float size = oracle::power_of_ten(random, -3.0F, 3.0F);
        const Vec3 p = oracle::in_cube(random, size);
        const Vec3 a = oracle::in_cube(random, size);
        const Vec3 b = random.below(10) == 0 ? a : Vec3(oracle::in_cube(random, size));
        const Passage passage(Vec3::Zero(), {p, Vec3::Zero()}, {a, b - a});
        const double expected = passage.distance(passage.closest(1.0));
        ASSERT_NEAR(double(point_segment_distance(p, a, b)), expected, 5e-7 * double(size) * 6.0);
    }
}

}  // namespace
}  // namespace jink::geometry
