// SPDX-License-Identifier: BSD-3-Clause
// Two aircraft under one id, and tables that are flooded.
#include <algorithm>

#include <gtest/gtest.h>

#include "core/world/track_table.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

constexpr TimePoint kBegin{50'000'000};

struct TrackDoubling : testing::Test {
    TrackTable table;
    vehicle::VehicleState own;

    TrackStatus hear(TrackId id, const Vec3& position, const Vec3& velocity, TimePoint at)
    {
        return table.update(test::sighting(id, position, velocity, at), own, at);
    }
    [[nodiscard]] bool knows(const Vec3& place, TimePoint at)
    {
        const auto all = table.snapshot(at);
        return std::any_of(all.begin(), all.end(), [&](const Track& t) {
            return (t.position - place).norm() <= t.radius + 3 * t.sigma_position;
        });
    }
};

/// Each of them 5 times a second, one a tenth of a second behind the other; before, the last one heard was all there
/// was.
TEST_F(TrackDoubling, TwoAircraftUnderOneIdAreBothKept)
{
    int known = 0;
    for (int i = 0; i < 50; ++i) {
        const TimePoint at = kBegin + 0.1F * static_cast<float>(i);
        const float t = 0.1F * static_cast<float>(i);
        const Vec3 a(10.0F * t, 0, 0);
        const Vec3 b(300.0F - 20.0F * t, 100, 20);
        static_cast<void>(i % 2 == 0 ? hear(7, a, Vec3(10, 0, 0), at) : hear(7, b, Vec3(-20, 0, 0), at));
        known += i > 0 && knows(a, at) && knows(b, at) ? 1 : 0;
    }
    EXPECT_EQ(known, 49);
    EXPECT_EQ(table.diagnostics().doubled, 1U);
    const auto both = table.snapshot(kBegin + 5.0F);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].id, both[1].id);
    EXPECT_EQ(both[0].instance, 0);
    EXPECT_EQ(both[1].instance, 1);
}

TEST_F(TrackDoubling, OneStampAndTwoPlacesAreTwoAircraft)
{
    EXPECT_EQ(hear(7, Vec3(0, 0, 0), Vec3::Zero(), kBegin), TrackStatus::created);
    EXPECT_EQ(hear(7, Vec3(50, 0, 0), Vec3::Zero(), kBegin), TrackStatus::created);
    EXPECT_EQ(hear(7, Vec3(50, 0, 0), Vec3::Zero(), kBegin), TrackStatus::stale) << "the same one again";
    EXPECT_EQ(table.diagnostics().doubled, 1U);
}

TEST_F(TrackDoubling, TwoOfOneIdCrossAndKeepTheirCourses)
{
    for (int i = 0; i < 100; ++i) {
        const float t = 0.1F * static_cast<float>(i);
        const TimePoint at = kBegin + t;
        const Vec3 a(-50.0F + 10.0F * t, 0, 0);
        const Vec3 b(0, -50.0F + 10.0F * t, 0);  // both at the origin after 5 s
        static_cast<void>(hear(7, a, Vec3(10, 0, 0), at));
        static_cast<void>(hear(7, b, Vec3(0, 10, 0), at));
        ASSERT_TRUE(knows(a, at) && knows(b, at)) << t;
    }
    EXPECT_EQ(table.size(), 2U);
    EXPECT_EQ(table.diagnostics().doubled, 1U);
}

TEST_F(TrackDoubling, AWrongFirstFixIsGoneAfterTheUsualAge)
{
    static_cast<void>(hear(7, Vec3(500, 0, 0), Vec3::Zero(), kBegin));
    const Seconds age = TrackTableSettings{}.max_age;
    for (int i = 1; i < 40; ++i) {
        const TimePoint at = kBegin + 0.1F * static_cast<float>(i);
        static_cast<void>(hear(7, Vec3(0, 0, 0), Vec3::Zero(), at));
        table.expire(at);
        EXPECT_EQ(table.size(), at - kBegin <= age ? 2U : 1U) << i;
    }
    EXPECT_TRUE(knows(Vec3(0, 0, 0), kBegin + 4.0F));
}

TEST_F(TrackDoubling, AManyfoldIdKeepsItsMostUrgentOnes)
{
    for (std::size_t i = 0; i < 20; ++i) {
        const float off = 1000.0F - 40.0F * static_cast<float>(i);  // each nearer than the one before
        const TrackStatus status = hear(7, Vec3(off, 0, 0), Vec3::Zero(), kBegin);
        EXPECT_EQ(status, i < kMaxSameId ? TrackStatus::created : TrackStatus::replaced) << i;
    }
    EXPECT_EQ(hear(7, Vec3(5000, 0, 0), Vec3::Zero(), kBegin), TrackStatus::full);
    const auto kept = table.snapshot(kBegin);
    ASSERT_EQ(kept.size(), kMaxSameId);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_LT(kept[i].position.x(), 240.0F + 40.0F * kMaxSameId);
        EXPECT_EQ(kept[i].instance, i);
    }
}

TEST_F(TrackDoubling, AnUncertainHeightHasATrackOfItsOwn)
{
    TrackMeasurement m = test::sighting(7, Vec3(100, 0, 10), Vec3::Zero(), kBegin);
    EXPECT_EQ(table.update(m, own, kBegin), TrackStatus::created);
    m.half_height = 90.0F;
    m.position.z() = 60.0F;
    EXPECT_EQ(table.update(m, own, kBegin), TrackStatus::created);
    m.position.z() = -40.0F;
    m.stamp = kBegin + 0.1F;
    EXPECT_EQ(table.update(m, own, m.stamp), TrackStatus::updated) << "within what its height may be";
    EXPECT_EQ(table.size(), 2U);
    const auto both = table.snapshot(kBegin + 0.1F);
    EXPECT_EQ(both[0].half_height, 0.0F);
    EXPECT_EQ(both[0].position.z(), 10.0F);
    EXPECT_EQ(both[1].half_height, 90.0F);
    for (const float bad : {-1.0F, 1e9F}) {
        m.half_height = bad;
        EXPECT_EQ(table.update(m, own, kBegin), TrackStatus::out_of_range);
    }
}

/// 64 tracks aimed at us from 3 km; a real one appears 9 s before the encounter, 5 m off, and must be kept.
TEST_F(TrackDoubling, AFloodAimedFromAfarDoesNotDisplaceWhatIsMetSoon)
{
    own.velocity = Vec3(0, 5, 0);
    for (std::size_t i = 0; i < kMaxTracks; ++i) {
        const float angle = 0.09F * static_cast<float>(i);
        const Vec3 from = 3000.0F * Vec3(std::cos(angle), std::sin(angle), 0);
        const Vec3 aimed = own.velocity - from / 100.0F;  // encounter after 100 s
        static_cast<void>(hear(static_cast<TrackId>(100 + i), from, aimed, kBegin));
    }
    EXPECT_EQ(table.size(), kMaxTracks);
    EXPECT_EQ(hear(1, Vec3(5, 9.0F * 15.0F, 0), Vec3(0, -10, 0), kBegin), TrackStatus::replaced);
    EXPECT_EQ(table.snapshot(kBegin)[0].id, 1U);
    EXPECT_EQ(table.diagnostics().floods, 1U);
}

TEST_F(TrackDoubling, AFewNewOnesASecondAreNoFlood)
{
    const std::uint16_t most = TrackTableSettings{}.flood;
    for (std::uint16_t i = 0; i < most; ++i) {
        static_cast<void>(hear(i, Vec3(100, 0, 0), Vec3::Zero(), kBegin));
    }
    static_cast<void>(hear(900, Vec3(100, 0, 0), Vec3::Zero(), kBegin + 1.5F));
    EXPECT_EQ(table.diagnostics().floods, 0U);
}

TEST_F(TrackDoubling, UrgencyCountsTimeMissAgeSourceAndConfirmation)
{
    Track t;
    t.stamp = kBegin;
    t.position = Vec3(100, 7, 0);
    t.velocity = Vec3(-10, 0, 0);
    t.radius = 1.0F;
    EXPECT_NEAR(urgency(t, 3, false, own, kBegin), 10.0F + 6.0F / 3.0F, 1e-4F);
    EXPECT_NEAR(urgency(t, 2, false, own, kBegin), 1.5F * 12.0F, 1e-4F);
    EXPECT_NEAR(urgency(t, 2, true, own, kBegin), 2.0F * 12.0F, 1e-4F);
    EXPECT_NEAR(urgency(t, 3, true, own, kBegin), 12.0F, 1e-4F);
    EXPECT_NEAR(urgency(t, 3, false, own, kBegin + 2.0F), 8.0F + 2.0F + 2.0F, 1e-4F) << "2 s nearer, 2 s old";
    t.source = TrackSource::own_sensor;
    EXPECT_NEAR(urgency(t, 3, false, own, kBegin), 6.0F, 1e-4F);
    t.half_height = 50.0F;
    t.position.z() = 40.0F;
    EXPECT_NEAR(urgency(t, 3, false, own, kBegin), 6.0F, 1e-4F) << "it may be at our height";
}

}  // namespace
}  // namespace jink::world
