// SPDX-License-Identifier: BSD-3-Clause
// The fallback against a search that is thirty times as fine.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "core/avoid/fallback.hpp"
#include "core/base/random.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::test::kPlenty;

/// More margin than this is not sought [m].
constexpr float kPlentyOfRoom = 3.0F;

/// The i-th of `n` directions spread evenly over the sphere (a Fibonacci lattice).
Vec3 direction(int i, int n)
{
    const float z = 1.0F - (2.0F * static_cast<float>(i) + 1.0F) / static_cast<float>(n);
    const float azimuth = static_cast<float>(i) * kPi * (3.0F - std::sqrt(5.0F));
    const float r = std::sqrt(1.0F - z * z);
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

/// Margin to the box with rounded corners: a cube of half extent 1 m becomes a sphere.
float rounded_margin(const Flight& f, const Vec3& command)
{
    Flight inner = f;
    inner.scene.limits.half_extents.setZero();
    WorkBudget budget(kPlenty);
    return command_margin(inner.scene.situation(), command, Settings{}, budget) - f.scene.limits.half_extents.x();
}

/// Greatest least `margin(command)` of 240 directions at three speeds, and of braking.
template <class Margin>
float best_of_721(const Situation& s, Vec3& command, Margin&& margin)
{
    float best = -1e9F;
    const auto attempt = [&](const Vec3& c) {
        const float its = margin(c);
        if (its > best) {
            best = its;
            command = c;
        }
    };
    attempt(Vec3::Zero());
    for (const float share : {1.0F, 0.6F, 0.3F}) {
        for (int i = 0; i < 240; ++i) {
            attempt(vehicle::clamped_velocity(direction(i, 240), share * s.limits.cruise_speed, s.limits));
        }
    }
    return best;
}

float best_of_721(const Situation& s, Vec3& command)
{
    return best_of_721(s, command, [&](const Vec3& c) {
        WorkBudget budget(kPlenty);
        return command_margin(s, c, Settings{}, budget);
    });
}

/// Threats so near that braking alone is not clear.
Flight close_call(Random& random)
{
    Flight f;
    const float course = random.uniform(-kPi, kPi);
    f.scene.own.velocity = random.uniform(0.0F, 5.0F) * Vec3(std::cos(course), std::sin(course), 0.0F);
    f.scene.own.velocity.z() = random.uniform(-1.0F, 1.0F);
    const int count = 1 + static_cast<int>(random.below(2));
    for (int n = 0; n < count; ++n) {
        const float meets = random.uniform(0.3F, 2.5F);
        Vec3 velocity(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F), random.uniform(-3.0F, 3.0F));
        velocity *= random.below(3) == 0 ? 0.0F : 1.0F;
        const Vec3 miss(random.uniform(-1.5F, 1.5F), random.uniform(-1.5F, 1.5F), random.uniform(-1.5F, 1.5F));
        f.scene.track(f.scene.own.position + f.scene.own.velocity * meets + miss - velocity * meets, velocity,
                      random.uniform(0.5F, 2.0F));
    }
    return f;
}

TEST(FallbackAgainstAFineSearch, FindsAWayOutWhereThereIsOne)
{
    constexpr std::uint64_t kSeed = 20261121;
    Random random(kSeed);
    int tried = 0;
    int missed = 0;
    double sum = 0.0;
    float most = 0.0F;
    for (int i = 0; i < 600; ++i) {
        const Flight f = close_call(random);
        const Situation s = f.scene.situation();
        Vec3 command = Vec3::Zero();
        WorkBudget budget(kPlenty);
        const Fallback chosen = choose_fallback(s, world::way_of(s), nullptr, Settings{}, budget);
        if (chosen.kind == world::ManoeuvreKind::brake && chosen.margin >= 0.0F) {
            continue;
        }
        const float fine = best_of_721(s, command);
        const float rounded = best_of_721(s, command, [&](const Vec3& c) { return rounded_margin(f, c); });
        // The best for the rounded box is taken where it is clear of the whole box, else the best for the whole box.
        const float off = std::min(rounded, kPlentyOfRoom) - rounded_margin(f, chosen.command);
        const float behind = chosen.margin >= 0.0F ? std::min(off, std::min(fine, kPlentyOfRoom) - chosen.margin) : off;
        ++tried;
        missed += fine >= 0.1F && chosen.margin < 0.0F ? 1 : 0;
        sum += std::max(behind, 0.0F);
        most = std::max(most, behind);
        EXPECT_LT(behind, 0.4F) << "seed " << kSeed << ", case " << i << ": (" << command.x() << ", " << command.y()
                                << ", " << command.z() << ") keeps " << fine << ", chosen " << chosen.margin;
    }
    std::printf("[ measured ] %d close calls: %.4f m behind on average, %.2f m at most\n", tried, sum / tried,
                static_cast<double>(most));
    EXPECT_GT(tried, 300);
    EXPECT_EQ(missed, 0) << "seed " << kSeed;
    EXPECT_LT(sum / tried, 0.005) << "mean [m]";
}

/// A close call with threats that are known badly, so that nothing is clear.
Flight unsure_call(Random& random)
{
    Flight f = close_call(random);
    for (world::Track& track : f.scene.tracks) {
        track.sigma_position = random.uniform(0.2F, 1.0F);
        track.sigma_velocity = random.uniform(0.0F, 0.6F);
    }
    return f;
}

/// The way that is best for what is likely is taken.
TEST(FallbackAgainstAFineSearch, WhereNothingIsClearWhatIsLikelyDecides)
{
    constexpr std::uint64_t kSeed = 20261126;
    Random random(kSeed);
    int tried = 0;
    int differ = 0;
    double sum = 0.0;
    for (int i = 0; i < 600; ++i) {
        Flight f = unsure_call(random);
        Vec3 command = Vec3::Zero();
        const Situation s = f.scene.situation();
        WorkBudget budget(kPlenty);
        const Fallback chosen = choose_fallback(s, world::way_of(s), nullptr, Settings{}, budget);
        const float whole = command_margin(s, chosen.command, Settings{}, budget);
        EXPECT_EQ(chosen.margin >= 0.0F, whole >= 0.0F) << i << ": clear is told where it is, and there alone";
        if (chosen.margin >= 0.0F) {
            continue;
        }
        EXPECT_LT(best_of_721(s, command), 0.1F) << "seed " << kSeed << ", case " << i << ": something is clear";
        const Vec3 of_all = command;
        f.scene.rules.k_sigma = 1.0F;
        const auto likely_margin = [&](const Vec3& c) { return rounded_margin(f, c); };
        const float fine = best_of_721(s, command, likely_margin);
        const float behind = fine - likely_margin(chosen.command);
        EXPECT_LT(behind, 0.4F) << "seed " << kSeed << ", case " << i;
        differ += likely_margin(of_all) < fine - 0.1F ? 1 : 0;
        sum += std::max(behind, 0.0F);
        ++tried;
    }
    std::printf(
        "[ measured ] %d calls without a way out: %.4f m behind on average; in %d the way of greatest margin to "
        "all that is possible is another\n",
        tried, sum / tried, differ);
    EXPECT_GT(tried, 100);
    EXPECT_GT(differ, 10);
    EXPECT_LT(sum / tried, 0.02) << "mean [m]";
}

/// A search that ends by its budget does not swing between commands: what is flown is compared first.
TEST(FallbackAgainstAFineSearch, WithAnyBudgetTheFormerOneIsLeftForABetterOneAlone)
{
    constexpr std::uint64_t kSeed = 20261128;
    constexpr float kBetter = 0.02F - 1e-4F;
    Random random(kSeed);
    int left = 0;
    int kept = 0;
    for (int i = 0; i < 400; ++i) {
        Flight f = unsure_call(random);
        const Situation s = f.scene.situation();
        const Fallback previous{world::ManoeuvreKind::velocity,
                                vehicle::clamped_velocity(direction(static_cast<int>(random.below(240)), 240),
                                                          s.limits.cruise_speed, s.limits),
                                -1.0F};
        WorkBudget whole(kPlenty);
        static_cast<void>(choose_fallback(s, world::way_of(s), &previous, Settings{}, whole));
        WorkBudget one(kPlenty);
        static_cast<void>(command_margin(s, previous.command, Settings{}, one));
        static_cast<void>(command_margin(s, Vec3::Zero(), Settings{}, one));
        // Enough for braking and for what is flown, twice.
        const std::uint32_t units = 3 * (kPlenty - one.left()) + random.below(kPlenty - whole.left());
        WorkBudget budget(units);
        const Fallback chosen = choose_fallback(s, world::way_of(s), &previous, Settings{}, budget);
        if (chosen.margin >= 0.0F) {
            continue;
        }
        if (chosen.command == previous.command) {
            ++kept;
            continue;
        }
        f.scene.rules.k_sigma = 1.0F;
        EXPECT_GE(rounded_margin(f, chosen.command), rounded_margin(f, previous.command) + kBetter)
            << "seed " << kSeed << ", case " << i << ", budget " << units;
        ++left;
    }
    EXPECT_GT(left, 100);
    EXPECT_GT(kept, 20);
}

}  // namespace
}  // namespace jink::avoid
