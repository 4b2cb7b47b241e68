// SPDX-License-Identifier: BSD-3-Clause
// The cost by which answers of different methods are compared, term by term against values worked out by hand.
#include "core/avoid/objective.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/avoid/final_check.hpp"
#include "core/avoid/planning.hpp"
#include "core/base/work_units.hpp"
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

/// 6 s, and ten times the flight of the depth, at the deepest place.
TEST(Objective, ASoftMarginCostsTheWayIntoIt)
{
    const auto beside = flight({{0, 0, 30}, {10, 3, 30}, {30, 3, 30}, {40, 0, 30}}, 2.0F);
    const auto clearance_of = [&](float y, float top, const world::Vec2& velocity = {0, 0}) {
        Flight f;
        f.scene.cylinder(world::Vec2(20, y), 5.0F);
        f.scene.cylinders[0].margin = 4.0F;
        f.scene.cylinders[0].top = top;
        f.scene.cylinders[0].velocity = velocity;
        f.scene.cylinder(world::Vec2(20, 200), 5.0F);
        return cost(f, beside, apart(1.0F)).clearance;
    };
    EXPECT_EQ(clearance_of(-6.1F, 100.0F), 0.0F) << "9.1 m from the flight";
    EXPECT_NEAR(clearance_of(-5.0F, 100.0F), 6.0F + 10.0F * 1.0F / 5.0F, kExact) << "between two points";
    EXPECT_NEAR(clearance_of(9.0F, 100.0F), 6.0F + 10.0F * 3.0F / 5.0F, kExact);
    EXPECT_NEAR(clearance_of(4.0F, 100.0F), 6.0F + 10.0F * 4.0F / 5.0F, kExact) << "into the body: the check's matter";
    EXPECT_EQ(clearance_of(-5.0F, 29.0F), 0.0F) << "above it";
    // Abeam of it after 3 s: 6 m farther away by then.
    EXPECT_EQ(clearance_of(-5.0F, 100.0F, {0, -2}), 0.0F);
    EXPECT_NEAR(clearance_of(-11.0F, 100.0F, {0, 2}), 6.0F + 10.0F * 1.0F / 5.0F, 0.5F);
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
    f.scene.obstacle(geometry::make_box(Vec3(40, 0, 30), Vec3(1, 20, 20)));
    const world::Reference none;
    EXPECT_TRUE(std::isinf(avoid::cost_of(world::with_reference(s, none), {}, aside, apart(1.0F), ample).total()));
}

// --- dead ends ---

/// At (20, 0, 30) 5 m above the leg's height; 8 s of look-ahead at 5 m/s later the leg is at (60, 0, 30).
Seconds dead_end_of(const Flight& f, const Vec3& end = Vec3(20, 0, 35))
{
    return cost(f, flight({{0, 0, 30}, end}, 4.0F), apart(1.0F)).dead_end;
}

TEST(DeadEnds, AreBlockedByAnObstacleOnTheStraightWay)
{
    Flight f;
    EXPECT_EQ(dead_end_of(f), 0.0F);
    const auto flown = flight({{0, 0, 30}, {20, 0, 35}}, 4.0F);
    const ManoeuvreCost free = cost(f, flown, apart(1.0F));
    f.scene.obstacle(geometry::make_box(Vec3(40, 0, 30), Vec3(1, 20, 20)));
    const ManoeuvreCost blocked = cost(f, flown, apart(1.0F));
    EXPECT_EQ(blocked.dead_end, 6.0F);
    EXPECT_NEAR(blocked.total(), free.total() + 6.0F, kExact) << "all other terms stay";
    f.scene.obstacles.clear();
    f.scene.obstacle(geometry::make_sphere(Vec3(40, 0, 32.5F), 1.0F));
    EXPECT_EQ(dead_end_of(f), 6.0F) << "in the middle of the way, beside the leg";
}

/// The way is the vehicle's box wide, and no wider.
TEST(DeadEnds, AreAsWideAsTheVehicle)
{
    Flight f;
    const float half = f.scene.limits.half_extents.y();
    const auto beside = [&](float gap) {
        f.scene.obstacles.clear();
        f.scene.obstacle(geometry::make_box(Vec3(40, half + gap + 10.0F, 30), Vec3(1, 10, 20)));
        return dead_end_of(f);
    };
    EXPECT_EQ(beside(0.1F), 0.0F);
    EXPECT_EQ(beside(-0.1F), 6.0F);
}

TEST(DeadEnds, ReachFromTheEndToTheLookAhead)
{
    Flight f;
    const auto sphere_at = [&](float x, float z) {
        f.scene.obstacles.clear();
        f.scene.obstacle(geometry::make_sphere(Vec3(x, 0, z), 0.5F));
        return dead_end_of(f);
    };
    const float reach = 0.5F + f.scene.limits.half_extents.x();
    EXPECT_EQ(sphere_at(60.0F + reach - 0.1F, 30), 6.0F);
    EXPECT_EQ(sphere_at(60.0F + reach + 0.1F, 30), 0.0F) << "beyond the look-ahead";
    EXPECT_EQ(sphere_at(20.0F - reach - 0.1F, 35), 0.0F) << "before the end";
    EXPECT_EQ(sphere_at(40, 40), 0.0F);
    f.scene.rules.lookahead = 4.0F;
    EXPECT_EQ(sphere_at(40, 30), 6.0F);
    EXPECT_EQ(sphere_at(60, 30), 0.0F);
}

TEST(DeadEnds, AreNoneForTrafficAndBounds)
{
    Flight f;
    f.scene.track(Vec3(40, 0, 32.5F), Vec3::Zero(), 3.0F);
    f.scene.airspace.has_ceiling = true;
    f.scene.airspace.ceiling = 32.0F;
    EXPECT_EQ(dead_end_of(f), 0.0F);
}

/// 6 s, and the way out of the circle and back at half the speed.
TEST(DeadEnds, OfAClosedAreaGrowWithTheWayThroughItsCircle)
{
    const auto at = [](float aside, float radius) {
        Flight f;
        f.scene.cylinder(world::Vec2(40, aside), radius);
        f.scene.cylinders[0].top = 100.0F;
        return dead_end_of(f, Vec3(20, 0, 30));
    };
    const float speed = Flight{}.scene.reference.speed;
    EXPECT_NEAR(at(0.0F, 5.0F), 6.0F + 4.0F * 5.0F / speed, 1e-3F);
    EXPECT_NEAR(at(2.0F, 5.0F), 6.0F + 4.0F * 3.0F / speed, 1e-3F);
    EXPECT_NEAR(at(-2.0F, 5.0F), 6.0F + 4.0F * 3.0F / speed, 1e-3F);
    EXPECT_NEAR(at(5.5F, 5.0F), 6.0F, 1e-3F) << "the vehicle's own width alone";
    EXPECT_EQ(at(8.0F, 5.0F), 0.0F);
}

/// The flight ends after 4 s at (20, 0), the way back takes 8 s more.
TEST(DeadEnds, OfAnAreaThatMovesAreWhereItIsThen)
{
    const auto at = [](const world::Vec2& centre, const world::Vec2& velocity) {
        Flight f;
        f.scene.cylinder(centre, 5.0F);
        f.scene.cylinders[0].top = 100.0F;
        f.scene.cylinders[0].velocity = velocity;
        return dead_end_of(f, Vec3(20, 0, 30));
    };
    // The vehicle is at x = 40 after 8 s.
    EXPECT_NEAR(at({40, -24}, {0, 3}), 6.0F + 4.0F * 5.0F / Flight{}.scene.reference.speed, 0.2F);
    EXPECT_EQ(at({40, 0}, {0, 3}), 0.0F) << "gone by then";
    EXPECT_EQ(at({40, -60}, {0, 3}), 0.0F) << "it comes later";
}

/// Nothing behind the route's end counts, and from beyond it the way leads back.
TEST(DeadEnds, EndWithTheRoute)
{
    Flight f;
    f.scene.leg(Vec3(0, 0, 30), Vec3(30, 0, 30), 5.0F);
    f.scene.obstacle(geometry::make_box(Vec3(36, 0, 30), Vec3(1, 20, 20)));
    EXPECT_EQ(dead_end_of(f), 0.0F);
    EXPECT_EQ(dead_end_of(f, Vec3(40, 0, 30)), 6.0F);
    EXPECT_EQ(dead_end_of(f, Vec3(30, 0, 30)), 0.0F) << "at the end of the route itself";
}

/// A corner of the route counts: the wall stands on the first leg's continuation, and then across the second leg.
TEST(DeadEnds, FollowTheRouteRoundItsCorner)
{
    Flight f;
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 30), Vec3(30, 0, 30)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(30, 0, 30), Vec3(30, 100, 30)), path::RouteStatus::ok);
    f.scene.reference = world::Reference(route, 5.0F);
    f.scene.obstacle(geometry::make_box(Vec3(40, 0, 30), Vec3(1, 20, 20)));
    EXPECT_EQ(dead_end_of(f), 0.0F);
    f.scene.obstacle(geometry::make_box(Vec3(25, 20, 30), Vec3(3, 1, 20)));
    EXPECT_EQ(dead_end_of(f), 6.0F) << "on the straight way to (30, 30, 30)";
}

/// One point of the route more than the terms before, and the check. Unknown is blocked.
TEST(DeadEnds, WithoutTheWorkToKnowAreBlocked)
{
    Flight f;
    f.scene.obstacle(geometry::make_sphere(Vec3(200, 0, 30), 1.0F));
    const auto flown = flight({{0, 0, 30}, {20, 0, 35}}, 4.0F);
    const world::Situation s = f.scene.situation();
    WorkBudget ample(1000);
    EXPECT_EQ(avoid::cost_of(s, {}, flown, apart(1.0F), ample).dead_end, 0.0F);
    const std::uint32_t whole = ample.spent();
    EXPECT_EQ(whole, 9U + 2U + 1U + 2U * units::kPathPiece + units::kThreat + units::kThreatChunk);
    for (std::uint32_t units = 9; units < whole; ++units) {
        WorkBudget less(units);
        const ManoeuvreCost c = avoid::cost_of(s, {}, flown, apart(1.0F), less);
        EXPECT_EQ(c.dead_end, 6.0F) << units;
        EXPECT_TRUE(std::isfinite(c.total())) << units;
        EXPECT_TRUE(less.exhausted()) << units;
    }
    WorkBudget exactly(whole);
    EXPECT_EQ(avoid::cost_of(s, {}, flown, apart(1.0F), exactly).dead_end, 0.0F);
    WorkBudget none(8);
    EXPECT_TRUE(std::isinf(avoid::cost_of(s, {}, flown, apart(1.0F), none).total()));
}

/// Plans of the inflated vehicle and of the vehicle as it is compare by the vehicle as it is.
TEST(DeadEnds, AreOfTheVehicleAsItIsWhateverThePlanKept)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    const float half = f.scene.limits.half_extents.y();
    f.scene.obstacle(geometry::make_box(Vec3(40, half + 0.2F + 10.0F, 30), Vec3(1, 10, 20)));
    const world::Situation s = f.scene.situation();
    const Inflated inflated(s, 0.4F);
    const Manoeuvre up = along(s, {s.own.position, s.own.position + Vec3(10, 0, 5)}, Vec3(0, 0, 1));
    const auto assessed = [&](const world::Situation& of, float kept) {
        WorkBudget budget(100'000);
        const Assessment a = assess(of, up, Settings{}, kept, budget);
        EXPECT_GE(a.margin, 0.0F);
        return a.cost.dead_end;
    };
    EXPECT_EQ(assessed(s, 0.0F), 0.0F);
    EXPECT_EQ(assessed(inflated.situation, 0.4F), 0.0F);
    EXPECT_EQ(assessed(inflated.situation, 0.0F), 6.0F) << "a vehicle that is that large does not pass";
}

/// Answers the same for every place; nothing: not known.
struct FakeCostToGo final : world::CostToGo {
    std::optional<Seconds> lost;
    mutable std::vector<Vec3> asked;

    [[nodiscard]] std::optional<Seconds> lost_from(const Vec3& place) const noexcept override
    {
        asked.push_back(place);
        return lost;
    }
    [[nodiscard]] std::optional<Vec3> way_around(const Vec3&, float) const noexcept override { return std::nullopt; }
};

/// What is lost on the way from the flight's end on, where that is known, and else the straight way.
TEST(DeadEnds, CostWhatIsLostWhereThatIsKnown)
{
    Flight f;
    const auto flown = flight({{0, 0, 30}, {20, 0, 35}}, 4.0F);
    FakeCostToGo known;
    const auto cost_with = [&](std::uint32_t units) {
        world::Situation s = f.scene.situation();
        s.cost_to_go = &known;
        known.asked.clear();
        WorkBudget budget(units);
        return avoid::cost_of(s, {}, flown, apart(1.0F), budget);
    };
    const ManoeuvreCost free = cost(f, flown, apart(1.0F));
    f.scene.obstacle(geometry::make_box(Vec3(40, 0, 30), Vec3(1, 20, 20)));
    for (const Seconds lost : {0.0F, 3.5F, 30.0F}) {
        known.lost = lost;
        const ManoeuvreCost c = cost_with(1000);
        EXPECT_EQ(c.dead_end, lost) << "though the straight way is blocked";
        EXPECT_NEAR(c.total(), free.total() + lost, kExact) << "all other terms stay";
        ASSERT_EQ(known.asked.size(), 1U);
        EXPECT_EQ(known.asked[0], Vec3(20, 0, 35)) << "from the flight's end";
    }
    known.lost.reset();
    EXPECT_EQ(cost_with(1000).dead_end, 6.0F) << "not known: the straight way";
    EXPECT_EQ(known.asked.size(), 1U);
    f.scene.obstacles.clear();
    EXPECT_EQ(cost_with(1000).dead_end, 0.0F);
    known.lost = 3.5F;
    EXPECT_EQ(cost_with(1000).dead_end, 3.5F) << "of a closed area, with no obstacle at all";
}

/// Nine work units for the terms before. One too few for the answer: it is not asked for, and an obstacle blocks.
TEST(DeadEnds, WithoutTheWorkToAskAreBlocked)
{
    Flight f;
    const auto flown = flight({{0, 0, 30}, {20, 0, 35}}, 4.0F);
    f.scene.obstacle(geometry::make_sphere(Vec3(200, 0, 30), 1.0F));
    FakeCostToGo known;
    known.lost = 3.5F;
    world::Situation s = f.scene.situation();
    s.cost_to_go = &known;
    WorkBudget exactly(9 + units::kLost);
    EXPECT_EQ(avoid::cost_of(s, {}, flown, apart(1.0F), exactly).dead_end, 3.5F);
    EXPECT_EQ(exactly.left(), 0U);
    for (std::uint32_t units = 9; units < 9 + units::kLost; ++units) {
        known.asked.clear();
        WorkBudget less(units);
        EXPECT_EQ(avoid::cost_of(s, {}, flown, apart(1.0F), less).dead_end, 6.0F) << units;
        EXPECT_TRUE(known.asked.empty()) << units;
    }
}

}  // namespace
}  // namespace jink::avoid
