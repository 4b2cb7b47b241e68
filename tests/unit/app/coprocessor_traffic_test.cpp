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

}  // namespace
}  // namespace jink::app::test
