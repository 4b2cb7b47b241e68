// SPDX-License-Identifier: BSD-3-Clause
// Half-spaces of pairs against the velocity obstacle's own definition, in doubles (G-ORCA specification, T2), and their
// joint guarantee.
#include "core/orca/agent_plane.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::orca {
namespace {

using Point = Eigen::Vector3d;

/// How far the moving point t v stays from the sphere about p, t in [0, horizon]: negative within the obstacle.
double clearance(const Point& p, const Point& v, double radius, double horizon)
{
    const double t = v.squaredNorm() > 0.0 ? std::clamp(v.dot(p) / v.squaredNorm(), 0.0, horizon) : 0.0;
    return (t * v - p).norm() - radius;
}

Vec3 vector(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

struct Encounter {
    Vec3 p, v;
    float radius, horizon;
};

/// Closing, passing, leaving; every fifth on the axis or upright.
Encounter random_encounter(Random& random, int i)
{
    Encounter e;
    e.radius = random.uniform(0.2F, 3.0F);
    e.horizon = random.uniform(1.0F, 15.0F);
    do {
        e.p = vector(random, 20.0F);
        if (i % 7 == 0) {
            e.p = {0, 0, e.p.z()};
        }
    } while (e.p.norm() <= e.radius * 1.001F);
    const float rate = random.uniform(0.2F, 3.0F) / e.horizon;
    e.v = e.p * rate + vector(random, 1.5F * e.radius / e.horizon + 0.3F);
    if (i % 5 == 0) {
        e.v = e.p * rate;
    }
    return e;
}

TEST(AgentPlaneLaws, TheExitIsOnTheBoundaryAndTheNearest)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    for (int i = 0; i < 20000; ++i) {
        const Encounter e = random_encounter(random, i);
        const std::string where = "seed " + std::to_string(kSeed) + ", case " + std::to_string(i) + ": |p| " +
                                  std::to_string(e.p.norm()) + " radius " + std::to_string(e.radius) + " |v| " +
                                  std::to_string(e.v.norm()) + " horizon " + std::to_string(e.horizon);
        const Exit exit = nearest_exit(e.p, e.v, e.radius, e.horizon);
        ASSERT_NEAR(static_cast<double>(exit.normal.norm()), 1.0, 1e-5) << where;
        const Point p = e.p.cast<double>();
        const Point v = e.v.cast<double>();
        const Point n = exit.normal.cast<double>();
        const double scale = 1.0 + v.norm();
        const auto clear = [&](const Point& at) {
            return clearance(p, at, static_cast<double>(e.radius), static_cast<double>(e.horizon));
        };
        const Point boundary = v + static_cast<double>(exit.depth) * n;
        // A change of the velocity by s changes the distance at t by s t: compared at the time that matters, in m/s.
        ASSERT_GT(clear(boundary + 2e-5 * scale * n), 0.0) << where;
        ASSERT_LT(clear(boundary - 2e-5 * scale * n), 0.0) << where;
        // No boundary point is nearer: a sphere of less than |depth| about v holds no change of side.
        const bool inside = clear(v) < 0.0;
        ASSERT_TRUE(inside == (exit.depth > 0.0F) || std::fabs(exit.depth) < 2e-5 * scale) << where;
        for (int k = 0; k < 8; ++k) {
            const Point way = vector(random, 1.0F).cast<double>().normalized();
            const Point at = v + way * (std::fabs(static_cast<double>(exit.depth)) * 0.99 - 2e-5 * scale);
            if (std::fabs(static_cast<double>(exit.depth)) > 1e-3 * scale) {
                ASSERT_EQ(clear(at) < 0.0, inside) << where;
            }
        }
    }
}

Pair random_pair(Random& random)
{
    Pair pair;
    pair.position = vector(random, random.below(3) == 0 ? 1.5F : 10.0F);
    pair.own_velocity = vector(random, 2.0F);
    pair.other_velocity = vector(random, 2.0F);
    pair.across = random.uniform(0.3F, 2.0F);
    pair.upright = pair.across * random.uniform(0.25F, 2.0F);
    return pair;
}

Pair mirrored(const Pair& pair)
{
    Pair out = pair;
    out.position = -pair.position;
    std::swap(out.own_velocity, out.other_velocity);
    out.above = !pair.above;
    return out;
}

TEST(AgentPlaneLaws, BothSidesHaveMirroredHalfSpaces)
{
    constexpr std::uint64_t kSeed = 20261124;
    Random random(kSeed);
    for (int i = 0; i < 20000; ++i) {
        Pair pair = random_pair(random);
        if (i % 5 == 0) {
            pair.own_velocity = pair.other_velocity + pair.position * random.uniform(0.05F, 1.0F);  // on the axis
        }
        if (i % 11 == 0) {
            pair.position = {0, 0, pair.position.z()};
        }
        if (i % 101 == 0) {
            pair.position = Vec3::Zero();
        }
        PairSettings settings;
        settings.conflict = i % 2 == 0 ? Conflict::at_rest : Conflict::present;
        const PairPlanes own = pair_planes(pair, settings);
        const PairPlanes other = pair_planes(mirrored(pair), settings);
        for (const auto& [a, b] : {std::pair{own.warning, other.warning}, std::pair{own.conflict, other.conflict}}) {
            ASSERT_EQ(a.normal, Vec3(-b.normal)) << "seed " << kSeed << ", case " << i;
            const float own_left = a.offset - a.normal.dot(pair.own_velocity);
            const float other_left = b.offset - b.normal.dot(pair.other_velocity);
            if (settings.conflict == Conflict::present || a.level == Level::warning) {
                ASSERT_NEAR(own_left, other_left, 2e-6F) << "seed " << kSeed << ", case " << i;
            } else {
                ASSERT_EQ(a.offset, b.offset) << "seed " << kSeed << ", case " << i;
            }
        }
    }
}

/// The relative velocity that both half-spaces just let pass, and some beyond: never within the obstacle.
TEST(AgentPlaneLaws, WhatBothObeyDoesNotCollide)
{
    constexpr std::uint64_t kSeed = 20261125;
    Random random(kSeed);
    int tried = 0;
    for (int i = 0; i < 20000; ++i) {
        const Pair pair = random_pair(random);
        PairSettings settings;
        settings.horizon = random.uniform(1.0F, 10.0F);
        const double stretch = static_cast<double>(pair.across / pair.upright);
        const auto stretched = [stretch](const Vec3& v) {
            return Point(static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z()) * stretch);
        };
        if (stretched(pair.position).norm() < static_cast<double>(pair.across) * 1.01) {
            continue;
        }
        ++tried;
        const HalfSpace own = pair_plane(pair, settings);
        const HalfSpace other = pair_plane(mirrored(pair), settings);
        const auto obeying = [&](const HalfSpace& plane, Vec3 v) {
            v += std::max(plane.violation(v), 0.0F) * plane.normal;
            return v;
        };
        const Vec3 x_own = obeying(own, vector(random, 3.0F));
        const Vec3 x_other = obeying(other, vector(random, 3.0F));
        const double least = clearance(stretched(pair.position), stretched(x_own - x_other),
                                       static_cast<double>(pair.across), static_cast<double>(settings.horizon));
        ASSERT_GT(least, -2e-4) << "seed " << kSeed << ", case " << i;
    }
    EXPECT_GT(tried, 10000);
}

/// Conflict::at_rest: for all obeying commands of both, after one brake time they are not within the conflict region.
TEST(AgentPlaneLaws, AtRestTheConflictRegionIsNotEnteredInOneBrakeTime)
{
    constexpr std::uint64_t kSeed = 20261126;
    Random random(kSeed);
    for (int i = 0; i < 20000; ++i) {
        Pair pair = random_pair(random);
        pair.weights = i % 3 == 0 ? kAlone : kShared;
        PairSettings settings;
        settings.conflict = Conflict::at_rest;
        settings.brake = random.uniform(0.1F, 1.0F);
        const double inner = static_cast<double>(pair.across * settings.conflict_ratio);
        const double stretch = static_cast<double>(pair.across / pair.upright);
        const auto stretched = [stretch](const Vec3& v) {
            return Point(static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z()) * stretch);
        };
        if (stretched(pair.position).norm() < inner) {
            continue;
        }
        const HalfSpace own = pair_planes(pair, settings).conflict;
        ASSERT_TRUE(pair.weights.react == 1.0F || own.violation(Vec3::Zero()) <= 0.0F);  // rest is always left
        Vec3 x_own = vector(random, 4.0F);
        x_own += std::max(own.violation(x_own), 0.0F) * own.normal;
        Vec3 x_other = pair.other_velocity;
        if (pair.weights.react != 1.0F) {
            const HalfSpace other = pair_planes(mirrored(pair), settings).conflict;
            x_other = vector(random, 4.0F);
            x_other += std::max(other.violation(x_other), 0.0F) * other.normal;
        }
        const double least =
            clearance(stretched(pair.position), stretched(x_own - x_other), inner, static_cast<double>(settings.brake));
        ASSERT_GT(least, -1e-4) << "seed " << kSeed << ", case " << i;
    }
}

/// No conflict is possible beyond the reach: exact pruning.
TEST(AgentPlaneLaws, BeyondTheReachNothingCollides)
{
    constexpr std::uint64_t kSeed = 20261127;
    Random random(kSeed);
    for (int i = 0; i < 20000; ++i) {
        const float radius = random.uniform(0.2F, 2.0F);
        const float horizon = random.uniform(1.0F, 10.0F);
        const float stretch = random.uniform(0.25F, 4.0F);
        const float own = random.uniform(0.1F, 3.0F);
        const float other = random.uniform(0.1F, 3.0F);
        const auto direction = [&] { return Vec3(vector(random, 1.0F).normalized()); };
        const Vec3 along = direction();
        const Vec3 p = along * (reach(radius, horizon, own, other, stretch) * 1.0001F);  // stretched
        // Straight at each other as fast as they can, or about so.
        const Vec3 v_own = i % 2 == 0 ? Vec3(along * own) : Vec3(direction() * own);
        const Vec3 v_other = i % 2 == 0 ? Vec3(along * -other) : Vec3(direction() * other);
        const Vec3 v = v_own - v_other;
        const Point stretched(static_cast<double>(v.x()), static_cast<double>(v.y()),
                              static_cast<double>(v.z()) * static_cast<double>(stretch));
        ASSERT_GT(clearance(p.cast<double>(), stretched, static_cast<double>(radius), static_cast<double>(horizon)),
                  0.0)
            << "seed " << kSeed << ", case " << i;
    }
}

}  // namespace
}  // namespace jink::orca
