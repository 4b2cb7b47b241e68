// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/random.hpp"
#include "core/world/track_table.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace jink::world {
namespace {

constexpr TimePoint kTime{100'000'000};

TrackMeasurement sighting(TrackId id, const Vec3& position, TimePoint stamp = kTime)
{
    return test::sighting(id, position, Vec3::Zero(), stamp);
}

struct TrackTables : testing::Test {
    TrackTable table;
    vehicle::VehicleState own;
};

std::uint32_t sum(const TrackDiagnostics& d)
{
    return d.updated + d.created + d.replaced + d.not_finite + d.out_of_range + d.stale + d.future + d.full;
}

TEST_F(TrackTables, FirstSightingIsTakenAsItIs)
{
    TrackMeasurement m = sighting(7, Vec3(10, 20, 30));
    m.velocity = Vec3(1, -2, 0.5F);
    m.max_acceleration = 2.0F;
    m.source = TrackSource::datalink;
    EXPECT_EQ(table.update(m, own, kTime), TrackStatus::created);
    EXPECT_EQ(table.diagnostics().created, 1U);
    const auto tracks = table.snapshot(kTime);
    ASSERT_EQ(tracks.size(), 1U);
    EXPECT_EQ(tracks[0].id, 7U);
    EXPECT_EQ(tracks[0].position, m.position);
    EXPECT_EQ(tracks[0].velocity, m.velocity);
    EXPECT_EQ(tracks[0].stamp, kTime);
    EXPECT_EQ(tracks[0].radius, 1.0F);
    EXPECT_EQ(tracks[0].sigma_position, 0.5F);
    EXPECT_EQ(tracks[0].sigma_velocity, 0.3F);
    EXPECT_EQ(tracks[0].max_acceleration, 2.0F);
    EXPECT_EQ(tracks[0].source, TrackSource::datalink);
    EXPECT_EQ(table.id_in_snapshot(0), 7U);
}

TEST_F(TrackTables, TheNewestSightingSaysWhetherItIsCooperative)
{
    for (int i = 0; i < 6; ++i) {
        TrackMeasurement m = sighting(7, Vec3(10, 20, 30), {kTime.us + i * 100'000});
        m.cooperative = i % 3 == 1;  // filtered, and started anew by a jump of the velocity
        m.velocity.x() += i >= 3 ? 50.0F : 0.0F;
        m.position.x() += i > 3 ? 5.0F * static_cast<float>(i - 3) : 0.0F;
        m.source = m.cooperative ? TrackSource::utm : TrackSource::adsb;
        static_cast<void>(table.update(m, own, m.stamp));
        const auto tracks = table.snapshot(m.stamp);
        ASSERT_EQ(tracks.size(), 1U);
        EXPECT_EQ(tracks[0].cooperative, m.cooperative) << i;
        EXPECT_EQ(tracks[0].source, m.source) << i;
    }
    EXPECT_EQ(table.diagnostics().jumps, 1U);
}

TEST_F(TrackTables, WithoutVelocityTheFirstSightingStandsWithALargeDoubt)
{
    TrackMeasurement m = sighting(7, Vec3(10, 20, 30));
    m.has_velocity = false;
    m.velocity = Vec3(99, 99, 99);
    m.sigma_velocity = 0.0F;
    EXPECT_EQ(table.update(m, own, kTime), TrackStatus::created);
    const auto tracks = table.snapshot(kTime);
    EXPECT_EQ(tracks[0].velocity, Vec3(0, 0, 0));
    EXPECT_EQ(tracks[0].sigma_velocity, TrackTableSettings{}.first_sigma_velocity);
}

TEST_F(TrackTables, NaNAndInfinityInAnyFieldAreRefused)
{
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (int field = 0; field < 10; ++field) {
            TrackMeasurement m = sighting(1, Vec3(1, 2, 3));
            float* const fields[] = {&m.position.x(),   &m.position.y(),    &m.position.z(), &m.velocity.x(),
                                     &m.velocity.y(),   &m.velocity.z(),    &m.radius,       &m.sigma_position,
                                     &m.sigma_velocity, &m.max_acceleration};
            *fields[field] = bad;
            EXPECT_EQ(table.update(m, own, kTime), TrackStatus::not_finite) << bad << " in field " << field;
        }
    }
    EXPECT_EQ(table.diagnostics().not_finite, 30U);
    EXPECT_EQ(table.size(), 0U);
}

TEST_F(TrackTables, RangesAreRefusedBeyondTheirEdgesOnly)
{
    const TrackTableSettings settings;
    const auto status = [&](auto change) {
        TrackTable fresh;
        TrackMeasurement m = sighting(1, Vec3(1, 2, 3));
        change(m);
        const TrackStatus result = fresh.update(m, own, kTime);
        EXPECT_EQ(fresh.diagnostics().out_of_range, result == TrackStatus::out_of_range ? 1U : 0U);
        return result;
    };
    EXPECT_EQ(status([&](auto& m) { m.position = Vec3(settings.max_range, 0, 0); }), TrackStatus::created);
    EXPECT_EQ(status([&](auto& m) { m.position = Vec3(settings.max_range * 1.0001F, 0, 0); }),
              TrackStatus::out_of_range);
    EXPECT_EQ(status([&](auto& m) { m.velocity = Vec3(0, 0, -settings.max_speed); }), TrackStatus::created);
    EXPECT_EQ(status([&](auto& m) { m.velocity = Vec3(0, 0, -settings.max_speed * 1.0001F); }),
              TrackStatus::out_of_range);
    EXPECT_EQ(status([](auto& m) { m.radius = 0.0F; }), TrackStatus::created);
    EXPECT_EQ(status([](auto& m) { m.radius = -0.001F; }), TrackStatus::out_of_range);
    EXPECT_EQ(status([](auto& m) { m.sigma_position = 0.0F; }), TrackStatus::out_of_range);
    EXPECT_EQ(status([](auto& m) { m.sigma_position = -1.0F; }), TrackStatus::out_of_range);
    EXPECT_EQ(status([](auto& m) { m.sigma_velocity = 0.0F; }), TrackStatus::out_of_range);
    EXPECT_EQ(status([](auto& m) { m.sigma_velocity = 0.0F, m.has_velocity = false; }), TrackStatus::created);
    EXPECT_EQ(status([](auto& m) { m.max_acceleration = -0.1F; }), TrackStatus::out_of_range);
}

TEST_F(TrackTables, RangeCountsFromTheVehicleNotFromTheOrigin)
{
    own.position = Vec3(1e5F, 0, 0);
    EXPECT_EQ(table.update(sighting(1, Vec3(1, 2, 3)), own, kTime), TrackStatus::out_of_range);
    EXPECT_EQ(table.update(sighting(1, Vec3(1.1e5F, 2, 3)), own, kTime), TrackStatus::created);
}

TEST_F(TrackTables, SizesThatFloatCannotSquareAreRefused)
{
    for (const float absurd : {1e-30F, 1e20F, 3e38F}) {
        for (int field = 0; field < 4; ++field) {
            TrackMeasurement m = sighting(1, Vec3(1, 2, 3));
            float* const fields[] = {&m.sigma_position, &m.sigma_velocity, &m.radius, &m.max_acceleration};
            if (absurd < 1.0F && field >= 2) {
                continue;  // a body without extent and a track that never turns are fine
            }
            *fields[field] = absurd;
            EXPECT_EQ(table.update(m, own, kTime), TrackStatus::out_of_range) << absurd << " in field " << field;
        }
    }
}

TEST_F(TrackTables, StaleAndFutureStamps)
{
    const TrackTableSettings settings;
    EXPECT_EQ(table.update(sighting(1, Vec3::Zero(), kTime - settings.max_age - 0.001F), own, kTime),
              TrackStatus::stale);
    EXPECT_EQ(table.update(sighting(1, Vec3::Zero(), kTime - settings.max_age + 0.001F), own, kTime),
              TrackStatus::created);
    EXPECT_EQ(table.update(sighting(2, Vec3::Zero(), kTime + settings.future_slack + 0.001F), own, kTime),
              TrackStatus::future);
    EXPECT_EQ(table.update(sighting(2, Vec3::Zero(), kTime + settings.future_slack - 0.001F), own, kTime),
              TrackStatus::created);
    EXPECT_EQ(table.diagnostics().stale, 1U);
    EXPECT_EQ(table.diagnostics().future, 1U);
    EXPECT_EQ(sum(table.diagnostics()), 4U);
}

TEST_F(TrackTables, ACooperativeVehicleIsKeptForLonger)
{
    TrackTableSettings settings;
    settings.max_age = 2.0F;
    settings.cooperative_age = 8.0F;
    table.configure(settings);
    TrackMeasurement silent = sighting(1, Vec3(1, 0, 0), kTime - 5.0F);
    EXPECT_EQ(table.update(silent, own, kTime), TrackStatus::stale);
    silent.cooperative = true;
    EXPECT_EQ(table.update(silent, own, kTime), TrackStatus::created);
    EXPECT_EQ(table.update(sighting(2, Vec3(50, 0, 0), kTime - 1.5F), own, kTime), TrackStatus::created);
    table.expire(kTime + 1.0F);
    ASSERT_EQ(table.size(), 1U) << "of the other one nothing was heard for 2.5 s";
    EXPECT_EQ(table.snapshot(kTime)[0].id, 1U);
    table.expire(kTime + 2.99F);
    EXPECT_EQ(table.size(), 1U);
    table.expire(kTime + 3.01F);
    EXPECT_EQ(table.size(), 0U);
    // A longer age of all is theirs too.
    settings.max_age = 20.0F;
    table.configure(settings);
    silent.stamp = kTime - 19.0F;
    EXPECT_EQ(table.update(silent, own, kTime), TrackStatus::created);
    table.expire(kTime);
    EXPECT_EQ(table.size(), 1U);
}

TEST_F(TrackTables, AnOlderOrEqualStampOfAKnownTrackChangesNothing)
{
    EXPECT_EQ(table.update(sighting(1, Vec3(5, 0, 0)), own, kTime), TrackStatus::created);
    EXPECT_EQ(table.update(sighting(1, Vec3(6, 0, 0)), own, kTime), TrackStatus::stale);
    EXPECT_EQ(table.update(sighting(1, Vec3(6, 0, 0), kTime - 1.0F), own, kTime), TrackStatus::stale);
    EXPECT_EQ(table.snapshot(kTime)[0].position, Vec3(5, 0, 0));
    EXPECT_EQ(table.diagnostics().stale, 2U);
}

TEST_F(TrackTables, AJumpWithinReachStartsTheTrackAnewFromTheSighting)
{
    // In a second: 5 m by acceleration, and 6 standard deviations of 0.85 m.
    EXPECT_EQ(table.update(sighting(1, Vec3::Zero()), own, kTime), TrackStatus::created);
    EXPECT_EQ(table.update(sighting(1, Vec3(8, 0, 0), kTime + 1.0F), own, kTime + 1.0F), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 1U);
    EXPECT_EQ(table.snapshot(kTime + 1.0F)[0].position, Vec3(8, 0, 0));
    EXPECT_EQ(table.snapshot(kTime + 1.0F)[0].sigma_position, 0.5F);
    TrackMeasurement turned = sighting(1, Vec3(8, 0, 0), kTime + 1.1F);
    turned.velocity = Vec3(0, 30, 0);
    EXPECT_EQ(table.update(turned, own, kTime + 1.1F), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 2U);
    EXPECT_EQ(table.snapshot(kTime + 1.1F)[0].velocity, Vec3(0, 30, 0));
    EXPECT_EQ(table.diagnostics().doubled, 0U);
}

/// 5 m/s, turning with 3 m/s2: the filter's estimate must stay within its own uncertainty, or restart.
TEST_F(TrackTables, ATurningIntruderIsFollowed)
{
    float worst = 0.0F;
    for (int i = 0; i < 100; ++i) {
        const float t = 0.1F * static_cast<float>(i);
        const float angle = 0.6F * t;
        const Vec3 position(8.333F * std::sin(angle), 8.333F * (1.0F - std::cos(angle)), 0);
        TrackMeasurement m = sighting(1, position, kTime + t);
        m.velocity = Vec3(5.0F * std::cos(angle), 5.0F * std::sin(angle), 0);
        m.sigma_position = 0.2F;
        m.sigma_velocity = 0.2F;
        EXPECT_TRUE(table.update(m, own, kTime + t) <= TrackStatus::created);
        worst = std::max(worst, (table.snapshot(kTime + t)[0].position - position).norm());
    }
    // Centripetal 3 m/s2 against a filter made for 0.5: it lags, by less than three sigmas of one sighting.
    EXPECT_LT(worst, 0.6F);
    EXPECT_EQ(table.size(), 1U);
}

/// The acceleration that a vehicle has shown which reports its velocity, `velocity(seconds)`, every 0.1 s.
template <class Velocity>
float shown_by(TrackTable& table, Velocity velocity, float sigma, bool cooperative = true, int reports = 31)
{
    Vec3 place(50.0F, 0.0F, 30.0F);
    TimePoint at = kTime;
    for (int i = 0; i < reports; ++i) {
        TrackMeasurement m = sighting(7, place, at);
        m.velocity = velocity(0.1F * static_cast<float>(i));
        m.sigma_velocity = sigma;
        m.cooperative = cooperative;
        static_cast<void>(table.update(m, {}, at));
        place += 0.1F * m.velocity;
        at = at + 0.1F;
    }
    return table.snapshot(at).front().shown_acceleration;
}

TEST_F(TrackTables, ACooperativeVehicleShowsHowHardItAccelerates)
{
    const auto gains = [](float t) { return Vec3(4.0F * t, 0.0F, -2.0F * t); };
    const auto climbs = [](float t) { return Vec3(1.0F * t, 0.0F, 4.0F * t); };
    EXPECT_NEAR(shown_by(table, gains, 0.01F), 4.0F - 4.5F * 0.01F / 0.5F, 0.02F);
    vehicle::VehicleLimits limits;
    limits.max_acceleration = 4.0F;
    limits.max_vertical_acceleration = 2.0F;
    EXPECT_FALSE(table.any_accelerates_harder(limits, {}));
    limits.max_acceleration = 3.0F;
    EXPECT_TRUE(table.any_accelerates_harder(limits, {}));
    TrackTable climbing;
    EXPECT_NEAR(shown_by(climbing, climbs, 0.01F), 4.0F - 4.5F * 0.01F / 0.5F, 0.02F);
    TrackTable unsure;
    EXPECT_NEAR(shown_by(unsure, gains, 0.3F), 4.0F - 4.5F * 0.3F / 0.5F, 0.02F) << "what noise explains";
    TrackTable others;
    EXPECT_EQ(shown_by(others, gains, 0.01F, false), 0.0F);
}

TEST_F(TrackTables, WhatAVehicleHasShownStaysAndIsNoMoreThanAnyCan)
{
    const auto bursts = [](float t) { return Vec3(t < 1.0F ? 6.0F * t : 6.0F, 0.0F, 0.0F); };
    EXPECT_NEAR(shown_by(table, bursts, 0.01F, true, 1000), 6.0F, 0.1F);
    TrackTable glitch;
    const auto jumps = [](float t) { return Vec3(t < 1.05F ? 0.0F : 40.0F, 0.0F, 0.0F); };
    EXPECT_EQ(shown_by(glitch, jumps, 0.01F), TrackTableSettings{}.reach_acceleration);
    TrackTable late;
    const auto first = [](float) { return Vec3(20.0F, 0.0F, 0.0F); };
    EXPECT_EQ(shown_by(late, first, 0.01F), 0.0F) << "it came at that velocity";
}

TEST_F(TrackTables, NoiseOfAVelocityIsNoAcceleration)
{
    Random random(11);
    int beyond = 0;
    for (int i = 0; i < 200; ++i) {
        TrackTable noisy;
        const auto velocity = [&](float) {
            return Vec3(5.0F + 0.3F * random.normal(), 0.3F * random.normal(), 0.3F * random.normal());
        };
        beyond += shown_by(noisy, velocity, 0.3F, true, 101) > 1.0F ? 1 : 0;
    }
    EXPECT_LE(beyond, 2) << "of 200 in 10 s each by more than 1 m/s2";
}

/// The turn rate that an aircraft shows which reports once a second.
float turn_shown_by(float speed, float rate, float sigma, Random& random, bool manned = true, int reports = 12)
{
    TrackTable table;
    Vec3 place(900.0F, 0.0F, 30.0F);
    TimePoint at = kTime;
    for (int i = 0; i < reports; ++i) {
        const float course = rate * static_cast<float>(i);
        const Vec3 velocity(speed * std::cos(course), speed * std::sin(course), 1.0F);
        TrackMeasurement m = sighting(7, place, at);
        m.velocity = velocity + sigma * Vec3(random.normal(), random.normal(), random.normal());
        m.sigma_position = 3.0F;
        m.sigma_velocity = sigma;
        m.manned = manned;
        EXPECT_LE(table.update(m, {}, at), TrackStatus::created);
        place += velocity;
        at = at + 1.0F;
    }
    const auto tracks = table.snapshot(at);
    EXPECT_EQ(tracks.size(), 1U);
    return tracks.front().turn_rate;
}

TEST_F(TrackTables, AnAircraftShowsHowItTurns)
{
    Random random(3);
    for (const float rate : {0.6F, 0.2F, 0.052F, -0.052F, -0.2F, -0.6F}) {
        EXPECT_NEAR(turn_shown_by(50.0F, rate, 0.01F, random), rate, 0.04F * std::abs(rate)) << rate;
        EXPECT_EQ(turn_shown_by(50.0F, rate, 0.01F, random, false), 0.0F) << "a drone";
    }
    EXPECT_EQ(turn_shown_by(0.0F, 0.0F, 0.01F, random, true, 1), 0.0F) << "one report";
}

TEST_F(TrackTables, NoiseOfAVelocityIsHardlyATurn)
{
    Random random(12);
    int beyond = 0;
    double error = 0.0;
    for (int i = 0; i < 500; ++i) {
        beyond += std::abs(turn_shown_by(40.0F, 0.0F, 0.5F, random)) > 0.015F ? 1 : 0;
        error += static_cast<double>(turn_shown_by(40.0F, 0.052F, 0.5F, random)) / 500.0;
    }
    EXPECT_LE(beyond, 5) << "of 500 that fly straight on at 40 m/s";
    EXPECT_NEAR(error, 0.052, 0.012) << "3 deg/s, less what noise explains";
}

TEST_F(TrackTables, AVelocityThatComesLaterIsNoAcceleration)
{
    TrackMeasurement m = sighting(7, Vec3(50.0F, 0.0F, 30.0F));
    m.cooperative = true;
    m.has_velocity = false;
    static_cast<void>(table.update(m, own, kTime));
    m.has_velocity = true;
    m.velocity = Vec3(0.5F, 0.0F, 0.0F);
    for (int i = 1; i <= 12; ++i) {
        m.stamp = kTime + 0.1F * static_cast<float>(i);
        m.position += 0.1F * m.velocity;
        static_cast<void>(table.update(m, own, m.stamp));
    }
    EXPECT_EQ(table.snapshot(m.stamp).front().shown_acceleration, 0.0F);
}

TEST_F(TrackTables, SnapshotExtrapolatesAndSortsById)
{
    TrackMeasurement m = sighting(9, Vec3(0, 0, 10), kTime - 2.0F);
    m.velocity = Vec3(3, 0, 0);
    EXPECT_EQ(table.update(m, own, kTime), TrackStatus::created);
    EXPECT_EQ(table.update(sighting(4, Vec3(1, 1, 1)), own, kTime), TrackStatus::created);
    EXPECT_EQ(table.update(sighting(6, Vec3(2, 2, 2)), own, kTime), TrackStatus::created);
    const auto tracks = table.snapshot(kTime);
    ASSERT_EQ(tracks.size(), 3U);
    EXPECT_EQ(tracks[0].id, 4U);
    EXPECT_EQ(tracks[1].id, 6U);
    EXPECT_EQ(tracks[2].id, 9U);
    EXPECT_NEAR(tracks[2].position.x(), 6.0F, 1e-4F);
    EXPECT_EQ(tracks[2].stamp, kTime - 2.0F) << "the stamp stays, so that doubt grows from it";
}

TEST_F(TrackTables, ExpiryByAge)
{
    const TrackTableSettings settings;
    for (TrackId id = 0; id < 5; ++id) {
        static_cast<void>(table.update(sighting(id, Vec3::Zero(), kTime - 0.5F * static_cast<float>(id)), own, kTime));
    }
    table.expire(kTime);
    EXPECT_EQ(table.size(), 5U);
    table.expire(kTime + settings.max_age - 1.25F);  // 3 and 4 are older than max_age now
    EXPECT_EQ(table.size(), 3U);
    EXPECT_EQ(table.diagnostics().expired, 2U);
    const auto left = table.snapshot(kTime);
    for (std::size_t i = 0; i < left.size(); ++i) {
        EXPECT_EQ(left[i].id, i);
    }
    table.expire(kTime + 100.0F);
    EXPECT_EQ(table.size(), 0U);
    EXPECT_EQ(table.diagnostics().expired, 5U);
    EXPECT_TRUE(table.snapshot(kTime).empty());
}

/// Each status has a sighting that provokes it, and moves its own counter and no other.
TEST_F(TrackTables, EachStatusCountsAsItself)
{
    using Counter = std::uint32_t TrackDiagnostics::*;
    const auto provoke = [&](const TrackMeasurement& m, TrackStatus status, Counter counter) {
        const TrackDiagnostics before = table.diagnostics();
        EXPECT_EQ(table.update(m, own, kTime), status);
        EXPECT_EQ(table.diagnostics().*counter, before.*counter + 1);
        EXPECT_EQ(sum(table.diagnostics()), sum(before) + 1);
    };
    const Vec3 near(100, 0, 0);
    const TimePoint earlier = kTime - 0.2F;
    provoke(sighting(0, near, earlier), TrackStatus::created, &TrackDiagnostics::created);
    provoke(sighting(0, near), TrackStatus::updated, &TrackDiagnostics::updated);
    provoke(sighting(0, near), TrackStatus::stale, &TrackDiagnostics::stale);
    provoke(sighting(1, near, kTime - 10.0F), TrackStatus::stale, &TrackDiagnostics::stale);
    provoke(sighting(1, near, kTime + 10.0F), TrackStatus::future, &TrackDiagnostics::future);
    provoke(sighting(1, Vec3(kNan, 0, 0)), TrackStatus::not_finite, &TrackDiagnostics::not_finite);
    provoke(sighting(1, Vec3(1e6F, 0, 0)), TrackStatus::out_of_range, &TrackDiagnostics::out_of_range);
    for (std::size_t i = 1; i < kMaxTracks; ++i) {
        provoke(sighting(static_cast<TrackId>(i), near), TrackStatus::created, &TrackDiagnostics::created);
    }
    provoke(sighting(900, Vec3(500, 0, 0)), TrackStatus::full, &TrackDiagnostics::full);
    provoke(sighting(901, Vec3(50, 0, 0)), TrackStatus::replaced, &TrackDiagnostics::replaced);
    EXPECT_EQ(table.diagnostics().jumps, 0U);
    EXPECT_EQ(table.diagnostics().expired, 0U);
}

/// Static tracks at growing distances; the table must hold the nearest.
TEST_F(TrackTables, CapacityLessOneFullAndOneMore)
{
    const auto at = [](std::size_t i) { return Vec3(100.0F + static_cast<float>(i), 0, 0); };
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        EXPECT_EQ(table.size(), i);
        EXPECT_EQ(table.update(sighting(static_cast<TrackId>(i), at(i)), own, kTime), TrackStatus::created);
    }
    EXPECT_EQ(table.update(sighting(900, at(kMaxTracks)), own, kTime), TrackStatus::full) << "farther than all";
    EXPECT_EQ(table.size(), kMaxTracks);
    EXPECT_EQ(table.update(sighting(901, Vec3(50, 0, 0)), own, kTime), TrackStatus::replaced);
    EXPECT_EQ(table.diagnostics().full, 1U);
    EXPECT_EQ(table.diagnostics().replaced, 1U);
    const auto tracks = table.snapshot(kTime);
    ASSERT_EQ(tracks.size(), kMaxTracks);
    EXPECT_EQ(tracks[kMaxTracks - 1].id, 901U);
    EXPECT_EQ(tracks[kMaxTracks - 2].id, kMaxTracks - 2) << "the farthest one gave way";
    EXPECT_EQ(table.update(sighting(0, at(0) + Vec3(0.1F, 0, 0), kTime + 0.1F), own, kTime + 0.1F),
              TrackStatus::updated)
        << "known ones are updated in a full table";
}

/// Sizes count: of two at one distance the larger is the nearer.
TEST_F(TrackTables, WhatGivesWayIsJudgedByTheBodysSurface)
{
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        TrackMeasurement m = sighting(static_cast<TrackId>(i), Vec3(100, static_cast<float>(i) * 0.01F, 0));
        m.radius = i == 3 ? 0.5F : 1.0F;
        EXPECT_EQ(table.update(m, own, kTime), TrackStatus::created);
    }
    EXPECT_EQ(table.update(sighting(900, Vec3(99.9F, 0, 0)), own, kTime), TrackStatus::replaced);
    const auto tracks = table.snapshot(kTime);
    EXPECT_TRUE(std::none_of(tracks.begin(), tracks.end(), [](const Track& t) { return t.id == 3; }));
}

/// An old sighting is compared at the track's present position: here close to an encounter, though measured far off the
/// own path.
TEST_F(TrackTables, WhatGivesWayIsJudgedWhereItIsNow)
{
    own.velocity = Vec3(20, 0, 0);
    TrackMeasurement met = sighting(1, Vec3(100, -28, 0), kTime - 2.0F);
    met.velocity = Vec3(0, 4, 0);  // now at (100, -20): both reach (100, 0) in 5 s
    EXPECT_EQ(table.update(met, own, kTime), TrackStatus::created);
    for (std::size_t i = 1; i < kMaxTracks; ++i) {
        const float offset = 4.0F + 0.01F * static_cast<float>(i);
        TrackMeasurement m = sighting(static_cast<TrackId>(i + 1), Vec3(200, offset, 0));
        EXPECT_EQ(table.update(m, own, kTime), TrackStatus::created);
    }
    EXPECT_EQ(table.update(sighting(900, Vec3(200, 4, 0)), own, kTime), TrackStatus::replaced);
    EXPECT_EQ(table.snapshot(kTime)[0].id, 1U) << "the one on collision course has to stay";
}

TEST_F(TrackTables, ClearForgetsTracksAndKeepsCounts)
{
    static_cast<void>(table.update(sighting(1, Vec3::Zero()), own, kTime));
    table.clear();
    EXPECT_EQ(table.size(), 0U);
    EXPECT_EQ(table.diagnostics().created, 1U);
    EXPECT_EQ(table.update(sighting(1, Vec3::Zero()), own, kTime), TrackStatus::created);
}

TEST_F(TrackTables, SettingsTakeEffectAtOnce)
{
    TrackTableSettings settings;
    settings.max_range = 10.0F;
    table.configure(settings);
    EXPECT_EQ(table.update(sighting(1, Vec3(11, 0, 0)), own, kTime), TrackStatus::out_of_range);
    EXPECT_EQ(table.update(sighting(1, Vec3(9, 0, 0)), own, kTime), TrackStatus::created);
}

}  // namespace
}  // namespace jink::world
