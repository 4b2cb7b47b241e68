// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/near.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/geometry/convex.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/obstacle_distance.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

// Conflicts between nodes and threats: by cells and singly, against everything, and against dense samples of the arcs.

namespace jink::reach::detail {
namespace {

using oracle::RandomSituation;

/// A set placed somewhere, with threats of every kind about.
struct Crowd : RandomSituation {
    explicit Crowd(std::uint64_t seed) : RandomSituation(seed), random(seed + 1'000'000)
    {
        const float course = random.uniform(-kPi, kPi);
        placed.set = test::unit_sets().segments[0].emergency;
        placed.origin = own.position;
        placed.cosine = std::cos(course);
        placed.sine = std::sin(course);
        placed.unit = random.uniform(0.7F, 4.0F);
        placed.period = random.uniform(0.2F, 1.0F);
        placed.upside_down = seed % 2 == 1;
        limits.half_extents = Vec3(random.uniform(0.3F, 2.0F), random.uniform(0.3F, 2.0F), random.uniform(0.3F, 2.0F));
        for (std::uint32_t i = 0; i < 6; ++i) {
            obstacles.push_back({100 + i, any_shape()});
        }
        for (int i = 0; i < 3; ++i) {
            const Vec3 at = somewhere(12.0F * placed.unit);
            const float middle = at.z() + random.uniform(-4.0F, 4.0F);
            const float tall = random.uniform(0.1F, 5.0F);
            cylinders.push_back({{at.head<2>(), random.uniform(0.2F, 3.0F)},
                                 {random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F)},
                                 middle - tall,
                                 middle + tall,
                                 random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 4.0F)});
        }
        airspace.cylinders = cylinders;
        airspace.has_ceiling = airspace.has_keep_in = true;
        airspace.floor = own.position.z() - random.uniform(2.0F, 20.0F);
        airspace.ceiling = own.position.z() + random.uniform(2.0F, 20.0F);
        airspace.home = own.position;
        airspace.keep_in_radius = random.uniform(10.0F, 60.0F);
    }

    Vec3 somewhere(float reach)
    {
        return own.position +
               Vec3(random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-6.0F, 6.0F));
    }
    geometry::Shape any_shape()
    {
        const float reach = 10.0F * placed.unit;
        const Vec3 a = somewhere(reach);
        const Vec3 b = a + Vec3(random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F));
        const float radius = random.uniform(0.1F, 2.0F);
        const Mat3 axes =
            Eigen::AngleAxisf(random.uniform(-kPi, kPi), Vec3(random.normal(), random.normal(), 1.0F).normalized())
                .toRotationMatrix();
        switch (random.below(6)) {
        case 0: return geometry::make_sphere(a, radius);
        case 1: return geometry::make_capsule(Vec3(a.x(), a.y(), 0.0F), Vec3(a.x(), a.y(), 60.0F), radius);
        case 2: return geometry::make_capsule(a, b, radius);
        case 3: return geometry::make_cylinder(a, b, radius);
        case 4: return geometry::make_box(a, Vec3(radius, 2.0F * radius, 1.0F), axes);
        default: return geometry::make_hull(kWedge, a, axes);
        }
    }

    static constexpr std::size_t kCorners = 5;
    static inline const std::array<Point3, kCorners> kWedge{
        {{0, 0, 2}, {2, 0, 0}, {-1, 2, 0}, {-1, -2, 0}, {0, 0, -1}}};
    Random random;
    Placed placed;
    std::vector<world::Cylinder> cylinders;
};

NearThreats& near_of(const Crowd& crowd, WorkBudget& budget)
{
    static NearThreats near;
    EXPECT_TRUE(near.collect(crowd.view(), crowd.placed, 0.0F, 0.0F, budget));
    EXPECT_TRUE(near.mark(crowd.placed, CellSpheres(crowd.placed.set->grid), budget));
    return near;
}

TEST(NearThreatsLaw, CellsLoseNothing)
{
    std::size_t nodes = 0;
    std::size_t met = 0;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        const Crowd crowd(seed);
        WorkBudget budget(100'000'000);
        const NearThreats& near = near_of(crowd, budget);
        const Placed& placed = crowd.placed;
        for (std::size_t i = 1; i < placed.set->nodes(); ++i) {
            const auto node = static_cast<NodeIndex>(i);
            const Seconds end = placed.time(node);
            const Level by_all = near.level(
                {placed.node(placed.set->parent[node]), placed.node(node), end - placed.period, end, placed.bulge()},
                budget);
            ASSERT_EQ(near.level(placed, node, budget), by_all) << "seed " << seed << " node " << i;
            ++nodes;
            met += by_all < kFree ? 1U : 0U;
        }
    }
    EXPECT_GT(met * 10, nodes);
    EXPECT_LT(met * 10, nodes * 9);
}

/// Cylinders alone, so that they set a movement's level: along its arc a free movement enters no margin, a movement
/// short of clearance enters no body; and bodies do close movements.
TEST(NearThreatsLaw, CylindersCloseBodiesAndTellMargins)
{
    constexpr int kSamples = 16;
    std::array<std::size_t, kRuns + 1> seen{};
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Crowd crowd(seed);
        crowd.tracks.clear();
        crowd.obstacles.clear();
        crowd.airspace.has_floor = crowd.airspace.has_ceiling = crowd.airspace.has_keep_in = false;
        WorkBudget budget(100'000'000);
        if (world::separation_at(crowd.view(), crowd.own.position, 0.0F, budget).margin < 0.0F) {
            continue;
        }
        const NearThreats& near = near_of(crowd, budget);
        const Placed& placed = crowd.placed;
        const ReachSet& set = *placed.set;
        const float extra = crowd.rules.k_sigma * crowd.own.sigma_position;
        for (int draw = 0; draw < 60; ++draw) {
            const auto node = static_cast<NodeIndex>(1 + crowd.random.below(set.nodes() - 1));
            const NodeIndex parent = set.parent[node];
            const Level level = near.level(placed, node, budget);
            ++seen[level];
            const Pose<float> from{set.position_of(parent),
                                   static_cast<float>(set.attitude[2U * parent]) * set.step.pitch,
                                   static_cast<float>(set.attitude[2U * parent + 1U]) * set.step.yaw};
            for (int i = 0; i <= kSamples && level > Level(AvoidanceRun::hard_constraints); ++i) {
                const float share = static_cast<float>(i) / kSamples;
                const Vec3 own = placed.to_world(
                    i == 0 ? from.position
                           : at_share(from, static_cast<Movement>(set.movement[node]), share, set.step).position);
                const Seconds t = placed.time(parent) + share * placed.period;
                for (const world::Cylinder& cylinder : crowd.cylinders) {
                    world::Cylinder wide = cylinder;
                    wide.circle.radius += level == kFree ? cylinder.margin : 0.0F;
                    ASSERT_GE(world::cylinder_distance(crowd.limits.half_extents, own, wide, t) - extra, -2e-3F)
                        << "seed " << seed << " node " << node << " share " << share;
                }
            }
        }
    }
    EXPECT_EQ(seen[Level(AvoidanceRun::obstacles)] + seen[Level(AvoidanceRun::intruders)], 0U);
    EXPECT_GT(seen[Level(AvoidanceRun::hard_constraints)], 300U);
    EXPECT_GT(seen[Level(AvoidanceRun::soft_constraints)], 300U);
    EXPECT_GT(seen[kFree], 3000U);
}

/// Along the arc itself, at the true times: movements reported free or short of clearance have no contact.
TEST(NearThreatsLaw, NoNodeThatIsReportedFreeTouchesAnything)
{
    constexpr int kSamples = 24;
    std::size_t looked_at = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        Crowd crowd(seed);
        WorkBudget budget(100'000'000);
        const NearThreats& near = near_of(crowd, budget);
        const Placed& placed = crowd.placed;
        const ReachSet& set = *placed.set;
        for (int draw = 0; draw < 40; ++draw) {
            const auto node = static_cast<NodeIndex>(1 + crowd.random.below(set.nodes() - 1));
            const NodeIndex parent = set.parent[node];
            // Bounds are checked at the ends of movements: the parent must be free as well.
            if (!is_free(near.level(placed, node, budget), AvoidanceRun::hard_constraints) ||
                (parent != 0 && !is_free(near.level(placed, parent, budget), AvoidanceRun::hard_constraints))) {
                continue;
            }
            const Pose<float> from{set.position_of(parent),
                                   static_cast<float>(set.attitude[2U * parent]) * set.step.pitch,
                                   static_cast<float>(set.attitude[2U * parent + 1U]) * set.step.yaw};
            ++looked_at;
            for (int i = 0; i <= kSamples; ++i) {
                const float share = static_cast<float>(i) / kSamples;
                const Vec3 own = placed.to_world(
                    i == 0 ? from.position
                           : at_share(from, static_cast<Movement>(set.movement[node]), share, set.step).position);
                const Seconds t = placed.time(parent) + share * placed.period;
                // Threats that the start is in the margin of are judged by the escape rule.
                const world::Separation now = world::separation_at(crowd.view(), crowd.own.position, 0.0F, budget);
                if (now.margin < 0.0F) {
                    break;
                }
                ASSERT_GE(world::separation_at(crowd.view(), own, t, budget).margin, -0.06F)
                    << "seed " << seed << " node " << node << " share " << share;
            }
        }
    }
    EXPECT_GT(looked_at, 2000U);
}

}  // namespace
}  // namespace jink::reach::detail
