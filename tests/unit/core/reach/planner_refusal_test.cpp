// SPDX-License-Identifier: BSD-3-Clause
// Refusals of the reach planner: unsuitable input, settings and sets.
#include <gtest/gtest.h>

#include <limits>

#include "core/reach/planner.hpp"
#include "tests/unit/core/reach/planner_bench.hpp"

namespace jink::reach {
namespace {

using test::PlannerBench;
using world::PlanStatus;

class PlannerRefusal : public ::testing::Test, protected PlannerBench {};

TEST_F(PlannerRefusal, WhatItIsNotForIsBadInputAndWritesNothing)
{
    reference.valid = false;
    EXPECT_EQ(plan(), PlanStatus::bad_input);
    EXPECT_TRUE(out.path.points.empty());
    reference.valid = true;
    path::Route route;
    reference = world::Reference(route, reference.speed);
    EXPECT_EQ(plan(), PlanStatus::bad_input) << "an empty route";
    ASSERT_EQ(route.add_leg(Vec3(-20, 0, 30), Vec3(200, 0, 30)), path::RouteStatus::ok);
    EXPECT_EQ(plan(), PlanStatus::found);
    leg(Vec3(-20, 0, 30), Vec3(200, 0, 30));
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        add_track(Vec3(-1000, 0, 30), Vec3::Zero(), 0.5F);
    }
    EXPECT_EQ(plan(), PlanStatus::found) << "as many as there may be";
    add_track(Vec3(-1000, 0, 30), Vec3::Zero(), 0.5F);
    EXPECT_EQ(plan(), PlanStatus::bad_input);
    tracks.clear();
    for (std::size_t i = 0; i < kMaxObstacles; ++i) {
        add_box(Vec3(-1000, 0, 30), Vec3::Ones());
    }
    EXPECT_EQ(plan(), PlanStatus::found);
    add_box(Vec3(-1000, 0, 30), Vec3::Ones());
    EXPECT_EQ(plan(), PlanStatus::bad_input);
    obstacles.clear();
    std::vector<world::Cylinder> cylinders(kMaxCylinders);
    for (world::Cylinder& cylinder : cylinders) {
        cylinder.circle = {world::Vec2(-1000, 0), 1.0F};
        cylinder.top = 10.0F;
    }
    airspace.cylinders = cylinders;
    EXPECT_EQ(plan(), PlanStatus::found);
    cylinders.push_back(cylinders.front());
    airspace.cylinders = cylinders;
    EXPECT_EQ(plan(), PlanStatus::bad_input);
    Planner without{Settings{}};
    airspace.cylinders = {};
    WorkBudget budget(kAllTheWork);
    EXPECT_EQ(without.plan(view(), budget, out), PlanStatus::bad_input) << "no sets";
}

TEST_F(PlannerRefusal, SettingsOutOfRangeAreRefusedAndChangeNothing)
{
    EXPECT_TRUE(is_valid(settings));
    const auto with = [&](auto Settings::*member, auto value) {
        Settings changed = settings;
        changed.*member = value;
        return is_valid(changed);
    };
    EXPECT_FALSE(with(&Settings::sets, static_cast<const VehicleSets*>(nullptr)));
    using Tries = std::uint8_t;
    EXPECT_TRUE(with(&Settings::tries, Tries{1}) && with(&Settings::tries, Tries{64}));
    EXPECT_FALSE(with(&Settings::tries, Tries{0}) || with(&Settings::tries, Tries{65}));
    ASSERT_TRUE(planner.configure(settings));
    Settings bad = settings;
    bad.tries = 0;
    bad.least_outer_layer = 1;
    EXPECT_FALSE(planner.configure(bad));
    EXPECT_EQ(planner.settings().tries, settings.tries);
    EXPECT_EQ(planner.settings().least_outer_layer, settings.least_outer_layer);
}

TEST_F(PlannerRefusal, SetsThatHaveNoRoomAreRefused)
{
    const auto fits = [&](const ReachSet* navigation, const ReachSet* emergency) {
        only(pairs[0].navigation, pairs[0].emergency);
        pairs[2] = {navigation, emergency, false};
        return is_valid(settings);
    };
    const ReachSet good = *pairs[0].navigation;
    const auto of = [&](std::size_t nodes, const Grid<float>& grid) {
        static std::vector<NodeIndex> parents;
        parents.assign(nodes, 0);
        ReachSet set = good;
        set.parent = parents;
        set.grid = grid;
        return fits(&set, &good) && fits(&good, &set);
    };
    EXPECT_TRUE(fits(&good, &good));
    EXPECT_FALSE(fits(nullptr, &good));
    EXPECT_FALSE(fits(&good, nullptr));
    EXPECT_FALSE(of(0, kGrid));
    EXPECT_TRUE(of(1, kGrid));
    EXPECT_TRUE(of(kMaxReachNodes, kGrid));
    EXPECT_FALSE(of(kMaxReachNodes + 1, kGrid));
    EXPECT_TRUE(of(1, Grid<float>(kMaxReachCells / 64, 8, 8, 4.0F, 0.8F, 0.5F))) << "cells, and directions";
    EXPECT_FALSE(of(1, Grid<float>(kMaxReachCells / 64 + 1, 8, 8, 4.0F, 0.8F, 0.5F)));
    EXPECT_FALSE(of(1, Grid<float>(1, 13, 5, 4.0F, 0.8F, 0.5F)));
}

TEST_F(PlannerRefusal, AVehicleSuitsSetsThatAskNoMoreThanItCan)
{
    limits.max_acceleration = 5.0F;
    limits.max_vertical_acceleration = 3.0F;
    limits.max_climb = 3.0F;
    limits.max_descent = 2.0F;
    limits.cruise_speed = 10.0F;
    EXPECT_TRUE(suits(sets, limits)) << "exactly what they were built for";
    const auto with = [&](float vehicle::VehicleLimits::*limit, float share) {
        vehicle::VehicleLimits changed = limits;
        changed.*limit *= share;
        return suits(sets, changed);
    };
    for (float vehicle::VehicleLimits::*limit :
         {&vehicle::VehicleLimits::max_acceleration, &vehicle::VehicleLimits::max_vertical_acceleration,
          &vehicle::VehicleLimits::max_climb, &vehicle::VehicleLimits::max_descent}) {
        EXPECT_TRUE(with(limit, 1.5F));
        EXPECT_TRUE(with(limit, 1.0F - 5e-5F)) << "rounding";
        EXPECT_FALSE(with(limit, 0.999F));
    }
    EXPECT_TRUE(with(&vehicle::VehicleLimits::cruise_speed, 0.5F));
    EXPECT_FALSE(with(&vehicle::VehicleLimits::cruise_speed, 1.001F)) << "it would cruise faster than they are for";
}

}  // namespace
}  // namespace jink::reach
