// SPDX-License-Identifier: BSD-3-Clause
// Laws of the filter's tick over random settings, traffic, boxes and bounds. JINK_CASES and JINK_SEED are taken.
#include "core/orca/velocity_filter.hpp"

#include <gtest/gtest.h>

#include "tests/property/core/orca/random_tick.hpp"

namespace jink::orca {
namespace {

using namespace random_tick;
using geometry::oracle::case_count;
using geometry::oracle::seed_of;
using Vec3d = Eigen::Vector3d;

/// From a point to a box in the space stretched for the envelope, in doubles.
Vec3d way_to(const Box& box, const Vec3d& point, const ObstacleSettings& kept)
{
    const Vec3d offset = box.centre.cast<double>() - point;
    const Vec3d nearest = (offset.array().abs() - box.half.cast<double>().array()).max(0.0) * offset.array().sign();
    return nearest.cwiseProduct(Vec3d(1.0, 1.0, double(kept.horizontal) / double(kept.vertical)));
}

/// By how much `velocity` is faster than it may be towards a box's nearest point [m/s].
double box_broken_by(const Box& box, const Seen& tick, const Vec3& velocity)
{
    const ObstacleSettings& kept = tick.settings.obstacles;
    const Vec3d way = way_to(box, tick.input.own.position.cast<double>(), kept);
    const double distance = way.norm();
    if (distance < 1e-3) {
        return 0.0;  // within: the unit tests have it
    }
    const Vec3d scale(1.0, 1.0, double(kept.horizontal) / double(kept.vertical));
    const double margin = distance - double(kept.horizontal);
    const double most = margin >= 0.0 ? margin / double(kept.horizon)
                                      : -std::min(double(kept.recovery_speed), -margin / double(kept.recovery_time));
    const Vec3d towards = (way / distance).cwiseProduct(scale);
    return (velocity.cast<double>().dot(towards) - most) / towards.norm();
}

/// How far the envelope gets into a box within the horizon when `velocity` is flown [m], stretched; below 0: it does
/// not.
double box_entered_by(const Box& box, const Seen& tick, const Vec3& velocity)
{
    const ObstacleSettings& kept = tick.settings.obstacles;
    constexpr int kInstants = 40;
    double least = 1e9;
    for (int i = 0; i <= kInstants; ++i) {
        const double t = double(kept.horizon) * i / kInstants;
        const Vec3d at = tick.input.own.position.cast<double>() + t * velocity.cast<double>();
        least = std::min(least, way_to(box, at, kept).norm());
    }
    return double(kept.horizontal) - least;
}

TEST(VelocityFilterLaws, CommandsAreFlyableAndBreakNoMoreThanTheySay)
{
    Random random(seed_of(1));
    const std::size_t count = case_count(20'000);
    std::array<std::size_t, kLevels> relaxed{};
    double deepest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 12);
        const Decision decision = decide(tick);
        ASSERT_TRUE(is_flyable(decision, tick.settings.limits, tick.input.own.velocity)) << "case " << i;
        ASSERT_EQ(decision.status & (std::uint32_t{kBadInput} | kWorkLimit | kConfigUnsafe), 0U) << "case " << i;
        const float unsaid = 4e-6F * scale_of(tick);
        for (const HalfSpace& plane : planes_of(tick)) {
            const auto level = static_cast<std::size_t>(plane.level);
            const bool said = (decision.status & kSaid[level]) != 0;
            ASSERT_LE(plane.violation(decision.command), said ? decision.broken[level] + 2.1e-4F : unsaid)
                << "case " << i << ", level " << level;
        }
        if ((decision.status & (std::uint32_t{kRelaxedObstacle} | kCapBroken)) == 0) {
            for (const Box& box : tick.boxes) {
                const bool apart = box_entered_by(box, tick, Vec3::Zero()) <= 0.0;
                const double entered = apart ? box_entered_by(box, tick, decision.command) : 0.0;
                deepest = std::max(deepest, entered);
                ASSERT_LE(entered, 1e-3) << "case " << i;
                // Distances are exact to their resolution, the directions they leave in to its root.
                const double leaves = apart ? 0.0 : box_broken_by(box, tick, decision.command);
                ASSERT_LE(leaves, 2e-4 + 0.02 * double(decision.command.norm())) << "case " << i;
            }
        }
        for (std::size_t level = 0; level < kLevels; ++level) {
            relaxed[level] += (decision.status & kSaid[level]) != 0 ? 1U : 0U;
        }
    }
    std::printf(
        "[ measured ] %zu ticks: %zu relax obstacles, %zu conflict, %zu warning, %zu limits; boxes entered by %.2g m\n",
        count, relaxed[1], relaxed[2], relaxed[3], relaxed[0], deepest);
    EXPECT_EQ(relaxed[0], 0U);
    for (const std::size_t level : {1U, 2U, 3U}) {
        EXPECT_GT(relaxed[level], count / 100);
        EXPECT_LT(relaxed[level], count);
    }
}

/// The identity wherever the preferred velocity satisfies all constraints, near or far.
TEST(VelocityFilterLaws, WhatKeepsToEverythingIsLeftAlone)
{
    Random random(seed_of(2));
    const std::size_t count = case_count(20'000);
    std::size_t met = 0;
    std::size_t near = 0;
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 4);
        tick.settings.bias.sideways = tick.settings.bias.vertical = 0.0F;
        tick.settings.slows_down = false;
        const MotionLimits& limits = tick.settings.limits;
        const Vec3 change = in_sphere(random, 0.999F * limits.acceleration * limits.period);
        tick.input.preferred = clamped(limits, tick.input.own.velocity + change);
        const LimitSet set = limit_set(limits, tick.input.own.velocity);
        std::vector<HalfSpace> planes = planes_of(tick);
        planes.insert(planes.end(), set.half_spaces().begin(), set.half_spaces().end());
        const bool keeps = tick.input.preferred.norm() < 0.9999F * limits.max_speed &&
                           (tick.input.preferred - set.reference).norm() < set.spheres[1].radius &&
                           std::all_of(planes.begin(), planes.end(),
                                       [&](const HalfSpace& p) { return p.violation(tick.input.preferred) < 0.0F; }) &&
                           std::all_of(tick.boxes.begin(), tick.boxes.end(), [&](const Box& b) {
                               return box_broken_by(b, tick, tick.input.preferred) < -0.02F * scale_of(tick);
                           });
        const Decision decision = decide(tick);
        if (keeps && (decision.status & kObstaclePenetration) == 0) {
            ASSERT_EQ(decision.command, tick.input.preferred) << "case " << i;
            ASSERT_TRUE(decision.bindings.empty()) << "case " << i;
            ++met;
            near += planes.empty() ? 0U : 1U;
        }
    }
    std::printf("[ measured ] %zu of %zu left alone, %zu of them with half-spaces about\n", met, count, near);
    EXPECT_GE(met, count / 10);
    EXPECT_GE(near, count / 20);
}

/// A flight of several ticks twice: bit-identical, independent of another filter in between.
TEST(VelocityFilterLaws, TheSameCallsGiveTheSameAnswers)
{
    Random random(seed_of(3));
    const std::size_t count = case_count(1000);
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 8);
        tick.settings.smoothing = 1 + random.below(4);
        VelocityFilter one(tick.settings);
        VelocityFilter two(tick.settings);
        if (one.configure(tick.settings) != Unsafe::none) {
            continue;
        }
        for (std::int64_t t = 1; t < 6; ++t) {
            Seen elsewhere = random_seen(random, 8);
            const Decision a = decide(one, tick);
            VelocityFilter between(elsewhere.settings);
            static_cast<void>(decide(between, elsewhere));
            const Decision b = decide(two, tick);
            ASSERT_EQ(a.command, b.command) << "case " << i;
            ASSERT_EQ(a.status, b.status) << "case " << i;
            ASSERT_EQ(a.broken, b.broken) << "case " << i;
            ASSERT_EQ(a.work, b.work) << "case " << i;
            ASSERT_TRUE(one.issued({t * 1000}, a.command));
            ASSERT_TRUE(two.issued({t * 1000}, b.command));
            tick.input.own.velocity = a.command;
        }
    }
}

/// Tolerance between answers to the same question: an optimum among nearly parallel half-spaces is a long edge that
/// rounding does not resolve, so a few deviations are permitted, but no violations.
struct Apart {
    std::size_t far = 0;
    float worst = 0.0F;
    void add(float by)
    {
        worst = std::max(worst, by);
        far += by > 1e-3F ? 1U : 0U;
    }
    void check(const char* name, std::size_t count) const
    {
        std::printf("[ measured ] %s: %zu of %zu apart by more than 1e-3 m/s, worst %.2g m/s\n", name, far, count,
                    double(worst));
        EXPECT_LE(far, 1 + count / 500);
    }
};

TEST(VelocityFilterLaws, TheOrderOfNeighboursChangesNothing)
{
    Random random(seed_of(4));
    const std::size_t count = case_count(10'000);
    Apart apart;
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 24);
        const Decision first = decide(tick);
        for (std::size_t k = tick.neighbours.size(); k > 1; --k) {
            std::swap(tick.neighbours[k - 1], tick.neighbours[random.below(k)]);
        }
        const Decision second = decide(tick);
        ASSERT_EQ(first.status & ~kRelaxedWarning & ~kRelaxedConflict,
                  second.status & ~kRelaxedWarning & ~kRelaxedConflict)
            << "case " << i;
        ASSERT_EQ(first.nearest_id, second.nearest_id) << "case " << i;
        ASSERT_EQ(first.nearest, second.nearest) << "case " << i;
        for (std::size_t level = 0; level < kLevels; ++level) {
            ASSERT_NEAR(first.broken[level], second.broken[level], 5e-4F) << "case " << i << ", level " << level;
        }
        apart.add((first.command - second.command).norm());
    }
    apart.check("another order", count);
}

/// Both vehicles of a pair do the opposite: everything mirrored at a point, ids exchanged.
void mirror(Seen& tick)
{
    const Vec3 own = tick.input.own.position;
    tick.input.own.velocity *= -1.0F;
    tick.input.preferred *= -1.0F;
    tick.settings.own_id = 1000 - tick.settings.own_id;
    std::swap(tick.settings.limits.climb_rate, tick.settings.limits.sink_rate);
    std::swap(tick.settings.limits.climb_acceleration, tick.settings.limits.sink_acceleration);
    for (Neighbour& n : tick.neighbours) {
        n.position *= -1.0F;
        n.velocity *= -1.0F;
        n.id = 1000 - n.id;
    }
    for (Box& box : tick.boxes) {
        box.centre = own - (box.centre - own);
    }
    for (Bound& bound : tick.bounds) {
        bound.outward *= -1.0F;
    }
}

Vec3 turned(const Vec3& v) { return {-v.y(), v.x(), v.z()}; }

/// A quarter turn about the vertical.
void turn(Seen& tick)
{
    const Vec3 own = tick.input.own.position;
    tick.input.own.velocity = turned(tick.input.own.velocity);
    tick.input.preferred = turned(tick.input.preferred);
    for (Neighbour& n : tick.neighbours) {
        n.position = turned(n.position);
        n.velocity = turned(n.velocity);
    }
    for (Box& box : tick.boxes) {
        box.centre = own + turned(box.centre - own);
        std::swap(box.half.x(), box.half.y());
    }
    for (Bound& bound : tick.bounds) {
        bound.outward = turned(bound.outward);
    }
}

TEST(VelocityFilterLaws, MirroredAndTurnedTheCommandIsToo)
{
    Random random(seed_of(5));
    const std::size_t count = case_count(10'000);
    Apart mirrors;
    Apart turns;
    for (std::size_t i = 0; i < count; ++i) {
        Seen tick = random_seen(random, 12);
        const Decision decision = decide(tick);
        Seen mirrored = tick;
        mirror(mirrored);
        mirrors.add((decide(mirrored).command + decision.command).norm());
        Seen quarter = tick;
        turn(quarter);
        turns.add((decide(quarter).command - turned(decision.command)).norm());
    }
    mirrors.check("mirrored", count);
    turns.check("turned", count);
}

/// Two vehicles alone: their commands are opposite, also after a long stall.
TEST(VelocityFilterLaws, APairDoesOppositeThings)
{
    Random random(seed_of(6));
    const std::size_t count = case_count(1000);
    for (std::size_t i = 0; i < count; ++i) {
        Seen a;
        a.settings = random_settings(random);
        a.settings.limits.climb_rate = a.settings.limits.sink_rate = 0.0F;
        a.settings.limits.climb_acceleration = a.settings.limits.sink_acceleration = 0.0F;
        a.settings.own_id = 1;
        Seen b = a;
        b.settings.own_id = 2;
        VelocityFilter first(a.settings);
        VelocityFilter second(b.settings);
        const Vec3 half = i % 4 == 0 ? Vec3(0, 0, 2) : in_sphere(random, 3.0F);
        Neighbour other;
        other.half_width = a.settings.half_width;
        other.half_height = a.settings.half_height;
        other.max_speed = a.settings.limits.max_speed;
        a.input.preferred = i % 3 == 0 ? Vec3(half.normalized() * 0.5F) : in_sphere(random, other.max_speed);
        b.input.preferred = -a.input.preferred;
        Vec3 apart = 2.0F * half;
        for (int t = 0; t < 200; ++t) {
            other.position = apart;
            other.velocity = b.input.own.velocity;
            other.id = 2;
            a.neighbours = {other};
            other.position = -apart;
            other.velocity = a.input.own.velocity;
            other.id = 1;
            b.neighbours = {other};
            const Vec3 one = decide(first, a).command;
            const Vec3 two = decide(second, b).command;
            ASSERT_LE((one + two).norm(), 1e-4F) << "case " << i << ", tick " << t;
            a.input.own.velocity = one;
            b.input.own.velocity = -one;  // rounding is not let grow
            apart += (b.input.own.velocity - one) * a.settings.limits.period;
        }
    }
}

}  // namespace
}  // namespace jink::orca
