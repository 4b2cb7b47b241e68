// SPDX-License-Identifier: BSD-3-Clause
#include "core/cost/tables.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometric/offsets.hpp"
#include "core/geometric/planner.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"
#include "firmware/vehicles/uav2/cost_tables.hpp"
#include "firmware/vehicles/uav2/vehicle.hpp"
#include "tests/numbers.hpp"

namespace jink::cost::tables {
namespace {

constexpr CurveQuery kLevel{.family = 0, .offset = 2.0F, .distance = 10.0F, .speed = 5.0F};

TEST(CostTables, FitThePlannersCurves)
{
    const geometric::Settings settings;
    for (const Tables& tables : {kDefault, kUav2}) {
        EXPECT_EQ(tables.waypoints, settings.waypoints);
        EXPECT_LE(tables.bytes, 6U * 1024U);
        ASSERT_EQ(tables.families.size(), 3U);
        for (const geometric::Family family : {geometric::Family::simple, geometric::Family::symmetric}) {
            const FamilyTable& table = tables.families[static_cast<std::size_t>(family)];
            EXPECT_EQ(table.length, geometric::curve_length_x(family, 1.0F));
            ASSERT_EQ(table.offset.size(), settings.waypoints);
            for (std::size_t i = 0; i < table.offset.size(); ++i) {
                const float u = table.length * static_cast<float>(i) / static_cast<float>(table.chords());
                // Roundings of u, tripled at the steep end of a simple curve.
                EXPECT_NEAR(table.offset[i], geometric::unit_offset(family, u), 2e-6F) << table.name << ' ' << i;
            }
        }
    }
    EXPECT_EQ(kDefault.families[0].name, "simple");
    EXPECT_EQ(kDefault.families[1].name, "symmetric");
    EXPECT_EQ(kDefault.families[2].name, "smooth");
    EXPECT_EQ(kLargestRatio, geometric::detail::kLargestRatio);
}

TEST(CostTables, CarryTheirVehicle)
{
    const vehicle::VehicleLimits limits = vehicle::uav2_limits();
    const vehicle::Airframe airframe = vehicle::uav2_airframe();
    EXPECT_EQ(kUav2.vehicle, "uav2");
    EXPECT_EQ(kUav2.cruise_speed, limits.cruise_speed);
    EXPECT_EQ(kUav2.max_climb, limits.max_climb);
    EXPECT_EQ(kUav2.max_descent, limits.max_descent);
    EXPECT_EQ(kUav2.mass, airframe.mass);
    EXPECT_FLOAT_EQ(kUav2.drag, 0.25F * 0.8F * 1.225F * 10.0F);
    const Caps caps = caps_for(limits, airframe);
    EXPECT_EQ(kUav2.caps.time_low, caps.time_low);
    EXPECT_EQ(kUav2.caps.time_high, caps.time_high);
    EXPECT_EQ(kUav2.caps.energy_low, caps.energy_low);
    EXPECT_EQ(kUav2.caps.energy_high, caps.energy_high);
    EXPECT_EQ(kDefault.caps.time_high, 7.0814F);
    const Tables other = with_limits(kDefault, limits, airframe);
    EXPECT_EQ(other.max_climb, 8.0F);
    EXPECT_EQ(other.mass, 10.0F);
    EXPECT_EQ(other.drag, kUav2.drag);
    EXPECT_EQ(other.caps.time_high, caps.time_high);
}

TEST(CostTables, AlongTheLegThereIsNothingToTurn)
{
    for (std::size_t family = 0; family < 3; ++family) {
        const CurveQuery query{.family = family, .offset = 0.0F, .distance = 10.0F, .speed = 5.0F};
        const float length = 10.0F * kDefault.families[family].length;
        const auto found = estimate(kDefault, query);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->length, length, 1e-5F * length);
        EXPECT_NEAR(found->time, length / 5.0F, 1e-5F * length);
        EXPECT_EQ(found->smoothness, 0.0F);
        // Drag alone: C_D rho A_e / 4 * length * |2 v|^2.
        const float drag = 0.25F * 0.5F * 1.225F * 2.5F * length * 100.0F;
        EXPECT_NEAR(*energy(kDefault, query), drag, 1e-5F * drag);
    }
}

TEST(CostTables, ALegThatIsTooSteepIsFlownAtTheLimit)
{
    // Straight up: 3 m/s, for any cruise speed. Straight down: likewise.
    for (const float along_z : {1.0F, -1.0F}) {
        const CurveQuery query{.family = 1, .offset = 0.0F, .distance = 6.0F, .speed = 5.0F, .along_z = along_z};
        EXPECT_NEAR(estimate(kDefault, query)->time, 12.0F / 3.0F, 1e-5F);
        const float potential = 3.0F * kGravity * 12.0F;
        const float drag = 0.25F * 0.5F * 1.225F * 2.5F * 12.0F * 36.0F;
        EXPECT_NEAR(*energy(kDefault, query), potential + drag, 1e-5F * (potential + drag));
    }
    // Exactly at the limit nothing changes.
    const CurveQuery at_limit{.family = 1, .offset = 0.0F, .distance = 6.0F, .speed = 5.0F, .along_z = 0.6F};
    EXPECT_NEAR(estimate(kDefault, at_limit)->time, 12.0F / 5.0F, 1e-5F);
}

TEST(CostTables, AnUprightPlaneIsSlowedOnlyWhereItIsSteep)
{
    // Slope of the symmetric family at most 1.5 r; sine 0.6 is reached at a slope of 0.75.
    CurveQuery query{.family = 1, .offset = 4.9F, .distance = 10.0F, .speed = 5.0F, .along_z = 0.0F, .side_z = 1.0F};
    EXPECT_FLOAT_EQ(estimate(kDefault, query)->time, estimate(kDefault, query)->length / 5.0F);
    query.offset = 5.3F;
    EXPECT_GT(estimate(kDefault, query)->time, estimate(kDefault, query)->length / 5.0F * 1.00001F);
    query.side_z = 0.0F;
    EXPECT_FLOAT_EQ(estimate(kDefault, query)->time, estimate(kDefault, query)->length / 5.0F);
}

void expect_refused(const CurveQuery& query, const char* what)
{
    EXPECT_FALSE(covers(kDefault, query)) << what;
    EXPECT_FALSE(estimate(kDefault, query)) << what;
    EXPECT_FALSE(energy(kDefault, query)) << what;
}

TEST(CostTables, WhatTheyDoNotHoldIsRefused)
{
    ASSERT_TRUE(covers(kDefault, kLevel));
    const auto with = [](const auto& change) {
        CurveQuery query = kLevel;
        change(query);
        return query;
    };
    expect_refused(with([](CurveQuery& q) { q.family = 3; }), "family");
    expect_refused(with([](CurveQuery& q) { q.offset = 12.8011F; }), "too far right");
    expect_refused(with([](CurveQuery& q) { q.offset = -12.8011F; }), "too far left");
    expect_refused(with([](CurveQuery& q) { q.offset = kNan; }), "offset");
    expect_refused(with([](CurveQuery& q) { q.offset = kInfinity; }), "endless offset");
    for (const float bad : {0.0F, -1.0F, kNan, kInfinity}) {
        expect_refused(with([bad](CurveQuery& q) { q.distance = bad; }), "distance");
        expect_refused(with([bad](CurveQuery& q) { q.speed = bad; }), "speed");
    }
    for (const float bad : {1.1F, -1.1F, kNan, kInfinity}) {
        expect_refused(with([bad](CurveQuery& q) { q.along_z = bad; }), "leg");
        expect_refused(with([bad](CurveQuery& q) { q.side_z = bad; }), "plane");
    }
    expect_refused(with([](CurveQuery& q) { q.along_z = q.side_z = 0.8F; }), "leg and plane not square");
    // The ends belong to it.
    EXPECT_TRUE(covers(kDefault, with([](CurveQuery& q) { q.offset = 12.801F; })));
    EXPECT_TRUE(covers(kDefault, with([](CurveQuery& q) { q.offset = -12.801F; })));
    EXPECT_TRUE(covers(kDefault, with([](CurveQuery& q) { q.along_z = 1.00001F; })));
    EXPECT_FALSE(covers(Tables{}, kLevel)) << "no tables at all";
}

TEST(CostTables, SmoothnessAloneIsTheSameAndRefusesTheSame)
{
    for (std::size_t family = 0; family < kDefault.families.size(); ++family) {
        for (const float offset : {-12.801F, -3.0F, 0.0F, 0.5F, 12.801F}) {
            CurveQuery query = kLevel;
            query.family = family;
            query.offset = offset;
            const std::optional<Estimate> all = estimate(kDefault, query);
            ASSERT_TRUE(all);
            EXPECT_EQ(smoothness(kDefault, family, offset, query.distance), all->smoothness) << offset;
        }
    }
    EXPECT_FALSE(smoothness(kDefault, 3, 1.0F, 10.0F)) << "family";
    EXPECT_FALSE(smoothness(kDefault, 0, 12.8011F, 10.0F)) << "offset";
    EXPECT_FALSE(smoothness(kDefault, 0, kNan, 10.0F)) << "offset";
    for (const float bad : {0.0F, -1.0F, kNan, kInfinity}) {
        EXPECT_FALSE(smoothness(kDefault, 0, 1.0F, bad)) << "distance";
    }
    EXPECT_FALSE(smoothness(Tables{}, 0, 1.0F, 10.0F)) << "no tables at all";
}

}  // namespace
}  // namespace jink::cost::tables
