// SPDX-License-Identifier: BSD-3-Clause
// Pairs and neighbours, sentence by sentence of their headers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/orca/agent_plane.hpp"
#include "core/orca/neighbours.hpp"

namespace jink::orca {
namespace {

constexpr float kNotFinite[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                -std::numeric_limits<float>::infinity()};

// --- velocity obstacles ---

/// Beside the cut-off sphere's cap the cone is left, not the sphere.
TEST(PairContract, BesideTheCapTheConeIsLeft)
{
    const Vec3 position(10, 0, 0);
    const float slope = std::sqrt(99.0F);  // of a tangent: 1 m at 10 m
    for (const float side : {-1.0F, 1.0F}) {
        // Behind the sphere's centre at the horizon, and far to its side.
        const Exit exit = nearest_exit(position, {0.99F, side * 0.5F, 0}, 1.0F, 10.0F);
        EXPECT_LT((exit.normal - Vec3(-0.1F, side * slope / 10.0F, 0)).norm(), 1e-5F);
        EXPECT_NEAR(exit.depth, 0.099F - 0.5F * slope / 10.0F, 1e-5F);
    }
    // On its cap the sphere is left.
    const Exit cap = nearest_exit(position, {0.5F, 0.02F, 0}, 1.0F, 10.0F);
    const Vec3 from_sphere(-0.5F, 0.02F, 0);
    EXPECT_LT((cap.normal - from_sphere.normalized()).norm(), 1e-5F);
    EXPECT_NEAR(cap.depth, 0.1F - from_sphere.norm(), 1e-5F);
}

/// The same velocity near the axis, over four decades of the offset: side and depth are unchanged.
TEST(PairContract, NearTheAxisTheSideOfTheVelocityIsKept)
{
    for (const Vec3& axis : {Vec3(0.6F, 0.8F, 0), Vec3(0.48F, 0.64F, 0.6F), Vec3(-0.36F, 0.48F, 0.8F)}) {
        const Vec3 across = Vec3(-axis.y(), axis.x(), 0.0F).normalized();
        for (float off = 3e-5F; off < 0.3F; off *= 3.0F) {
            const Vec3 position = 700.0F * axis;
            const Vec3 velocity = 9.0F * axis + off * across;
            const Exit exit = nearest_exit(position, velocity, 2.0F, 100.0F);
            const double sine = 2.0 / position.cast<double>().norm();
            const Eigen::Vector3d along = position.cast<double>().normalized();
            const Eigen::Vector3d left = velocity.cast<double>() - along * along.dot(velocity.cast<double>());
            const Eigen::Vector3d wanted = std::sqrt(1.0 - sine * sine) * left.normalized() - sine * along;
            EXPECT_LT((exit.normal.cast<double>() - wanted).norm(), 0.03) << off;
            EXPECT_NEAR(static_cast<double>(exit.depth), -velocity.cast<double>().dot(wanted), 1e-4) << off;
        }
    }
}

/// No side of its own below 1e-5 m/s (G-ORCA 3.2): the right one is taken.
TEST(PairContract, ASpeedAcrossOfJustTheLimitHasNoSide)
{
    EXPECT_LT(nearest_exit({10, 0, 0}, {2, 1e-5F, 0}, 1.0F, 10.0F).normal.y(), 0.0F);
    EXPECT_GT(nearest_exit({10, 0, 0}, {2, 1.01e-5F, 0}, 1.0F, 10.0F).normal.y(), 0.0F);
}

/// Centres that are a micrometre apart have a direction (G-ORCA 3.5: coincident below).
TEST(PairContract, CentresOfAMicrometreHaveADirection)
{
    EXPECT_EQ(separating({1e-6F, 0, 0}, 1e-6F, Vec3::Zero(), 0.1F, true).normal, Vec3(-1, 0, 0));
    const Vec3 nearer(0.9e-6F, 0, 0);
    EXPECT_EQ(separating(nearer, nearer.norm(), Vec3::Zero(), 0.1F, true).normal, Vec3(0, 0, 1));
    EXPECT_EQ(separating(nearer, nearer.norm(), Vec3::Zero(), 0.1F, false).normal, Vec3(0, 0, -1));
    EXPECT_FLOAT_EQ(separating({3, 4, 0}, 5.0F, {1, 2, 0}, 0.5F, true).depth, 0.5F + 2.2F);
    Pair pair;
    PairSettings settings;
    settings.ramp = Ramp::interpolated;
    pair.position = {1e-6F, 0, 0};
    EXPECT_NEAR(pair_plane(pair, settings).offset, 0.5F * 1.0F / settings.period, 1e-2F) << "apart in a period";
    pair.position = nearer;
    EXPECT_NEAR(pair_plane(pair, settings).offset, 0.5F * settings.ramp_speed, 1e-5F);
}

/// Conflict::present: outside, the half-space of optimal reciprocal avoidance of the smaller region.
TEST(PairContract, PresentIsTheSmallerRegionsHalfSpace)
{
    Pair pair;
    pair.position = {3, 0.2F, 0.1F};
    pair.own_velocity = {0.6F, 0.1F, 0};
    pair.other_velocity = {-0.4F, 0, 0.05F};
    pair.source = 9;
    PairSettings settings;
    settings.horizon = 5.0F;
    settings.conflict_ratio = 0.6F;
    const Vec3 velocity = pair.own_velocity - pair.other_velocity;
    const Exit exit = nearest_exit(pair.position, velocity, 0.6F, 5.0F);
    ASSERT_GT(exit.depth, 0.0F);
    for (const Weights& weights : {kShared, kAlone}) {
        pair.weights = weights;
        const HalfSpace plane = pair_planes(pair, settings).conflict;
        EXPECT_LT((plane.normal - exit.normal).norm(), 1e-6F);
        EXPECT_NEAR(plane.offset, exit.normal.dot(pair.own_velocity) + weights.react * exit.depth, 1e-6F);
        EXPECT_EQ(plane.source, 9U);
        EXPECT_EQ(plane.level, Level::conflict);
    }
}

/// At its rim both formulations agree: no jump on entering a region.
TEST(PairContract, NothingJumpsAtTheRims)
{
    for (const Conflict conflict : {Conflict::present, Conflict::at_rest}) {
        Pair pair;
        pair.own_velocity = {0.5F, 0.2F, -0.1F};
        pair.other_velocity = {-0.1F, 0.1F, 0};
        PairSettings settings;
        settings.conflict = conflict;
        const auto at = [&](float distance) {
            pair.position = distance * Vec3(0.6F, 0, 0.8F);
            return pair_planes(pair, settings);
        };
        for (const float rim : {1.0F, 0.7F}) {
            const PairPlanes in = at(rim * (1.0F - 1e-6F));
            const PairPlanes out = at(rim * (1.0F + 1e-6F));
            // A cone of half a right angle less the square root of 2e-6: 1.4e-3 of the speed.
            EXPECT_NEAR(in.conflict.offset, out.conflict.offset, 1e-3F) << rim;
            EXPECT_NEAR(in.warning.offset, out.warning.offset, 1e-3F) << rim;
            EXPECT_LT((in.conflict.normal - out.conflict.normal).norm(), 3e-3F) << rim;
        }
    }
}

/// Both sides of a pair get mirrored half-spaces, to the bit, for any shape, inside and outside the regions.
TEST(PairContract, BothSidesAreMirrored)
{
    for (const float upright : {1.0F, 0.5F, 1.5F}) {
        for (const float distance : {0.3F, 0.8F, 1.2F, 5.0F}) {
            Pair mine;
            mine.upright = upright;
            mine.position = distance * Vec3(0.48F, 0.64F, 0.6F);
            mine.own_velocity = {0.5F, -0.25F, 0.125F};
            mine.other_velocity = -mine.own_velocity;
            mine.above = true;
            Pair other = mine;
            other.position = -mine.position;
            std::swap(other.own_velocity, other.other_velocity);
            other.above = false;
            for (const Conflict conflict : {Conflict::present, Conflict::at_rest}) {
                PairSettings settings;
                settings.conflict = conflict;
                const PairPlanes a = pair_planes(mine, settings);
                const PairPlanes b = pair_planes(other, settings);
                EXPECT_EQ(a.conflict.normal, Vec3(-b.conflict.normal));
                EXPECT_EQ(a.conflict.offset, b.conflict.offset);
                EXPECT_EQ(a.warning.normal, Vec3(-b.warning.normal));
                EXPECT_EQ(a.warning.offset, b.warning.offset);
                EXPECT_EQ(a.distance, b.distance);
                EXPECT_EQ(pair_plane(mine, settings).offset, a.warning.offset);
                EXPECT_EQ(pair_plane(mine, settings).normal, a.warning.normal);
            }
        }
    }
}

TEST(PairContract, ARangeBoundsTheHorizonByTheClosingSpeed)
{
    EXPECT_FLOAT_EQ(effective_horizon(10.0F, 2.0F, 10.0F, 0.5F, 0.5F, 1.0F), 8.0F) << "8 m at 1 m/s";
    EXPECT_EQ(effective_horizon(1.0F, 1.0F, 10.0F, 0.0F, 0.0F, 1.0F), 10.0F) << "nobody closes in";
    EXPECT_FLOAT_EQ(effective_horizon(10.0F, 2.0F, 10.0F, 0.0F, 2.0F, 1.0F), 4.0F) << "the other one alone";
}

// --- neighbours ---

Neighbour ahead(float x, std::uint32_t id)
{
    Neighbour n;
    n.position = {x, 0, 0};
    n.id = id;
    return n;
}

TEST(NeighbourContract, EveryFieldThatIsNoneIsRefused)
{
    const auto select_one = [](const Neighbour& n) {
        WorkBudget budget(1000);
        const std::vector<Neighbour> all{n, ahead(6, 2)};
        const Selection out = select({}, all, budget);
        EXPECT_EQ(out.chosen.size() + out.refused, 2U);
        return out.refused;
    };
    EXPECT_EQ(select_one(ahead(5, 1)), 0U);
    for (float Neighbour::*member : {&Neighbour::half_width, &Neighbour::half_height, &Neighbour::max_speed,
                                     &Neighbour::acceleration, &Neighbour::age}) {
        Neighbour n = ahead(5, 1);
        n.*member = 0.0F;
        EXPECT_EQ(select_one(n), 0U) << "0 is a number";
        for (const float bad : {kNotFinite[0], kNotFinite[1], kNotFinite[2], -0.1F}) {
            n.*member = bad;
            EXPECT_EQ(select_one(n), 1U) << bad;
        }
    }
    for (const float bad : kNotFinite) {
        for (int axis = 0; axis < 3; ++axis) {
            Neighbour n = ahead(5, 1);
            n.position[axis] = bad;
            EXPECT_EQ(select_one(n), 1U);
            n = ahead(5, 1);
            n.velocity[axis] = bad;
            EXPECT_EQ(select_one(n), 1U);
        }
    }
}

/// Of those that are left out the least cap counts, whether they came before or after those that are kept.
TEST(NeighbourContract, TheLeastCapOfThoseLeftOutCounts)
{
    std::vector<Neighbour> near;
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours; ++i) {
        near.push_back(ahead(2.0F, i + 1));
    }
    Neighbour fast = ahead(33.0F, 100);  // leaves 3.2 - 3.1
    fast.max_speed = 3.1F;
    const std::vector<Neighbour> far{fast, ahead(31.0F, 101), ahead(35.0F, 102)};
    const auto cap = [](std::vector<Neighbour> first, const std::vector<Neighbour>& then) {
        first.insert(first.end(), then.begin(), then.end());
        WorkBudget budget(10'000);
        const Selection out = select({}, first, budget);
        EXPECT_EQ(out.truncated, 3U);
        EXPECT_EQ(out.chosen.size(), kMaxOrcaNeighbours);
        return out.speed_cap;
    };
    const std::vector<Neighbour> reversed(far.rbegin(), far.rend());
    for (const auto& others : {far, reversed}) {
        EXPECT_NEAR(cap(near, others), 0.1F, 1e-5F);
        EXPECT_NEAR(cap(others, near), 0.1F, 1e-5F);
    }
}

/// Each checked neighbour costs work units; with a budget for only some the speed is capped at zero.
TEST(NeighbourContract, ABudgetForSomeIsStandstill)
{
    const std::vector<Neighbour> all{ahead(5, 1), ahead(6, 2), ahead(7, 3)};
    std::uint32_t needed = 0;
    for (std::uint32_t units = 0; units < 100; ++units) {
        WorkBudget budget(units);
        const Selection out = select({}, all, budget);
        EXPECT_EQ(out.exhausted, out.chosen.size() < 3) << units;
        EXPECT_EQ(out.speed_cap == 0.0F, out.exhausted) << units;
        needed = out.exhausted ? units + 1 : needed;
    }
    EXPECT_EQ(needed % 3, 0U) << "as much for each";
    EXPECT_GT(needed, 0U);
}

/// Height and width of both, each with its own cover and age.
TEST(NeighbourContract, SizesOfBothAreAddedUp)
{
    NeighbourSettings own;
    own.half_width = 0.7F;
    own.half_height = 0.2F;
    own.cover = 1.5F;
    Neighbour n = ahead(5, 1);
    n.half_width = 0.4F;
    n.half_height = 0.3F;
    n.velocity = {1, 2, 3};
    const Pair pair = pair_of(own, {4, 5, 6}, n, 2);
    EXPECT_FLOAT_EQ(pair.across, 1.5F * 1.1F);
    EXPECT_FLOAT_EQ(pair.upright, 1.5F * 0.5F);
    EXPECT_EQ(pair.position, Vec3(5, 0, 0));
    EXPECT_EQ(pair.own_velocity, Vec3(4, 5, 6));
    EXPECT_EQ(pair.other_velocity, Vec3(1, 2, 3));
    n.cooperative = false;
    EXPECT_EQ(pair_of(own, {4, 5, 6}, n, 2).weights.react, 1.0F);
}

}  // namespace
}  // namespace jink::orca
