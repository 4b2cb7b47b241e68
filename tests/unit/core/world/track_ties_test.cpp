// SPDX-License-Identifier: BSD-3-Clause
// Tracks that are equally urgent or fit equally well, motion at the least speed that counts, and a full table's order.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/core/world/scene.hpp"
#include "tests/unit/core/world/track_edges.hpp"

namespace jink::world {
namespace {

using namespace test;

bool holds(TrackTable& table, TrackId id)
{
    for (const Track& track : table.snapshot(kStart)) {
        if (track.id == id) {
            return true;
        }
    }
    return false;
}

/// Full table: of two equally least urgent tracks the first is replaced.
TEST_F(TrackEdges, OfEquallyUrgentTracksTheFirstGivesWay)
{
    ASSERT_EQ(take(seen(1, Vec3(3000, 0, 0))), TrackStatus::created);
    ASSERT_EQ(take(seen(2, Vec3(-3000, 0, 0))), TrackStatus::created);
    for (TrackId id = 3; id <= kMaxTracks; ++id) {
        ASSERT_EQ(take(seen(id, Vec3(0, 100.0F + 10.0F * static_cast<float>(id), 0))), TrackStatus::created);
    }
    ASSERT_EQ(take(seen(1000, Vec3(50, 0, 0))), TrackStatus::replaced);
    EXPECT_FALSE(holds(table, 1));
    EXPECT_TRUE(holds(table, 2));
}

/// The same of the tracks of one id.
TEST_F(TrackEdges, OfEquallyUrgentTracksOfAnIdTheFirstGivesWay)
{
    ASSERT_EQ(take(seen(7, Vec3(3000, 0, 0))), TrackStatus::created);
    ASSERT_EQ(take(seen(7, Vec3(-3000, 0, 0))), TrackStatus::created);
    for (std::size_t i = 2; i < kMaxSameId; ++i) {
        ASSERT_EQ(take(seen(7, Vec3(0, 500.0F * static_cast<float>(i), 0))), TrackStatus::created);
    }
    ASSERT_EQ(take(seen(7, Vec3(50, 0, 0))), TrackStatus::replaced);
    float west = 0.0F;
    float east = 0.0F;
    for (const Track& track : table.snapshot(kStart)) {
        west = std::min(west, track.position.x());
        east = std::max(east, track.position.x());
    }
    EXPECT_EQ(west, -3000.0F);
    EXPECT_EQ(east, 50.0F);
}

/// Of two tracks of an id that a sighting fits equally well the first takes it.
TEST_F(TrackEdges, ASightingThatFitsTwoTracksGoesToTheFirst)
{
    // Apart at first, flying towards each other: half-way after 5 s.
    TrackMeasurement a = seen(7, Vec3(0, 100, 0));
    TrackMeasurement b = seen(7, Vec3(0, -100, 0));
    a.velocity = Vec3(0, -20, 0);
    b.velocity = Vec3(0, 20, 0);
    settings.max_age = 10.0F;
    table.configure(settings);
    ASSERT_EQ(take(a), TrackStatus::created);
    ASSERT_EQ(take(b), TrackStatus::created);
    TrackMeasurement middle = seen(7, Vec3(0, 0, 0), kStart + 4.0F);
    middle.has_velocity = false;
    ASSERT_EQ(take(middle), TrackStatus::updated);
    const auto tracks = table.snapshot(kStart + 4.0F);
    ASSERT_EQ(tracks.size(), 2U);
    EXPECT_EQ(tracks[0].stamp, kStart + 4.0F);
    EXPECT_EQ(tracks[1].stamp, kStart);
}

/// For any number and kind of tracks, the snapshot is in order of id.
TEST_F(TrackEdges, AFullTablesSnapshotIsInOrder)
{
    for (TrackId id = 1; id <= kMaxTracks; ++id) {
        const auto place = static_cast<float>(id);
        TrackMeasurement m = seen(id, Vec3(100.0F * place, 70.0F + place, 90.0F + place));
        m.velocity = Vec3(1, 2, 3);
        m.max_acceleration = 2.0F;
        m.half_height = 5.0F;
        m.source = TrackSource::utm;
        m.cooperative = true;
        ASSERT_EQ(take(m), TrackStatus::created);
    }
    for (int again = 0; again < 2; ++again) {
        const auto tracks = table.snapshot(kStart);
        ASSERT_EQ(tracks.size(), kMaxTracks);
        for (std::size_t i = 0; i < tracks.size(); ++i) {
            ASSERT_EQ(tracks[i].id, i + 1);
        }
    }
}

/// A receding track was nearest before: its time to the closest approach is 0.
TEST(TrackUrgency, OfATrackThatFliesAwayIsItsDistance)
{
    Track track;
    track.stamp = kStart;
    track.position = Vec3(31, 0, 0);
    track.radius = 1.0F;
    track.velocity = Vec3(2, 0, 0);
    const vehicle::VehicleState own;
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), 10.0F, 1e-5F);
    // So slow that it counts as static, and slightly faster: 31 m at that speed take days.
    float aside = 0.0F;
    while (3.162e-5F * 3.162e-5F + aside * aside < 1e-9F) {
        aside += 1e-11F;
    }
    track.velocity = Vec3(-3.162e-5F, aside, 0);
    ASSERT_EQ(track.velocity.squaredNorm(), 1e-9F);
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), 10.0F, 1e-5F);
    track.velocity = Vec3(-3.2e-5F, 0, 0);
    EXPECT_GT(urgency(track, 3, false, own, kStart), 9e5F);
}

/// A track whose place is known through its velocity alone, and then the velocity to a tenth of a millimetre per
/// second: the remaining variance is rounding, and never negative.
TEST(TrackFilter, UncertaintiesStayNumbers)
{
    const vehicle::VehicleState own;
    TrackTableSettings straight;
    straight.process_acceleration = 0.0F;
    for (int i = 1; i <= 200; ++i) {
        TrackTable table(straight);
        TrackMeasurement m = seen(1, Vec3(1, 2, 3));
        m.sigma_position = 1e-4F;
        m.sigma_velocity = 3.0F + 1.9F * static_cast<float>(i);
        ASSERT_EQ(table.update(m, own, m.stamp), TrackStatus::created);
        m.stamp = m.stamp + (0.1F + 0.013F * static_cast<float>(i));
        m.sigma_position = 19000.0F;
        m.sigma_velocity = 1e-4F;
        ASSERT_EQ(table.update(m, own, m.stamp), TrackStatus::updated);
        const auto tracks = table.snapshot(m.stamp);
        ASSERT_EQ(tracks.size(), 1U);
        ASSERT_TRUE(std::isfinite(tracks[0].sigma_position)) << i;
        ASSERT_TRUE(std::isfinite(tracks[0].sigma_velocity)) << i;
    }
}

}  // namespace
}  // namespace jink::world
