// SPDX-License-Identifier: BSD-3-Clause
// Predictions by random commands, against a vehicle flown in double in steps of a fifth of a millisecond.
#include "core/orca/prediction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.hpp"

namespace jink::orca {
namespace {

constexpr std::int64_t kStep = 200;  // [us], and all times are multiples of it

Vec3 random_vector(Random& random, float most)
{
    return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

/// The state at `at`, stepped: in each step the newest command that acts. Before any, the measured velocity.
struct Flown {
    Eigen::Vector3d position;
    Eigen::Vector3d velocity;
    bool uncovered = false;
};
Flown fly(const vehicle::VehicleState& measured, const std::vector<IssuedCommand>& issued, std::int64_t act, double lag,
          std::int64_t at)
{
    Flown flown{measured.position.cast<double>(), measured.velocity.cast<double>(), false};
    const double dt = 1e-6 * static_cast<double>(kStep);
    const double kept = lag > 0.0 ? std::exp(-dt / lag) : 0.0;
    for (std::int64_t t = measured.stamp.us; t < at; t += kStep) {
        const IssuedCommand* acting = nullptr;
        for (const IssuedCommand& command : issued) {
            acting = command.issued.us + act <= t ? &command : acting;
        }
        flown.uncovered = flown.uncovered || acting == nullptr;
        const Eigen::Vector3d goal = acting != nullptr ? acting->velocity.cast<double>().eval() : flown.velocity;
        flown.position += goal * dt + (flown.velocity - goal) * lag * (1.0 - kept);
        flown.velocity = goal + (flown.velocity - goal) * kept;
    }
    return flown;
}

TEST(PredictionLaws, IsWhatTheVehicleFlies)
{
    double worst = 0.0;
    int clipped = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        Random random(seed);
        const auto time = [&](std::uint64_t most) { return static_cast<std::int64_t>(random.below(most)) * kStep; };
        // Some hours after start, at odd times.
        std::int64_t t = 10'000'000'000 + time(100'000);
        std::vector<IssuedCommand> issued;
        CommandRing ring;
        const std::size_t n = random.below(60);
        for (std::size_t i = 0; i < n; ++i) {
            t += kStep + time(250);  // up to 50 ms
            issued.push_back({TimePoint{t}, random_vector(random, 10.0F)});
            ASSERT_EQ(ring.add(TimePoint{t}, issued.back().velocity), RingStatus::ok);
        }
        const std::int64_t act = time(2500);
        vehicle::VehicleState measured;
        measured.stamp = TimePoint{t - time(4000)};
        measured.position = random_vector(random, 50.0F);
        measured.velocity = random_vector(random, 10.0F);
        const std::int64_t at = measured.stamp.us + time(10'000);
        const float lag = random.below(3) == 0 ? 0.0F : random.uniform(0.01F, 0.8F);
        const VelocityLoop loop{static_cast<float>(act) * 1e-6F, lag};
        // The delay goes through float seconds: a microsecond of it may be lost.
        const Predicted p = predict(measured, ring, loop, TimePoint{at});
        const Flown flown =
            fly(measured, issued, (TimePoint{} + loop.act).us == act ? act : act - kStep, static_cast<double>(lag), at);
        const double error = (p.position.cast<double>() - flown.position).norm();
        if ((TimePoint{} + loop.act).us == act) {
            ASSERT_LT(error, 1e-4) << "seed " << seed;
            ASSERT_LT((p.velocity.cast<double>() - flown.velocity).norm(), 2e-5) << "seed " << seed;
            ASSERT_EQ(p.clipped, flown.uncovered) << "seed " << seed;
            worst = std::max(worst, error);
        } else {
            ASSERT_LT(error, 0.1) << "seed " << seed;
        }
        clipped += p.clipped ? 1 : 0;
    }
    EXPECT_GT(clipped, 20);
    EXPECT_LT(clipped, 380);
    std::printf("[ measured ] worst rounding of a prediction %.2g m\n", worst);
}

/// Predicting in two parts is predicting at once: the commands that act do not depend on where one starts.
TEST(PredictionLaws, TwoPartsAreOneWhole)
{
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        Random random(seed);
        CommandRing ring;
        for (std::int64_t i = 0; i < 40; ++i) {
            ASSERT_EQ(ring.add(TimePoint{25'000 * i}, random_vector(random, 3.0F)), RingStatus::ok);
        }
        const VelocityLoop loop{0.2F, random.uniform(0.0F, 0.3F)};
        vehicle::VehicleState measured;
        measured.stamp = TimePoint{200'000 + static_cast<std::int64_t>(random.below(300'000))};
        measured.velocity = random_vector(random, 3.0F);
        const TimePoint end{measured.stamp.us + static_cast<std::int64_t>(random.below(700'000))};
        vehicle::VehicleState half = measured;
        half.stamp = TimePoint{(measured.stamp.us + end.us) / 2};
        const Predicted first = predict(measured, ring, loop, half.stamp);
        half.position = first.position;
        half.velocity = first.velocity;
        const Predicted whole = predict(measured, ring, loop, end);
        const Predicted second = predict(half, ring, loop, end);
        ASSERT_LT((whole.position - second.position).norm(), 1e-5F) << "seed " << seed;
        ASSERT_LT((whole.velocity - second.velocity).norm(), 1e-5F) << "seed " << seed;
    }
}

}  // namespace
}  // namespace jink::orca
