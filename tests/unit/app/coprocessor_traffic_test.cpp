// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step and traffic with incomplete reports.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

/// An aircraft climbs towards the vehicle's position in 7 s, with or without a reported climb rate. Returns the height
/// below the vehicle at which the conflict is detected; 0: never.
float seen_below(bool says_climb, float climb)
{
    constexpr GlobalPosition kOrigin{473977420, 85455940, 488000};
    Flight f;
    EXPECT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
    f.fly(60);
    Vec3 where = f.position + Vec3(0.0F, 35.0F, -7.0F * climb);
    for (int i = 0; i < 350; ++i) {
        if (i % 10 == 0) {
            AdsbVehicle m = wire::adsb(9, to_global(where, kOrigin).value());
            m.hor_velocity = 0;
            m.ver_velocity = static_cast<std::int16_t>(says_climb ? climb * 100.0F : 0.0F);
            m.flags = static_cast<std::uint16_t>(says_climb ? m.flags : m.flags & ~128U);
            f.feed(m, 156);
        }
        f.fly(1);
        if (f.last.guidance.conflict.has_value()) {
            return f.position.z() - where.z();
        }
        where.z() += climb * 0.02F;
    }
    return 0.0F;
}

TEST(CoprocessorTraffic, OfUnknownClimbIsAConflictAsEarlyAsOfKnown)
{
    for (const float climb : {2.0F, 4.0F, 8.0F}) {
        const float known = seen_below(true, climb);
        EXPECT_GT(known, 5.0F * climb);
        EXPECT_GT(seen_below(false, climb), known - 2.0F * climb) << "at most 2 s later";
    }
}

/// A copter whose autopilot has reported a first origin `aside` metres east of the true origin. A static obstacle is 40
/// m ahead.
struct MisplacedOrigin {
    explicit MisplacedOrigin(float aside)
    {
        f.ticks = 1;  // the origin is a second away
        f.feed(wire::heartbeat(wire::kCopterAuto, true, 3));
        const GlobalPosition first = to_global(Vec3(aside, 0.0F, 0.0F), kOrigin).value();
        f.feed(wire::origin(first.lat, first.lon, first.alt));
        f.fly(10);
        AdsbVehicle mast = wire::adsb(9, to_global(f.position + Vec3(0.0F, 40.0F, 0.0F), kOrigin).value());
        mast.emitter_type = 19;
        mast.hor_velocity = mast.ver_velocity = 0;
        f.feed(mast, 156);
        f.fly(5);
    }
    static constexpr GlobalPosition kOrigin{473977420, 85455940, 488000};
    Flight f;
};

TEST(CoprocessorTraffic, MovesWithTheOriginWithoutAnotherReport)
{
    for (const float aside : {30.0F, -30.0F, 200.0F}) {
        MisplacedOrigin m(aside);
        ASSERT_EQ(m.f.last.tracks, 1U);
        ASSERT_FALSE(m.f.last.guidance.conflict.has_value()) << "as far as can be known";
        m.f.feed(wire::origin());
        m.f.fly(3);
        EXPECT_EQ(m.f.last.tracks, 1U);
        EXPECT_TRUE(m.f.last.guidance.conflict.has_value()) << aside;
        EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U);
        EXPECT_EQ(m.f.coprocessor.diagnostics().tracks_not_moved, 0U);
        m.f.feed(wire::origin());
        m.f.fly(3);
        EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U) << "the same one again";
    }
}

TEST(CoprocessorTraffic, FromBeyondTheMapIsForgottenAndCounted)
{
    MisplacedOrigin m(link::mavlink::kMapReach + 500.0F);
    ASSERT_EQ(m.f.last.tracks, 1U);
    m.f.feed(wire::origin());
    m.f.fly(1);
    EXPECT_EQ(m.f.last.tracks, 0U);
    EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U);
    EXPECT_EQ(m.f.coprocessor.diagnostics().tracks_not_moved, 1U);
}

constexpr GlobalPosition kHome{473977420, 85455940, 488000};
constexpr std::uint8_t kOther = 9;

/// The neighbouring vehicle's report about itself, in its sender's format.
GlobalPositionInt said_by_system(const Vec3& where, std::uint32_t boot_ms)
{
    const GlobalPosition p = to_global(where, kHome).value();
    return {boot_ms, p.lat, p.lon, p.alt, 0, 0, 0, 0, 0};
}

UtmGlobalPosition said_to_utm(const Vec3& where)
{
    const GlobalPosition p = to_global(where, kHome).value();
    UtmGlobalPosition m;
    m.lat = p.lat;
    m.lon = p.lon;
    m.alt = p.alt;
    m.uas_id.fill(3);
    m.flight_state = 3;
    m.flags = 2 | 4 | 8 | 32 | 64;
    return m;
}

template <link::mavlink::Message M>
void feed_from(Flight& f, std::uint8_t system, const M& message)
{
    f.feed_bytes(wire::frame_of(message, {system, 1, 0}));
}

TEST(CoprocessorTraffic, SharesTheReactionAsTheParameterSays)
{
    const Vec3 aside(0.0F, -200.0F, 50.0F);
    for (unsigned mask = 0; mask < 16; ++mask) {
        Parameters parameters;
        ASSERT_EQ(parameters.set(Param::coop, static_cast<float>(mask)), ParamStatus::ok);
        Flight f(parameters);
        f.fly(60);
        AdsbVehicle manned = wire::adsb(0xA1, to_global(aside, kHome).value());
        AdsbVehicle uav = manned;
        uav.ICAO_address = 0xA2;
        uav.emitter_type = 14;
        AdsbVehicle mast = manned;
        mast.ICAO_address = 0xA3;
        mast.emitter_type = 19;
        for (const AdsbVehicle& m : {manned, uav, mast}) {
            f.feed(m, 156);
        }
        feed_from(f, kOther, said_by_system(aside, f.boot_ms()));
        feed_from(f, kOther + 1, said_to_utm(aside));
        f.fly(1);
        const auto tracks = f.coprocessor.tracks(f.now);
        ASSERT_EQ(tracks.size(), 5U);
        const std::array<bool, 5> expected{(mask & 8U) != 0, (mask & (4U | 8U)) != 0, false, (mask & 1U) != 0,
                                           (mask & 2U) != 0};
        const std::array kSources{world::TrackSource::adsb, world::TrackSource::adsb, world::TrackSource::adsb,
                                  world::TrackSource::datalink, world::TrackSource::utm};
        for (std::size_t i = 0; i < 5; ++i) {
            EXPECT_EQ(tracks[i].cooperative, expected[i]) << "mask " << mask << " track " << i;
            EXPECT_EQ(tracks[i].source, kSources[i]);
        }
    }
}

TEST(CoprocessorTraffic, WhoeverSaysThatHeWillNotDoesNotShareTheReaction)
{
    const Vec3 aside(0.0F, -200.0F, 50.0F);
    Flight f;
    f.fly(60);
    const auto shares = [&] {
        const auto tracks = f.coprocessor.tracks(f.now);
        EXPECT_EQ(tracks.size(), 1U);
        return tracks.front().cooperative;
    };
    feed_from(f, kOther, said_by_system(aside, f.boot_ms()));
    f.fly(1);
    EXPECT_TRUE(shares());
    feed_from(f, kOther, wire::heartbeat(wire::kCopterAuto, false, 3));
    feed_from(f, kOther, said_by_system(aside, f.boot_ms()));
    f.fly(1);
    EXPECT_FALSE(shares()) << "disarmed";
    feed_from(f, kOther, wire::heartbeat(wire::kCopterAuto, true, 3));
    feed_from(f, kOther, said_by_system(aside, f.boot_ms()));
    f.fly(1);
    EXPECT_TRUE(shares()) << "the newest word counts";
}

TEST(CoprocessorTraffic, AnotherSystemInTheWayIsAConflictReportedByItsId)
{
    Flight f;
    f.fly(60);
    for (int i = 0; i < 100 && !f.last.guidance.conflict.has_value(); ++i) {
        feed_from(f, kOther, said_by_system(Vec3(0.0F, 40.0F, 50.0F), f.boot_ms()));
        f.fly(1);
    }
    ASSERT_TRUE(f.last.guidance.conflict.has_value());
    const auto reported = f.said_of<Collision>();
    ASSERT_EQ(reported.size(), 1U);
    EXPECT_EQ(reported[0].src, 1);
    EXPECT_EQ(reported[0].id, kOther);
}

TEST(CoprocessorTraffic, OwnTransponderHeardBackIsNoTraffic)
{
    for (const float own : {0.0F, 161.0F, 16777215.0F}) {
        Parameters parameters;
        ASSERT_EQ(parameters.set(Param::own_address, own), ParamStatus::ok);
        Flight f(parameters);
        f.fly(60);
        for (const std::uint32_t address : {0U, 161U, 0xFFFFFFU}) {
            f.feed(wire::adsb(address, to_global(f.position, kHome).value()), 156);
        }
        f.fly(1);
        EXPECT_EQ(f.last.tracks, own > 0.0F ? 2U : 3U);
        EXPECT_EQ(f.coprocessor.diagnostics().own_heard, own > 0.0F ? 1U : 0U);
    }
}

}  // namespace
}  // namespace jink::app::test
