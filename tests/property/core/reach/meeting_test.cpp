// SPDX-License-Identifier: BSD-3-Clause
// The direct check of a straight node against a moving, growing ball: samples in double, both ways.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/reach/meeting.hpp"

namespace jink::reach {
namespace {

using PlaceAt = Point<double>;

struct Case {
    Vec3 from, to;
    float t_from, t_to, margin;
    Intruder intruder;
};

Case random_case(Random& random)
{
    const auto vector = [&](float size) {
        return Vec3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
    };
    Case c;
    c.from = vector(10.0F);
    c.to = c.from + vector(1.5F);
    c.t_from = random.below(4) == 0 ? 0.0F : random.uniform(0.0F, 10.0F);
    c.t_to = c.t_from + (random.below(9) == 0 ? 0.0F : random.uniform(0.0F, 2.0F));
    c.intruder.velocity = random.below(9) == 0 ? Vec3(Vec3::Zero()) : vector(random.below(2) == 0 ? 3.0F : 30.0F);
    c.intruder.radius = random.uniform(0.0F, 2.0F);
    c.intruder.horizontal = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.5F);
    c.intruder.vertical = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.5F);
    c.intruder.speed_share = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.5F);
    c.margin = random.uniform(0.0F, 1.0F);
    // Near each other at some time of the segment, more often than chance has it.
    const float share = random.uniform();
    const float when = c.t_from + share * (c.t_to - c.t_from);
    const float near = c.intruder.radius + c.margin + growth_of(c.intruder, c.t_to);
    c.intruder.position = c.from + share * (c.to - c.from) - when * c.intruder.velocity +
                          random.uniform(0.5F, 1.5F) * near * vector(1.0F).normalized();
    return c;
}

PlaceAt at_share_of(const Case& c, double s) { return c.from.cast<double>() + s * (c.to - c.from).cast<double>(); }
double time_of(const Case& c, double s)
{
    return static_cast<double>(c.t_from) + s * (static_cast<double>(c.t_to) - static_cast<double>(c.t_from));
}

/// Least distance of the centres, densely and then closer about the least.
double least_distance(const Case& c)
{
    const auto apart = [&](double s) {
        const PlaceAt q = c.intruder.position.cast<double>() + time_of(c, s) * c.intruder.velocity.cast<double>();
        return (at_share_of(c, s) - q).norm();
    };
    constexpr int kSamples = 200;
    int best = 0;
    for (int k = 1; k <= kSamples; ++k) {
        best = apart(k / static_cast<double>(kSamples)) < apart(best / static_cast<double>(kSamples)) ? k : best;
    }
    double low = std::max(0.0, (best - 1) / static_cast<double>(kSamples));
    double high = std::min(1.0, (best + 1) / static_cast<double>(kSamples));
    for (int k = 0; k < 60; ++k) {
        const double a = low + (high - low) / 3.0;
        const double b = high - (high - low) / 3.0;
        (apart(a) < apart(b) ? high : low) = apart(a) < apart(b) ? b : a;
    }
    return apart(0.5 * (low + high));
}

/// Blocked whenever straight flight comes too near, and never when it stays farther than the growth and the stated
/// looseness.
TEST(MeetingLaws, TheDirectCheckIsTheClosestApproach)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    int blocked = 0;
    int clear = 0;
    for (int i = 0; i < 20000; ++i) {
        const Case c = random_case(random);
        const double least = least_distance(c);
        const double scale = static_cast<double>(c.from.norm() + c.to.norm() + c.intruder.position.norm() +
                                                 c.t_to * c.intruder.velocity.norm());
        const double limit = static_cast<double>(c.intruder.radius) + static_cast<double>(c.margin);
        const double spread =
            std::min(static_cast<double>(std::max(c.intruder.horizontal, c.intruder.vertical)), 1.3089969);
        const double grown = (std::tan(spread) + static_cast<double>(c.intruder.speed_share)) *
                             static_cast<double>(c.intruder.velocity.norm()) * static_cast<double>(c.t_to);
        const bool is = meets(c.from, c.to, c.t_from, c.t_to, c.intruder, c.margin);
        if (least <= limit + grown) {
            ASSERT_TRUE(is) << "seed " << kSeed << ", case " << i;
        }
        if (least > limit + grown * (1.0 + 1e-5) + 4e-6 * scale) {
            ASSERT_FALSE(is) << "seed " << kSeed << ", case " << i;
        }
        ++(is ? blocked : clear);
    }
    EXPECT_GT(blocked, 5000);
    EXPECT_GT(clear, 5000);
}

/// An intruder that turns off at once, anywhere within its spread, at any speed that it may have: never clear where it
/// and the vehicle are too near at the same time.
TEST(MeetingLaws, NoDeviationWithinTheSpreadIsClear)
{
    constexpr std::uint64_t kSeed = 5;
    Random random(kSeed);
    int contacts = 0;
    for (int i = 0; i < 20000; ++i) {
        const Case c = random_case(random);
        const double speed = static_cast<double>(c.intruder.velocity.norm());
        if (speed == 0.0 || meets(c.from, c.to, c.t_from, c.t_to, c.intruder, c.margin)) {
            continue;
        }
        const PlaceAt along = c.intruder.velocity.cast<double>() / speed;
        const PlaceAt across = PlaceAt::UnitZ().cross(along);
        const PlaceAt left = across.norm() < 1e-3 ? PlaceAt(PlaceAt::UnitX()) : PlaceAt(across.normalized());
        const PlaceAt up = along.cross(left);
        for (int k = 0; k < 100; ++k) {
            const double angle = static_cast<double>(random.uniform(-kPi, kPi));
            const double share = std::sqrt(static_cast<double>(random.uniform()));
            const PlaceAt direction =
                (along + share * std::cos(angle) * std::tan(static_cast<double>(c.intruder.horizontal)) * left +
                 share * std::sin(angle) * std::tan(static_cast<double>(c.intruder.vertical)) * up)
                    .normalized();
            const double error = static_cast<double>(c.intruder.speed_share * random.uniform(-1.0F, 1.0F));
            const double s = static_cast<double>(random.uniform());
            const PlaceAt q = c.intruder.position.cast<double>() + speed * (1.0 + error) * time_of(c, s) * direction;
            ASSERT_GT((at_share_of(c, s) - q).norm(), static_cast<double>(c.intruder.radius + c.margin))
                << "seed " << kSeed << ", case " << i << ", sample " << k;
        }
        ++contacts;
    }
    EXPECT_GT(contacts, 5000);
}

/// The rate in time is a share, and not lost when stays have an instant in common.
TEST(MeetingLaws, RatesAreSharesAndNeverLost)
{
    constexpr std::uint64_t kSeed = 6;
    Random random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        const auto stay = [&] {
            const float from = static_cast<float>(random.below(8));
            return Stay{from, from + static_cast<float>(random.below(4)) * (i % 2 == 0 ? 1.0F : random.uniform())};
        };
        const Stay own = stay();
        const Stay other = stay();
        const float rate = time_rate(own, other);
        ASSERT_GE(rate, 0.0F);
        ASSERT_LE(rate, 1.0F);
        ASSERT_EQ(rate >= 1e-7F, meet(own, other)) << "seed " << kSeed << ", case " << i;
        ASSERT_GE(time_rate(own, padded(other, 0.1F)), rate);
    }
}

}  // namespace
}  // namespace jink::reach
