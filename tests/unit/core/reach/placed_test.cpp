// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/placed.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/reach/small_tree.hpp"

namespace jink::reach {
namespace {

/// At (100, 50, 30), course 30 degrees to the left of north, movements of 2 m that take 0.5 s.
class PlacedTest : public ::testing::Test {
protected:
    PlacedTest()
    {
        placed.set = &set;
        placed.origin = Vec3(100.0F, 50.0F, 30.0F);
        placed.cosine = std::cos(2.0F * kPi / 3.0F);
        placed.sine = std::sin(2.0F * kPi / 3.0F);
        placed.unit = 2.0F;
        placed.period = 0.5F;
        first = tree.add(0, Movement::up_left, 1024);
        second = tree.add(first, Movement::straight, 2048);
        set = tree.view();
    }
    test::SmallTree tree;
    NodeIndex first = 0;
    NodeIndex second = 0;
    ReachSet set;
    Placed placed;
};

TEST_F(PlacedTest, AheadLeftAndUpAreWhereTheCourseHasThem)
{
    const float root = std::sqrt(3.0F);
    EXPECT_NEAR((placed.to_world(Vec3(1, 0, 0)) - Vec3(99.0F, 50.0F + root, 30.0F)).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR((placed.to_world(Vec3(0, 1, 0)) - Vec3(100.0F - root, 49.0F, 30.0F)).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR((placed.to_world(Vec3(0, 0, 1)) - Vec3(100.0F, 50.0F, 32.0F)).norm(), 0.0F, 1e-5F);
    placed.upside_down = true;
    EXPECT_NEAR((placed.to_world(Vec3(0, 0, 1)) - Vec3(100.0F, 50.0F, 28.0F)).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR((placed.to_world(Vec3(1, 0, 0)) - Vec3(99.0F, 50.0F + root, 30.0F)).norm(), 0.0F, 1e-5F);
}

TEST_F(PlacedTest, BackIntoTheSetIsTheInverse)
{
    for (const bool mirrored : {false, true}) {
        placed.upside_down = mirrored;
        const Vec3 up = placed.to_set(Vec3(100.0F, 50.0F, 34.0F));
        EXPECT_NEAR(up.z(), mirrored ? -2.0F : 2.0F, 1e-5F);
        for (const Vec3& point : {Vec3(3, -1, 2), Vec3(-0.5F, 4, -1), Vec3(0, 0, 0)}) {
            EXPECT_NEAR((placed.to_set(placed.to_world(point)) - point).norm(), 0.0F, 2e-5F);
        }
    }
}

TEST_F(PlacedTest, NodesAreAtTheirPlaceAtTheirTime)
{
    EXPECT_NEAR((placed.to_set(placed.node(first)) - tree.position(first)).norm(), 0.0F, kPositionUnit);
    EXPECT_EQ(placed.node(0), placed.origin);
    EXPECT_EQ(placed.time(0), 0.0F);
    EXPECT_EQ(placed.time(first), 0.5F);
    EXPECT_EQ(placed.time(second), 1.0F);
}

/// Every point of a movement is within the bulge of its chord; and the bulge is no more than needed for one that turns
/// about both axes, and for the rounding of tables.
TEST_F(PlacedTest, TheBulgeCoversEveryMovement)
{
    const float stored = placed.unit * kPositionUnit;
    float worst = 0.0F;
    for (const Movement movement : kAllMovements) {
        const Pose<float> from{Point<float>::Zero(), 0.0F, 0.0F};
        const Vec3 end = apply(from, movement, set.step).position;
        const Vec3 along = end.normalized();
        for (int i = 1; i < 40; ++i) {
            const Vec3 at = at_share(from, movement, static_cast<float>(i) / 40.0F, set.step).position;
            worst = std::max(worst, placed.unit * (at - along * along.dot(at)).norm());
        }
    }
    EXPECT_GE(placed.bulge(), worst + stored);
    EXPECT_LE(placed.bulge(), 1.05F * worst + stored);
}

}  // namespace
}  // namespace jink::reach
