// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/passing_side.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

Vec3 drawn(Random& random)
{
    const auto one = [&] { return 40.0F * random.uniform() - 20.0F; };
    const float x = one();
    const float y = one();
    return {x, y, one()};
}

/// How the vehicle `own` at `at` passes the vehicle `other` at `there`, both of one link.
Vec3 side_of(TrackId own, const Vec3& at, TrackId other, const Vec3& there)
{
    Scene scene;
    scene.leg(at, at + Vec3(100, 0, 0));
    scene.own.position = at;
    scene.own_id = own;
    Track& track = scene.track(there, Vec3(-5, 0, 0));
    track.id = other;
    track.cooperative = true;
    track.source = TrackSource::datalink;
    const Situation s = scene.situation();
    return passing_side(s, s.threats[0]);
}

TEST(PassingSide, IsTheRightOneAndTheSmallerIdClimbs)
{
    const Vec3 low = side_of(3, Vec3::Zero(), 4, Vec3(40, 0, 0));
    const Vec3 high = side_of(5, Vec3::Zero(), 4, Vec3(40, 0, 0));
    EXPECT_LT(low.y(), -0.7F);
    EXPECT_LT(high.y(), -0.7F);
    EXPECT_GT(low.z(), 0.5F);
    EXPECT_LT(high.z(), -0.5F);
    const Vec3 unknown = side_of(0, Vec3::Zero(), 4, Vec3(40, 0, 0));
    EXPECT_EQ(unknown, Vec3(0, -1, 0)) << "no order of ids";
}

TEST(PassingSide, IsTheOppositeOneForTheOtherVehicle)
{
    Random random(11);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = drawn(random);
        const Vec3 b = i % 7 == 0 ? Vec3(a.x(), a.y(), drawn(random).z()) : drawn(random);
        const Vec3 mine = side_of(3, a, 4, b);
        EXPECT_EQ(side_of(4, b, 3, a), Vec3(-mine)) << i;
        EXPECT_NEAR(mine.norm(), 1.0F, 1e-6F) << i;
        EXPECT_EQ(side_of(3, a, 4, a), Vec3(Vec3::Zero())) << "no line of sight";
    }
}

/// Whatever both may choose within their quarters, right, or the own one of up and down: never the same direction.
TEST(PassingSide, LeavesNoDirectionToBoth)
{
    const Vec3 mine = side_of(3, Vec3::Zero(), 4, Vec3(40, 0, 0));
    const Vec3 other = side_of(4, Vec3(40, 0, 0), 3, Vec3::Zero());
    constexpr int kDirections = 64;
    for (int i = 0; i < kDirections; ++i) {
        const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(kDirections);
        const Vec3 to(0.0F, std::cos(angle), std::sin(angle));
        EXPECT_FALSE(mine.dot(to) > 0.0F && other.dot(to) > 0.0F) << i;
        EXPECT_TRUE(mine.dot(to) != 0.0F || other.dot(to) == 0.0F) << i;
    }
}

TEST(PassingSide, IsNoneOfWhatDoesNotAvoidUs)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0));
    scene.own_id = 3;
    scene.airspace.has_floor = true;
    scene.airspace.floor = -30.0F;
    scene.track(Vec3(40, 0, 0), Vec3(-5, 0, 0));
    scene.obstacle(geometry::make_box(Vec3(20, 0, 0), Vec3::Ones()));
    const Situation s = scene.situation();
    for (const Threat& threat : s.threats) {
        EXPECT_EQ(passing_side(s, threat), Vec3(Vec3::Zero()));
    }
}

/// An id of another scheme says nothing beside the own one.
TEST(PassingSide, IsLevelForAnotherSchemeOfIds)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0));
    scene.own_id = 3;
    Track& track = scene.track(Vec3(40, 0, 5), Vec3(-5, 0, 0));
    track.cooperative = true;
    for (const TrackSource source : {TrackSource::adsb, TrackSource::utm}) {
        track.source = source;
        const Situation s = scene.situation();
        EXPECT_EQ(passing_side(s, s.threats[0]), Vec3(0, -1, 0));
    }
}

}  // namespace
}  // namespace jink::world
