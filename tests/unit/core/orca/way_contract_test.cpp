// SPDX-License-Identifier: BSD-3-Clause
// Paths along obstacles, sentence by sentence of their header: the end of a path, and the report of an exhausted
// budget.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/core/orca/obstacle_contract.hpp"

namespace jink::orca {
namespace {

using test::ObstacleContract;

/// Undecided at a coarse resolution is not clear: contact 0.2 m before the end of the path.
TEST_F(ObstacleContract, ACoarseResolutionDoesNotOverlookTheEndOfTheWay)
{
    settings.resolution = 0.5F;
    add(geometry::make_sphere({5.8F, 0, 0}, 1.0F));
    EXPECT_FALSE(way({1, 0, 0}, 4.0F).clear);
    EXPECT_LE(way({1, 0, 0}, 4.0F).clear_until, 3.8F + 1e-3F);
    only_hull({{4.8F, -1, -1}, {4.8F, 1, -1}, {4.8F, 0, 1}, {6, 0, 0}});
    EXPECT_FALSE(way({1, 0, 0}, 4.0F).clear);
}

/// Within the resolution, but not at rest there: the step that is proven is taken.
TEST_F(ObstacleContract, TheFirstStepIsTakenWhateverTheResolution)
{
    settings.resolution = 0.5F;
    add(geometry::make_sphere({2.3F, 0, 0}, 1.0F));
    const WayClearance found = way({1, 0, 0}, 4.0F);
    EXPECT_FALSE(found.clear);
    EXPECT_NEAR(found.clear_until, 0.3F, 1e-3F);
}

/// Contact at 3.677 m: a path that ends before it is clear, also if only the second sample shows this.
TEST_F(ObstacleContract, AWayThatEndsShortlyBeforeTheContactIsClear)
{
    add(geometry::make_sphere({5, 1.5F, 0}, 1.0F));
    const float contact = 5.0F - std::sqrt(4.0F - 2.25F);
    for (const float length : {3.6F, 3.66F}) {
        EXPECT_TRUE(way({1, 0, 0}, length).clear) << length;
        EXPECT_EQ(way({1, 0, 0}, length).clear_until, length);
    }
    EXPECT_FALSE(way({1, 0, 0}, 3.7F).clear);
    EXPECT_NEAR(way({1, 0, 0}, 3.7F).clear_until, contact, 1e-3F);
}

/// Without path length and budget the place itself is unknown.
TEST_F(ObstacleContract, AWayOfNoLengthIsNotClearWithoutABudget)
{
    settings.vertical = 0.8F;
    add(geometry::make_capsule({0.5F, -3, -2}, {0.5F, 3, 2}, 0.5F));
    const WayClearance found = way({1, 0, 0}, 0.0F, 0);
    EXPECT_FALSE(found.clear);
    EXPECT_TRUE(found.bounded);
    EXPECT_EQ(found.clear_until, 0.0F);
}

/// A contact that is proven stays so when the budget runs out at the next obstacle.
TEST_F(ObstacleContract, AProvenContactIsNoBound)
{
    settings.vertical = 0.8F;
    add(geometry::make_capsule({1.2F, -3, -2}, {1.2F, 3, 2}, 0.5F));
    std::vector<WayClearance> alone;
    for (std::uint32_t units = 0; units < 200; ++units) {
        alone.push_back(way({1, 0, 0}, 4.0F, units));
    }
    ASSERT_FALSE(alone.back().clear || alone.back().bounded);
    EXPECT_EQ(alone.back().clear_until, 0.0F) << "it is in its margin";
    add(geometry::make_capsule({-1.2F, -3, -2}, {-1.2F, 3, 2}, 0.5F));
    for (std::uint32_t units = 0; units < 200; ++units) {
        const WayClearance both = way({1, 0, 0}, 4.0F, units);
        EXPECT_FALSE(both.clear) << units;
        if (!alone[units].bounded) {
            EXPECT_FALSE(both.bounded) << units;
            EXPECT_EQ(both.source, 0) << units;
        }
    }
}

/// If the budget runs out anywhere, the path is never reported clear beyond the truth.
TEST_F(ObstacleContract, AWayIsNeverClearBeyondWhatWasLookedAt)
{
    settings.vertical = 0.8F;
    add_hull({{5, -2, -2}, {5, 2, -2}, {5, 0, 2}, {6, 0, 0}});
    add(geometry::make_capsule({5, 3, -3}, {4, 3, 3}, 0.5F));
    const Vec3 velocity(1, 0.4F, 0.1F);
    const WayClearance whole = way(velocity, 6.0F);
    ASSERT_FALSE(whole.clear || whole.bounded);
    std::uint32_t enough = 0;
    for (std::uint32_t units = 0; units < 400; ++units) {
        const WayClearance some = way(velocity, 6.0F, units);
        EXPECT_FALSE(some.clear) << units;
        EXPECT_LE(some.clear_until, whole.clear_until + 1e-4F) << units;
        enough = some.bounded ? units + 1 : enough;
    }
    EXPECT_GT(enough, 3U);
    EXPECT_LT(enough, 400U);
    // And one that is clear needs all of its budget.
    only_hull({{5, -2, -2}, {5, 2, -2}, {5, 0, 2}, {6, 0, 0}});
    const Vec3 beside(1, 0.6F, 0);
    ASSERT_TRUE(way(beside, 6.0F).clear);
    EXPECT_FALSE(way(beside, 6.0F, 0).clear);
}

}  // namespace
}  // namespace jink::orca
