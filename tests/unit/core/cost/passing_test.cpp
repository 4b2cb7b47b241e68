// SPDX-License-Identifier: BSD-3-Clause
// The terms that Pinheiro leaves for future work: the passing side of moving threats, and the time beyond the collision
// point.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/cost/cost.hpp"

namespace jink::cost {
namespace {

/// A path along x at 5 m/s through the origin at t = 4 s.
struct AlongX {
    std::vector<float> x, y, z, t;
    AlongX()
    {
        for (int i = 0; i <= 80; ++i) {
            t.push_back(0.1F * static_cast<float>(i));
            x.push_back(5.0F * (t.back() - 4.0F));
            y.push_back(0.0F);
            z.push_back(0.0F);
        }
    }
    [[nodiscard]] Waypoints view() const { return {x, y, z, t}; }
};

/// A threat of 1 m at 5 m/s on `course` (0: same direction, 180: head-on) that is at `at` after 4 s.
geometry::Motion threat_on(float course_degrees, const Vec3& at)
{
    const float course = course_degrees * kPi / 180.0F;
    const Vec3 velocity(5.0F * std::cos(course), 5.0F * std::sin(course), 0.0F);
    return {at - 4.0F * velocity, velocity};
}

TEST(Passing, InFrontOfWhatCrossesCostsAndBehindItDoesNot)
{
    const AlongX path;
    // It crosses from right to left and is late: the vehicle is in front of it; then early.
    const Passing front = passing(path.view(), threat_on(90.0F, Vec3(0.0F, -4.0F, 0.0F)), 1.0F);
    EXPECT_NEAR(front.share, 0.5F + 0.5F * std::sqrt(0.5F), 0.02F) << "at right angles: 45 degrees off its course";
    EXPECT_NEAR(front.gap, std::sqrt(8.0F) - 1.0F, 0.05F);
    const Passing behind = passing(path.view(), threat_on(90.0F, Vec3(0.0F, 4.0F, 0.0F)), 1.0F);
    EXPECT_NEAR(behind.share, 0.5F - 0.5F * std::sqrt(0.5F), 0.02F);
    // Over it, beside it head-on and beside it overtaking: no side is better.
    EXPECT_NEAR(passing(path.view(), threat_on(90.0F, Vec3(0.0F, 0.0F, -3.0F)), 1.0F).share, 0.5F, 0.02F);
    EXPECT_NEAR(passing(path.view(), threat_on(180.0F, Vec3(0.0F, 3.0F, 0.0F)), 1.0F).share, 0.5F, 0.1F);
    // Turned against it by more, there is less to choose: the offset is square to the relative velocity.
    const float sharp = passing(path.view(), threat_on(150.0F, Vec3(0.0F, -4.0F, 0.0F)), 1.0F).share;
    EXPECT_GT(sharp, 0.5F);
    EXPECT_LT(sharp, front.share);
}

TEST(Passing, NothingToTellIsOneHalfAndNothingThereIsNothing)
{
    const AlongX path;
    EXPECT_EQ(passing(path.view(), {Vec3(3.0F, 2.0F, 0.0F), Vec3::Zero()}, 1.0F).share, 0.5F);
    EXPECT_EQ(PassingMean{}.value(), 0.0F);
    PassingMean mean;
    mean.add({1.0F, 1.0F});
    mean.add({0.0F, 3.0F});
    EXPECT_FLOAT_EQ(mean.value(), 0.75F) << "the nearer the more";
    mean.add({0.5F, -2.0F});
    EXPECT_NEAR(mean.value(), (1.0F + 5.0F) / (1.0F + 1.0F / 3.0F + 10.0F), 1e-5F) << "contact: the least gap";
}

TEST(TimeBeyond, CountsFromAbeamOfTheCollisionPoint)
{
    AlongX path;
    for (float& x : path.x) {
        x += 20.0F;  // from 0 to 40 m in 8 s
    }
    EXPECT_NEAR(time_beyond(path.view(), Vec3::UnitX(), 20.0F), 4.0F, 1e-4F);
    EXPECT_NEAR(time_beyond(path.view(), Vec3::UnitX(), 10.25F), 8.0F - 2.05F, 1e-4F) << "between two waypoints";
    EXPECT_EQ(time_beyond(path.view(), Vec3::UnitX(), 41.0F), 0.0F) << "it does not come there";
    EXPECT_NEAR(time_beyond(path.view(), Vec3::UnitX(), 0.0F), 8.0F, 1e-4F);
    EXPECT_EQ(normalise({.beyond = 100.0F}, Caps{}).beyond, 1.0F);
    EXPECT_NEAR(normalise({.beyond = 2.0F}, Caps{}).beyond, 2.0F / (1.15F * 7.0814F), 1e-5F);
}

TEST(Weights, TheNewTermsTakeTheirShareOfOne)
{
    EXPECT_TRUE(is_valid(Weights{0.2F, 0.1F, 0.4F, 0.2F, 0.1F}));
    EXPECT_FALSE(is_valid(Weights{0.3F, 0.2F, 0.5F, 0.1F, 0.0F})) << "more than 1";
    EXPECT_FALSE(is_valid(Weights{0.4F, 0.2F, 0.5F, -0.1F, 0.0F}));
    EXPECT_FALSE(is_valid(Weights{0.4F, 0.2F, 0.5F, 0.0F, -0.1F}));
    NormalisedTerms terms;
    terms.passing = 0.5F;
    terms.beyond = 1.0F;
    EXPECT_FLOAT_EQ(total(terms, Weights{0.2F, 0.1F, 0.4F, 0.2F, 0.1F}), 0.2F);
    EXPECT_EQ(total(terms, Weights{}), 0.0F) << "not asked for";
}

}  // namespace
}  // namespace jink::cost
