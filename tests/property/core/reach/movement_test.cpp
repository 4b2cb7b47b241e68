// SPDX-License-Identifier: BSD-3-Clause
// The closed form of a movement against the differential equation itself; mirrors; lengths.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/random.hpp"
#include "core/reach/movement.hpp"

namespace jink::reach {
namespace {

/// x' = cos(pitch) cos(yaw), y' = cos(pitch) sin(yaw), z' = -sin(pitch) with linear angles, by Simpson's rule.
Point<double> integral(double length, double pitch, double yaw, double by_pitch, double by_yaw)
{
    constexpr int kParts = 200;
    const auto slope = [&](double s) {
        const double p = pitch + s * by_pitch;
        const double y = yaw + s * by_yaw;
        return Point<double>(std::cos(p) * std::cos(y), std::cos(p) * std::sin(y), -std::sin(p));
    };
    Point<double> sum = slope(0.0) + slope(1.0);
    for (int i = 1; i < 2 * kParts; ++i) {
        sum += (i % 2 == 0 ? 2.0 : 4.0) * slope(static_cast<double>(i) / (2.0 * kParts));
    }
    return sum * (length / (6.0 * kParts));
}

TEST(MovementLaws, ClosedFormIsTheIntegral)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    for (int i = 0; i < 20000; ++i) {
        const auto in = [&](double size) { return static_cast<double>(random.uniform(-1.0F, 1.0F)) * size; };
        const double pitch = in(1.5);
        const double yaw = in(6.0);
        // Small and equal turns too, where the closed form's quotients are 0 / 0.
        const double by_pitch = i % 5 == 0 ? 0.0 : in(i % 7 == 0 ? 1e-5 : 1.0);
        const double by_yaw = i % 3 == 0 ? by_pitch : i % 4 == 0 ? -by_pitch : in(1.0);
        const double length = static_cast<double>(random.uniform(0.1F, 20.0F));
        const Point<double> exact = integral(length, pitch, yaw, by_pitch, by_yaw);
        const Point<double> closed = arc_displacement(length, pitch, yaw, by_pitch, by_yaw);
        ASSERT_NEAR((closed - exact).norm(), 0.0, 1e-9 * length) << "seed " << kSeed << ", case " << i;
        const Point<float> single =
            arc_displacement(static_cast<float>(length), static_cast<float>(pitch), static_cast<float>(yaw),
                             static_cast<float>(by_pitch), static_cast<float>(by_yaw));
        ASSERT_NEAR((single.cast<double>() - exact).norm(), 0.0, 3e-6 * length) << "seed " << kSeed << ", case " << i;
    }
}

Movement mirrored_left_right(Movement m)
{
    const std::array<Movement, kMovements> of{Movement::straight,  Movement::right,    Movement::left,
                                              Movement::up,        Movement::down,     Movement::down_right,
                                              Movement::down_left, Movement::up_right, Movement::up_left};
    return of[static_cast<std::size_t>(m)];
}
Movement mirrored_up_down(Movement m)
{
    const std::array<Movement, kMovements> of{Movement::straight, Movement::left,      Movement::right,
                                              Movement::down,     Movement::up,        Movement::up_left,
                                              Movement::up_right, Movement::down_left, Movement::down_right};
    return of[static_cast<std::size_t>(m)];
}

TEST(MovementLaws, MirroredOrdersFlyMirroredPathsOfTheSameLength)
{
    constexpr std::uint64_t kSeed = 7;
    Random random(kSeed);
    for (int i = 0; i < 5000; ++i) {
        Pose<double> pose;
        Pose<double> aside;
        Pose<double> below;
        const int count = 1 + static_cast<int>(random.below(12));
        for (int k = 0; k < count; ++k) {
            const auto movement = static_cast<Movement>(random.below(kMovements));
            const Pose<double> next = apply(pose, movement, MovementStep<double>{});
            ASSERT_LE((next.position - pose.position).norm(), 1.0 + 1e-12) << "a chord is no longer than its arc";
            ASSERT_GE((next.position - pose.position).norm(), 0.994);
            pose = next;
            aside = apply(aside, mirrored_left_right(movement), MovementStep<double>{});
            below = apply(below, mirrored_up_down(movement), MovementStep<double>{});
        }
        ASSERT_NEAR((aside.position - pose.position.cwiseProduct(Point<double>(1, -1, 1))).norm(), 0.0, 1e-12)
            << "seed " << kSeed << ", case " << i;
        ASSERT_NEAR((below.position - pose.position.cwiseProduct(Point<double>(1, 1, -1))).norm(), 0.0, 1e-12)
            << "seed " << kSeed << ", case " << i;
        ASSERT_LE(pose.position.norm(), static_cast<double>(count) + 1e-12);
    }
}

/// Section 16.1: n movements have arc length n for any turns; with either model their chords are not longer.
TEST(MovementLaws, NMovementsAreNLong)
{
    constexpr std::uint64_t kSeed = 8;
    Random random(kSeed);
    for (int i = 0; i < 1000; ++i) {
        Pose<double> pose;
        double length = 0.0;
        double chords = 0.0;
        const int count = 1 + static_cast<int>(random.below(12));
        for (int k = 0; k < count; ++k) {
            const auto movement = static_cast<Movement>(random.below(kMovements));
            Point<double> before = pose.position;
            constexpr int kParts = 64;
            for (int n = 1; n <= kParts; ++n) {
                const Point<double> at =
                    at_share(pose, movement, static_cast<double>(n) / kParts, MovementStep<double>{}).position;
                length += (at - before).norm();
                before = at;
            }
            chords += (before - pose.position).norm();
            pose = apply(pose, movement, MovementStep<double>{});
        }
        ASSERT_NEAR(length, count, 2e-6 * count) << "seed " << kSeed << ", case " << i;
        ASSERT_LE(chords, count + 1e-12) << "seed " << kSeed << ", case " << i;
    }
}

}  // namespace
}  // namespace jink::reach
