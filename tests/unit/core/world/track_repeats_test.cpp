// SPDX-License-Identifier: BSD-3-Clause
// Receivers that repeat what they heard last: ADSB_VEHICLE says its age in whole seconds only, so a repetition within
// the second looks like a new sighting of an aircraft that has not moved.
#include "core/world/track_table.hpp"
#include "tests/unit/core/world/scene.hpp"

#include <gtest/gtest.h>

namespace jink::world {
namespace {

constexpr TimePoint kTime{100'000'000};
constexpr std::int64_t kTenth = 100'000;

struct TrackRepeats : testing::Test {
    TrackStatus see(const Vec3& position, const Vec3& velocity, std::int64_t after, bool has_velocity = true)
    {
        TrackMeasurement m = test::sighting(7, position, velocity, {kTime.us + after});
        m.has_velocity = has_velocity;
        return table.update(m, own, m.stamp);
    }
    TrackTable table;
    vehicle::VehicleState own;
};

TEST_F(TrackRepeats, KeepThePlaceAndTheAgeOfWhatWasHeard)
{
    const Vec3 velocity(60, 0, 0);
    EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, 0), TrackStatus::created);
    for (int i = 1; i <= 9; ++i) {
        EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, i * kTenth), TrackStatus::stale) << i;
    }
    const auto tracks = table.snapshot({kTime.us + 9 * kTenth});
    ASSERT_EQ(tracks.size(), 1U);
    EXPECT_NEAR(tracks[0].position.x(), -246.0F, 1e-3F) << "a second's flight nearer than the report says";
    EXPECT_EQ(tracks[0].stamp, kTime);
    EXPECT_EQ(see(Vec3(-240, 0, 0), velocity, 10 * kTenth), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().stale, 9U);
    EXPECT_EQ(table.diagnostics().jumps, 0U);
}

TEST_F(TrackRepeats, AgeOutThough)
{
    EXPECT_EQ(see(Vec3(-300, 0, 0), Vec3(60, 0, 0), 0), TrackStatus::created);
    for (int i = 1; i <= 31; ++i) {
        static_cast<void>(see(Vec3(-300, 0, 0), Vec3(60, 0, 0), i * kTenth));
        table.expire({kTime.us + i * kTenth});
    }
    EXPECT_EQ(table.size(), 0U);
}

/// ArduPilot's receiver list repeats for 5 to 10 s what was received last.
TEST_F(TrackRepeats, BringNoTrackBackThatAgedOut)
{
    const Vec3 velocity(60, 0, 0);
    for (TrackId id = 100; id < 100 + kMaxTracks - 1; ++id) {  // others age out meanwhile
        static_cast<void>(
            table.update(test::sighting(id, Vec3(0, 500, 0), velocity, {kTime.us + 1}), own, kTime + 1.0F));
    }
    EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, 0), TrackStatus::created);
    table.expire({kTime.us + 31 * kTenth});
    EXPECT_EQ(table.size(), 0U);
    for (int i = 31; i <= 100; i += 10) {
        EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, i * kTenth), TrackStatus::stale) << i;
        table.expire({kTime.us + i * kTenth});
    }
    EXPECT_EQ(table.size(), 0U);
    EXPECT_EQ(see(Vec3(240, 0, 0), velocity, 101 * kTenth), TrackStatus::created) << "heard again";
    table.expire({kTime.us + 140 * kTenth});
    EXPECT_EQ(see(Vec3(240, 0, 0), velocity, 141 * kTenth), TrackStatus::stale);
    table.clear();
    EXPECT_EQ(see(Vec3(240, 0, 0), velocity, 142 * kTenth), TrackStatus::created) << "in another frame";
}

TEST_F(TrackRepeats, WhatStandsIsSeenAnew)
{
    for (const Vec3& velocity : {Vec3(0, 0, 0), Vec3(0.3F, 0, 0.1F)}) {
        table.clear();
        EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, 0), TrackStatus::created);
        EXPECT_EQ(see(Vec3(-300, 0, 0), velocity, kTenth), TrackStatus::updated);
    }
    table.clear();
    EXPECT_EQ(see(Vec3(-300, 0, 0), Vec3::Zero(), 0, false), TrackStatus::created) << "nobody knows whether it moves";
    EXPECT_EQ(see(Vec3(-300, 0, 0), Vec3::Zero(), 5 * kTenth, false), TrackStatus::updated);
}

TEST_F(TrackRepeats, OneThatIsFilteredOrStartedAnewKnowsItsLastSightingToo)
{
    EXPECT_EQ(see(Vec3(-300, 0, 0), Vec3(60, 0, 0), 0), TrackStatus::created);
    EXPECT_EQ(see(Vec3(-294, 0, 0), Vec3(-60, 0, 0), kTenth), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 1U);
    EXPECT_EQ(see(Vec3(-294, 0, 0), Vec3(-60, 0, 0), 2 * kTenth), TrackStatus::stale);
    EXPECT_EQ(see(Vec3(-312, 0, 0), Vec3(-60, 0, 0), 4 * kTenth), TrackStatus::updated);
    EXPECT_EQ(see(Vec3(-312, 0, 0), Vec3(-60, 0, 0), 5 * kTenth), TrackStatus::stale) << "filtered";
}

/// Of all that it may say anew, any part is news.
TEST_F(TrackRepeats, TheLeastChangeIsANewSighting)
{
    for (int axis = 0; axis < 6; ++axis) {
        table.clear();
        Vec3 position(-300, 40, 20);
        Vec3 velocity(2, 1, 0.5F);
        EXPECT_EQ(see(position, velocity, 0), TrackStatus::created);
        EXPECT_EQ(see(position, velocity, kTenth), TrackStatus::stale);
        (axis < 3 ? position : velocity)[axis % 3] += 0.01F;
        EXPECT_EQ(see(position, velocity, 2 * kTenth), TrackStatus::updated) << axis;
    }
    table.clear();
    EXPECT_EQ(see(Vec3(-1, 2, 3), Vec3(1, 1, 1), 0), TrackStatus::created);
    EXPECT_EQ(see(Vec3(-1, 2, 3), Vec3(-1, -1, 1), kTenth), TrackStatus::updated) << "signs of two";
    EXPECT_EQ(see(Vec3(-1, -2, 3), Vec3(1, -1, 1), 2 * kTenth), TrackStatus::updated);
}

}  // namespace
}  // namespace jink::world
