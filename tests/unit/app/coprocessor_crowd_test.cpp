// SPDX-License-Identifier: BSD-3-Clause
// Traffic that shares an id, that has a barometer alone, and that is too much; in closed loop.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

constexpr GlobalPosition kGround{473977420, 85455940, 488000};

AdsbVehicle seen_at(std::uint32_t id, const Vec3& where, const Vec3& velocity)
{
    AdsbVehicle m = wire::adsb(id, to_global(where, kGround).value());
    const float course = std::atan2(velocity.x(), velocity.y()) * 180.0F / 3.14159265F;
    m.heading = static_cast<std::uint16_t>(std::lround((course < 0.0F ? course + 360.0F : course) * 100.0F) % 36000);
    m.hor_velocity = static_cast<std::uint16_t>(std::lround(std::hypot(velocity.x(), velocity.y()) * 100.0F));
    m.ver_velocity = static_cast<std::int16_t>(std::lround(velocity.z() * 100.0F));
    return m;
}

/// An intruder that reaches the vehicle after `kUntilMet`, at its height: 20 courses, head-on to overtaking.
struct Encounter {
    static constexpr float kUntilMet = 12.0F;
    explicit Encounter(int i) : f(std::make_unique<Flight>())
    {
        EXPECT_TRUE(f->until([](const StepReport& r) { return r.faults == 0; }, 200));
        f->fly(60);
        const float angle = 0.3F + 0.29F * static_cast<float>(i);
        velocity = 10.0F * Vec3(std::sin(angle), std::cos(angle), 0.0F);
        where = f->position + kUntilMet * (f->velocity - velocity);
    }
    /// Least distance between the centres. `tell(tick)` sends this tick's reports.
    template <class Tell>
    float fly(const Tell& tell)
    {
        float least = 1e9F;
        for (int i = 0; i < 900; ++i) {
            tell(i);
            f->fly(1);
            where += 0.02F * velocity;
            least = std::min(least, (f->position - where).norm());
        }
        EXPECT_FALSE(f->lost_input);
        return least;
    }
    std::unique_ptr<Flight> f;
    Vec3 where = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
};
/// Nearer than this is a hit: two bodies of half a metre each, and a margin [m].
constexpr float kHit = 2.0F;
constexpr int kEncounters = 20;

/// Both at 5 Hz; the other one is heard 20 or 100 ms behind, 2 km away.
TEST(CoprocessorCrowd, TwoAircraftUnderOneIdDoNotHideOneAnother)
{
    int hits = 0;
    for (int k = 0; k < kEncounters; ++k) {
        Encounter e(k);
        const int behind = k % 2 == 0 ? 1 : 5;
        const Vec3 away = e.where + Vec3(2000.0F, 0.0F, 100.0F);
        const float least = e.fly([&](int i) {
            if (i % 10 == 0) {
                e.f->feed(seen_at(7, e.where, e.velocity), 156);
            }
            if (i % 10 == behind) {
                e.f->feed(seen_at(7, away, Vec3(0.0F, -1.0F, 0.0F)), 156);
            }
        });
        hits += least < kHit ? 1 : 0;
        EXPECT_GE(e.f->coprocessor.track_diagnostics().doubled, 1U);
    }
    EXPECT_EQ(hits, 0) << "of " << kEncounters;
}

/// A barometer that is off by the weather; without and with our own, which is off by as much.
TEST(CoprocessorCrowd, APressureAltitudeThatIsWrongIsStillAvoided)
{
    int hits = 0;
    int flown = 0;
    for (const float error : {10.0F, -10.0F, 40.0F, -60.0F}) {
        for (const bool own_known : {false, true}) {
            for (int k = 0; k < kEncounters; k += 4) {
                Encounter e(k);
                const float least = e.fly([&](int i) {
                    if (own_known && i % 50 == 0) {
                        const double height = 488.0 + double(e.f->position.z()) + double(error);
                        ScaledPressure m;
                        m.press_abs = static_cast<float>(1013.25 * std::pow(1.0 - 2.25577e-5 * height, 5.25588));
                        e.f->feed(m);
                    }
                    if (i % 10 == 0) {
                        AdsbVehicle m = seen_at(7, e.where + error * Vec3::UnitZ(), e.velocity);
                        m.altitude_type = 0;
                        e.f->feed(m, 156);
                    }
                });
                hits += least < kHit ? 1 : 0;
                ++flown;
            }
        }
    }
    EXPECT_EQ(hits, 0) << "of " << flown;
}

/// At our height in truth, sea level 48 m above the ellipsoid or 35 m below; the sender may mean either.
TEST(CoprocessorCrowd, AGeometricAltitudeAboveTheEllipsoidIsStillAvoided)
{
    int hits = 0;
    int flown = 0;
    for (const std::int32_t undulation : {48'000, -35'000}) {
        for (const bool above_ellipsoid : {true, false}) {
            for (int k = 0; k < kEncounters; k += 4) {
                Encounter e(k);
                const float offset = above_ellipsoid ? 1e-3F * static_cast<float>(undulation) : 0.0F;
                const float least = e.fly([&](int i) {
                    if (i % 100 == 0) {
                        GpsRawInt m;
                        m.alt = 538'000;
                        m.alt_ellipsoid = m.alt + undulation;
                        m.fix_type = 3;
                        e.f->feed(m);
                    }
                    if (i % 10 == 1) {
                        e.f->feed(seen_at(7, e.where + offset * Vec3::UnitZ(), e.velocity), 156);
                    }
                });
                hits += least < kHit ? 1 : 0;
                ++flown;
            }
        }
    }
    EXPECT_EQ(hits, 0) << "of " << flown;
}

/// A reported height of 60 m above may be our height; a geometric (satellite) height is 60 m above.
TEST(CoprocessorCrowd, HeightsOfSatellitesStillSeparate)
{
    for (const std::uint8_t type : {std::uint8_t{0}, std::uint8_t{1}}) {
        Encounter e(0);
        e.where.z() += 60.0F;
        static_cast<void>(e.fly([&](int i) {
            if (i % 10 == 0) {
                AdsbVehicle m = seen_at(7, e.where, e.velocity);
                m.altitude_type = type;
                e.f->feed(m, 156);
            }
        }));
        EXPECT_EQ(e.f->requested.empty(), type == 1) << int(type);
        EXPECT_EQ(e.f->last.uncertain_heights, type == 1 ? 0 : 1) << int(type);
    }
}

/// As many spoofed aircraft as the table holds, aimed at us from 3 km; the real one comes later.
TEST(CoprocessorCrowd, AFloodDoesNotHideARealThreatAndIsReportedOnce)
{
    int hits = 0;
    for (int k = 0; k < kEncounters; k += 5) {
        Encounter e(k);
        int reported = 0;
        const float least = e.fly([&](int i) {
            // 16 of them in each of four ticks, once a second.
            for (std::uint32_t n = 0; i % 50 < 4 && n < kMaxTracks / 4; ++n) {
                const auto id = static_cast<std::uint32_t>(i % 50) * (kMaxTracks / 4) + n;
                const float angle = 0.098F * static_cast<float>(id);
                const Vec3 side(std::cos(angle), std::sin(angle), 0.0F);
                const Vec3 from = e.f->position + 3000.0F * side;
                e.f->feed(seen_at(1000 + id, from, e.f->velocity - 30.0F * side), 156);
            }
            if (i % 10 == 5 && i > 150) {
                e.f->feed(seen_at(7, e.where, e.velocity), 156);
            }
            for (const Statustext& m : e.f->said_of<Statustext>()) {
                reported +=
                    std::string_view(m.text.data(), m.text.size()).starts_with("jink: too much traffic") ? 1 : 0;
            }
        });
        hits += least < kHit ? 1 : 0;
        EXPECT_EQ(reported, 1);
    }
    EXPECT_EQ(hits, 0);
}

}  // namespace
}  // namespace jink::app::test
