// SPDX-License-Identifier: BSD-3-Clause
// Neighbours by what they broadcast: predicted, aged, lost and gone (G-ORCA 11.4).
#include "tests/reference/orca/broadcast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.hpp"
#include "tests/unit/core/orca/flown.hpp"

namespace jink::orca {
namespace {

using namespace flown;

constexpr std::int64_t kPeriod = 25'000;  // 40 Hz

Vec3 random_vector(Random& random, float most)
{
    return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

Broadcast moving_east()
{
    Broadcast heard;
    heard.state.position = Vec3(10, 0, 2);
    heard.state.velocity = Vec3(1, 0, 0);
    return heard;
}

/// 11.4 CONST_VEL: p_j + v_j (t_eff - t_j).
TEST(NeighbourPrediction, WithoutCommandsAtConstantVelocity)
{
    const PredictedNeighbour n = predict_neighbour(moving_east(), TimePoint{500'000}, {}, 20.0F);
    EXPECT_LT((n.position - Vec3(10.5F, 0, 2)).norm(), 1e-6F);
    EXPECT_EQ(n.freshness, Freshness::fresh);
    EXPECT_NEAR(n.inflation, 0.1F * 0.5F + 0.5F * 2.0F * 0.25F, 1e-6F);
}
/// 11.4 BROADCAST: the neighbour turns, and broadcasts its commands.
TEST(NeighbourPrediction, ByItsLastCommands)
{
    Broadcast heard = moving_east();
    heard.loop.act = 0.2F;
    heard.commands.unchecked_push_back({TimePoint{-200'000}, Vec3(1, 0, 0)});
    heard.commands.unchecked_push_back({TimePoint{-100'000}, Vec3(0, 1, 0)});
    const PredictedNeighbour n = predict_neighbour(heard, TimePoint{500'000}, {}, 20.0F);
    EXPECT_LT((n.position - Vec3(10.1F, 0.4F, 2)).norm(), 1e-6F);
    EXPECT_LT((n.velocity - Vec3(0, 1, 0)).norm(), 1e-6F);
}
/// A vehicle's prediction of itself by its ring equals its neighbours' prediction.
TEST(NeighbourPrediction, IsWhatTheNeighbourPredictsOfItself)
{
    CommandRing ring;
    Broadcast heard = moving_east();
    heard.loop = {0.2F, 0.15F};
    for (int i = 0; i < 8; ++i) {
        const IssuedCommand c{TimePoint{kPeriod * (i - 8)}, Vec3(0.1F * static_cast<float>(i), 1, 0)};
        ASSERT_EQ(ring.add(c.issued, c.velocity), RingStatus::ok);
        heard.commands.unchecked_push_back(c);
    }
    const TimePoint at{300'000};
    const Predicted own = predict(heard.state, ring, heard.loop, at);
    EXPECT_EQ(own.position, predict_neighbour(heard, at, {}, 20.0F).position);
    EXPECT_EQ(own.velocity, predict_neighbour(heard, at, {}, 20.0F).velocity);
}

/// 11.4: stale after 1 s, lost after 3 s, then static, then gone.
TEST(NeighbourPrediction, AgesFromFreshToGone)
{
    const Broadcast heard = moving_east();
    const auto at = [&](double age) {
        return predict_neighbour(heard, TimePoint{static_cast<std::int64_t>(age * 1e6)}, {}, 10.0F);
    };
    EXPECT_EQ(at(1.0).freshness, Freshness::fresh);
    EXPECT_EQ(at(1.00001).freshness, Freshness::stale);
    EXPECT_EQ(at(3.0).freshness, Freshness::stale);
    EXPECT_EQ(at(3.0).velocity.x(), 1.0F);
    const PredictedNeighbour lost = at(4.0);
    EXPECT_EQ(lost.freshness, Freshness::lost);
    EXPECT_EQ(lost.velocity, Vec3::Zero());
    EXPECT_LT((lost.position - Vec3(13, 0, 2)).norm(), 1e-5F) << "stands where it would be at 3 s";
    EXPECT_NEAR(lost.inflation, 3.0F + 1.5F, 1e-4F) << "3 m, and 1.5 m/s for a second";
    // 3 m + 1.5 m/s * (t - 3 s) exceeds 10 m at 7.667 s.
    EXPECT_EQ(at(7.6).freshness, Freshness::lost);
    EXPECT_EQ(at(7.7).freshness, Freshness::gone);
}

TEST(NeighbourPrediction, InflationIsLimitedToThreeMetres)
{
    const AgeRules rules;
    EXPECT_EQ(inflation_of(0.0F, 1.5F, 2.0F, rules), 0.0F);
    EXPECT_EQ(inflation_of(-1.0F, 1.5F, 2.0F, rules), 0.0F) << "stamped later than it is wanted for";
    EXPECT_NEAR(inflation_of(1.0F, 1.5F, 2.0F, rules), 1.1F, 1e-6F);
    EXPECT_EQ(inflation_of(2.9F, 1.5F, 2.0F, rules), 3.0F);
    EXPECT_EQ(inflation_of(3.0F, 1.5F, 2.0F, rules), 3.0F);
    float before = 0.0F;
    for (int ms = 0; ms < 10'000; ms += 7) {
        const float now = inflation_of(static_cast<float>(ms) * 1e-3F, 1.5F, 0.4F, rules);
        EXPECT_GE(now, before) << ms;
        before = now;
    }
}

TEST(LostNeighbours, TheBoundHoldsUntilItIsLostAndItsSpeedFromThenOn)
{
    AgeRules rules;
    rules.lost = 3.0F;
    EXPECT_FLOAT_EQ(inflation_of(2.0F, 1.5F, 0.0F, rules), 0.2F);
    EXPECT_FLOAT_EQ(inflation_of(3.0F, 1.5F, 0.0F, rules), 0.3F);
    EXPECT_FLOAT_EQ(inflation_of(10.0F, 1.5F, 0.0F, rules), 0.3F + 7.0F * 1.5F);
    EXPECT_FLOAT_EQ(inflation_of(10.0F, 1.5F, 2.0F, rules), 3.0F + 7.0F * 1.5F);
    EXPECT_EQ(inflation_of(-1.0F, 1.5F, 2.0F, rules), 0.0F);
}

TEST(LostNeighbours, OneIsGoneWhenItsSphereIsLargerThanAllThatIsLookedAt)
{
    Broadcast heard;
    heard.state.stamp = {0};
    const AgeRules rules;
    const TimePoint at{10'000'000};
    const float sphere = inflation_of(10.0F, heard.max_speed, heard.max_acceleration, rules);
    EXPECT_EQ(predict_neighbour(heard, at, rules, sphere).freshness, Freshness::lost);
    EXPECT_EQ(predict_neighbour(heard, at, rules, std::nextafter(sphere, 0.0F)).freshness, Freshness::gone);
    EXPECT_EQ(predict_neighbour(heard, {3'000'000}, rules, 0.0F).freshness, Freshness::stale) << "lost is older";
    EXPECT_EQ(predict_neighbour(heard, {1'000'000}, rules, 0.0F).freshness, Freshness::fresh) << "stale is older";
}

/// The sphere grows about the last position until it exceeds the reach; then the neighbour is gone (G-ORCA 11.4).
TEST(LostNeighbours, ALostNeighbourIsKeptClearOfUntilItIsGone)
{
    Broadcast heard;
    heard.state.stamp = {0};
    heard.state.position = {6, 0, 0};
    heard.state.velocity = {-0.5F, 0, 0};
    const AgeRules rules;
    const float reach = 1.2F + 10.0F * 3.0F;
    Freshness freshness = Freshness::fresh;
    float slowest = 1e9F;
    for (int second = 0; freshness != Freshness::gone; ++second) {
        ASSERT_LT(second, 60);
        const PredictedNeighbour there = predict_neighbour(heard, {1'000'000LL * second}, rules, reach);
        freshness = there.freshness;
        Flown flown({}, {1, 0, 0});
        if (freshness != Freshness::gone) {
            Neighbour n = other(there.position, there.velocity);
            n.half_width += there.inflation;
            n.half_height += there.inflation;
            n.cooperative = freshness == Freshness::fresh;
            flown.neighbours = {n};
        }
        const Decision decision = flown.ticks(40);
        if (freshness == Freshness::lost) {
            EXPECT_EQ(there.velocity, Vec3::Zero());
            EXPECT_LT(decision.command.x(), 0.5F) << second;
            slowest = std::min(slowest, decision.command.x());
        } else if (freshness == Freshness::gone) {
            expect_near(decision.command, {1, 0, 0}, 1e-5F);
        }
    }
    EXPECT_LT(slowest, 0.0F);  // backs away from the growing sphere
}

/// A lost neighbour's sphere only grows, and contains every position it can reach until the limit of 3 m.
TEST(LostNeighbours, TheInflatedSphereHoldsANeighbourThatManoeuvres)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        Broadcast heard;
        heard.state.velocity = random_vector(random, 0.8F);
        const AgeRules rules{1.0F, 3.0F, random.uniform(0.0F, 0.2F), 100.0F};
        Eigen::Vector3d position = Eigen::Vector3d::Zero();
        Eigen::Vector3d velocity =
            heard.state.velocity.cast<double>() +
            random_vector(random, 1.0F).normalized().cast<double>() * static_cast<double>(rules.velocity_error);
        const Eigen::Vector3d acceleration = random_vector(random, 1.0F).normalized().cast<double>() * 2.0;
        for (int ms = 0; ms < 3000; ms += 10) {
            const PredictedNeighbour n = predict_neighbour(heard, TimePoint{1000 * std::int64_t{ms}}, rules, 1000.0F);
            ASSERT_LE((position - n.position.cast<double>()).norm(), static_cast<double>(n.inflation) + 1e-4)
                << "seed " << seed << ", " << ms << " ms";
            position += velocity * 0.01 + 0.5 * acceleration * 1e-4;
            velocity += acceleration * 0.01;
        }
    }
}

}  // namespace
}  // namespace jink::orca
