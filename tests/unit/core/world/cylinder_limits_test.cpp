// SPDX-License-Identifier: BSD-3-Clause
// Cylinders: one large value among small ones, instants of the least distance, and the cost of its search.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "core/world/cylinder.hpp"
#include "tests/unit/core/world/cylinder_pair.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::CylinderApproach;

/// For every large value its rounding bound is subtracted: never above the true value.
TEST(CylinderRounding, OneLargeNumberIsEnough)
{
    Random random(20261211);
    const auto small = [&] { return random.uniform(-3.0F, 3.0F); };
    for (int i = 0; i < 20000; ++i) {
        Pair p;
        p.half = Vec3(random.uniform(0.1F, 3.0F), random.uniform(0.1F, 3.0F), random.uniform(0.1F, 3.0F));
        p.own = Vec3(small(), small(), small());
        p.velocity = Vec3::Zero();
        p.cylinder = {
            {Vec2(small(), small()), random.uniform(0.1F, 3.0F)}, Vec2(small(), small()), small(), 0.0F, 0.0F};
        p.cylinder.top = p.cylinder.bottom + random.uniform(0.0F, 3.0F);
        p.start = random.uniform(0.0F, 3.0F);
        p.outset = small();
        const float size = std::pow(10.0F, random.uniform(3.0F, 5.0F));
        const float large = random.below(2) == 0 ? size : -size;
        const auto which = random.below(10);
        switch (which) {
        case 0: p.cylinder.circle.centre.x() = large; break;
        case 1: p.cylinder.circle.centre.y() = large; break;
        case 2: p.cylinder.velocity = Vec2(std::clamp(large, -500.0F, 500.0F), small()), p.start = 60.0F; break;
        case 3: p.own.x() = large; break;
        case 4: p.own.z() = large; break;
        case 5: p.half = Vec3(0.1F * size, 0.3F, 0.01F * size + 0.3F); break;
        case 6: p.cylinder.circle.radius = size; break;
        case 7: p.cylinder.bottom = -size, p.cylinder.top = -size + random.uniform(0.0F, 1.0F); break;
        case 8: p.cylinder.top = size, p.cylinder.bottom = size - random.uniform(0.0F, 1.0F); break;
        default: p.outset = large; break;
        }
        const double sizes =
            double(p.cylinder.circle.centre.cwiseAbs().sum() + (p.cylinder.velocity * p.start).cwiseAbs().sum() +
                   p.own.cwiseAbs().sum() + p.half.sum() + p.cylinder.circle.radius + std::abs(p.cylinder.bottom) +
                   std::abs(p.cylinder.top) + std::abs(p.outset));
        const double reported = double(p.approach().look(0.0F).value);
        ASSERT_LE(reported, p.distance()) << i << ", number " << which;
        ASSERT_GE(reported, p.distance() - 1e-6 * sizes - 1e-6) << i << ", number " << which;
    }
}

/// Beside, above, below, across either rim and inside, with the slopes of a box that moves.
TEST(CylinderLooks, ByHand)
{
    const Cylinder cylinder{{Vec2(0, 0), 4.0F}, Vec2(0, 0), 10.0F, 20.0F, 0.0F};
    struct Expected {
        const char* where;
        Vec3 own, velocity;
        float value, slope;
    };
    const Expected cases[] = {
        {"west of it", Vec3(-15, 0, 15), Vec3(2, 0, 7), 10.0F, -2.0F},
        {"east of it", Vec3(15, 0, 15), Vec3(2, 0, 7), 10.0F, 2.0F},
        {"south of it", Vec3(0, -15, 15), Vec3(1, -2, 0), 10.0F, 2.0F},
        {"a corner first", Vec3(-4, -5, 15), Vec3(1, 1, 0), 1.0F, -1.4F},
        {"above", Vec3(1, 1, 25), Vec3(3, 3, 2), 4.0F, 2.0F},
        {"below", Vec3(1, 1, 5), Vec3(3, 3, 2), 4.0F, -2.0F},
        {"over the rim", Vec3(8, 0, 25), Vec3(5, 0, 0), 5.0F, 3.0F},
        {"climbing over the rim", Vec3(8, 0, 25), Vec3(0, 0, 5), 5.0F, 4.0F},
        {"under the rim", Vec3(-8, 0, 5), Vec3(5, 0, 0), 5.0F, -3.0F},
        {"climbing under the rim", Vec3(-8, 0, 5), Vec3(0, 0, 5), 5.0F, -4.0F},
        {"inside, nearest to its side", Vec3(4, 0, 15), Vec3(2, 0, 9), -1.0F, 2.0F},
        {"inside, nearest to its top", Vec3(1, 0, 20), Vec3(2, 0, 9), -1.0F, 9.0F},
        {"inside, nearest to its bottom", Vec3(1, 0, 10), Vec3(2, 0, 9), -1.0F, -9.0F},
        {"on its axis", Vec3(0, 0, 15), Vec3(2, 0, 0), -4.0F, 0.0F},
    };
    for (const Expected& e : cases) {
        Pair p{Vec3(1, 1, 1), e.own, e.velocity, cylinder, 0.0F, 0.0F, 0.0F};
        EXPECT_NEAR(p.approach().look(0.0F).value, e.value, 1e-4F) << e.where;
        EXPECT_NEAR(p.approach().look(0.0F).slope, e.slope, 1e-4F) << e.where;
        p.outset = 0.5F;
        p.growth = 0.25F;
        EXPECT_NEAR(p.approach().look(0.0F).value, e.value - 0.5F, 1e-4F) << e.where;
        EXPECT_NEAR(p.approach().look(0.0F).slope, e.slope - 0.25F, 1e-4F) << e.where;
        // The same position after two seconds, starting two seconds before, and with the cylinder moving instead.
        p.own = e.own - 2.0F * e.velocity;
        EXPECT_NEAR(p.approach().look(2.0F).value, e.value - 1.0F, 1e-3F) << e.where;
        EXPECT_NEAR(p.approach().look(2.0F).slope, e.slope - 0.25F, 1e-3F) << e.where;
        p.velocity = Vec3(0, 0, e.velocity.z());
        p.own = Vec3(e.own.x(), e.own.y(), p.own.z());
        p.cylinder.velocity = -e.velocity.head<2>();
        p.start = -2.0F;
        EXPECT_NEAR(p.approach().look(2.0F).value, e.value - 1.0F, 1e-3F) << e.where;
        EXPECT_NEAR(p.approach().look(2.0F).slope, e.slope - 0.25F, 1e-3F) << e.where;
    }
}

/// A constant distance is reported for the beginning.
TEST(CylinderLeast, OfADistanceThatDoesNotChangeTheBeginningIsReported)
{
    for (const Vec2& velocity : {Vec2(0, 0), Vec2(3, -2)}) {
        Pair p;
        p.velocity = Vec3(velocity.x(), velocity.y(), 0);
        p.cylinder.velocity = velocity;
        WorkBudget budget(kPlenty);
        const geometry::Approach near = p.approach().least(8.0F, 1e9F, budget);
        EXPECT_EQ(near.when, 0.0F);
        EXPECT_EQ(near.distance, p.approach().look(0.0F).value);
        EXPECT_EQ(budget.spent(), units::kCylinderPart);
    }
}

/// A pass that ends at its closest approach, or slightly after, needs no search.
TEST(CylinderLeast, AtTheEndOrJustBeforeItCostsNoInstants)
{
    const Pair p;  // nearest after 4 s, for 2 / 5 s
    for (const Seconds span : {3.0F, 3.8F, 4.0F}) {
        WorkBudget budget(kPlenty);
        const geometry::Approach near = p.approach().least(span, 1e9F, budget);
        EXPECT_EQ(near.when, span);
        EXPECT_EQ(budget.spent(), units::kCylinderPart);
    }
    // From 5 cm before the box is level with the middle until 2 mm past it: 0.2 mm of distance, less than 0.1 mm left.
    Pair off = p;
    off.half = Vec3(0.1F, 0.1F, 1.0F);
    off.own = Vec3(-0.15F, 8, 0);
    WorkBudget budget(kPlenty);
    const geometry::Approach near = off.approach().least(0.0504F, 1e9F, budget);
    EXPECT_NEAR(near.distance, 4.9F, 1e-3F);
    EXPECT_EQ(near.when, 0.0504F);
    EXPECT_EQ(budget.spent(), units::kCylinderPart);
}

/// The search ends where the bound is `enough`, exactly.
TEST(CylinderLeast, EndsAtWhatIsEnough)
{
    const Pair p;
    WorkBudget budget(kPlenty);
    const float bound = p.approach().least(9.0F, -1e8F, budget).distance;
    ASSERT_EQ(budget.spent(), units::kCylinderPart);
    ASSERT_LT(bound, 3.9F) << "two tangents, not the least";
    WorkBudget again(kPlenty);
    EXPECT_EQ(p.approach().least(9.0F, bound, again).distance, bound);
    EXPECT_EQ(again.spent(), units::kCylinderPart);
    WorkBudget more(kPlenty);
    EXPECT_NEAR(p.approach().least(9.0F, std::nextafter(bound, 1e9F), more).distance, 4.0F, 4.0F - bound);
    EXPECT_GT(more.spent(), units::kCylinderPart);
}

/// The least distance is never above the distance at its reported instant, nor at either end.
TEST(CylinderLeast, IsNotAboveWhatWasLookedAt)
{
    Random random(20261212);
    for (int i = 0; i < 4000; ++i) {
        Pair p;
        p.half = Vec3(random.uniform(0.1F, 3.0F), random.uniform(0.1F, 3.0F), random.uniform(0.1F, 3.0F));
        p.own = Vec3(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-20, 20));
        p.velocity = Vec3(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-2, 2));
        p.cylinder.circle.radius = random.uniform(0.1F, 20.0F);
        p.growth = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 1.0F);
        const float span = random.uniform(0.1F, 10.0F);
        WorkBudget budget(kPlenty);
        const geometry::Approach near = p.approach().least(span, 1e9F, budget);
        ASSERT_LE(near.distance, p.approach().look(near.when).value) << i;
        ASSERT_LE(near.distance, p.approach().look(0.0F).value) << i;
        ASSERT_LE(near.distance, p.approach().look(span).value) << i;
    }
}

/// Past the cylinder within a fraction of a second of a minute's approach: neither crossings of tangents nor halvings
/// alone find that soon.
TEST(CylinderLeast, LongArmsAreNotCreptAlong)
{
    const Pair pairs[] = {
        {Vec3(0.351168F, 1.04529F, 1.18541F),
         Vec3(-5643.44F, -6105.75F, 2.06422F),
         Vec3(255.246F, 276.106F, 0.178931F),
         {{Vec2(6.22314F, 3.278F), 13.1452F}, Vec2(0, 0), -5.0F, 7.10142F, 0.0F},
         0.0F,
         -0.0479871F,
         0.0F},
        {Vec3(1.60785F, 1.82845F, 0.368783F),
         Vec3(-992.296F, 793.807F, 14.8664F),
         Vec3(187.592F, -149.742F, -2.29676F),
         {{Vec2(-2.67074F, 7.59262F), 15.4653F}, Vec2(0, 0), -5.0F, 4.76876F, 0.0F},
         0.0F,
         -0.213512F,
         0.557381F},
    };
    const Seconds spans[] = {25.7153F, 42.2377F};
    for (int i = 0; i < 2; ++i) {
        WorkBudget budget(kPlenty);
        static_cast<void>(pairs[i].approach().least(spans[i], 1e9F, budget));
        EXPECT_LE(budget.spent(), units::kCylinderPart + 17 * units::kCylinderTurn) << i;
    }
}

}  // namespace
}  // namespace jink::world
