// SPDX-License-Identifier: BSD-3-Clause
// Alejo's shorter horizon for contradicting half-spaces, compared with yielding half-spaces.
#include "tests/reference/orca/horizon_search.hpp"

#include <array>

#include <gtest/gtest.h>

#include "core/orca/agent_plane.hpp"

namespace jink::orca {
namespace {

/// Two non-cooperative neighbours from either side: at 2 m, 1 m/s each, required distance 1 m.
struct Between {
    std::array<HalfSpace, 2> planes{};

    std::span<const HalfSpace> operator()(float horizon)
    {
        PairSettings settings;
        settings.horizon = horizon;
        Pair pair;
        pair.weights = kAlone;
        for (std::size_t i = 0; i < 2; ++i) {
            const float sign = i == 0 ? 1.0F : -1.0F;
            pair.position = {2.0F * sign, 0, 0};
            pair.other_velocity = {-0.25F * sign, 0, 0};
            planes[i] = pair_plane(pair, settings);
        }
        return planes;
    }
};

TEST(HorizonSearch, FindsTheLongestThatLeavesAVelocity)
{
    // Each leaves half of 1 m / horizon - 0.25 m/s towards it: both leave something until 4 s.
    Between build;
    const std::array<Sphere, 1> sphere{{{Vec3::Zero(), 1.0F}}};
    Scratch<8> scratch;
    WorkBudget budget(100'000);
    const HorizonFound found =
        longest_horizon(build, {{}, sphere, {0.5F, 0, 0}, Vec3::Zero()}, 0.5F, 10.0F, scratch.view(), budget);
    EXPECT_NEAR(found.horizon, 4.0F, 9.5F / 256.0F);
    EXPECT_LE(found.horizon, 4.0F + 1e-3F);
    EXPECT_EQ(found.solution.status, 0U);
    EXPECT_NEAR(found.solution.velocity.x(), 0.5F * (1.0F / found.horizon - 0.25F), 1e-5F);
    // Yielding half-spaces report the violation instead: x >= 0.05 and x <= -0.05 with 5 s, without cooperation.
    const Solution relaxed = solve({build(5.0F), sphere, {0.5F, 0, 0}, Vec3::Zero()}, scratch.view(), budget);
    EXPECT_EQ(relaxed.status, kRelaxedWarning);
    EXPECT_NEAR(relaxed.broken[3], 0.05F, 1e-5F);
}

TEST(HorizonSearch, TheLongestWhereItDoesAndNoneWhereNoneDoes)
{
    Between build;
    const std::array<Sphere, 1> sphere{{{Vec3::Zero(), 1.0F}}};
    Scratch<8> scratch;
    WorkBudget budget(100'000);
    const Problem problem{{}, sphere, {0.5F, 0, 0}, Vec3::Zero()};
    EXPECT_EQ(longest_horizon(build, problem, 0.5F, 3.0F, scratch.view(), budget).horizon, 3.0F);
    const HorizonFound none = longest_horizon(build, problem, 5.0F, 10.0F, scratch.view(), budget);
    EXPECT_EQ(none.horizon, 0.0F);
    EXPECT_EQ(none.solution.status, kRelaxedWarning);
}

}  // namespace
}  // namespace jink::orca
