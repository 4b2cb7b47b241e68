// SPDX-License-Identifier: BSD-3-Clause
// The cost by which answers of different methods are compared, term by term against values worked out by hand.
#include "core/avoid/objective.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

constexpr float kExact = 1e-3F;

world::Separation apart(float margin) { return {margin, 0.0F, {}}; }

/// A flight through `points`, `dt` between them.
std::vector<path::PathPoint> flight(const std::vector<Vec3>& points, Seconds dt)
{
    std::vector<path::PathPoint> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t from = i + 1 < points.size() ? i : i - 1;
        out.push_back({points[i], (points[from + 1] - points[from]) / dt, static_cast<float>(i) * dt});
    }
    return out;
}

ManoeuvreCost cost(const Flight& f, const std::vector<path::PathPoint>& flown, const world::Separation& separation,
                   const Manoeuvre& manoeuvre = {}, const Manoeuvre* flying = nullptr)
{
    world::Situation s = const_cast<Flight&>(f).scene.situation();
    s.flying = flying;
    WorkBudget budget(100'000);
    return avoid::cost_of(s, manoeuvre, flown, separation, budget);
}

TEST(Objective, TheLegItselfCostsNothing)
{
    Flight f;
    const auto straight = flight({{0, 0, 30}, {10, 0, 30}, {50, 0, 30}}, 2.0F);
    // 50 m in 4 s where the reference takes 10.
    const ManoeuvreCost fast = cost(f, straight, apart(5.0F));
    EXPECT_NEAR(fast.delay, -6.0F, kExact);
    const auto by_the_leg = flight({{0, 0, 30}, {10, 0, 30}, {20, 0, 30}}, 2.0F);
    const ManoeuvreCost none = cost(f, by_the_leg, apart(5.0F));
    EXPECT_NEAR(none.total(), 0.0F, kExact);
    EXPECT_EQ(none.side, Vec3(Vec3::Zero()));
}

/// 3 m to the left after 4 s, 16 m along: 4 m behind, and half of 3 m for the way back.
TEST(Objective, EachTermIsWhatItSays)
{
    Flight f;
    const auto aside = flight({{0, 0, 30}, {8, 1.5F, 30}, {16, 3, 30}}, 2.0F);
    const ManoeuvreCost c = cost(f, aside, apart(0.25F));
    EXPECT_NEAR(c.delay, (4.0F + 1.5F) / 5.0F, kExact);
    EXPECT_NEAR(c.deviation, 0.2F * 3.0F / 5.0F, kExact);
    // One change: from 5 m/s along the leg to (4, 0.75) m/s.
    EXPECT_NEAR(c.effort, std::hypot(1.0F, 0.75F) / f.scene.limits.max_acceleration, kExact);
    EXPECT_NEAR(c.clearance, 0.75F / 5.0F, kExact);
    EXPECT_EQ(c.consistency, 0.0F);
    EXPECT_EQ(c.rules, 0.0F);
    EXPECT_NEAR((c.side - kLeft).norm(), 0.0F, kExact);
    EXPECT_EQ(cost(f, aside, apart(1.0F)).clearance, 0.0F);
    EXPECT_EQ(cost(f, aside, apart(30.0F)).clearance, 0.0F);
}

TEST(Objective, HoldsOnToTheMethodAndTheSide)
{
    Flight f;
    const auto aside = flight({{0, 0, 30}, {8, 1.5F, 30}, {16, 3, 30}}, 2.0F);
    Manoeuvre flying;
    flying.by = kFirst;
    flying.side = kLeft;
    Manoeuvre answer;
    answer.by = kFirst;
    EXPECT_EQ(cost(f, aside, apart(1.0F), answer, &flying).consistency, 0.0F);
    flying.side = -kLeft;
    EXPECT_EQ(cost(f, aside, apart(1.0F), answer, &flying).consistency, 6.0F);
    flying.side = Vec3(0, 0, 1);
    EXPECT_EQ(cost(f, aside, apart(1.0F), answer, &flying).consistency, 0.0F) << "at right angles is no change";
    answer.by = kSecond;
    EXPECT_EQ(cost(f, aside, apart(1.0F), answer, &flying).consistency, 1.0F);
    const auto near = flight({{0, 0, 30}, {8, 0.1F, 30}, {16, 0.2F, 30}}, 2.0F);
    flying.side = -kLeft;
    EXPECT_EQ(cost(f, near, apart(1.0F), answer, &flying).consistency, 1.0F) << "beside the leg by less has no side";
}

/// Head-on with one that avoids us too: both pass to their right.
TEST(Objective, KnowsTheSideOnWhichTwoVehiclesPass)
{
    Flight f;
    head_on(f);
    f.scene.tracks[0].cooperative = true;
    const world::Separation to_it{2.0F, 1.0F, {world::ThreatKind::track, 0}};
    const auto left = flight({{0, 0, 30}, {8, 1.5F, 30}, {16, 3, 30}}, 2.0F);
    const auto right = flight({{0, 0, 30}, {8, -1.5F, 30}, {16, -3, 30}}, 2.0F);
    EXPECT_EQ(cost(f, left, to_it).rules, 6.0F);
    EXPECT_EQ(cost(f, right, to_it).rules, 0.0F);
    EXPECT_EQ(cost(f, left, apart(2.0F)).rules, 0.0F) << "it is not what the flight comes nearest to";
    f.scene.tracks[0].cooperative = false;
    EXPECT_EQ(cost(f, left, to_it).rules, 0.0F);
}

TEST(Objective, WithoutWorkOrARouteNothingIsCheap)
{
    Flight f;
    const auto aside = flight({{0, 0, 30}, {8, 1.5F, 30}, {16, 3, 30}}, 2.0F);
    const world::Situation s = f.scene.situation();
    WorkBudget enough(11);
    EXPECT_TRUE(std::isfinite(avoid::cost_of(s, {}, aside, apart(1.0F), enough).total()));
    EXPECT_EQ(enough.left(), 0U) << "five, and two a point on a leg";
    WorkBudget less(10);
    EXPECT_TRUE(std::isinf(avoid::cost_of(s, {}, aside, apart(1.0F), less).total()));
    WorkBudget ample(1000);
    const world::Reference none;
    EXPECT_TRUE(std::isinf(avoid::cost_of(world::with_reference(s, none), {}, aside, apart(1.0F), ample).total()));
}

}  // namespace
}  // namespace jink::avoid
