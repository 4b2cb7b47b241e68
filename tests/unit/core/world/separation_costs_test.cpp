// SPDX-License-Identifier: BSD-3-Clause
// Cost of a check, to the work unit: threats that are certainly not nearer are skipped, checked ones cost once.
#include <vector>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/separation_parts.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

struct ExactCosts : testing::Test {
    /// Without the cost of the path itself.
    [[nodiscard]] std::uint32_t cost(const path::TimedPath& path, const EscapeRule& escape = {},
                                     const Cutoff& cutoff = {}) const
    {
        WorkBudget budget(kPlenty);
        static_cast<void>(least_separation(scene.situation(), path, 100.0F, budget, escape, cutoff));
        return budget.spent() - 1 - static_cast<std::uint32_t>(path.points.size()) * units::kPathPiece;
    }
    /// A threat that may be near all `pieces` of one chunk.
    static std::uint32_t near(std::uint32_t pieces)
    {
        return units::kThreat + units::kThreatChunk + pieces * units::kThreatPiece;
    }
    /// Eastwards at 1 m/s in pieces of a second.
    static path::TimedPath east(int pieces)
    {
        std::vector<Vec3> positions;
        for (int i = 0; i <= pieces; ++i) {
            positions.push_back(Vec3(static_cast<float>(i), 0, 0));
        }
        return flight(positions, 1.0F);
    }
    [[nodiscard]] std::uint32_t query(const Vec3& from, const Vec3& to) const
    {
        WorkBudget budget(kPlenty);
        static_cast<void>(obstacle_margin(scene.limits.half_extents, from, to, scene.obstacles[0].shape, budget, 0.0F));
        return budget.spent();
    }
    Scene scene;
};

/// A solid is checked once at the start of the flight and once per piece that its own axes do not prove to be as far
/// away as what was found.
TEST_F(ExactCosts, ASolidOnceAtTheStartAndOnceForEachPiece)
{
    scene.obstacle(geometry::make_box(Vec3(2, 4, 0), Vec3(40, 2.5F, 40)));
    std::uint32_t expected = near(3) + query(Vec3::Zero(), Vec3::Zero());
    for (int i = 0; i < 3; ++i) {
        const auto x = static_cast<float>(i);
        expected += units::kBoxBound + (i == 0 ? query(Vec3(x, 0, 0), Vec3(x + 1.0F, 0, 0)) : 0U);
    }
    EXPECT_EQ(cost(east(3)), expected);
}

/// Of eight pieces only the one that is near.
TEST_F(ExactCosts, PiecesFarFromASolidAreNotLookedAt)
{
    scene.obstacle(geometry::make_box(Vec3(0.5F, 2.3F, 0), Vec3(0.2F, 0.2F, 0.2F)));
    std::vector<Vec3> positions;
    for (int i = 0; i <= 8; ++i) {
        positions.push_back(Vec3(10.0F * static_cast<float>(i), 0, 0));
    }
    const path::TimedPath path = flight(positions, 1.0F);
    EXPECT_EQ(cost(path),
              near(8) + query(Vec3::Zero(), Vec3::Zero()) + units::kBoxBound + query(Vec3::Zero(), Vec3(10, 0, 0)));
}

/// After an earlier contact 2 m deep, a sphere is not checked while it is smaller than that, though later in contact
/// and growing.
TEST_F(ExactCosts, WhatIsSmallerThanADeepContactIsNotLookedAt)
{
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(3, 0, 0), Vec3(6, 0, 0), Vec3(9, 0, 0)}, 1.0F);
    scene.track(Vec3(20, 0, 0), Vec3(-20, 0, 0), 2.0F);
    const std::uint32_t first = cost(path);
    ASSERT_NEAR(separation(scene, path).margin, -2.0F, 1e-4F);
    scene.track(Vec3(1.6F, 0, 0), Vec3::Zero(), 0.5F).max_acceleration = 0.8F;  // 0.9 m after a second, 4.1 m after 3
    EXPECT_EQ(cost(path) - first, near(3));
}

/// A shrunk sphere is checked with its size at that time, not with a larger one.
TEST_F(ExactCosts, AShrunkSphereIsSmallerNotLarger)
{
    scene.track(Vec3(4, 0, 0), Vec3(-4, 0, 0), 1.0F);
    const std::uint32_t first = cost(east(1));
    ASSERT_NEAR(separation(scene, east(1)).margin, -1.0F, 1e-4F);
    // A metre and a half inside, left behind at 2 m/s.
    scene.track(Vec3(-2.5F, 0, 0), Vec3(-1, 0, 0), 3.0F);
    EXPECT_EQ(cost(east(1)) - first, near(1));
}

/// Cylinders: both ends of a piece once; an instant once.
TEST_F(ExactCosts, ACylinderOnceForEachPieceThatDoesNotEscape)
{
    scene.cylinder(Vec2(-10, 0), 3.0F);
    EXPECT_EQ(cost(east(1)), near(1) + units::kCylinderPart) << "it is left behind: nearest at the start";
    EXPECT_EQ(cost(east(3)), near(3) + 3 * units::kCylinderPart);
    EXPECT_EQ(cost(flight({Vec3::Zero()}, 1.0F)), near(1) + units::kCylinderPart) << "standing";
}

/// Inside a cylinder: until the surface has grown back, then the whole of it.
TEST_F(ExactCosts, ACylinderTwiceInThePieceInWhichAnEscapeEnds)
{
    scene.cylinder(Vec2(-3.5F, 0), 3.0F);  // half a metre inside: 0.55 m at 0.5 m/s
    EXPECT_EQ(cost(east(1)), near(1) + units::kCylinderPart);
    EXPECT_EQ(cost(east(2)), near(2) + 3 * units::kCylinderPart);
    EXPECT_EQ(cost(east(3)), near(3) + 4 * units::kCylinderPart);
    EXPECT_EQ(cost(east(3), {0.05F, 0.0F}), near(3) + 3 * units::kCylinderPart) << "one that does not grow back";
    EXPECT_EQ(cost(flight({Vec3::Zero()}, 1.0F)), near(1) + units::kCylinderPart);
}

/// No rule, no parts.
TEST_F(ExactCosts, WhatDoesNotGrowBackIsLookedAtAsAWhole)
{
    scene.track(Vec3(-3.5F, 0, 0), Vec3::Zero(), 3.0F);
    EXPECT_EQ(cost(east(1), {0.0F, 0.0F}), near(1) + units::kSpherePart);
    EXPECT_EQ(cost(east(1), {0.05F, 0.0F}), near(1) + units::kSpherePart);
}

/// Exactly at a cylinder's clearance a flight starts outside of it: no credit to go in.
TEST(CylinderStarts, ExactlyOutsideHaveNoCredit)
{
    Scene scene;
    scene.cylinder(Vec2(5, 0), 3.0F);
    scene.rules.k_sigma = 1.0F;
    scene.own.sigma_position = cylinder_distance(Vec3::Ones(), Vec3::Zero(), scene.cylinders[0], 0.0F);
    EXPECT_NEAR(separation(scene, flight({Vec3::Zero(), Vec3(0.04F, 0, 0)}, 0.01F)).margin, -0.04F, 1e-5F);
    scene.own.sigma_position += 1e-4F;
    EXPECT_GT(separation(scene, flight({Vec3::Zero(), Vec3(0.04F, 0, 0)}, 0.01F)).margin, 0.0F) << "inside";
}

/// For a large box close to a solid, the margin is the distance less the clearance, not a share of the box.
TEST(ObstacleMargins, OfALargeBoxAreNoShareOfItWhereItIsClear)
{
    const auto margin = [](float gap, float extra) {
        WorkBudget budget(kPlenty);
        const geometry::Shape wall = geometry::make_box(Vec3(0, 25.0F + gap, 0), Vec3(50, 5, 50));
        return obstacle_margin(Vec3(20, 20, 20), Vec3::Zero(), Vec3(1, 0, 0), wall, budget, extra);
    };
    for (const float gap : {0.005F, 0.01F, 0.02F, 0.04F}) {
        for (const float extra : {0.1F, 0.3F, 1.0F}) {
            EXPECT_LE(margin(gap, extra), gap - extra + 1e-3F) << gap << ' ' << extra;
            EXPECT_GE(margin(gap, extra), gap - extra - kObstacleResolution - 5e-3F) << gap << ' ' << extra;
        }
        EXPECT_GE(margin(gap, 0.0F), 0.0F);
    }
}

}  // namespace
}  // namespace jink::world
