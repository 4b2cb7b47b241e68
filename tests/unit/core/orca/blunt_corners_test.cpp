// SPDX-License-Identifier: BSD-3-Clause
// When a program is solved again in double-float: if the active planes' angles are below 0.1 rad, or more than three
// are active. Detected by the work units: an iteration in double-float costs sixteen times as much.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/program.hpp"

namespace jink::orca {
namespace {

/// Half-spaces that let nothing pass `reach` along each direction, and a preferred velocity beyond all of them.
class BluntCorners : public ::testing::Test {
protected:
    static HalfSpace below(const Vec3& direction, float reach, Level level = Level::conflict)
    {
        HalfSpace out;
        out.normal = -direction.normalized();
        out.offset = -reach;
        out.level = level;
        return out;
    }
    static Vec3 turned(float angle) { return {std::cos(angle), std::sin(angle), 0.0F}; }
    std::uint32_t work()
    {
        Scratch<16> scratch;
        WorkBudget budget(1'000'000);
        solution = solve({planes, spheres, preferred, Vec3::Zero()}, scratch.view(), budget);
        EXPECT_EQ(solution.status & (kBadInput | kWorkLimit | kInfeasibleDynamics), 0U);
        return budget.spent();
    }
    /// Threshold: below the extra cost of one double-float iteration on one plane.
    bool refined() { return work() > 100U; }

    std::vector<HalfSpace> planes;
    std::vector<Sphere> spheres{{Vec3::Zero(), 20.0F}};
    Vec3 preferred = Vec3(5, 0, 0);
    Solution solution;
};

TEST_F(BluntCorners, PlainAnswersAreNot)
{
    EXPECT_FALSE(refined()) << "nothing holds it " << work();
    planes = {below({1, 0, 0}, 1.0F)};
    EXPECT_FALSE(refined()) << work();
    planes.push_back(below({0, 1, 0}, 1.0F));
    preferred = {5, 5, 0};
    EXPECT_FALSE(refined()) << work();
    planes.push_back(below({0, 0, 1}, 1.0F));
    preferred = {5, 5, 5};
    EXPECT_FALSE(refined()) << work();
    EXPECT_EQ(solution.actives, 3U);
    spheres = {{Vec3::Zero(), 1.5F}};
    preferred = {5, 0, 0};
    EXPECT_FALSE(refined()) << "a half-space and a sphere beyond it " << work();
    spheres = {{Vec3::Zero(), 0.9F}};
    EXPECT_FALSE(refined()) << "a sphere alone " << work();
    spheres = {{Vec3::Zero(), 2.0F}, {{1, 0, 0}, 1.5F}};
    planes.clear();
    preferred = {1, 9, 0};
    EXPECT_FALSE(refined()) << "two spheres " << work();
}

TEST_F(BluntCorners, SmallAnglesAre)
{
    for (const float angle : {0.09F, 0.11F}) {
        // Both hold a velocity between their directions.
        planes = {below(turned(0.5F * angle), 1.0F), below(turned(-0.5F * angle), 1.0F)};
        preferred = {5, 0, 0};
        EXPECT_EQ(refined(), angle < 0.1F) << work();
        EXPECT_EQ(solution.actives, 2U);
        // Opposite ones that leave just a point between them.
        planes = {below(turned(0.5F * angle), 1.0F), below(-turned(-0.5F * angle), -1.0F + 1e-7F)};
        preferred = {1, 9, 0};
        EXPECT_EQ(refined(), angle < 0.1F) << "opposite " << work();
        // A half-space and a sphere.
        planes = {below(turned(angle), std::cos(angle) * 2.0F)};
        spheres = {{Vec3::Zero(), 2.0F}};
        preferred = turned(-0.0F) * 9.0F + Vec3(0, 0.2F, 0);
        EXPECT_EQ(refined(), angle < 0.1F) << "sphere " << work();
        spheres = {{Vec3::Zero(), 20.0F}};
    }
}

/// Three planes in a flat corner, though no two are nearly parallel.
TEST_F(BluntCorners, FlatCornersOfThreeAre)
{
    for (const float height : {0.02F, 0.2F}) {
        planes.clear();
        for (int k = 0; k < 3; ++k) {
            const Vec3 side = turned(2.0943951F * static_cast<float>(k));
            planes.push_back(below(side + height * Vec3::UnitZ(), 1.0F));
        }
        preferred = {0, 0, 500};
        spheres = {{Vec3::Zero(), 1000.0F}};
        EXPECT_EQ(refined(), height < 0.1F) << work();
        EXPECT_EQ(solution.actives, 3U);
    }
}

/// More than three through the point that is found: which of them hold it is open.
TEST_F(BluntCorners, MoreThanThreeAre)
{
    preferred = {5, 0, 0};
    planes = {below({1, 1, 0}, 1.0F), below({1, -1, 0}, 1.0F), below({1, 0, 1}, 1.0F)};
    EXPECT_FALSE(refined()) << work();
    planes.push_back(below({1, 0, -1}, 1.0F));
    EXPECT_TRUE(refined()) << work();
    EXPECT_LT((solution.velocity - Vec3(std::sqrt(2.0F), 0, 0)).norm(), 1e-4F);
    planes.pop_back();
    spheres = {{Vec3::Zero(), std::sqrt(2.0F)}};
    EXPECT_GT(work(), 32U) << "a sphere beside three: one turn, which finds nothing better";
    planes.pop_back();
    spheres.push_back({{1, 0, 0}, std::sqrt(2.0F) - 1.0F});
    EXPECT_GT(work(), 32U) << "two spheres beside two";
    // A plane off by 0.01 m/s is not active.
    planes = {below({1, 1, 0}, 1.0F), below({1, -1, 0}, 1.0F), below({1, 0, 1}, 1.0F), below({1, 0, -1}, 1.01F)};
    spheres = {{Vec3::Zero(), 20.0F}};
    EXPECT_FALSE(refined()) << work();
}

/// A sphere that is a point holds everything.
TEST_F(BluntCorners, ASphereThatIsAPointAndAHalfSpaceThroughItAre)
{
    spheres = {{Vec3::Zero(), 20.0F}, {{1, 0, 0}, 0.0F}};
    EXPECT_FALSE(refined()) << work();
    EXPECT_LT((solution.velocity - Vec3(1, 0, 0)).norm(), 1e-6F);
    planes = {below({0, 1, 0}, 0.0F)};
    static_cast<void>(work());
    EXPECT_LT((solution.velocity - Vec3(1, 0, 0)).norm(), 1e-6F);
    EXPECT_EQ(solution.status, 0U);
}

// --- yielding levels ---

TEST_F(BluntCorners, AFifthAsFarBrokenIs)
{
    planes = {below({1, 1, 1}, -0.5F), below({1, -1, -1}, -0.5F), below({-1, 1, -1}, -0.5F), below({-1, -1, 1}, -0.5F)};
    preferred = {0.3F, 0.1F, 0};
    static_cast<void>(work());
    EXPECT_NEAR(solution.broken[2], 0.5F, 1e-4F);
    EXPECT_LT(solution.velocity.norm(), 1e-3F);
    // A fifth one as far broken: it is open which four decide.
    planes.push_back(below({1, 0, 0}, -0.5F));
    EXPECT_TRUE(refined()) << work();
    EXPECT_NEAR(solution.broken[2], 0.5F, 1e-4F);
}

/// Hard half-spaces balance the yielding ones with many times their share.
TEST_F(BluntCorners, LargeSharesAre)
{
    for (const float yield : {1.0F, 0.06F, 0.04F, 0.02F}) {
        planes = {below({1, 1, 1}, -0.5F), below({1, -1, -1}, -0.5F), below({-1, 1, -1}, -0.5F),
                  below({-1, -1, 1}, -0.5F)};
        for (HalfSpace& plane : planes) {
            plane.yield = yield;
        }
        EXPECT_EQ(refined(), yield < 0.05F) << "their sum is one over the yield, twenty are too many " << work();
        EXPECT_NEAR(solution.broken[2], 0.5F / yield, 1e-3F / yield);
    }
}

/// A contradiction of no more than rounding times the shares.
TEST_F(BluntCorners, SmallContradictionsAre)
{
    for (const float by : {0.5F, 3e-5F}) {
        planes = {below({1, 1, 1}, -by), below({1, -1, -1}, -by), below({-1, 1, -1}, -by), below({-1, -1, 1}, -by)};
        EXPECT_EQ(refined(), by < 4e-5F) << work();
        EXPECT_NEAR(solution.broken[2], by, 1e-5F);
    }
}

/// A sphere that is a point counts as one more that holds it.
TEST_F(BluntCorners, ASphereThatIsAPointBesideTwoIs)
{
    spheres = {{Vec3::Zero(), 20.0F}, {{1, 0, 0}, 0.0F}};
    planes = {below({1, 0, 0}, 1.0F)};
    EXPECT_LE(work(), 32U);
    planes.push_back(below({0, 1, 0}, 0.0F));
    EXPECT_GT(work(), 32U);
    EXPECT_LT((solution.velocity - Vec3(1, 0, 0)).norm(), 1e-6F);
}

}  // namespace
}  // namespace jink::orca
