// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/cell_fusion.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/reach/planner.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

// Cells rated by Gomola's method: its answers are clear too, and fewer are found.

namespace jink::reach {
namespace {

using oracle::RandomSituation;
using world::PlanStatus;

constexpr std::uint32_t kFusionPlenty = 100'000'000;

Planner& by_cells(CellFusion* fusion)
{
    static Planner planner{[] {
        Settings settings;
        settings.sets = &test::unit_sets();
        return settings;
    }()};
    planner.rate_cells_by(fusion);
    return planner;
}

PlanStatus plan(Planner& planner, const RandomSituation& s, world::Manoeuvre& out)
{
    WorkBudget budget(kFusionPlenty);
    return planner.plan(s.view(), budget, out);
}

TEST(CellFusionLaws, WhatIsFoundByCellsIsClear)
{
    FusionRule in_time;
    FusionRule at_any_time;
    at_any_time.models.timed = false;
    FusionRule spread;
    spread.models.spread = true;
    spread.horizontal = spread.vertical = 0.1F;
    CellFusion fusions[] = {CellFusion(in_time), CellFusion(at_any_time), CellFusion(spread)};
    std::array<std::size_t, 3> found{};
    std::size_t by_nodes = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        const RandomSituation s(seed);
        WorkBudget budget(kFusionPlenty);
        const bool starts_clear = world::separation_at(s.view(), s.own.position, 0.0F, budget).margin > 1.0F;
        world::Manoeuvre m;
        by_nodes += plan(by_cells(nullptr), s, m) == PlanStatus::found ? 1U : 0U;
        for (std::size_t i = 0; i < found.size(); ++i) {
            if (plan(by_cells(&fusions[i]), s, m) != PlanStatus::found) {
                continue;
            }
            ++found[i];
            if (starts_clear) {  // cells know no escape rule
                ASSERT_GE(world::least_separation(s.view(), m.path, 100.0F, budget).margin, -0.06F)
                    << "seed " << seed << " rule " << i;
            }
        }
    }
    EXPECT_GT(found[0], 20U);
    EXPECT_GE(found[0], found[1]) << "what is in a cell at another time is not in the way";
    EXPECT_GE(found[0], found[2]) << "who may deviate is in more cells";
    EXPECT_GT(by_nodes, found[0]);
    std::printf(
        "[ measured ] of 300 random situations ways were found in %zu by nodes, in %zu by cells in time, in %zu by "
        "cells at any time, in %zu with intruders that may deviate by 6 degrees\n",
        by_nodes, found[0], found[1], found[2]);
    by_cells(nullptr);
}

/// A placed set whose grid holds solids of every kind: no point of a solid is in a cell reported free of it.
TEST(CellFusionLaws, NoCellThatIsReportedFreeHoldsAnythingOfASolid)
{
    std::size_t points = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Random random(seed);
        RandomSituation s(seed);
        s.tracks.clear();
        s.obstacles.clear();
        s.airspace = {};
        s.limits.half_extents = Vec3::Constant(1e-3F);
        s.own.sigma_position = 0.0F;
        Placed placed;
        placed.set = test::unit_sets().segments[0].emergency;
        placed.origin = s.own.position;
        placed.cosine = std::cos(0.1F * static_cast<float>(seed));
        placed.sine = std::sin(0.1F * static_cast<float>(seed));
        placed.unit = random.uniform(1.0F, 3.0F);
        placed.period = 0.5F;
        placed.upside_down = seed % 2 == 0;
        const Vec3 at =
            placed.to_world(Vec3(random.uniform(1.0F, 8.0F), random.uniform(-4.0F, 4.0F), random.uniform(-3.0F, 3.0F)));
        const Vec3 to = at + Vec3(random.uniform(-3.0F, 3.0F), random.uniform(-3.0F, 3.0F), random.uniform(1.0F, 5.0F));
        const float radius = random.uniform(0.2F, 2.0F);
        const geometry::Shape shapes[] = {geometry::make_sphere(at, radius), geometry::make_capsule(at, to, radius),
                                          geometry::make_cylinder(at, to, radius),
                                          geometry::make_box(at, Vec3(radius, 0.5F, 2.0F))};
        s.obstacles = {{0, shapes[seed % 4]}};
        CellFusion fusion{FusionRule{}};
        std::vector<Level> blocks(placed.set->grid.cells(), kFree);
        WorkBudget budget(kFusionPlenty);
        ASSERT_EQ(fusion.rate(s.view(), placed, CellSpheres(placed.set->grid), 0.0F, blocks, budget),
                  RateStatus::rated);
        for (int i = 0; i < 2000; ++i) {
            const Vec3 direction = Vec3(random.normal(), random.normal(), random.normal()).normalized();
            const Vec3 surface = geometry::support(s.obstacles[0].shape, direction);
            const Vec3 centre = s.obstacles[0].shape.centre;
            const Vec3 point = centre + random.uniform() * (surface - centre);  // convex: inside
            const Located cell = placed.set->grid.locate(placed.to_set(point));
            if (cell.status == LocateStatus::inside) {
                ++points;
                ASSERT_EQ(blocks[placed.set->grid.index(cell.place)], 0) << "seed " << seed << " point " << i;
            }
        }
    }
    EXPECT_GT(points, 20000U);
}

TEST(CellFusion, BoundsOfTheAirspaceAreHardConstraints)
{
    RandomSituation s(1);
    s.tracks.clear();
    s.obstacles.clear();
    s.own.sigma_position = 0.0F;
    s.airspace = {};
    s.airspace.has_floor = true;
    s.airspace.floor = s.own.position.z() - 1.5F;
    Placed placed;
    placed.set = test::unit_sets().segments[0].emergency;
    placed.origin = s.own.position;
    placed.unit = 2.5F;
    placed.period = 0.5F;
    for (const bool upside_down : {false, true}) {
        placed.upside_down = upside_down;
        CellFusion fusion{FusionRule{}};
        std::vector<Level> blocks(placed.set->grid.cells(), kFree);
        WorkBudget budget(kFusionPlenty);
        ASSERT_EQ(fusion.rate(s.view(), placed, CellSpheres(placed.set->grid), 0.0F, blocks, budget),
                  RateStatus::rated);
        const auto level = [&](std::uint8_t layer, std::uint8_t row) {
            return blocks[placed.set->grid.index({layer, 3, row})];
        };
        const std::uint8_t down = upside_down ? 4 : 0;
        EXPECT_EQ(level(9, down), static_cast<Level>(AvoidanceRun::hard_constraints));
        EXPECT_EQ(level(9, static_cast<std::uint8_t>(4 - down)), kFree);
    }
}

TEST(CellFusion, WithoutWorkItSaysSo)
{
    const RandomSituation s(3);
    CellFusion fusion{FusionRule{}};
    Planner& planner = by_cells(&fusion);
    WorkBudget budget(5000);
    world::Manoeuvre m;
    EXPECT_EQ(planner.plan(s.view(), budget, m), PlanStatus::budget_spent);
    by_cells(nullptr);
}

}  // namespace
}  // namespace jink::reach
