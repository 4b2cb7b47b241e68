// SPDX-License-Identifier: BSD-3-Clause
// Cost tables: shipped tables equal those of the vehicle files, bounds hold, and damage is detected.
#include "toolchain/host/cost_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/vehicles/default/cost_tables.hpp"
#include "firmware/vehicles/uav2/cost_tables.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/waypoints_study.hpp"

namespace jink::host {
namespace {

using cost::tables::Tables;

files::Vehicle shipped(const std::string& name)
{
    files::Complaints complaints;
    const auto vehicle =
        files::read_vehicle_file(JINK_SOURCES "/firmware/vehicles/" + name + "/vehicle.yaml", complaints);
    EXPECT_TRUE(vehicle) << test::all_of(complaints);
    return vehicle.value_or(*files::built_in_vehicle("default"));
}

/// Every ratio of the proof, fewer legs and planes: `jink tables --check` takes all of them.
constexpr Density kLooking{40, 8, 8, 40};

TEST(CostTables, WhatIsShippedIsWhatTheVehicleFilesGive)
{
    for (const std::string name : {"default", "uav2"}) {
        MadeTables made = make_tables(shipped(name), 25);
        const std::string folder = "firmware/vehicles/" + name;
        EXPECT_EQ(tables_header(made), test::slurp(JINK_SOURCES "/" + folder + "/cost_tables.hpp"))
            << "run: jink tables " << folder << "/vehicle.yaml --out " << folder << "/cost_tables.hpp";
    }
}

TEST(CostTables, TheBoundsHoldBetweenTheSamplesThatTheyComeFrom)
{
    for (const Tables& tables : {cost::tables::kDefault, cost::tables::kUav2}) {
        for (std::size_t i = 0; i < tables.families.size(); ++i) {
            const TableErrors errors = sample_errors(tables, i, kLooking);
            EXPECT_TRUE(holds(errors, tables.families[i].bounds)) << tables.vehicle << ' ' << tables.families[i].name;
            EXPECT_EQ(errors.refused, 0U);
            EXPECT_GT(errors.look_ups, 200'000U);
        }
    }
}

TEST(CostTables, DamageIsSeen)
{
    const MadeTables sound = make_tables(shipped("default"), 25);
    const auto damaged = [&](const auto& damage) {
        MadeTables made = sound;
        damage(made.families[1]);
        return !holds(sample_errors(made.view(), 1, kLooking), made.families[1].bounds);
    };
    EXPECT_FALSE(damaged([](MadeTables::Family&) {}));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.arc.back() *= 1.01F; })) << "beyond the domain";
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.arc[100] *= 1.0005F; }));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.bend[5] *= 1.0005F; }));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.turn[9] *= 1.05F; }));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.slope[3] *= 1.05F; }));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.offset[7] *= 1.005F; }));
    EXPECT_TRUE(damaged([](MadeTables::Family& f) { f.bounds.time *= 0.5F; }));
}

/// The reference flights of the caps (cost::reference_flights), out of tables of as many waypoints.
TEST(CostTables, TheReferenceFlightsComeOutOfTheTables)
{
    for (const std::string name : {"default", "uav2"}) {
        const files::Vehicle vehicle = shipped(name);
        MadeTables made = make_tables(vehicle, 57);
        const Tables tables = made.view();
        const cost::Caps flown = cost::reference_flights(vehicle.limits, vehicle.airframe);
        const float speed = vehicle.limits.cruise_speed;
        const cost::tables::CurveQuery lower{0, 3.2F * 2.0F / 3.0F, 3.0F, speed, 0.0F, 0.0F};
        const float distance = std::hypot(8.25F, 1.75F);
        const cost::tables::CurveQuery upper{0, -9.6F, distance, speed, -1.75F / distance, 8.25F / distance};
        // Bounds, and the rounding of the flights' 57 points.
        const auto near = [](float found, float exact, float bound) {
            EXPECT_NEAR(found, exact, exact * (bound + 2e-5F));
        };
        const cost::tables::Bounds& bounds = tables.families[0].bounds;
        near(estimate(tables, lower)->time, flown.time_low, bounds.time);
        near(estimate(tables, upper)->time, flown.time_high, bounds.time);
        near(*energy(tables, lower), flown.energy_low, bounds.energy);
        near(*energy(tables, upper), flown.energy_high, bounds.energy);
    }
}

TEST(CostTables, AnyNumberOfWaypointsMakesTables)
{
    for (const std::uint16_t waypoints : std::vector<std::uint16_t>{8, 9, 20, 33, 64}) {
        MadeTables made = make_tables(shipped("default"), waypoints);
        const Tables tables = made.view();
        for (std::size_t i = 0; i < tables.families.size(); ++i) {
            EXPECT_EQ(tables.families[i].mirrored, i > 0 && waypoints % 2 == 1);
            EXPECT_TRUE(holds(sample_errors(tables, i, {23, 6, 6, 40}), tables.families[i].bounds)) << waypoints;
        }
    }
}

TEST(CostTables, NamesOfVehiclesBecomeNamesOfConstants)
{
    EXPECT_EQ(identifier_of("default"), "Default");
    EXPECT_EQ(identifier_of("my quad-3"), "MyQuad3");
    EXPECT_EQ(identifier_of("3 rotors"), "");
    EXPECT_EQ(identifier_of(" -\xc3\xa4"), "");
    EXPECT_EQ(identifier_of(""), "");
}

/// Chords of a parabola lie y'' / 8 of a squared step from it; at the top the symmetric curve is one, 6 r steep.
TEST(WaypointStudy, ChordsLieAnEighthOfTheSecondDerivativeInside)
{
    const double step = 2.0 / 24.0;
    EXPECT_NEAR(chord_distance(1, 25, 0.05), 0.05 * 6.0 * step * step / 8.0, 0.05 * 0.0006);
    EXPECT_GT(chord_distance(0, 25, 1.28), chord_distance(0, 37, 1.28));
}

TEST(WaypointStudy, TheReferenceHasNoErrorAndMoreWaypointsHaveLess)
{
    const files::Vehicle vehicle = shipped("default");
    const WaypointErrors same = waypoint_errors(vehicle, kReferenceWaypoints);
    EXPECT_EQ(same.time, 0.0);
    EXPECT_EQ(same.smoothness, 0.0);
    EXPECT_EQ(same.energy, 0.0);
    EXPECT_EQ(same.closeness, 0.0);
    EXPECT_EQ(same.order, 0.0);
    const WaypointErrors few = waypoint_errors(vehicle, 13);
    const WaypointErrors many = waypoint_errors(vehicle, 49);
    EXPECT_LT(many.time, few.time);
    EXPECT_LT(many.smoothness, few.smoothness);
    EXPECT_LT(many.energy, few.energy);
    EXPECT_LT(many.cost, few.cost);
    EXPECT_LT(many.inside, few.inside);
}

}  // namespace
}  // namespace jink::host
