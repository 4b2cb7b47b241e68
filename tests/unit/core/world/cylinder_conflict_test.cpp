// SPDX-License-Identifier: BSD-3-Clause
// Reports on a closed area on the path.
#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

struct CylinderOnTheWay : testing::Test {
    CylinderOnTheWay()
    {
        scene.leg(Vec3(0, 0, 0), Vec3(100, 0, 0), 5.0F);
        scene.own.sigma_position = 0.2F;
    }
    [[nodiscard]] bool meets(Conflict& out)
    {
        WorkBudget budget(kPlenty);
        const Situation s = scene.situation();
        return main_conflict(s, way_of(s), 12.0F, budget, out);
    }
    Scene scene;
    Conflict found;
};

TEST_F(CylinderOnTheWay, IsReportedAsTheBodyIsMet)
{
    scene.cylinder(Vec2(30, 2), 4.0F, Vec2(0, -0.5F));
    ASSERT_TRUE(meets(found));
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::cylinder, 0}));
    EXPECT_NEAR(found.radius_at_closest, 4.0F + 0.6F, 1e-4F);
    EXPECT_GE(found.time_to_closest, found.time_to_loss);
    EXPECT_NEAR(found.own_at_closest.x(), 5.0F * found.time_to_closest, 1e-3F);
    EXPECT_NEAR(found.threat_at_closest.x(), 30.0F, 1e-3F);
    EXPECT_NEAR(found.threat_at_closest.y(), 2.0F - 0.5F * found.time_to_closest, 1e-3F);
    EXPECT_NEAR(found.miss_distance, (found.threat_at_closest - found.own_at_closest).norm(), 1e-4F);
    EXPECT_LT(found.margin, 0.0F);
}

/// The cylinder's centre is reported at the own height, or at the nearest height of the cylinder.
TEST_F(CylinderOnTheWay, IsReportedAtTheOwnHeightWithinItsOwn)
{
    scene.cylinder(Vec2(30, 0), 4.0F);
    const auto height = [&](float bottom, float top) {
        scene.cylinders[0].bottom = bottom;
        scene.cylinders[0].top = top;
        scene.airspace.cylinders = scene.cylinders;
        EXPECT_TRUE(meets(found));
        return found.threat_at_closest.z();
    };
    EXPECT_EQ(height(-20.0F, 20.0F), 0.0F);
    EXPECT_EQ(height(0.5F, 20.0F), 0.5F) << "the box reaches up to it";
    EXPECT_EQ(height(-20.0F, -0.75F), -0.75F);
}

/// Contact at the path's end, long after the arrival.
TEST_F(CylinderOnTheWay, AStormOverTheEndIsReportedWhenItComes)
{
    scene.leg(Vec3(0, 0, 0), Vec3(10, 0, 0), 5.0F);
    scene.cylinder(Vec2(10, 30), 4.0F, Vec2(0, -3));
    ASSERT_TRUE(meets(found));
    // 30 - 4 - 1 - 0.6 m at 3 m/s.
    EXPECT_NEAR(found.time_to_loss, 24.4F / 3.0F, 1e-2F);
    EXPECT_NEAR(found.time_to_closest, 10.0F, 0.7F) << "over it by then";
    EXPECT_NEAR(found.own_at_closest.x(), 10.0F, 1e-3F);
    scene.cylinders[0].velocity = Vec2(0, -2);
    scene.airspace.cylinders = scene.cylinders;
    EXPECT_FALSE(meets(found)) << "12.2 s";
}

/// For any remaining budget: an unchecked threat is a conflict now.
TEST_F(CylinderOnTheWay, WhereTheBudgetRunsOutItIsMetNow)
{
    scene.cylinder(Vec2(300, 0), 4.0F);
    scene.cylinder(Vec2(30, 2), 4.0F);
    scene.airspace.cylinders = scene.cylinders;
    const Situation s = scene.situation();
    WorkBudget ample(kPlenty);
    ASSERT_TRUE(main_conflict(s, way_of(s), 12.0F, ample, found));
    ASSERT_EQ(found.threat.index, 1U);
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        Conflict now;
        ASSERT_TRUE(main_conflict(s, way_of(s), 12.0F, budget, now)) << n;
        ASSERT_EQ(now.time_to_loss, 0.0F) << n;
        ASSERT_EQ(now.margin, -kSeparationCap) << n;
        ASSERT_EQ(now.threat.kind, ThreatKind::cylinder) << n;
        ASSERT_EQ(now.threat.index, n < units::kConflictCylinder + units::kCylinderPart ? 0U : now.threat.index) << n;
    }
}

/// Into its rim at the path's end; the cylinder moves on over the hovering vehicle.
TEST_F(CylinderOnTheWay, IsDeepestWhileItHovers)
{
    scene.leg(Vec3(0, 0, 0), Vec3(10, 0, 0), 5.0F);
    scene.cylinder(Vec2(18, 0), 6.0F, Vec2(-0.8F, 0));
    ASSERT_TRUE(meets(found));
    // 18 - 6 - 1.6 m at 5.8 m/s.
    EXPECT_NEAR(found.time_to_loss, 10.4F / 5.8F, 1e-2F);
    EXPECT_GT(found.time_to_closest, 4.0F);
    EXPECT_LT(found.margin, -5.0F);
    EXPECT_NEAR(found.own_at_closest.x(), 10.0F, 1e-3F);
    EXPECT_NEAR(found.threat_at_closest.x(), 18.0F - 0.8F * found.time_to_closest, 1e-3F);
}

/// Exact contact counts; a slightly wider pass does not.
TEST_F(CylinderOnTheWay, BesideItIsNoConflict)
{
    scene.cylinder(Vec2(30, 5.7F), 4.0F);  // 0.1 m beside the box and its uncertainty
    EXPECT_FALSE(meets(found));
    scene.cylinders[0].circle.centre.y() = 5.5F;
    scene.airspace.cylinders = scene.cylinders;
    EXPECT_TRUE(meets(found));
}

}  // namespace
}  // namespace jink::world
