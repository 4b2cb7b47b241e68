// SPDX-License-Identifier: BSD-3-Clause
// Results do not depend on the world's origin, or on the direction of north.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/orca/obstacle_view.hpp"
#include "core/orca/smoothing.hpp"
#include "tests/oracle/hull_obstacles.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/unit/core/orca/orca_input.hpp"

namespace jink::orca {
namespace {

using test::OrcaInput;
using world::PlanStatus;

/// The scene of one thing that binds, moved by `by` and turned by quarters, and the command turned back.
class OrcaAnywhere : public OrcaInput {
protected:
    enum Thing { cylinder, fence, floor, ceiling, box, hull, track, leg, kThings };

    [[nodiscard]] static Vec3 quarter(const Vec3& v, int quarters)
    {
        Vec3 out = v;
        for (int i = 0; i < quarters; ++i) {
            out = Vec3(-out.y(), out.x(), out.z());
        }
        return out;
    }
    Vec3 command_at(Thing thing, const Vec3& by, int quarters)
    {
        const auto placed = [&](const Vec3& v) { return Vec3(quarter(v, quarters) + by); };
        scene = world::test::Scene();
        scene.own.stamp = scene.now;
        scene.own.position = placed(Vec3(0, 0, 30));
        scene.own.velocity = quarter(Vec3(1, 0.5F, 0.25F), quarters);
        scene.leg(scene.own.position, placed(Vec3(200, 50, 30)), 5.0F);
        scene.airspace.home = placed(Vec3(-6, 2, 3));
        std::vector<Vec3> corners;
        const Vec3 middle = placed(Vec3(13, 7, 0));
        switch (thing) {
        case cylinder:
            scene.cylinder(middle.head<2>(), 10.0F, quarter(Vec3(-0.3F, 0.2F, 0), quarters).head<2>());
            scene.cylinders[0].bottom = by.z() - 20.0F;
            scene.cylinders[0].top = by.z() + 60.0F;
            break;
        case fence:
            scene.airspace.has_keep_in = true;
            scene.airspace.keep_in_radius = 9.0F;
            break;
        case floor:
            scene.airspace.has_floor = true;
            scene.airspace.floor = by.z() + 29.2F;
            break;
        case ceiling:
            scene.airspace.has_ceiling = true;
            scene.airspace.ceiling = by.z() + 30.9F;
            break;
        case box: scene.obstacle(geometry::make_box(placed(Vec3(6, 1, 31)), Vec3(2, 2, 2))); break;
        case hull:
            for (int c = 0; c < 8; ++c) {
                corners.push_back(placed(
                    Vec3((c & 1) != 0 ? 8.0F : 4.0F, (c & 2) != 0 ? 3.0F : -1.0F, (c & 4) != 0 ? 33.0F : 29.0F)));
            }
            break;
        case track:
            scene.track(placed(Vec3(12, 4, 30.5F)), quarter(Vec3(-2, -1, 0), quarters)).cooperative = true;
            break;
        default: break;
        }
        const oracle::HullObstacles hulls({corners});
        if (thing == hull) {
            scene.obstacles.push_back(hulls.all()[0]);
        }
        planner = Planner(settings);
        EXPECT_EQ(plan(), PlanStatus::found);
        return quarter(out.command, (4 - quarters) % 4);
    }
};

TEST_F(OrcaAnywhere, TheAnswerIsTheSame)
{
    const Vec3 free = command_at(leg, Vec3::Zero(), 0);
    for (int thing = 0; thing < kThings; ++thing) {
        const Vec3 here = command_at(static_cast<Thing>(thing), Vec3::Zero(), 0);
        if (thing != leg) {
            EXPECT_GT((here - free).norm(), 0.02F) << "it binds, " << thing;
        }
        for (const Vec3& by : {Vec3(40, -25, 7), Vec3(-90, 60, -20), Vec3(0, 35, 0)}) {
            for (int quarters = 0; quarters < 4; ++quarters) {
                EXPECT_LT((command_at(static_cast<Thing>(thing), by, quarters) - here).norm(), 2e-3F)
                    << thing << " turned by " << quarters;
            }
        }
    }
}

/// A search that has ended by itself is not cut short, however far the obstacle is, and one that ends at its reach is
/// not either.
TEST(ObstacleSearches, ThatEndByThemselvesAreNotCutShort)
{
    Random random(20261202);
    for (int i = 0; i < 400; ++i) {
        const Vec3 to = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
        const Mat3 turned = Eigen::AngleAxisf(random.uniform(0, 3), to).toRotationMatrix();
        const world::Obstacle box{0, geometry::make_box(random.uniform(5.0F, 90.0F) * to, Vec3(2, 1, 3), turned)};
        const std::vector<world::Threat> threats = oracle::threats_of({&box, 1});
        const Obstacles scene(threats);
        const detail::ObstacleView view{scene, {random.uniform(0.6F, 3.0F), 1.0F}, 1e-4F};
        WorkBudget budget(1'000'000);
        const detail::Sighting whole = view.obstacle(0, Vec3::Zero(), 1e6F, budget);
        ASSERT_FALSE(whole.bounded) << i;
        const float reach = random.uniform(0.05F, 0.999F) * whole.distance;
        const detail::Sighting some = view.obstacle(0, Vec3::Zero(), reach, budget);
        ASSERT_GE(some.distance, reach) << i;
        ASSERT_FALSE(some.bounded) << i;
    }
}

/// A mean of one is the command itself, to the bit.
TEST(SmoothingOfOne, IsTheCommandToTheBit)
{
    CommandFilter one(1);
    Random random(20261203);
    for (int i = 0; i < 200; ++i) {
        const Vec3 command(random.uniform(-1, 1), random.uniform(-1000, 1000), 1e-3F * random.uniform(-1, 1));
        ASSERT_EQ(one.add(command), command) << i;
    }
}

}  // namespace
}  // namespace jink::orca
