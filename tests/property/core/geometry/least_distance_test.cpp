// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/sweep.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometry {
namespace {

using oracle::Passage;

struct LeastCase {
    Vec3 half = Vec3::Zero();
    Motion own, threat;
    Seconds horizon = 1.0F;
};

LeastCase any_least_case(Random& random)
{
    const float size = oracle::power_of_ten(random, -3.0F, 2.0F);
    const float far = random.below(4) == 0 ? 1000.0F : size;
    const Vec3 centre = oracle::in_cube(random, far);
    LeastCase c;
    c.half = oracle::in_cube(random, size).cwiseAbs();
    c.own = {centre + oracle::in_cube(random, 3.0F * size), oracle::in_cube(random, size)};
    c.threat = {centre + oracle::in_cube(random, 3.0F * size), oracle::in_cube(random, size)};
    c.horizon = random.below(8) == 0 ? 0.0F : oracle::power_of_ten(random, -1.0F, 1.0F);
    if (random.below(3) == 0) {
        const auto axis = static_cast<int>(random.below(3));
        c.half[axis] *= static_cast<float>(random.below(2));
        c.threat.velocity[axis] = c.own.velocity[axis];
    }
    if (random.below(10) == 0) {
        c.threat.velocity = c.own.velocity;
    }
    return c;
}

/// Rounding that a distance may carry: of the relative coordinates, and of the travelled distance.
double allowed_least(const LeastCase& c)
{
    const Vec3 relative = c.threat.position - c.own.position;
    const Vec3 way = c.horizon * (c.threat.velocity - c.own.velocity);
    return 5e-7 * double(relative.cwiseAbs().sum() + way.cwiseAbs().sum() + c.half.sum());
}

Approach least_of(const LeastCase& c) { return least_distance(c.half, c.own, c.threat, c.horizon); }

class LeastDistance : public ::testing::Test {
protected:
    const std::uint64_t seed = oracle::seed_of(20240611);
    ::testing::ScopedTrace trace{__FILE__, __LINE__, seed};
    Random random{seed};
};

TEST_F(LeastDistance, AgreesWithBisectionInDouble)
{
    double worst = 0;
    double worst_when = 0;
    for (std::size_t n = oracle::case_count(1'000'000); n > 0; --n) {
        const LeastCase c = any_least_case(random);
        const Passage passage(c.half, c.own, c.threat);
        const Approach found = least_of(c);
        const double least = passage.distance(passage.closest(double(c.horizon)));
        ASSERT_GE(found.when, 0.0F);
        ASSERT_LE(found.when, c.horizon);
        worst = std::max(worst, std::abs(double(found.distance) - least) / allowed_least(c));
        worst_when = std::max(worst_when, (passage.distance(double(found.when)) - least) / allowed_least(c));
        ASSERT_LE(worst, 1.0) << n << " found " << found.distance << " least " << least;
        ASSERT_LE(worst_when, 1.0) << n;
    }
    std::cout << "least_distance: worst error " << worst << ", worst distance at its instant " << worst_when
              << " of the allowed_least\n";
}

TEST_F(LeastDistance, KeepsItsValueUnderMirrorsPermutationsAndExchange)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const LeastCase c = any_least_case(random);
        const float distance = least_of(c).distance;
        LeastCase mirrored = c;
        const auto axis = static_cast<int>(random.below(3));
        for (Vec3* v :
             {&mirrored.own.position, &mirrored.own.velocity, &mirrored.threat.position, &mirrored.threat.velocity}) {
            (*v)[axis] = -(*v)[axis];
        }
        // Negation is exact, so not a single bit may change.
        ASSERT_EQ(least_of(mirrored).distance, distance);
        ASSERT_EQ(least_of(mirrored).when, least_of(c).when);
        LeastCase exchanged = c;
        std::swap(exchanged.own, exchanged.threat);
        ASSERT_EQ(least_of(exchanged).distance, distance);
        LeastCase turned = c;
        for (Vec3* v : {&turned.half, &turned.own.position, &turned.own.velocity, &turned.threat.position,
                        &turned.threat.velocity}) {
            *v = Vec3(v->y(), v->z(), v->x());
        }
        ASSERT_NEAR(double(least_of(turned).distance), double(distance), 2.0 * allowed_least(c));
    }
}

TEST_F(LeastDistance, NeverGrowsWithTheHorizon)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        LeastCase c = any_least_case(random);
        const double longer = double(least_of(c).distance);
        const double slack = allowed_least(c);
        c.horizon *= random.uniform();
        ASSERT_GE(double(least_of(c).distance), longer - 2.0 * slack);
    }
}

TEST_F(LeastDistance, DependsOnRelativeMotionOnly)
{
    for (std::size_t n = oracle::case_count(100'000); n > 0; --n) {
        const LeastCase c = any_least_case(random);
        LeastCase moved = c;
        const Vec3 by = oracle::in_cube(random, 10.0F);
        const Vec3 wind = oracle::in_cube(random, 10.0F);
        moved.own = {c.own.position + by, c.own.velocity + wind};
        moved.threat = {c.threat.position + by, c.threat.velocity + wind};
        // The sums above round as well, each to half a unit in its last place.
        const double rounding = 6e-8 * 2.0 *
                                double((moved.own.position.cwiseAbs() + moved.threat.position.cwiseAbs() +
                                        c.horizon * (moved.own.velocity.cwiseAbs() + moved.threat.velocity.cwiseAbs()))
                                           .sum());
        ASSERT_NEAR(double(least_of(moved).distance), double(least_of(c).distance),
                    2.0 * allowed_least(c) + 2.0 * rounding);
    }
}

TEST_F(LeastDistance, IsZeroExactlyWhereAPointTouches)
{
    std::size_t touching = 0;
    for (std::size_t n = oracle::case_count(200'000); n > 0; --n) {
        const LeastCase c = any_least_case(random);
        const Approach found = least_of(c);
        const bool contact = contact_interval(c.half, c.own, c.threat, 0.0F, c.horizon).has_value();
        touching += contact ? 1 : 0;
        if (found.distance == 0.0F) {
            ASSERT_TRUE(contact);
        }
        if (contact) {
            ASSERT_LE(double(found.distance),
                      2.0 * allowed_least(c) +
                          1e-6 * double((c.threat.position - c.own.position).cwiseAbs().sum() + c.half.sum()));
        }
    }
    EXPECT_GT(touching, oracle::case_count(200'000) / 500);
}

TEST_F(LeastDistance, GivesTheFirstOfEquallyCloseInstants)
{
    // Along a face, and through the inside: a plateau begins where the nose enters the slab.
    const Vec3 half(1.0F, 2.0F, 3.0F);
    const Approach along = least_distance(half, {}, {{-5.0F, 4.0F, 0.0F}, {2.0F, 0.0F, 0.0F}}, 10.0F);
    EXPECT_EQ(along.distance, 2.0F);
    EXPECT_FLOAT_EQ(along.when, 2.0F);
    const Approach through = least_distance(half, {}, {{0.5F, 0.0F, -7.0F}, {0.0F, 0.0F, 4.0F}}, 10.0F);
    EXPECT_EQ(through.distance, 0.0F);
    EXPECT_FLOAT_EQ(through.when, 1.0F);
}

}  // namespace
}  // namespace jink::geometry
