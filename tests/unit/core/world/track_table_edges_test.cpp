// SPDX-License-Identifier: BSD-3-Clause
// Tracks at the limits of acceptance and capacity.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/core/world/track_edges.hpp"

namespace jink::world {
namespace {

using namespace test;

TEST_F(TrackEdges, AHeightOfUnknownUncertaintyIsRefused)
{
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        TrackMeasurement m = seen(1, Vec3(10, 0, 0));
        m.half_height = bad;
        EXPECT_EQ(take(m), TrackStatus::not_finite);
    }
    EXPECT_EQ(table.size(), 0U);
}

TEST_F(TrackEdges, WhatIsExactlyAtALimitIsTaken)
{
    settings.max_range = 1000.0F;
    settings.max_speed = 50.0F;
    const auto taken = [&](auto change) {
        TrackTable fresh(settings);
        TrackMeasurement m = seen(1, Vec3(10, 0, 0));
        change(m);
        return fresh.update(m, own, kStart) == TrackStatus::created;
    };
    const auto at = [&](float TrackMeasurement::*field, float value, bool beyond_is_more) {
        EXPECT_TRUE(taken([&](TrackMeasurement& m) { m.*field = value; })) << value;
        const float beyond = std::nextafter(value, beyond_is_more ? kInfinity : -kInfinity);
        EXPECT_FALSE(taken([&](TrackMeasurement& m) { m.*field = beyond; })) << value;
    };
    at(&TrackMeasurement::radius, 1000.0F, true);
    at(&TrackMeasurement::radius, 0.0F, false);
    at(&TrackMeasurement::sigma_position, 1000.0F, true);
    at(&TrackMeasurement::sigma_position, 1e-4F, false);
    at(&TrackMeasurement::sigma_velocity, 50.0F, true);
    at(&TrackMeasurement::sigma_velocity, 1e-4F, false);
    at(&TrackMeasurement::max_acceleration, 1000.0F, true);
    at(&TrackMeasurement::max_acceleration, 0.0F, false);
    at(&TrackMeasurement::half_height, 1000.0F, true);
    at(&TrackMeasurement::half_height, 0.0F, false);
    EXPECT_TRUE(taken([](TrackMeasurement& m) { m.position = Vec3(0, -1000, 0); }));
    EXPECT_FALSE(taken([](TrackMeasurement& m) { m.position = Vec3(0, -1000.1F, 0); }));
    EXPECT_TRUE(taken([](TrackMeasurement& m) { m.velocity = Vec3(0, 0, -50); }));
    EXPECT_FALSE(taken([](TrackMeasurement& m) { m.velocity = Vec3(0, 0, -50.01F); }));
}

TEST_F(TrackEdges, AgesAreTakenUpToTheirLimits)
{
    const TimePoint now = kStart + 10.0F;
    const auto status = [&](std::int64_t ago_us) {
        TrackTable fresh(settings);
        return fresh.update(seen(1, Vec3(10, 0, 0), {now.us - ago_us}), own, now);
    };
    settings.max_age = 2.0F;
    settings.future_slack = 0.5F;
    EXPECT_EQ(status(2'000'000), TrackStatus::created);
    EXPECT_EQ(status(2'000'010), TrackStatus::stale);
    EXPECT_EQ(status(-500'000), TrackStatus::created);
    EXPECT_EQ(status(-500'010), TrackStatus::future);
}

// --- the filter ---

/// A sighting without velocity gives no information on it: no jump, for any speed of the track.
TEST_F(TrackEdges, ASightingWithoutVelocityIsNoJumpOfIt)
{
    TrackMeasurement m = seen(1, Vec3(0, 0, 0));
    m.velocity = Vec3(80, 0, 0);
    static_cast<void>(take(m));
    m = seen(1, Vec3(40, 0, 0), kStart + 0.5F);
    m.has_velocity = false;
    m.sigma_velocity = 0.0F;
    EXPECT_EQ(take(m), TrackStatus::updated);
    EXPECT_EQ(table.diagnostics().jumps, 0U);
    EXPECT_NEAR(only(m.stamp).velocity.x(), 80.0F, 0.1F);
}

/// One axis of the textbook's filter in double: white acceleration noise, position and velocity measured.
struct Textbook {
    double x = 0.0, v = 0.0, pp = 0.0, pv = 0.0, vv = 0.0;
    void predict(double dt, double q)
    {
        x += v * dt;
        pp += 2.0 * dt * pv + dt * dt * vv + q * dt * dt * dt / 3.0;
        pv += dt * vv + q * dt * dt / 2.0;
        vv += q * dt;
    }
    void see_position(double z, double r)
    {
        const double s = pp + r, kp = pp / s, kv = pv / s, y = z - x;
        x += kp * y, v += kv * y;
        vv -= kv * pv, pv -= kp * pv, pp -= kp * pp;
    }
    void see_velocity(double z, double r)
    {
        const double s = vv + r, kp = pv / s, kv = vv / s, y = z - v;
        x += kp * y, v += kv * y;
        pp -= kp * pv, pv -= kv * pv, vv -= kv * vv;
    }
};

TEST_F(TrackEdges, FollowsTheTextbook)
{
    Textbook book;
    TrackMeasurement m = seen(1, Vec3(3, 0, 0));
    m.velocity = Vec3(10, 0, 0);
    static_cast<void>(take(m));
    book.x = 3.0, book.v = 10.0, book.pp = 0.25, book.vv = 0.09;
    const double q = 0.25;
    for (int i = 1; i <= 12; ++i) {
        const float dt = i % 3 == 0 ? 0.7F : 0.2F;
        m.stamp = m.stamp + dt;
        m.position.x() = static_cast<float>(book.x + book.v * double(dt)) + (i % 2 == 0 ? 0.3F : -0.2F);
        m.velocity.x() = 10.0F + (i % 4 == 0 ? 0.4F : -0.1F);
        m.has_velocity = i % 5 != 0;
        ASSERT_EQ(take(m), TrackStatus::updated);
        book.predict(double(dt), q);
        book.see_position(double(m.position.x()), 0.25);
        if (m.has_velocity) {
            book.see_velocity(double(m.velocity.x()), 0.09);
        }
        const Track track = only(m.stamp);
        ASSERT_NEAR(track.position.x(), book.x, 1e-4) << i;
        ASSERT_NEAR(track.velocity.x(), book.v, 1e-4) << i;
        ASSERT_NEAR(track.sigma_position, std::sqrt(book.pp), 1e-4) << i;
        ASSERT_NEAR(track.sigma_velocity, std::sqrt(book.vv), 1e-4) << i;
    }
    EXPECT_EQ(table.diagnostics().jumps, 0U);
}

// --- which track a sighting belongs to ---

/// Reach: both uncertainties, and 10 m/s2 plus the larger of both acceleration bounds.
TEST_F(TrackEdges, AccelerationOfTheTrackOrOfTheSightingExtendsItsReach)
{
    const auto doubled = [&](float of_track, float of_sighting, float off) {
        TrackTable fresh;
        TrackMeasurement m = seen(1, Vec3(0, 0, 0));
        m.sigma_position = 0.01F;
        m.sigma_velocity = 0.01F;
        m.max_acceleration = of_track;
        EXPECT_EQ(fresh.update(m, own, kStart), TrackStatus::created);
        m.max_acceleration = of_sighting;
        m.position = Vec3(0, off, 0);
        m.stamp = kStart + 1.0F;
        static_cast<void>(fresh.update(m, own, m.stamp));
        return fresh.diagnostics().doubled == 1U;
    };
    // Six deviations of the process noise, 0.29 m each, are 1.7 m.
    EXPECT_FALSE(doubled(0.0F, 0.0F, 5.0F + 1.5F));
    EXPECT_TRUE(doubled(0.0F, 0.0F, 5.0F + 2.5F));
    EXPECT_FALSE(doubled(40.0F, 0.0F, 25.0F + 1.5F));
    EXPECT_TRUE(doubled(40.0F, 0.0F, 25.0F + 2.5F));
    EXPECT_FALSE(doubled(0.0F, 40.0F, 25.0F + 1.5F));
    EXPECT_TRUE(doubled(0.0F, 40.0F, 25.0F + 2.5F));
}

/// Of two uncertain heights the part that both leave open is forgiven, above and below, and no more.
TEST_F(TrackEdges, UncertainHeightsForgiveTheirSum)
{
    const auto doubled = [&](float above) {
        TrackTable fresh;
        TrackMeasurement m = seen(1, Vec3(0, 0, 100));
        m.sigma_position = 0.1F;
        m.half_height = 20.0F;
        EXPECT_EQ(fresh.update(m, own, kStart), TrackStatus::created);
        m.half_height = 10.0F;
        m.position.z() += above;
        m.stamp = kStart + 0.1F;
        static_cast<void>(fresh.update(m, own, m.stamp));
        return fresh.diagnostics().doubled == 1U;
    };
    for (const float sign : {1.0F, -1.0F}) {
        EXPECT_FALSE(doubled(sign * 5.0F));
        EXPECT_FALSE(doubled(sign * 30.0F));
        EXPECT_TRUE(doubled(sign * 33.0F)) << "3 m are left of which 0.9 m fit";
        EXPECT_TRUE(doubled(sign * 90.0F));
    }
}

/// A late sighting may lie where the track was then, by as much as between two sightings otherwise.
TEST_F(TrackEdges, ALateSightingOfAKnownTrackIsStaleAndNotAnotherAircraft)
{
    settings.process_acceleration = 6.0F;
    settings.reach_acceleration = 0.0F;
    table.configure(settings);
    TrackMeasurement m = seen(1, Vec3(0, 0, 0));
    m.velocity = Vec3(10, 0, 0);
    m.sigma_position = m.sigma_velocity = 0.05F;
    static_cast<void>(take(m));
    m.position = Vec3(-10, 15, 0);
    m.stamp = kStart - 1.0F;
    EXPECT_EQ(table.update(m, own, kStart), TrackStatus::stale) << "3.5 m of process noise, six times";
    m.position = Vec3(-10, 25, 0);
    EXPECT_EQ(table.update(m, own, kStart), TrackStatus::created);
}

/// Two of one id: place and, where it is known, velocity say whose the sighting is.
struct TwoOfOneId : TrackEdges {
    TwoOfOneId()
    {
        TrackMeasurement m = seen(1, Vec3(-30, 0, 0));
        m.velocity = Vec3(30, 0, 0);
        static_cast<void>(take(m));
        m = seen(1, Vec3(30, 4, 0));
        m.velocity = Vec3(-30, 0, 0);
        static_cast<void>(take(m));
        EXPECT_EQ(table.size(), 2U);
    }
    /// Which of both has been renewed at `stamp`.
    [[nodiscard]] int renewed(TimePoint stamp)
    {
        const auto tracks = table.snapshot(stamp);
        EXPECT_EQ(tracks.size(), 2U);
        EXPECT_NE(tracks[0].stamp == stamp, tracks[1].stamp == stamp);
        return tracks[0].stamp == stamp ? 0 : 1;
    }
};

TEST_F(TwoOfOneId, TheVelocityDecidesWhereTheyMeet)
{
    TrackMeasurement m = seen(1, Vec3(0, 1.5F, 0), kStart + 1.0F);  // nearer to the first
    m.velocity = Vec3(-30, 0, 0);
    EXPECT_EQ(take(m), TrackStatus::updated);
    EXPECT_EQ(renewed(m.stamp), 1);
}

TEST_F(TwoOfOneId, ThePlaceDecidesWithoutAVelocity)
{
    TrackMeasurement m = seen(1, Vec3(0, 2.5F, 0), kStart + 1.0F);  // nearer to the second
    m.has_velocity = false;
    m.velocity = Vec3(30, 0, 0);  // not reported
    EXPECT_EQ(take(m), TrackStatus::updated);
    EXPECT_EQ(renewed(m.stamp), 1);
}

// --- urgency ---

TEST(Urgency, OfWhatPassesWithinItsBodyIsItsTimeAlone)
{
    vehicle::VehicleState own;
    Track track;
    track.stamp = kStart;
    track.position = Vec3(100, 5, 0);
    track.velocity = Vec3(-10, 0, 0);
    track.radius = 20.0F;
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), 10.0F, 1e-4F);
    track.radius = 2.0F;
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), 10.0F + 1.0F, 1e-4F);
    track.stamp = kStart + 0.04F;
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), 10.04F + 1.0F, 1e-3F) << "a stamp ahead is no negative age";
    track.velocity = Vec3::Zero();
    EXPECT_NEAR(urgency(track, 3, false, own, kStart), (std::hypot(100.0F, 5.0F) - 2.0F) / 3.0F, 1e-3F);
}

}  // namespace
}  // namespace jink::world
