// SPDX-License-Identifier: BSD-3-Clause
// Space sets and the rating of trajectories: the avoidance specification, sections 4.7 to 4.9.
#include "tests/reference/reach/fusion.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

TEST(TrajectoryRatings, CheckValues)
{
    TrajectoryRating threatened;
    threatened.add(1, 0.1F);
    threatened.add(2, 0.2F);
    threatened.add(3, 0.0F);
    EXPECT_NEAR(threatened.reachability(), 0.72F, 1e-6F);
    EXPECT_FALSE(threatened.is_reachable());
    TrajectoryRating free;
    for (CellIndex cell = 0; cell < 20; ++cell) {
        free.add(cell, 0.0F);
    }
    EXPECT_EQ(free.reachability(), 1.0F);
    EXPECT_TRUE(free.is_reachable());
}

/// CHECK VALUE: the same cell twice in a footprint counts once.
TEST(TrajectoryRatings, ACellPassedTwiceCountsOnce)
{
    TrajectoryRating twice;
    twice.add(1, 0.1F);
    twice.add(2, 0.2F);
    twice.add(1, 0.1F);
    EXPECT_NEAR(twice.reachability(), 0.72F, 1e-6F);
}

TEST(TrajectoryRatings, TheThreatsSideWinsAtTheThreshold)
{
    TrajectoryRating at;
    at.add(1, kThreshold);
    EXPECT_FALSE(at.is_reachable());
    TrajectoryRating below;
    below.add(1, std::nextafter(kThreshold, 0.0F));
    EXPECT_TRUE(below.is_reachable());
    below.add(2, 0.5F * kThreshold);
    EXPECT_FALSE(below.is_reachable()) << "together they are too many";
    TrajectoryRating certain;
    certain.add(1, 1.0F);
    EXPECT_EQ(certain.reachability(), 0.0F);
    EXPECT_FALSE(certain.is_reachable());
    TrajectoryRating unknown;
    unknown.add(1, NAN);
    EXPECT_FALSE(unknown.is_reachable());
    TrajectoryRating nowhere;
    nowhere.add(kNoCell, 0.0F);
    EXPECT_FALSE(nowhere.is_reachable()) << "no such cell";
}

CellRating seen(float hidden = 0.0F)
{
    CellRating cell;
    cell.add_sensor(hidden, 0.0F);
    return cell;
}

/// Equations 6.164 to 6.167.
TEST(SpaceSetsOfCells, AreThoseOfTheSource)
{
    EXPECT_TRUE(space_of(seen()).free);
    const SpaceSets unseen = space_of(CellRating());
    EXPECT_TRUE(unseen.uncertain);
    EXPECT_FALSE(unseen.free);
    CellRating obstacle;
    obstacle.add_sensor(0.5F, 1.0F);
    EXPECT_TRUE(space_of(obstacle).occupied);
    EXPECT_TRUE(space_of(obstacle).uncertain) << "half of it is not seen: both are told";
    CellRating intruded = seen();
    intruded.add_intruder(1.0F);
    EXPECT_TRUE(space_of(intruded).constrained);
    EXPECT_FALSE(space_of(intruded).free);
    CellRating hidden_intruder = seen(0.5F);
    hidden_intruder.add_intruder(1.0F);
    EXPECT_FALSE(space_of(hidden_intruder).constrained) << "by eq. 6.166 only where it is visible";
    EXPECT_TRUE(hidden_intruder.is_intruded()) << "but the cell still knows";
    CellRating soft = seen();
    soft.add_soft(1.0F);
    EXPECT_TRUE(space_of(soft).constrained);
    CellRating hard = seen();
    hard.add_hard(1.0F);
    EXPECT_TRUE(space_of(hard).constrained);
    CellRating mapped = seen(0.5F);
    mapped.add_map(1.0F);
    EXPECT_FALSE(space_of(mapped).free);
}

/// A cell is free if no run blocks it, over all combinations of its ratings.
TEST(SpaceSetsOfCells, FreeIsFreeInEveryRun)
{
    const float ratings[] = {0.0F, 0.5F * kThreshold, kThreshold, 0.4F, 1.0F};
    int free = 0;
    int cells = 0;
    for (const float hidden : ratings) {
        for (const float obstacle : ratings) {
            for (const float map : ratings) {
                for (const float intruder : ratings) {
                    for (const float constraint : ratings) {
                        CellRating cell;
                        cell.add_sensor(hidden, obstacle);
                        cell.add_map(map);
                        cell.add_intruder(intruder);
                        cell.add_hard(constraint);
                        cell.add_soft(constraint);
                        cell.add_map_margin(map);
                        const SpaceSets sets = space_of(cell);
                        EXPECT_EQ(sets.free, cell.level() == kFree);
                        EXPECT_FALSE(sets.free && (sets.uncertain || sets.occupied || sets.constrained));
                        free += sets.free ? 1 : 0;
                        ++cells;
                    }
                }
            }
        }
    }
    EXPECT_EQ(cells, 3125);
    EXPECT_GT(free, 10);
}

TEST(Fusion, CheckValues)
{
    CellRating intruders;
    intruders.add_intruder(0.2F);
    intruders.add_intruder(0.5F);
    EXPECT_NEAR(intruders.intruder(), 0.6F, 1e-6F);

    CellRating cell;
    cell.add_sensor(0.1F, 0.3F);
    cell.add_sensor(0.5F, 0.8F);
    EXPECT_NEAR(cell.visibility(), 0.5F, 1e-6F);
    EXPECT_NEAR(cell.obstacle(), 0.4F, 1e-6F);
    cell.add_map(0.6F);
    EXPECT_NEAR(cell.map(), 0.3F, 1e-6F);
    cell.add_intruder(0.2F);
    cell.add_intruder(0.5F);
    EXPECT_NEAR(cell.threat(), 0.6F, 1e-6F);
}

/// Figure 6.13: the chart counts where the sensors do not cover.
TEST(Fusion, ChartsCountWhereNobodySees)
{
    CellRating seen;
    seen.add_sensor(0.0F, 0.0F);
    seen.add_map(1.0F);
    EXPECT_EQ(seen.map(), 0.0F) << "charted and visible, but not there";
    EXPECT_EQ(seen.level(), kFree);
    CellRating hidden;
    hidden.add_sensor(0.6F, 0.0F);
    hidden.add_map(0.9F);
    EXPECT_NEAR(hidden.map(), 0.54F, 1e-6F);
    CellRating found;
    found.add_sensor(0.0F, 1.0F);
    found.add_map(1.0F);
    EXPECT_EQ(found.threat(), 1.0F);
}

/// Table 6.5, at the threshold itself: the threat's side wins.
TEST(Fusion, ThresholdsAreThoseOfTheTable)
{
    const auto seen = [] {
        CellRating cell;
        cell.add_sensor(0.0F, 0.0F);
        return cell;
    };
    const float above = std::nextafter(kThreshold, 1.0F);
    const float below = std::nextafter(kThreshold, 0.0F);
    EXPECT_TRUE(seen().is_visible());
    CellRating cell;
    cell.add_sensor(kThreshold, 0.0F);
    EXPECT_TRUE(cell.is_visible());
    cell.add_sensor(above, 0.0F);
    EXPECT_FALSE(cell.is_visible());
    EXPECT_FALSE(CellRating().is_visible()) << "no sensor looks there";
    const auto level = [&](auto&& add) {
        CellRating c = seen();
        add(c);
        return c.level();
    };
    EXPECT_EQ(level([](CellRating&) {}), kFree);
    EXPECT_EQ(level([](CellRating& c) { c.add_sensor(0.0F, kThreshold); }), 0);
    EXPECT_EQ(level([&](CellRating& c) { c.add_sensor(0.0F, below); }), kFree);
    EXPECT_EQ(level([](CellRating& c) { c.add_intruder(1.0F); }), 1);
    EXPECT_EQ(level([](CellRating& c) { c.add_hard(kThreshold); }), 2);
    EXPECT_EQ(level([&](CellRating& c) { c.add_hard(below); }), kFree);
    EXPECT_EQ(level([](CellRating& c) { c.add_soft(kThreshold); }), 3);
    EXPECT_EQ(level([&](CellRating& c) { c.add_soft(below); }), kFree);
    EXPECT_EQ(level([](CellRating& c) {
                  c.add_soft(1.0F);
                  c.add_hard(1.0F);
                  c.add_intruder(1.0F);
              }),
              1)
        << "the first run in which it is not free";
    EXPECT_EQ(CellRating().level(), 0);
    EXPECT_EQ(CellRating().level(true), kFree) << "the last resort";
    CellRating charted;
    charted.add_sensor(1.0F, 0.5F);
    EXPECT_EQ(charted.obstacle(), 0.0F) << "damped";
    EXPECT_EQ(charted.level(true), 0) << "but in the way all the same";
}

}  // namespace
}  // namespace jink::reach
