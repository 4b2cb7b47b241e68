// SPDX-License-Identifier: BSD-3-Clause
// How threats grow, and tracks of uncertain height.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// 2 m of body, 0.5 m of doubt about the own place and 0.25 about the other, 0.1 m/s about the velocity, 0.4 m/s2;
/// three deviations.
struct Growing : testing::Test {
    Growing()
    {
        scene.own.sigma_position = 0.5F;
        track = &scene.track(Vec3(10, 0, 0), Vec3::Zero(), 2.0F);
        track->sigma_position = 0.25F;
        track->sigma_velocity = 0.1F;
        track->max_acceleration = 0.4F;
    }
    static float radius(float age) { return 2.0F + 3.0F * (std::sqrt(0.3125F) + 0.1F * age) + 0.5F * 0.4F * age * age; }
    Scene scene;
    Track* track = nullptr;
};

TEST_F(Growing, AsAPolynomialOfTimeItIsTheRadius)
{
    for (const float age : {0.0F, 1.5F}) {
        for (const float lead : {0.0F, 2.0F}) {
            track->stamp = scene.now - age;
            const Growth growth = growth_of(scene.situation(), *track).from(lead);
            EXPECT_NEAR(growth.radius, radius(age + lead), 1e-5F);
            EXPECT_NEAR(growth.rate, 0.3F + 0.4F * (age + lead), 1e-5F);
            EXPECT_EQ(growth.acceleration, 0.4F);
            for (const float t : {0.0F, 1.0F, 3.0F}) {
                EXPECT_NEAR(growth.at(t), radius(age + lead + t), 1e-4F) << age << ' ' << lead << ' ' << t;
            }
        }
    }
}

/// Errors of two places that have nothing to do with each other leave the radius as often as those of one place do, of
/// which 2.9 % lie beyond three deviations.
TEST_F(Growing, TheErrorsOfBothPlacesLeaveItAsOftenAsThoseOfOne)
{
    track->radius = track->sigma_velocity = track->max_acceleration = 0.0F;
    Random random(7);
    const auto error = [&random](float sigma) {
        return Vec3(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
    };
    constexpr int kErrors = 40'000;
    for (const auto& [own, other] :
         {std::pair(0.5F, 0.0F), std::pair(0.0F, 0.5F), std::pair(0.2F, 0.3F), std::pair(0.4F, 0.4F)}) {
        scene.own.sigma_position = own;
        track->sigma_position = other;
        const float reach = threat_radius(scene.situation(), *track, 0.0F);
        int beyond = 0;
        for (int i = 0; i < kErrors; ++i) {
            beyond += (error(own) - error(other)).norm() > reach ? 1 : 0;
        }
        EXPECT_NEAR(static_cast<double>(beyond) / kErrors, 0.0292, 0.004) << own << ' ' << other;
    }
}

/// Never below threat_radius where the stamp lies ahead.
TEST_F(Growing, AStampAheadGrowsFromNowOn)
{
    track->stamp = scene.now + 1.0F;
    const Growth growth = growth_of(scene.situation(), *track);
    EXPECT_NEAR(growth.radius, radius(0.0F), 1e-5F);
    EXPECT_NEAR(growth.rate, 0.3F, 1e-5F);
    for (const float t : {0.0F, 0.5F, 1.0F, 4.0F}) {
        EXPECT_GE(growth.at(t), threat_radius(scene.situation(), *track, t)) << t;
    }
}

TEST_F(Growing, AtManyInstantsItIsTheSameRadius)
{
    for (const float age : {-3.0F, -0.5F, 0.0F, 1.5F}) {
        track->stamp = scene.now - age;
        const Situation s = scene.situation();
        ASSERT_EQ(s.threats.size(), 1U);
        for (const float t : {0.0F, 0.4F, 0.6F, 2.0F, 5.0F}) {
            EXPECT_NEAR(s.threats[0].radius_at(t), threat_radius(scene.situation(), *track, t), 1e-4F)
                << age << ' ' << t;
        }
    }
}

/// What a cooperative vehicle may have done since its report: it accelerates as the own vehicle does, 2 m/s2 of which
/// 0.4 are its own bound, and its velocity counts until the own one can stand.
struct Doubted : Growing {
    Doubted()
    {
        scene.limits.max_acceleration = 2.0F;
        scene.own.velocity = Vec3(0, 6, 8);
        track->cooperative = true;
    }
    static constexpr float kEnds = 10.0F / 2.0F + 0.75F;
};

TEST_F(Doubted, AnOldReportHidesAPlaceAndAVelocityUntilTheOwnVehicleCanStand)
{
    for (const float age : {0.0F, 0.2F, 0.3F, 0.5F, 1.5F}) {
        track->stamp = scene.now - age;
        const float beyond = std::max(age - 0.3F, 0.0F);
        const float off = 0.5F * 1.6F * beyond * beyond;
        const float speed = 1.6F * beyond;
        const Situation s = scene.situation();
        for (const float t : {0.0F, 1.0F, kEnds, 8.0F}) {
            const float expected = radius(age + t) + off + speed * std::min(t, kEnds);
            EXPECT_NEAR(threat_radius(s, *track, t), expected, 1e-4F) << age << ' ' << t;
            EXPECT_NEAR(s.threats[0].radius_at(t), expected, 1e-4F) << age << ' ' << t;
        }
    }
}

/// The own vehicle may be bounded to less than the others are counted on to accelerate.
TEST_F(Doubted, OthersMayAccelerateHarderThanTheOwnVehicleWhereTheRulesSaySo)
{
    track->stamp = scene.now - 1.3F;
    const float as_the_own = doubt_of(scene.situation(), *track).velocity;
    EXPECT_NEAR(as_the_own, 1.6F, 1e-5F);
    scene.rules.fellow_acceleration = 1.0F;
    EXPECT_EQ(doubt_of(scene.situation(), *track).velocity, as_the_own) << "less than the own limit";
    scene.rules.fellow_acceleration = 5.0F;
    EXPECT_NEAR(doubt_of(scene.situation(), *track).velocity, 4.6F, 1e-5F);
    EXPECT_EQ(doubt_of(scene.situation(), *track).ends, kEnds) << "the own vehicle stops as before";
    track->shown_acceleration = 6.0F;
    EXPECT_NEAR(doubt_of(scene.situation(), *track).velocity, 4.6F, 1e-5F) << "within a quarter";
    track->shown_acceleration = 7.0F;
    EXPECT_NEAR(doubt_of(scene.situation(), *track).velocity, 6.6F, 1e-5F);
}

/// But for what it does within kFreshReport.
TEST_F(Doubted, TheRealMotionOfTheOtherStaysWithinIt)
{
    track->radius = track->sigma_position = track->sigma_velocity = track->max_acceleration = 0.0F;
    scene.own.sigma_position = 0.0F;
    Random random(5);
    const auto direction = [&random] { return Vec3(random.normal(), random.normal(), random.normal()).normalized(); };
    for (int i = 0; i < 2000; ++i) {
        const float age = kFreshReport + 2.0F * random.uniform();
        const Vec3 heard = 5.0F * direction();
        const Vec3 pushed = 2.0F * direction();  // since the report, then as it flies
        const Vec3 at_now = heard * age + 0.5F * age * age * pushed;
        const Vec3 now_flown = heard + age * pushed;
        track->stamp = scene.now - age;
        track->velocity = heard;
        const Situation s = scene.situation();
        for (const float t : {0.0F, 0.5F, 2.0F, kEnds}) {
            const float off = (at_now + t * now_flown - heard * (age + t)).norm();
            const float fresh = 2.0F * kFreshReport * (age - 0.5F * kFreshReport + t);
            EXPECT_LE(off, s.threats[0].radius_at(t) + fresh + 1e-4F) << i << ' ' << t;
        }
    }
}

TEST_F(Doubted, WhoDoesNotAvoidUsAndAStampAheadAreNotDoubted)
{
    track->stamp = scene.now + 0.05F;
    EXPECT_FALSE(scene.situation().threats[0].doubted);
    track->stamp = scene.now - 1.0F;
    EXPECT_TRUE(scene.situation().threats[0].doubted);
    track->max_acceleration = 3.0F;
    EXPECT_FALSE(scene.situation().threats[0].doubted) << "its own growth covers more";
    track->max_acceleration = 0.4F;
    track->cooperative = false;
    const Situation s = scene.situation();
    EXPECT_FALSE(s.threats[0].doubted);
    EXPECT_NEAR(threat_radius(s, *track, 2.0F), radius(3.0F), 1e-5F);
}

TEST_F(Growing, NumbersByHand)
{
    const Growth growth{2.0F, 3.0F, 4.0F};
    EXPECT_EQ(growth.at(0.0F), 2.0F);
    EXPECT_EQ(growth.at(2.0F), 2.0F + 6.0F + 8.0F);
}

TEST_F(Growing, AnUncertainHeightIsNearAtManyHeights)
{
    track->half_height = 7.0F;
    EXPECT_EQ(nearest_in_height(*track, Vec3(1, 2, 50), 30.0F), Vec3(1, 2, 43));
    EXPECT_EQ(nearest_in_height(*track, Vec3(1, 2, 50), 90.0F), Vec3(1, 2, 57));
    EXPECT_EQ(nearest_in_height(*track, Vec3(1, 2, 50), 55.0F), Vec3(1, 2, 55));
}

}  // namespace
}  // namespace jink::world
