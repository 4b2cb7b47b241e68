// SPDX-License-Identifier: BSD-3-Clause
// Gates, reaches and rates of the track table exactly at their limits.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/core/world/track_edges.hpp"

namespace jink::world {
namespace {

using namespace test;

/// No process noise: a track of 1 m and 2 m/s is known to sqrt(5) m after a second. With a sighting of 2 m that is
/// 3 m, and six of these are 18 m.
struct TrackGates : TrackEdges {
    TrackGates()
    {
        settings.process_acceleration = 0.0F;
        table.configure(settings);
        first = seen(1, Vec3::Zero());
        first.sigma_position = 1.0F;
        first.sigma_velocity = 2.0F;
        EXPECT_EQ(take(first), TrackStatus::created);
        second = first;
        second.stamp = kStart + 1.0F;
        second.sigma_position = 2.0F;
        second.has_velocity = false;
    }
    TrackMeasurement first;
    TrackMeasurement second;
};

TEST_F(TrackGates, SixDeviationsOfPlaceAreNoJump)
{
    second.position = Vec3(0, -18, 0);
    EXPECT_EQ(take(second), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 0U);
    EXPECT_EQ(only(second.stamp).position.y(), -10.0F) << "five ninths of the way";
}

TEST_F(TrackGates, MoreThanSixDeviationsOfPlaceAreAJump)
{
    second.position = Vec3(0, -18.01F, 0);
    EXPECT_EQ(take(second), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 1U);
    EXPECT_EQ(only(second.stamp).position.y(), -18.01F);
    EXPECT_EQ(only(second.stamp).sigma_position, 2.0F);
}

/// 2 m/s and 1.5 m/s are 2.5 m/s; six of these are 15 m/s.
TEST_F(TrackGates, SixDeviationsOfVelocityAreNoJumpAndMoreAreOne)
{
    second.has_velocity = true;
    second.sigma_velocity = 1.5F;
    second.velocity = Vec3(0, 0, 15);
    EXPECT_EQ(take(second), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 0U);
    TrackTable other(settings);
    static_cast<void>(other.update(first, own, first.stamp));
    second.velocity = Vec3(0, 0, 15.01F);
    EXPECT_EQ(other.update(second, own, second.stamp), TrackStatus::updated);
    EXPECT_EQ(other.diagnostics().jumps, 1U);
    EXPECT_EQ(other.snapshot(second.stamp)[0].velocity.z(), 15.01F);
}

/// 18 m and, at 10 m/s2 for a second, 5 m: so far it could have got.
TEST_F(TrackGates, WhatItCouldJustHaveReachedIsTheSameAircraft)
{
    second.position = Vec3(23, 0, 0);
    EXPECT_EQ(take(second), TrackStatus::updated);
    EXPECT_EQ(table.size(), 1U);
    TrackTable other(settings);
    static_cast<void>(other.update(first, own, first.stamp));
    second.position = Vec3(23.01F, 0, 0);
    EXPECT_EQ(other.update(second, own, second.stamp), TrackStatus::created);
    EXPECT_EQ(other.diagnostics().doubled, 1U);
    EXPECT_EQ(other.size(), 2U);
}

/// Sightings that are far better than the prediction leave no variance; rounding leaves none that is below 0.
TEST_F(TrackEdges, DeviationsAreNumbersHoweverGoodTheSightings)
{
    settings.process_acceleration = 0.0F;
    settings.max_age = 100.0F;
    for (const bool has_velocity : {false, true}) {
        for (int i = 0; i < 400; ++i) {
            TrackTable fresh(settings);
            TrackMeasurement m = seen(1, Vec3::Zero());
            m.sigma_position = 1e-4F;
            m.has_velocity = false;
            static_cast<void>(fresh.update(m, own, m.stamp));
            m.has_velocity = has_velocity;
            m.sigma_velocity = 1e-4F;
            for (int n = 1; n < 4; ++n) {
                m.stamp = m.stamp + 0.013F * static_cast<float>(i + 7) / static_cast<float>(n);
                ASSERT_EQ(fresh.update(m, own, m.stamp), TrackStatus::updated);
                const Track track = fresh.snapshot(m.stamp)[0];
                ASSERT_GE(track.sigma_position, 0.0F) << i;
                ASSERT_GE(track.sigma_velocity, 0.0F) << i;
            }
        }
    }
}

/// The least urgent of an id is the least urgent of all of them, not of the last two.
TEST_F(TrackEdges, OfAFullIdTheLeastUrgentGivesWayWhateverTheOrder)
{
    const float orders[][4] = {
        {900.0F, -300.0F, 600.0F, -500.0F}, {-300.0F, 900.0F, -500.0F, 600.0F}, {300.0F, -500.0F, 600.0F, -900.0F}};
    for (const auto& order : orders) {
        TrackTable fresh;
        const auto see = [&](float y) {
            TrackMeasurement m = seen(1, Vec3(0, y, 0));
            m.velocity = Vec3::Zero();
            return fresh.update(m, own, kStart);
        };
        for (const float y : order) {
            ASSERT_EQ(see(y), TrackStatus::created);
        }
        EXPECT_EQ(see(50.0F), TrackStatus::replaced);
        for (const Track& t : fresh.snapshot(kStart)) {
            EXPECT_LT(std::abs(t.position.y()), 899.0F);
        }
    }
}

/// Equal urgency to the least urgent track is not more urgent: no track is replaced.
TEST_F(TrackEdges, AsUrgentAsTheLeastUrgentIsNotEnough)
{
    const auto see = [&](float y) {
        TrackMeasurement m = seen(1, Vec3(0, y, 0));
        m.velocity = Vec3::Zero();
        return take(m);
    };
    for (const float y : {100.0F, 200.0F, 300.0F, 400.0F}) {
        ASSERT_EQ(see(y), TrackStatus::created);
    }
    EXPECT_EQ(see(-400.0F), TrackStatus::full);
    EXPECT_EQ(see(-399.0F), TrackStatus::replaced);
}

/// A clock that was set back begins a second anew.
TEST_F(TrackEdges, NewTracksAreCountedAnewWhereTheClockIsSetBack)
{
    settings.flood = 3;
    table.configure(settings);
    TrackId id = 1;
    const auto add = [&](TimePoint now) {
        EXPECT_EQ(take(seen(id, Vec3(0, 100.0F * static_cast<float>(id), 0), now)), TrackStatus::created);
        ++id;
    };
    for (int i = 0; i < 3; ++i) {
        add(kStart);
    }
    for (int i = 0; i < 3; ++i) {
        add(kStart + -20.0F);
    }
    EXPECT_EQ(table.diagnostics().floods, 0U);
    add(kStart + -20.0F);
    EXPECT_EQ(table.diagnostics().floods, 1U) << "the fourth";
    for (int i = 0; i < 4; ++i) {
        add(kStart + -19.0F);
    }
    EXPECT_EQ(table.diagnostics().floods, 2U) << "a second later";
}

/// New tracks of exactly `flood` in a second are no flood: a newcomer counts one and a half times.
TEST_F(TrackEdges, AsManyAsTheLimitAreNoFlood)
{
    settings.flood = 4;
    table.configure(settings);
    const auto see = [&](TrackId id, float y) {
        TrackMeasurement m = seen(id, Vec3(0, y, 0));
        m.velocity = Vec3::Zero();
        return take(m);
    };
    // Three sightings, of each but the last: 300 m and a tenth of a metre, less the body, are 100 s.
    TrackMeasurement known = seen(1, Vec3(0, 301, 0));
    known.velocity = Vec3::Zero();
    for (int n = 0; n < 3; ++n) {
        known.stamp = kStart + (-0.3F + 0.1F * static_cast<float>(n));
        static_cast<void>(take(known));
    }
    ASSERT_EQ(table.size(), 1U);
    for (const float y : {-10.0F, 40.0F}) {
        ASSERT_EQ(see(1, y), TrackStatus::created);
    }
    ASSERT_EQ(see(1, -70.0F), TrackStatus::created);  // four of the id, four new ones
    // The fifth: 181 m are 60 s, counted 90 without and 120 with a flood, against 100.1 s.
    EXPECT_EQ(see(1, -181.0F), TrackStatus::full) << "the fifth new one is a flood";
    EXPECT_EQ(table.diagnostics().floods, 1U);
    settings.flood = 5;
    TrackTable calm(settings);
    for (int n = 0; n < 3; ++n) {
        known.stamp = kStart + (-0.3F + 0.1F * static_cast<float>(n));
        static_cast<void>(calm.update(known, own, known.stamp));
    }
    for (const float y : {-10.0F, 40.0F, -70.0F}) {
        TrackMeasurement m = seen(1, Vec3(0, y, 0));
        m.velocity = Vec3::Zero();
        ASSERT_EQ(calm.update(m, own, kStart), TrackStatus::created);
    }
    TrackMeasurement m = seen(1, Vec3(0, -181, 0));
    m.velocity = Vec3::Zero();
    EXPECT_EQ(calm.update(m, own, kStart), TrackStatus::replaced) << "the fifth of five is none";
    EXPECT_EQ(calm.diagnostics().floods, 0U);
}

}  // namespace
}  // namespace jink::world
