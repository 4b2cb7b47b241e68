// SPDX-License-Identifier: BSD-3-Clause
// Inputs of a program, projection into the spheres, and levels that yield while spheres are active.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/orca/program.hpp"
#include "tests/unit/core/orca/enumerated.hpp"
#include "tests/unit/core/orca/half_space.hpp"

namespace jink::orca {
namespace {

using test::at_least;

Solution solution_of(const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres, const Vec3& preferred,
                     const Vec3& reference, std::uint32_t units = 1'000'000)
{
    Scratch<24> scratch;
    WorkBudget budget(units);
    return solve({planes, spheres, preferred, reference}, scratch.view(), budget);
}

/// Any point, one sphere or two: within both, to the bit of a float, and no farther off than it has to be.
TEST(ProgramContract, IntoTheSpheresIsWithinThem)
{
    Random random(20261129);
    for (int i = 0; i < 3000; ++i) {
        std::vector<Sphere> spheres{
            {random.uniform(0.0F, 2.0F) * enumerated::unit(random), random.uniform(0.5F, 9.0F)}};
        if (i % 2 == 0) {
            const float radius = random.uniform(0.1F, 3.0F);
            // Its centre lies within the first one.
            spheres.push_back(
                {spheres[0].centre + random.uniform(0.0F, 1.0F) * spheres[0].radius * enumerated::unit(random),
                 radius});
        }
        const Vec3 point = random.uniform(0.0F, 12.0F) * enumerated::unit(random);
        const Vec3 in = into_spheres(spheres, point);
        float most = 0.0F;
        for (const Sphere& sphere : spheres) {
            const double from = (in.cast<double>() - sphere.centre.cast<double>()).norm();
            // Its coordinates are rounded.
            ASSERT_LE(from, static_cast<double>(sphere.radius) +
                                1.2e-7 * static_cast<double>(sphere.centre.norm() + sphere.radius))
                << i;
            most = std::max(most, (point - sphere.centre).norm() - sphere.radius);
        }
        if (most <= 0.0F) {
            ASSERT_EQ(in, point) << i;
        }
        if (spheres.size() == 1 && most > 0.0F) {
            ASSERT_NEAR((in - point).norm(), most, 2e-5F) << i;
        }
    }
}

/// Numbers whose squares add up to none are no speeds.
TEST(ProgramContract, SpeedsThatOverflowTogetherAreRefused)
{
    const Vec3 huge(1.5e19F, 0, 0);
    EXPECT_EQ(solution_of({}, {{Vec3::Zero(), 2.0F}}, huge, huge).status, kBadInput);
    EXPECT_EQ(solution_of({}, {{huge, 2e38F}}, Vec3::Zero(), Vec3::Zero()).status, kBadInput);
    EXPECT_EQ(solution_of({}, {{Vec3::Zero(), 2.0F}}, {1e10F, 0, 0}, Vec3::Zero()).status, 0U);
}

/// A level that a sphere contradicts: the point of the sphere that breaks it least.
TEST(ProgramContract, WhereASphereHoldsALevelGivesWayToIt)
{
    for (const Level level : {Level::obstacles, Level::conflict, Level::warning}) {
        const Vec3 normal(0.6F, 0, 0.8F);
        const std::vector<HalfSpace> planes{at_least(normal, 3.0F, level)};
        const Solution solution = solution_of(planes, {{Vec3::Zero(), 2.0F}}, {0, 1, 0}, Vec3::Zero());
        EXPECT_EQ(solution.level, level);
        EXPECT_NEAR(solution.broken[static_cast<std::size_t>(level)], 1.0F, 1e-4F);
        // It yields by 1e-4 m/s more, and within the remaining part of the sphere it moves towards the preferred
        // velocity.
        EXPECT_LT((solution.velocity - 2.0F * normal).norm(), 0.03F);
        EXPECT_LE(planes[0].violation(solution.velocity), 1.0F + 2.1e-4F);
        // With the reachable set, from the side.
        const Solution reached = solution_of(planes, {{Vec3::Zero(), 2.0F}, {{1, 0, 0}, 0.5F}}, {0, 1, 0}, {1, 0, 0});
        EXPECT_NEAR(reached.broken[static_cast<std::size_t>(level)], 3.0F - 0.6F - 0.5F, 1e-4F);
        EXPECT_LT((reached.velocity - Vec3(1.3F, 0, 0.4F)).norm(), 0.02F);
    }
}

/// Three levels, each with two contradicting half-spaces: each violated by its own half, independent of the others.
TEST(ProgramContract, LimitsHoldWhateverGivesWay)
{
    Random random(20261130);
    for (int i = 0; i < 200; ++i) {
        std::vector<HalfSpace> planes;
        const Vec3 limit = enumerated::unit(random);
        planes.push_back(at_least(limit, -0.3F, Level::limits));
        std::vector<float> gaps;
        for (const Level level : {Level::obstacles, Level::conflict, Level::warning}) {
            const Vec3 normal = enumerated::unit(random);
            const float gap = random.uniform(-0.4F, 0.4F);
            gaps.push_back(gap);
            planes.push_back(at_least(normal, gap, level));
            planes.push_back(at_least(-normal, gap, level));
        }
        const Vec3 preferred = random.uniform(0.0F, 2.0F) * enumerated::unit(random);
        const Solution solution = solution_of(planes, {{Vec3::Zero(), 4.0F}}, preferred, Vec3::Zero());
        EXPECT_EQ(solution.status & (kInfeasibleDynamics | kWorkLimit | kBadInput), 0U) << i;
        EXPECT_LE(planes[0].violation(solution.velocity), 1e-5F) << i;
        // The strongest yielding level yields by half of its gap: the limit holds at 0.
        EXPECT_NEAR(solution.broken[1], std::max(gaps[0], 0.0F), 2e-5F) << i;
        EXPECT_EQ((solution.status & kRelaxedObstacle) != 0, gaps[0] > 0.0F) << i;
        for (const HalfSpace& plane : planes) {
            const float said = solution.broken[static_cast<std::size_t>(plane.level)];
            EXPECT_LE(plane.violation(solution.velocity), said + (said > 0.0F ? 2.1e-4F : 1e-5F)) << i;
        }
        // The level that is named is the strongest that is broken.
        for (std::size_t level = 0; level < static_cast<std::size_t>(solution.level); ++level) {
            EXPECT_EQ(solution.broken[level], 0.0F) << i;
        }
        if (solution.status != 0) {
            EXPECT_GT(solution.broken[static_cast<std::size_t>(solution.level)], 0.0F) << i;
        }
    }
}

/// Contradicting limits, at every place among others: the reference, and its violations.
TEST(ProgramContract, LimitsThatContradictLeaveTheReferenceWhateverElseThereIs)
{
    for (const bool others : {false, true}) {
        std::vector<HalfSpace> planes{at_least({1, 0, 0}, 0.5F, Level::limits),
                                      at_least({-1, 0, 0}, 0.5F, Level::limits)};
        if (others) {
            planes.push_back(at_least({0, 1, 0}, 0.7F, Level::obstacles));
            planes.push_back(at_least({0, -1, 0}, 0.1F, Level::obstacles));
            planes.push_back(at_least({0, 0, 1}, 0.9F, Level::warning));
        }
        const Vec3 reference(0.1F, 0.2F, 0.3F);
        const Solution solution = solution_of(planes, {{Vec3::Zero(), 4.0F}}, {1, 1, 1}, reference);
        EXPECT_EQ(solution.status, kInfeasibleDynamics) << "and nothing else: no level was tried";
        EXPECT_EQ(solution.velocity, reference);
        EXPECT_EQ(solution.level, Level::limits);
        EXPECT_FLOAT_EQ(solution.broken[0], 0.6F);
        if (others) {
            EXPECT_FLOAT_EQ(solution.broken[1], 0.5F);
            EXPECT_FLOAT_EQ(solution.broken[3], 0.6F);
        }
    }
}

/// Without any budget the point so far is the reference, not the preferred velocity.
TEST(ProgramContract, WithoutABudgetTheReferenceIsKept)
{
    const std::vector<HalfSpace> planes{at_least({1, 0, 0}, -3.0F, Level::obstacles)};
    const Vec3 reference(0.5F, 0.1F, 0);
    const std::vector<Sphere> spheres{{Vec3::Zero(), 4.0F}, {reference, 0.5F}};
    const Solution solution = solution_of(planes, spheres, {0.8F, 0.1F, 0}, reference, 0);
    EXPECT_EQ(solution.status, kWorkLimit);
    EXPECT_EQ(solution.velocity, reference);
}

/// Of many half-spaces through nearly one point, more than the search holds at once, the optimum is that of all.
TEST(ProgramContract, ManyHalfSpacesThroughOnePointLeaveIt)
{
    Random random(20261201);
    for (int i = 0; i < 20; ++i) {
        const Vec3 point = random.uniform(0.2F, 1.0F) * enumerated::unit(random);
        const Vec3 towards = enumerated::unit(random);
        std::vector<HalfSpace> planes;
        for (int k = 0; k < 12; ++k) {
            // A blunt cone about `towards`, whose tip is the point.
            Vec3 normal = enumerated::unit(random);
            normal = (normal - (normal.dot(towards) + 0.6F) * towards).normalized();
            planes.push_back(at_least(normal, normal.dot(point), Level::conflict));
        }
        const Solution solution = solution_of(planes, {{Vec3::Zero(), 5.0F}}, point + 2.0F * towards, Vec3::Zero());
        EXPECT_EQ(solution.status, 0U) << i;
        const auto exact = enumerated::nearest(enumerated::planes_of(planes), (point + 2.0F * towards).cast<double>());
        if (exact.has_value()) {
            EXPECT_LT((solution.velocity.cast<double>() - *exact).norm(), 1e-4) << i;
        }
        for (const HalfSpace& plane : planes) {
            EXPECT_LE(plane.violation(solution.velocity), 1e-5F) << i;
        }
    }
}

}  // namespace
}  // namespace jink::orca
