// SPDX-License-Identifier: BSD-3-Clause
// Cylinders: numbers that are equal to the bit, level pieces, and least distances at the end of the time.
#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "tests/unit/core/world/cylinder_pair.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;
using detail::CylinderApproach;

geometry::Approach least(const Pair& pair, Seconds span, float enough = 1e9F)
{
    WorkBudget budget(kPlenty);
    return pair.approach().least(span, enough, budget);
}

/// Inside, two exits are equally short: the slope is that of one of them, always the same one.
TEST(CylinderTies, OfTwoWaysOutTheSideGoesBeforeTheHeightAndUpBeforeDown)
{
    Pair corner{Vec3(1, 1, 1), Vec3(4, 0, 20), Vec3(2, 0, 9), {{Vec2(0, 0), 4.0F}, Vec2(0, 0), 10.0F, 20.0F, 0.0F}};
    EXPECT_NEAR(corner.approach().look(0.0F).value, -1.0F, 1e-4F);
    EXPECT_EQ(corner.approach().look(0.0F).slope, 2.0F);
    corner.own.z() = 10.0F;
    EXPECT_NEAR(corner.approach().look(0.0F).value, -1.0F, 1e-4F);
    EXPECT_EQ(corner.approach().look(0.0F).slope, 2.0F);
    Pair middle{Vec3(1, 1, 1), Vec3(0, 0, 15), Vec3(0, 0, 2), {{Vec2(0, 0), 50.0F}, Vec2(0, 0), 10.0F, 20.0F, 0.0F}};
    EXPECT_NEAR(middle.approach().look(0.0F).value, -6.0F, 1e-4F);
    EXPECT_EQ(middle.approach().look(0.0F).slope, 2.0F) << "climbing";
    middle.velocity.z() = -2.0F;
    EXPECT_EQ(middle.approach().look(0.0F).slope, -2.0F) << "sinking";
}

/// The box beside the cylinder, its side level with the centre for a while: a straight piece between two curves.
Pair passing(Random& random)
{
    Pair p;
    p.half = Vec3(random.uniform(1.0F, 5.0F), random.uniform(0.1F, 3.0F), random.uniform(0.1F, 3.0F));
    p.velocity = Vec3(random.uniform(1.0F, 30.0F), 0, 0);
    p.own = Vec3(random.uniform(-80.0F, -20.0F), random.uniform(4.0F, 30.0F), random.uniform(-5.0F, 5.0F));
    p.cylinder.circle.radius = random.uniform(0.1F, 20.0F);
    return p;
}

/// Where the distance does not change it is the least one, to the bit: at the end of the time and between two curves.
TEST(CylinderLeast, OfALevelPieceIsWhatItIsThere)
{
    Random random(20261221);
    int at_end = 0;
    int between = 0;
    for (int i = 0; i < 2000; ++i) {
        const Pair p = passing(random);
        const Seconds abeam = -p.own.x() / p.velocity.x();
        for (const Seconds span : {abeam, 2.5F * abeam}) {
            const geometry::Approach near = least(p, span);
            const CylinderApproach::Look there = p.approach().look(near.when);
            if (there.slope == 0.0F) {
                ASSERT_EQ(near.distance, there.value) << i;
                (near.when == span ? at_end : between) += 1;
            }
        }
    }
    EXPECT_GT(at_end, 1500);
    EXPECT_GT(between, 500);
}

/// Beside the centre by less than the radius, between faces that are far: as exact as outside.
TEST(CylinderLeast, IsAsExactInsideAsOutside)
{
    Random random(20261223);
    for (int i = 0; i < 1000; ++i) {
        Pair p = passing(random);
        p.cylinder.bottom = -200.0F;
        p.cylinder.top = 200.0F;
        p.cylinder.circle.radius = p.own.y() + random.uniform(-4.0F, 60.0F);
        p.half.x() = 0.01F;
        const double truth = double(p.own.y()) - double(p.half.y()) - double(p.cylinder.circle.radius);
        const float near = least(p, -2.2F * p.own.x() / p.velocity.x()).distance;
        ASSERT_LE(double(near), truth) << i;
        ASSERT_GE(double(near), truth - 2e-4 - 6e-4) << i << ": accuracy, and rounding of 600 m in all";
    }
}

/// With equal distance at both ends, the beginning is reported.
TEST(CylinderLeast, OfEqualEndsTheFirstIsReported)
{
    const Pair p;
    Seconds span = 7.99F;
    while (p.approach().look(span).value < p.approach().look(0.0F).value) {
        span = std::nextafter(span, 9.0F);
    }
    ASSERT_EQ(p.approach().look(span).value, p.approach().look(0.0F).value);
    EXPECT_EQ(least(p, span, -1e8F).when, 0.0F);
    EXPECT_EQ(least(p, span + 0.01F, -1e8F).when, 0.0F);
    EXPECT_EQ(least(p, span - 0.01F, -1e8F).when, span - 0.01F);
}

/// Sinking through the middle of a wide cylinder: as far as the end of the time the distance falls evenly, and just
/// there it turns. The tangents cross within the time: never below the first one at the end.
TEST(CylinderLeast, IsNotBelowTheFirstTangentAtTheEnd)
{
    Random random(20261222);
    for (int i = 0; i < 4000; ++i) {
        Pair p;
        p.cylinder.circle.radius = 500.0F;
        p.cylinder.bottom = random.uniform(-60.0F, -20.0F);
        p.cylinder.top = random.uniform(20.0F, 60.0F);
        p.own = Vec3(0, 0, random.uniform(70.0F, 120.0F));
        p.velocity = Vec3(0, 0, -random.uniform(1.0F, 100.0F));
        const float middle = 0.5F * (p.cylinder.bottom + p.cylinder.top);
        const Seconds span = (middle - p.own.z()) / p.velocity.z() * random.uniform(1.0F, 1.000002F);
        const CylinderApproach::Look first = p.approach().look(0.0F);
        const geometry::Approach near = least(p, span);
        ASSERT_LE(near.when, span) << i;
        ASSERT_GE(near.distance, std::min(first.value + first.slope * span, p.approach().look(span).value)) << i;
    }
}

/// The instant before the contact is clear, also if a sampled instant is in exact contact.
TEST(CylinderFirstContact, IsAnInstantThatIsClear)
{
    Pair p;
    p.own = Vec3(-20, 0, 0);
    // After 2 s the box is 6 m off; a cylinder larger by this distance is in contact, to the bit.
    p.outset = 5.999F;
    while (p.approach().look(2.0F).value > 0.0F) {
        p.outset = std::nextafter(p.outset, 7.0F);
    }
    ASSERT_EQ(p.approach().look(2.0F).value, 0.0F);
    WorkBudget budget(kPlenty);
    const Seconds first = p.approach().first_contact(4.0F, budget);
    EXPECT_LT(first, 2.0F);
    EXPECT_GE(first, 2.0F - 4.0F / 65536.0F);
    EXPECT_GT(p.approach().look(first).value, 0.0F);
}

/// Kilometres to a cylinder that is passed within a second, sinking a little: crossings of tangents alone would creep.
TEST(CylinderLeast, AShallowWayThroughAfterALongApproachIsFoundSoon)
{
    const auto sinking = [](const Vec3& half, const Vec3& own, float speed, float climb, float radius, float growth) {
        Pair p;
        p.half = half;
        p.own = own;
        p.velocity = Vec3(speed, 0, climb);
        p.cylinder.circle.radius = radius;
        p.growth = growth;
        return p;
    };
    const std::pair<Pair, Seconds> cases[] = {
        {sinking(Vec3(1.50217485F, 1.3825804F, 1.11200559F), Vec3(-1904.36731F, 0.495028496F, -7.29862595F),
                 164.987549F, -0.290684402F, 13.4511719F, 0.0F),
         11.8654785F},
        {sinking(Vec3(0.0447000265F, 2.588063F, 0.706349671F), Vec3(-4061.62817F, 0.17310977F, -6.90468216F),
                 132.31691F, -0.0551209599F, 9.2569828F, 0.0F),
         31.8490353F},
        {sinking(Vec3(0.0251276158F, 0.0376205146F, 0.271417499F), Vec3(-4187.20801F, 26.0767517F, 1.88777542F),
                 219.974564F, -0.127170637F, 46.4856682F, 0.116815738F),
         19.0491791F},
    };
    for (const auto& [pair, span] : cases) {
        WorkBudget budget(kPlenty);
        EXPECT_LT(pair.approach().least(span, 1e9F, budget).distance, 0.0F);
        EXPECT_LE(budget.spent(), units::kCylinderPart + 10 * units::kCylinderTurn);
    }
}

}  // namespace
}  // namespace jink::world
