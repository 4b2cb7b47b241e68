// SPDX-License-Identifier: BSD-3-Clause
// Which neighbours get half-spaces, and the cap for those that do not (G-ORCA specification, sections 3.8, 11.4, 18).
#include "core/orca/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

Neighbour at(float distance, std::uint32_t id)
{
    Neighbour n;
    n.position = {distance, 0, 0};
    n.id = id;
    return n;
}

Selection selected(const NeighbourSettings& settings, const std::vector<Neighbour>& all)
{
    WorkBudget budget(100'000);
    return select(settings, all, budget);
}

TEST(Neighbours, WhoCanNotBeMetIsLeftOutAndNothingIsLost)
{
    NeighbourSettings settings;  // 2 m/s each, 10 s, 1 m apart: 41 m
    const Selection out = selected(settings, {at(40.9F, 1), at(41.1F, 2)});
    ASSERT_EQ(out.chosen.size(), 1U);
    EXPECT_EQ(out.chosen[0], 0);
    EXPECT_EQ(out.truncated, 0);
    EXPECT_TRUE(std::isinf(out.speed_cap));
    EXPECT_EQ(out.horizon, 10.0F);
    // Faster than reported.
    Neighbour fast = at(41.1F, 2);
    fast.velocity = {-3, 0, 0};
    EXPECT_EQ(selected(settings, {fast}).chosen.size(), 1U);
}

TEST(Neighbours, ARangeShortensTheHorizonAndIsSaid)
{
    NeighbourSettings settings;
    settings.range = 4.0F;
    const Selection out = selected(settings, {at(3.9F, 1), at(4.1F, 2)});
    EXPECT_EQ(out.chosen.size(), 1U);
    EXPECT_NEAR(out.horizon, 3.0F / 4.0F, 1e-6F);  // (4 m - 1 m) / 4 m/s
}

TEST(Neighbours, TheSeventeenthCapsTheSpeed)
{
    const NeighbourSettings settings;
    std::vector<Neighbour> all;
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours + 1; ++i) {
        all.push_back(at(5.0F + 0.5F * static_cast<float>(kMaxOrcaNeighbours - i), i));
    }
    Selection out = selected(settings, all);
    ASSERT_EQ(out.chosen.size(), kMaxOrcaNeighbours);
    EXPECT_EQ(out.truncated, 1);
    EXPECT_EQ(out.chosen[0], kMaxOrcaNeighbours);  // the nearest first
    EXPECT_EQ(std::find(out.chosen.begin(), out.chosen.end(), 0), out.chosen.end());
    // 12 m of gap in 10 s less its 2 m/s is nothing: half of the gap, as it does itself.
    const float gap = 5.0F + 0.5F * static_cast<float>(kMaxOrcaNeighbours) - 1.0F;
    EXPECT_NEAR(out.speed_cap, gap / 20.0F, 1e-5F);
    // Slow: the remaining speed.
    all[0].max_speed = 0.5F;
    EXPECT_NEAR(selected(settings, all).speed_cap, gap / 10.0F - 0.5F, 1e-5F);
    // The order of the input changes nothing.
    all[0].max_speed = 2.0F;
    std::reverse(all.begin(), all.end());
    const Selection reversed = selected(settings, all);
    EXPECT_EQ(reversed.speed_cap, out.speed_cap);
    EXPECT_EQ(all[reversed.chosen[0]].id, kMaxOrcaNeighbours);
    EXPECT_EQ(all[reversed.chosen[15]].id, 1U);
}

TEST(Neighbours, OfThoseLeftOutTheNearestOrFastestDecides)
{
    NeighbourSettings settings;
    std::vector<Neighbour> all;
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours; ++i) {
        all.push_back(at(2.0F, i));
    }
    all.push_back(at(31.0F, 100));  // leaves 3 - 2 = 1 m/s
    all.push_back(at(33.0F, 101));
    all.back().max_speed = 3.1F;  // farther, but leaves 3.2 - 3.1
    const Selection out = selected(settings, all);
    EXPECT_EQ(out.truncated, 2);
    EXPECT_NEAR(out.speed_cap, 0.1F, 1e-5F);
}

TEST(Neighbours, WhoDoesNotGiveWayComesFirst)
{
    const NeighbourSettings settings;
    std::vector<Neighbour> all;
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours; ++i) {
        all.push_back(at(5.0F, i));
    }
    all.push_back(at(20.0F, 100));
    all.back().cooperative = false;
    EXPECT_EQ(selected(settings, all).chosen[0], kMaxOrcaNeighbours);
    // One too many of them, and nothing is left to trust in: no speed of one's own.
    for (Neighbour& n : all) {
        n.cooperative = false;
    }
    EXPECT_EQ(selected(settings, all).speed_cap, 0.0F);
}

TEST(Neighbours, StaleOnesArePassedAlone)
{
    NeighbourSettings settings;
    Neighbour n = at(10.0F, 7);
    Pair pair = pair_of(settings, {1, 0, 0}, n, 3);
    EXPECT_EQ(pair.across, 1.0F);
    EXPECT_EQ(pair.weights.react, 0.5F);
    EXPECT_EQ(pair.source, 3);
    EXPECT_TRUE(pair.above) << "the smaller id climbs";
    n.age = 0.5F;
    pair = pair_of(settings, {1, 0, 0}, n, 3);
    EXPECT_EQ(pair.across, 1.0F) << "what its age adds is part of its widths";
    EXPECT_EQ(pair.upright, 1.0F);
    EXPECT_EQ(pair.weights.react, 0.5F);
    n.age = 2.5F;
    pair = pair_of(settings, {1, 0, 0}, n, 3);
    EXPECT_EQ(pair.weights.react, 1.0F);
    EXPECT_EQ(selected(settings, {n}).stale, 1);
    settings.own_id = 8;
    EXPECT_FALSE(pair_of(settings, {1, 0, 0}, n, 3).above);
    settings.cover = kCylinderCover;
    n.age = 0.0F;
    EXPECT_NEAR(pair_of(settings, {1, 0, 0}, n, 3).across, std::sqrt(2.0F), 1e-6F);
}

TEST(Neighbours, RefusesWhatIsNoNumber)
{
    const NeighbourSettings settings;
    Neighbour bad = at(5.0F, 1);
    bad.position.y() = std::nanf("");
    Neighbour worse = at(5.0F, 2);
    worse.velocity.z() = std::numeric_limits<float>::infinity();
    Neighbour worst = at(5.0F, 3);
    worst.half_width = -1.0F;
    const Selection out = selected(settings, {bad, worse, worst, at(6.0F, 4)});
    EXPECT_EQ(out.refused, 3);
    ASSERT_EQ(out.chosen.size(), 1U);
    EXPECT_EQ(out.chosen[0], 3);
}

TEST(Neighbours, OutOfWorkNothingIsFlown)
{
    const NeighbourSettings settings;
    WorkBudget budget(10);
    const std::vector<Neighbour> all(20, at(6.0F, 4));
    const Selection out = select(settings, all, budget);
    EXPECT_TRUE(out.exhausted);
    EXPECT_EQ(out.speed_cap, 0.0F);
}

}  // namespace
}  // namespace jink::orca
