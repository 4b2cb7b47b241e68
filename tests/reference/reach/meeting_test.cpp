// SPDX-License-Identifier: BSD-3-Clause
// Meetings of the vehicle and intruders in time: padding, combined models and times of cells, by the avoidance
// specification, sections 2.1 to 2.8.
#include "tests/reference/reach/meeting.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/core/reach/small_tree.hpp"

namespace jink::reach {
namespace {

constexpr float kForAlways = std::numeric_limits<float>::infinity();

/// Section 2.2, all four CHECK VALUES; the third's danger is that an instant has no length.
TEST(TimeRates, CheckValuesWithPadding)
{
    EXPECT_FLOAT_EQ(time_rate({2, 4}, {3, 7}), 0.5F);
    EXPECT_FLOAT_EQ(time_rate({2, 4}, {0, 10}), 1.0F);
    EXPECT_EQ(time_rate({2, 4}, {4.5F, 6}), 0.0F);
    const Stay instant{3, 3};
    EXPECT_LE(time_rate({2, 6}, instant), 2.1e-7F) << "the source's rate is 0: kept just above the threshold";
    EXPECT_FLOAT_EQ(time_rate({2, 6}, padded(instant, 0.25F)), 0.125F);
}

TEST(TimeRates, PaddingIsHalfAStepTheRadiusAndTheClock)
{
    EXPECT_FLOAT_EQ(padding(0.5F, 1.0F, 5.0F, 0.2F), 0.45F);
    EXPECT_EQ(padding(0.5F, 1.0F, 0.0F, 0.2F), kForAlways);
    EXPECT_EQ(padded({1.0F, 2.0F}, kForAlways).from, 0.0F);
    EXPECT_EQ(padded({1.0F, 2.0F}, kForAlways).to, kForAlways);
    EXPECT_EQ(padded({0.1F, 2.0F}, 0.5F).from, 0.0F) << "nothing is before now";
}

/// Section 2.3.
TEST(TimeRates, ReachTimesGrowWithTheErrorOfTheSpeed)
{
    const Stay exact = reach_times(10.0F, 20.0F, 5.0F, 0.0F);
    EXPECT_FLOAT_EQ(exact.from, 2.0F);
    EXPECT_FLOAT_EQ(exact.to, 4.0F);
    const Stay wide = reach_times(10.0F, 20.0F, 5.0F, 0.1F);
    EXPECT_FLOAT_EQ(wide.from, 10.0F / 5.5F);
    EXPECT_FLOAT_EQ(wide.to, 20.0F / 4.5F);
    EXPECT_EQ(reach_times(10.0F, 20.0F, 5.0F, 1.0F).to, kForAlways) << "it may stand";
    EXPECT_EQ(reach_times(10.0F, 20.0F, 5.0F, 1.5F).to, kForAlways);
    EXPECT_EQ(reach_times(10.0F, 20.0F, 0.0F, 0.1F).from, 0.0F);
}

TEST(TimeRates, AnIntruderIsMovedToTheGridsTime)
{
    Intruder intruder;
    intruder.position = Vec3(1, 2, 3);
    intruder.velocity = Vec3(-2, 0.5F, 0);
    EXPECT_TRUE(moved(intruder, 2.0F).position.isApprox(Vec3(-3, 3, 3)));
}

/// The intruder of the check values of section 2.6, and its cell.
struct Example {
    Grid<float> grid;
    Intruder intruder;
    CellPlace place{7, 4, 2};
    CellSphere sphere = sphere_of(grid, place);
    CellIndex cell = grid.index(place);

    Example()
    {
        intruder.position = Vec3(12, 3, 0);
        intruder.velocity = Vec3(-2, -0.5F, 0);
        intruder.radius = 1.0F;
        intruder.horizontal = 0.26F;
        intruder.vertical = 0.09F;
    }
    [[nodiscard]] Meeting with(const Models& models, const std::optional<Stay>& vehicle) const
    {
        return CombinedModel(grid, intruder, models, 0.0F).in(cell, sphere, vehicle);
    }
};

/// Section 2.6, CHECK VALUE: the body's interval [1.2556, 3.4698] holds the line's [2.119, 2.605].
TEST(CombinedModels, EachModelHasItsOwnTimes)
{
    const Example e;
    const Meeting body = e.with({false, true, false, false}, std::nullopt);
    ASSERT_TRUE(body.stay);
    EXPECT_NEAR(body.stay->from, 1.2556F, 1e-3F);
    EXPECT_NEAR(body.stay->to, 3.4698F, 1e-3F);
    const Meeting line = e.with({true, false, false, false}, std::nullopt);
    ASSERT_TRUE(line.stay);
    const float pad = 1.0F / std::sqrt(4.25F);
    EXPECT_NEAR(line.stay->from, 2.119F - pad, 1e-3F);
    EXPECT_NEAR(line.stay->to, 2.605F + pad, 1e-3F);
    EXPECT_LE(body.stay->from, 2.119F);
    EXPECT_GE(body.stay->to, 2.605F);
    const Meeting spread = e.with({false, false, true, false}, std::nullopt);
    ASSERT_TRUE(spread.stay);
    EXPECT_LE(spread.stay->from, body.stay->from) << "its speed may be wrong, and it may go elsewhere";
    EXPECT_GE(spread.stay->to, body.stay->to);
}

/// Equation 6.150 and 6.151: the greatest rate of the models asked for, each by its own times.
TEST(CombinedModels, TheGreatestRateCounts)
{
    const Example e;
    EXPECT_EQ(e.with({true, true, true, false}, std::nullopt).rate, 1.0F) << "in space alone";
    const Stay early{0.0F, 1.3F};
    const float body = e.with({false, true, false, true}, early).rate;
    EXPECT_NEAR(body, (1.3F - 1.2556F) / 1.3F, 1e-3F);
    EXPECT_EQ(e.with({true, false, false, true}, early).rate, 0.0F) << "the line comes later";
    EXPECT_EQ(e.with({true, true, false, true}, early).rate, body);
    EXPECT_EQ(e.with({true, true, true, true}, Stay{5.5F, 6.0F}).rate, 0.0F) << "all are gone";
    EXPECT_EQ(e.with({true, true, true, true}, std::nullopt).rate, 0.0F) << "the vehicle never is there";
}

/// Section 2.8: no model at all is an error, and the intruder is taken by all of them at all times.
TEST(CombinedModels, NoModelIsAnErrorAndTakenAsAll)
{
    const Example e;
    const CombinedModel model(e.grid, e.intruder, {false, false, false, true}, 0.0F);
    EXPECT_EQ(model.status(), ModelStatus::bad_intruder_model);
    EXPECT_EQ(model.in(e.cell, e.sphere, Stay{100.0F, 101.0F}).rate, 1.0F);
    EXPECT_EQ(CombinedModel(e.grid, e.intruder, {true, false, false, true}, 0.0F).status(), ModelStatus::good);
}

/// A hovering intruder is in its own cell for ever, by every model.
TEST(CombinedModels, WhatStandsIsThereForEver)
{
    Example e;
    e.intruder.position = e.sphere.centre;
    for (const float speed : {0.0F, 0.05F}) {
        e.intruder.velocity = Vec3(0, speed, 0);
        for (int model = 0; model < 3; ++model) {
            const Meeting m = e.with({model == 0, model == 1, model == 2, true}, Stay{500.0F, 501.0F});
            EXPECT_EQ(m.rate, 1.0F) << speed << " " << model;
        }
    }
    // A slow intruder does move on: 20 s at 0.09 are 1.8.
    e.intruder.radius = 0.1F;
    e.intruder.velocity = Vec3(0, 0.09F, 0);
    e.intruder.position = e.sphere.centre - Vec3(0, e.sphere.radius + 0.11F + 1.0F, 0);
    const std::optional<Stay> later = body_in(e.sphere, e.intruder);
    ASSERT_TRUE(later);
    EXPECT_NEAR(later->from, 1.01F / 0.09F, 0.05F);
}

/// A body that grazes a cell is found from afar: a difference of squares in single precision would lose it.
TEST(CombinedModels, ABodyFromAfarIsNotLost)
{
    const Grid<float> grid;
    const CellSphere sphere = sphere_of(grid, {5, 3, 2});
    Intruder intruder;
    intruder.radius = 1.0F;
    int seen = 0;
    for (const float far : {50.0F, 500.0F, 5000.0F}) {
        for (int i = 0; i < 360; ++i) {
            const float angle = static_cast<float>(i) * kPi / 180.0F;
            const Vec3 towards(std::cos(angle), std::sin(angle), 0.0F);
            const Vec3 aside(-towards.y(), towards.x(), 0.0F);
            intruder.velocity = 20.0F * towards;
            // Closer than contact by the rounding of the position.
            const float beside = (sphere.radius + 1.0F) * (1.0F - 1e-6F) - 2e-7F * far;
            intruder.position = sphere.centre + beside * aside - far * towards;
            seen += body_in(sphere, intruder) ? 1 : 0;
        }
    }
    EXPECT_EQ(seen, 3 * 360);
}

/// Two movements straight on and one to the left, as tables.
struct SmallSet {
    std::array<NodeIndex, 4> parent{0, 0, 1, 0};
    std::array<std::uint8_t, 4> movement{0, 0, 0, 1};
    std::array<CellIndex, 4> end{kNoCell, 0, 0, 0};
    std::array<std::int16_t, 12> position{0, 0, 0, 1024, 0, 0, 2048, 0, 0, 1012, 133, 0};
    std::array<std::int8_t, 8> attitude{0, 0, 0, 0, 0, 0, 0, 1};
    std::array<std::uint16_t, 4> cost{};
    std::array<std::uint8_t, 4> depth{0, 1, 2, 1};
    std::array<std::uint16_t, 5> first_entry{0, 0, 1, 2, 3};
    std::array<FootprintEntry, 3> entries{};
    ReachSet set;

    SmallSet()
    {
        const Grid<float>& grid = set.grid;
        end = {kNoCell, grid.index({0, 3, 2}), grid.index({1, 3, 2}), grid.index({0, 4, 2})};
        entries = {FootprintEntry{end[1], 1, 8}, FootprintEntry{end[2], 1, 8}, FootprintEntry{end[3], 4, 8}};
        set.samples = 8;
        set.parent = parent;
        set.movement = movement;
        set.end = end;
        set.position = position;
        set.attitude = attitude;
        set.cost = cost;
        set.depth = depth;
        set.first_entry = first_entry;
        set.entries = entries;
        set.checksum = checksum_of(set);
    }
};

/// Section 2.1: the hull over all trajectories, by the parts of a movement before and after each sample; without a
/// trajectory no time, not 0.
TEST(CellTimes, AreTheHullOfAllTrajectories)
{
    const SmallSet small;
    ASSERT_EQ(check(small.set), SetStatus::good);
    std::vector<Stay> times(small.set.grid.cells());
    cell_times(small.set, 2.0F, times);
    const auto of = [&](const CellPlace& place) { return times[small.set.grid.index(place)]; };
    EXPECT_EQ(of({0, 3, 2}).from, 0.0F);
    EXPECT_FLOAT_EQ(of({0, 3, 2}).to, 2.0F * 9.0F / 8.0F);
    EXPECT_FLOAT_EQ(of({1, 3, 2}).from, 2.0F);
    EXPECT_FLOAT_EQ(of({1, 3, 2}).to, 2.0F * 17.0F / 8.0F);
    EXPECT_FALSE(is_never(of({0, 4, 2}))) << "to the left";
    EXPECT_GT(of({0, 4, 2}).from, 0.0F);
    EXPECT_TRUE(is_never(of({2, 3, 2}))) << "nobody passes there";
    EXPECT_TRUE(is_never(of({0, 0, 0})));
    EXPECT_FALSE(meet(kNever, {0.0F, kForAlways}));
}

TEST(CellTimes, BeyondTheGridThereIsNoCell)
{
    test::SmallTree tree;
    const NodeIndex last = tree.chain(Movement::straight, 11, 0);
    const ReachSet set = tree.view();
    EXPECT_TRUE(stay_of(set, last - 1U, 8, 1.0F));
    EXPECT_FALSE(stay_of(set, last, 8, 1.0F));
}

/// One sample before to one after, in times of the node's own movement.
TEST(CellTimes, ASampleStandsForTheOneBeforeAndTheOneAfter)
{
    test::SmallTree tree;
    const NodeIndex second = tree.add(tree.add(0, Movement::left, 0), Movement::left, 0);
    const ReachSet set = tree.view();
    const std::optional<CellStay> stay = stay_of(set, second, 4, 2.0F);
    ASSERT_TRUE(stay);
    EXPECT_FLOAT_EQ(stay->stay.from, 2.0F * (1.0F + 3.0F / 8.0F));
    EXPECT_FLOAT_EQ(stay->stay.to, 2.0F * (1.0F + 5.0F / 8.0F));
    const Pose<float> half = at_share(apply(Pose<float>{}, Movement::left, set.step), Movement::left, 0.5F, set.step);
    EXPECT_EQ(stay->cell, set.grid.index(set.grid.locate(half.position).place));
}

}  // namespace
}  // namespace jink::reach
