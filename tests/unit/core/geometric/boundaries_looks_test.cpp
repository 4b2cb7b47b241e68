// SPDX-License-Identifier: BSD-3-Clause
// Quick rejects of far threats: their tolerance is never below the error of the exact tests, from any length involved,
// and threats on their limit are checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/random.hpp"
#include "tests/unit/core/geometric/curve_bench.hpp"

namespace jink::geometric {
namespace {

using detail::Extent;
using detail::kExtentRounding;
using detail::kStraight;
using detail::MotionBound;

/// Tolerance of exact contact tests, as a share of the largest coordinates involved: 5e-7 of their sums
/// (core/geometry/sweep.hpp).
constexpr double kExactRounding = 1e-6;

struct Passing {
    float fastest = 1.0F, sphere_fastest = 0.0F, largest = 1.0F;
    Seconds duration = 10.0F;
    Vec3 apart, half;
};

/// Duration without possible contact, by the check at the beginning; verified to the last instant.
Seconds expect_room_is_left(const Passing& p)
{
    MotionBound room(p.fastest, p.sphere_fastest, p.largest, p.duration);
    room.look(p.apart, p.half, 0.0F);
    Seconds lasts = 0.0F;
    Seconds ends = p.duration;
    if (!room.lasts_until(lasts)) {
        return 0.0F;
    }
    while (std::nextafter(lasts, ends) < ends) {
        const Seconds middle = 0.5F * (lasts + ends);
        if (middle <= lasts || middle >= ends) {
            break;
        }
        (room.lasts_until(middle) ? lasts : ends) = middle;
    }
    const Eigen::Vector3d apart = p.apart.cast<double>().cwiseAbs();
    const Eigen::Vector3d half = p.half.cast<double>();
    const double closing = double(p.fastest) + double(p.sphere_fastest);
    const double gap = (apart - half).maxCoeff() - double(p.largest) - closing * double(lasts);
    const double lengths = apart.maxCoeff() + half.maxCoeff() + double(p.largest) + closing * double(p.duration);
    // A hundred times that is promised; this sum is rounded otherwise.
    EXPECT_GT(gap, 95.0 * kExactRounding * lengths)
        << p.apart.maxCoeff() << " from " << p.half.maxCoeff() << " and " << p.largest << " at " << closing;
    return lasts;
}

TEST(LookBorder, TheRoomBeforeASphereOutlastsRoundingOfEveryLength)
{
    // Each length by itself a thousand times all others.
    const Vec3 near(0.0F, 3.0F, 0.5F);
    const Vec3 half(0.5F, 0.25F, 0.5F);
    EXPECT_GT(expect_room_is_left({1.0F, 0.5F, 1.0F, 2.0F, near, half}), 0.5F);
    EXPECT_GT(expect_room_is_left({1.0F, 0.0F, 1.0F, 3000.0F, near, half}), 0.5F);
    EXPECT_GT(expect_room_is_left({0.0F, 1.0F, 1.0F, 3000.0F, near, half}), 0.5F);
    EXPECT_GT(expect_room_is_left({1.0F, 0.0F, 1000.0F, 2.0F, Vec3(0.0F, 1002.0F, 0.5F), half}), 0.5F);
    EXPECT_GT(expect_room_is_left({1.0F, 0.0F, 1.0F, 2.0F, near, Vec3(1000.0F, 0.25F, 0.5F)}), 0.5F);
    EXPECT_GT(expect_room_is_left({1000.0F, 0.0F, 1.0F, 1.0F, Vec3(0.0F, 900.0F, 0.5F), half}), 0.5F);
}

TEST(LookBorder, TheRoomBeforeASphereOutlastsRoundingOfAnything)
{
    Random random(71);
    const auto length = [&] { return std::pow(10.0F, random.uniform(-1.0F, 3.0F)); };
    unsigned seen = 0;
    for (int i = 0; i < 3000; ++i) {
        Passing p{length(),
                  length(),
                  length(),
                  length(),
                  Vec3(length(), length(), length()),
                  Vec3(length(), length(), length())};
        p.duration /= p.fastest + p.sphere_fastest;
        p.apart[static_cast<int>(random.below(3))] += p.largest + p.half.maxCoeff();
        seen += expect_room_is_left(p) > 0.0F ? 1U : 0U;
    }
    EXPECT_GT(seen, 2000U) << "mostly there is room";
}

TEST(LookBorder, NothingIsPassedOverBeforeTheFirstLook)
{
    for (const float speed : {0.0F, 1.0F}) {
        const MotionBound room(speed, 0.0F, 0.0F, 1.0F);
        EXPECT_FALSE(room.lasts_until(0.0F));
        EXPECT_FALSE(room.lasts_until(1.0F));
    }
}

TEST(LookBorder, RoomThatIsRoundingAloneLastsForNoTime)
{
    // Nothing moves and nothing has a size: all there is is the ten-thousandth of lengths that is left, to the bit.
    float room = 1e-4F;
    for (int i = 0; i < 4; ++i) {
        room = 1e-4F * (1.0F + room);
    }
    for (const float way : {0.0F, 1.0F}) {
        MotionBound look(0.0F, 0.0F, 0.0F, 1.0F);
        look.look(Vec3(0.0F, std::nextafter(room, way), 0.0F), Vec3::Zero(), 0.0F);
        EXPECT_EQ(look.lasts_until(1.0F), way > 0.0F);
        look.look(Vec3(0.0F, room, 0.0F), Vec3::Zero(), 0.0F);
        EXPECT_FALSE(look.lasts_until(1.0F));
    }
}

/// Boxes that lie `gap` from each other along one axis, `at` from the origin, the same in all others.
bool are_apart(int axis, float at, float gap, float half)
{
    Extent first{Vec3::Constant(-2.0F), Vec3::Constant(2.0F)};
    Extent second = first;
    first.low[axis] = at - 1.0F;
    first.high[axis] = at;
    second.low[axis] = at + gap;
    second.high[axis] = at + gap + 1.0F;
    const Vec3 grown = Vec3::Constant(half);
    const bool there = detail::apart(first.low, first.high, second.low, second.high, grown, 0.0F);
    EXPECT_EQ(detail::apart(second.low, second.high, first.low, first.high, grown, 0.0F), there) << axis << " " << at;
    return there;
}

TEST(LookBorder, BoxesFarOutAreApartByMoreThanRounding)
{
    // At 1 km adjacent numbers differ by 6e-5 m: bodies within a few of these may be in contact.
    for (int axis = 0; axis < 3; ++axis) {
        for (const float at : {-1000.0F, 1000.0F}) {
            EXPECT_FALSE(are_apart(axis, at, 2e-3F, 0.0F)) << axis << " " << at;
            EXPECT_TRUE(are_apart(axis, at, 3e-2F, 0.0F)) << axis << " " << at;
        }
        EXPECT_TRUE(are_apart(axis, 0.5F, 1e-3F, 0.0F)) << axis;
        EXPECT_FALSE(are_apart(axis, 0.5F, 0.5F, 0.5F)) << axis;
    }
    // A box on both sides of the origin is as large as its ends are far out.
    const Vec3 low(-1000.0F, -1.0F, -1.0F);
    const Vec3 high(1.0F, 1.0F, 1.0F);
    const Vec3 beside(1.0F + 2e-3F, -1.0F, -1.0F);
    EXPECT_FALSE(detail::apart(beside, beside, low, high, Vec3::Zero(), 0.0F));
    EXPECT_FALSE(detail::apart(-beside, -beside, -high, -low, Vec3::Zero(), 0.0F));
}

TEST(LookBorder, WhatTouchesTheRoomLeftIsNotApart)
{
    // About the origin the tolerance is the constant alone, to the bit.
    const Vec3 zero = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            Vec3 point = zero;
            point[axis] = side * kExtentRounding;
            EXPECT_FALSE(detail::apart(point, point, zero, zero, zero, 0.0F)) << axis << " " << side;
            point[axis] = side * std::nextafter(kExtentRounding, 1.0F);
            EXPECT_TRUE(detail::apart(point, point, zero, zero, zero, 0.0F)) << axis << " " << side;
        }
    }
}

std::size_t straight(const std::vector<Vec3>& points, std::size_t from = 0, const Vec3& behind = Vec3::Constant(1e3F),
                     const Vec3& along = Vec3::UnitX())
{
    std::vector<CurvePoint> timed;
    for (const Vec3& point : points) {
        timed.push_back({point, static_cast<float>(timed.size())});
    }
    const detail::Curve curve = curve_through(timed, behind);
    return detail::straight_until(detail::view_of(curve), from, along);
}

TEST(LookBorder, AStraightRunEndsWhereItTurnsBack)
{
    const Vec3 x = Vec3::UnitX();
    EXPECT_EQ(straight({0.0F * x, x, 3.0F * x, 2.0F * x, 1.0F * x}), 2U);
    EXPECT_EQ(straight({0.0F * x, x, 3.0F * x, 2.0F * x, 5.0F * x}), 2U) << "and does not go on from there";
    EXPECT_EQ(straight({0.0F * x, x, x, 2.0F * x}), 3U) << "standing is no turn";
}

TEST(LookBorder, AStraightRunEndsWithTheCurve)
{
    const Vec3 x = Vec3::UnitX();
    EXPECT_EQ(straight({0.0F * x, x, 2.0F * x}, 0, 3.0F * x), 2U) << "whatever lies behind its last point";
    EXPECT_EQ(straight({0.0F * x, x, 2.0F * x}, 1, 3.0F * x), 2U);
}

TEST(LookBorder, AStraightRunIsOneSegmentAtLeast)
{
    const Vec3 x = Vec3::UnitX();
    EXPECT_EQ(straight({0.0F * x, x, 2.0F * x}, 0, x, Vec3::UnitY()), 1U);
    EXPECT_EQ(straight({0.0F * x, x, 2.0F * x}, 1, x, -x), 2U);
    EXPECT_EQ(straight({0.0F * x, x, Vec3(2.0F, 1.0F, 0.0F)}), 1U);
}

TEST(LookBorder, AsFarOffAsStraightAllowsIsStraight)
{
    const Vec3 x = Vec3::UnitX();
    for (const float side : {-1.0F, 1.0F}) {
        const Vec3 within = 2.0F * x + Vec3(0.0F, side * kStraight, 0.0F);
        const Vec3 beyond = 2.0F * x + Vec3(0.0F, 0.0F, side * 1.001F * kStraight);
        EXPECT_EQ(straight({0.0F * x, x, within, 3.0F * x}), 3U);
        EXPECT_EQ(straight({0.0F * x, x, beyond, 3.0F * x}), 1U);
    }
}

TEST(LookBorder, WhatAThreatIsAtTheStartIsItMovedOnAndGrown)
{
    Scene scene;
    scene.threats = {{{Vec3(1.0F, -2.0F, 3.0F), Vec3(-4.0F, 0.5F, 2.0F)}, 1.5F, 0.25F, 0.5F}};
    scene.put_into(scene.problem);
    for (const Seconds begins : {0.0F, 0.5F, 2.0F}) {
        scene.problem.begins = begins;
        const detail::AtStart then = detail::at_start(scene.problem, scene.problem.threats[0]);
        EXPECT_EQ(then.motion.position, Vec3(1.0F - 4.0F * begins, -2.0F + 0.5F * begins, 3.0F + 2.0F * begins));
        EXPECT_EQ(then.motion.velocity, scene.threats[0].motion.velocity);
        EXPECT_EQ(then.growth.rate, 0.25F + 0.5F * begins);
        EXPECT_EQ(then.growth.acceleration, 0.5F);
        // As large later on as it grows from the first instant.
        for (const Seconds t : {0.0F, 1.0F, 4.0F}) {
            const float since = begins + t;
            EXPECT_EQ(then.growth.at(t), 1.5F + since * (0.25F + 0.25F * since));
        }
    }
}

}  // namespace
}  // namespace jink::geometric
