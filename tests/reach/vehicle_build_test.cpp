// SPDX-License-Identifier: BSD-3-Clause
// All sets of a vehicle: their demands on the vehicle, their sizes, and refusals.
#include "toolchain/reach/vehicle_build.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "toolchain/reach/expansion.hpp"

namespace jink::reach::build {
namespace {

constexpr double kDegree = 0.017453292519943295;

vehicle::VehicleLimits second_vehicle()
{
    vehicle::VehicleLimits limits;
    limits.cruise_speed = 15.0F;
    limits.max_climb = 8.0F;
    limits.max_descent = 8.0F;
    return limits;
}

Recipe reduced()
{
    Recipe recipe;
    recipe.profile = Profile::reduced;
    return recipe;
}

std::string why(const vehicle::VehicleLimits& limits, const Recipe& recipe)
{
    try {
        static_cast<void>(build_vehicle("test", limits, recipe));
    } catch (const CannotBuild& error) {
        return error.what();
    }
    return "built";
}

/// Specification 5.4, in figures by hand: 0.7 * 5 * 0.5 / 18 and 0.7 * 3 * 0.5 / 18 rad; 15 degrees at the most.
TEST(VehicleBuild, StepsFollowFromTheLimits)
{
    const Settings fast = settings_at(second_vehicle(), 18.0, 0.5);
    EXPECT_NEAR(fast.step.yaw, 0.0972222, 1e-6);
    EXPECT_NEAR(fast.step.pitch, 0.0583333, 1e-6);
    EXPECT_NEAR(fast.grid.horizontal(), 3 * 0.0972222, 1e-6);
    EXPECT_NEAR(fast.grid.vertical(), 2 * 0.0583333, 1e-6);
    EXPECT_EQ(fast.most_up, 7) << "asin(8 / 18) = 26.4 degrees, in steps of 3.34";
    const Settings slow = settings_at(vehicle::VehicleLimits{}, 3.5, 0.5);
    EXPECT_NEAR(slow.step.yaw, 15 * kDegree, 1e-9);
    EXPECT_NEAR(slow.step.pitch, 15 * kDegree, 1e-9);
    EXPECT_NEAR(slow.grid.horizontal(), 45 * kDegree, 1e-9) << "the source's grid";
    EXPECT_NEAR(slow.grid.vertical(), 30 * kDegree, 1e-9);
    vehicle::VehicleLimits lazy;
    lazy.max_climb = 0.3F;
    lazy.max_descent = 1.0F;
    const Settings flat = settings_at(lazy, 6.0, 0.5);
    EXPECT_NEAR(flat.step.pitch, std::asin(0.05), 1e-7) << "one step of pitch climbs at 0.3 m/s";
    EXPECT_EQ(flat.most_up, 1);
    EXPECT_EQ(flat.most_down, 3);
}

/// The vehicle can fly every movement of a set at every speed of its segment.
void expect_flyable(const BuiltVehicle& built)
{
    for (std::size_t i = 0; i < built.segments.size(); ++i) {
        const std::size_t speed = i / kPitchSegments;
        const double cruise = static_cast<double>(built.limits.cruise_speed);
        const double fastest =
            cruise * (speed + 1 < built.speeds.size() ? built.recipe.speeds[speed + 1] : built.recipe.most_speed);
        const BuiltVehicle::Segment& segment = built.segments[i];
        for (const std::size_t number : {segment.navigation, segment.emergency}) {
            const BuiltSet& set = built.sets[number];
            EXPECT_LE(fastest * set.settings.step.yaw / built.recipe.period, 0.7001 * built.limits.max_acceleration);
            EXPECT_LE(fastest * set.settings.step.pitch / built.recipe.period,
                      0.7001 * built.limits.max_vertical_acceleration);
            for (const Set::Member& member : set.set.members) {
                const double up = (segment.upside_down ? 1.0 : -1.0) * std::sin(member.node.pose.pitch);
                ASSERT_LE(fastest * up, built.limits.max_climb + 1e-6);
                ASSERT_LE(-fastest * up, built.limits.max_descent + 1e-6);
            }
        }
    }
}

TEST(VehicleBuild, SetsAreFlyableAndFit)
{
    for (const vehicle::VehicleLimits& limits : {vehicle::VehicleLimits{}, second_vehicle()}) {
        for (const Recipe& recipe : {Recipe{}, reduced()}) {
            const BuiltVehicle built = build_vehicle("test", limits, recipe);
            expect_flyable(built);
            EXPECT_EQ(built.sets.size(), 8U);
            EXPECT_EQ(built.segments.size(), 6U);
            EXPECT_LE(built.bytes(), most_bytes_of(recipe.profile));
            for (const BuiltSet& set : built.sets) {
                EXPECT_LE(set.set.members.size(), most_nodes_of(recipe.profile));
                EXPECT_EQ(bytes_of(set.set), bytes_of(set.stored.view()));
            }
            EXPECT_EQ(check(VehicleView(built).sets()), SetStatus::good);
        }
    }
}

TEST(VehicleBuild, ClimbingIsStoredUpsideDownOnlyWhereItMirrorsSinking)
{
    const BuiltVehicle even = build_vehicle("test", vehicle::VehicleLimits{}, reduced());
    for (std::size_t i = 0; i < even.segments.size(); ++i) {
        EXPECT_EQ(even.segments[i].upside_down, i % kPitchSegments == 2);
    }
    EXPECT_EQ(even.segments[2].emergency, even.segments[0].emergency);
    EXPECT_NE(even.segments[1].emergency, even.segments[0].emergency);
    vehicle::VehicleLimits limits;
    limits.max_descent = 1.5F;
    const BuiltVehicle uneven = build_vehicle("test", limits, reduced());
    expect_flyable(uneven);
    EXPECT_EQ(uneven.sets.size(), 12U);
    EXPECT_LE(uneven.bytes(), most_bytes_of(Profile::reduced));
    for (const BuiltVehicle::Segment& segment : uneven.segments) {
        EXPECT_FALSE(segment.upside_down);
    }
    const auto root = [&](std::size_t segment) {
        return uneven.sets[uneven.segments[segment].emergency].set.members[0].node.pitch_steps;
    };
    EXPECT_EQ(root(0), 1);
    EXPECT_EQ(root(1), 0);
    EXPECT_EQ(root(2), -1);
}

/// A vehicle that turns by the largest step at every speed has one pair for all of them.
TEST(VehicleBuild, EqualSetsAreStoredOnce)
{
    vehicle::VehicleLimits limits;
    limits.cruise_speed = 1.0F;
    const BuiltVehicle built = build_vehicle("test", limits, reduced());
    EXPECT_EQ(built.sets.size(), 4U);
    EXPECT_EQ(built.segments.size(), 6U);
    EXPECT_EQ(built.segments[1].emergency, built.segments[4].emergency);
    EXPECT_EQ(check(VehicleView(built).sets()), SetStatus::good);
}

/// The tables against the trajectories, flown anew in double precision.
TEST(VehicleBuild, TablesAreTheTrajectories)
{
    const BuiltVehicle built = build_vehicle("test", second_vehicle(), reduced());
    for (const BuiltSet& set : built.sets) {
        const ReachSet tables = set.stored.view();
        std::vector<Node> nodes{root_of(set.settings)};
        for (std::size_t i = 1; i < tables.nodes(); ++i) {
            const auto movement = static_cast<Movement>(tables.movement[i]);
            const std::optional<Node> node =
                child_of(set.settings, nodes[tables.parent[i]], tables.parent[i], movement);
            ASSERT_TRUE(node);
            nodes.push_back(*node);
            const Vec3 at = tables.position_of(i);
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(at[axis], node->pose.position[axis], 0.5 / 1024.0 + 1e-6);
            }
            ASSERT_EQ(tables.end[i], set.settings.grid.index(node->end));
            ASSERT_EQ(tables.attitude[2 * i], node->pitch_steps);
            ASSERT_EQ(tables.attitude[2 * i + 1], node->yaw_steps);
            ASSERT_EQ(tables.entered(i).size(), node->entered.size());
            for (std::size_t e = 0; e < node->entered.size(); ++e) {
                ASSERT_EQ(tables.entered(i)[e].cell, node->entered[e].cell);
                ASSERT_EQ(tables.entered(i)[e].first, node->entered[e].first);
                ASSERT_EQ(tables.entered(i)[e].last, node->entered[e].last);
            }
        }
        EXPECT_EQ(tables.attitude[0], set.settings.root_pitch) << "the root's own";
    }
}

/// Specification 11.3: of trajectories to one cell the smooth ones are cheap: up to twice the cost without smoothness.
TEST(VehicleBuild, EmergencyCostsFollowSmoothness)
{
    const BuiltVehicle built = build_vehicle("test", vehicle::VehicleLimits{}, reduced());
    const BuiltSet& set = built.sets[built.segments[1].emergency];
    const ReachSet tables = set.stored.view();
    for (std::size_t i = 1; i < tables.nodes(); ++i) {
        const Node& node = set.set.members[i].node;
        const double factor = 2.0 - node.smoothness();
        EXPECT_GE(tables.cost_of(i), factor * node.depth - 1e-3);
        EXPECT_LE(tables.cost_of(i), factor * 1.2 * node.depth + 1e-3);
    }
}

TEST(VehicleBuild, LessRoomFewerTrajectories)
{
    Recipe recipe = reduced();
    recipe.most_bytes = 60'000;
    const BuiltVehicle small = build_vehicle("test", vehicle::VehicleLimits{}, recipe);
    EXPECT_LE(small.bytes(), 60'000U);
    recipe.most_bytes = 0;
    const BuiltVehicle large = build_vehicle("test", vehicle::VehicleLimits{}, recipe);
    EXPECT_LT(small.density.spread, large.density.spread);
    EXPECT_EQ(small.density.most_lateral, large.density.most_lateral) << "ways out at the sides are kept longest";
    recipe.most_bytes = 20'000;
    EXPECT_NE(why(vehicle::VehicleLimits{}, recipe).find("more than 20000 bytes"), std::string::npos);
}

TEST(VehicleBuild, RecipesThatMakeNoSenseAreRefused)
{
    const auto with = [](const auto& change) {
        Recipe recipe = reduced();
        change(recipe);
        return why(vehicle::VehicleLimits{}, recipe);
    };
    EXPECT_EQ(with([](Recipe& r) { r.period = 0.0; }), "a movement takes 0.05 to 5 s, not 0");
    EXPECT_EQ(with([](Recipe& r) { r.period = std::nan(""); }), "a movement takes 0.05 to 5 s, not nan");
    EXPECT_EQ(with([](Recipe& r) { r.speeds = {}; }), "there are 1 to 8 speed segments");
    EXPECT_EQ(with([](Recipe& r) { r.speeds.assign(9, 0.1); }), "there are 1 to 8 speed segments");
    EXPECT_EQ(with([](Recipe& r) { r.speeds = {0.5, 0.5}; }), "speeds ascend from above 0: 0.5 comes after 0.5");
    EXPECT_EQ(with([](Recipe& r) { r.speeds = {-1.0}; }), "speeds ascend from above 0: -1 comes after 0");
    EXPECT_NE(with([](Recipe& r) { r.most_speed = 0.7; }).find("not 0.7"), std::string::npos);
    EXPECT_NE(with([](Recipe& r) { r.most_speed = 9.0; }).find("not 9"), std::string::npos);
    vehicle::VehicleLimits sluggish;
    sluggish.cruise_speed = 100.0F;
    sluggish.max_acceleration = 0.2F;
    EXPECT_NE(why(sluggish, reduced()).find("less than 0.25: take a longer period"), std::string::npos);
}

}  // namespace
}  // namespace jink::reach::build
