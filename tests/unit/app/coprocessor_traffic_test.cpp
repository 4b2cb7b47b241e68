// SPDX-License-Identifier: BSD-3-Clause
// Coprocessor::step and traffic that does not say all of what it does.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

/// Climbs towards the place where the vehicle will be in 7 s, and says how fast or does not. Height below the vehicle
/// at which the conflict is seen; 0: never.
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
        if (f.last.guidance.has_conflict) {
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

/// A copter whose autopilot has told its home alone: `aside` metres east of where it truly lies. Something stands 40 m
/// ahead in its way.
struct MisplacedHome {
    explicit MisplacedHome(float aside)
    {
        f.ticks = 1;  // the origin is a second away
        f.feed(wire::heartbeat(wire::kCopterAuto, true, 3));
        const GlobalPosition home = to_global(Vec3(aside, 0.0F, 0.0F), kOrigin).value();
        HomePosition m;
        m.latitude = home.lat;
        m.longitude = home.lon;
        m.altitude = home.alt;
        f.feed(m);
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
        MisplacedHome m(aside);
        ASSERT_EQ(m.f.last.tracks, 1U);
        ASSERT_FALSE(m.f.last.guidance.has_conflict) << "as far as can be known";
        m.f.feed(wire::origin());
        m.f.fly(3);
        EXPECT_EQ(m.f.last.tracks, 1U);
        EXPECT_TRUE(m.f.last.guidance.has_conflict) << aside;
        EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U);
        EXPECT_EQ(m.f.coprocessor.diagnostics().tracks_not_moved, 0U);
        m.f.feed(wire::origin());
        m.f.fly(3);
        EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U) << "the same one again";
    }
}

TEST(CoprocessorTraffic, FromBeyondTheMapIsForgottenAndCounted)
{
    MisplacedHome m(link::mavlink::kMapReach + 500.0F);
    ASSERT_EQ(m.f.last.tracks, 1U);
    m.f.feed(wire::origin());
    m.f.fly(1);
    EXPECT_EQ(m.f.last.tracks, 0U);
    EXPECT_EQ(m.f.coprocessor.diagnostics().origin_changes, 1U);
    EXPECT_EQ(m.f.coprocessor.diagnostics().tracks_not_moved, 1U);
}

}  // namespace
}  // namespace jink::app::test
