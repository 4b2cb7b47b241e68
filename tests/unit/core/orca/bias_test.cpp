// SPDX-License-Identifier: BSD-3-Clause
// Symmetry breaking and progress (G-ORCA section 10), and the slow-down of section 9.2.
#include "core/orca/bias.hpp"

#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace jink::orca {
namespace {

constexpr Seconds kTick = 0.025F;

/// To the right of an offset in the level, as 3.5 has it.
BiasNeighbour at(std::uint16_t id, const Vec3& offset)
{
    return {id, offset, offset.cross(Vec3(Vec3::UnitZ())).normalized()};
}

/// Stalled for `time` seconds without neighbours.
Bias stalled_for(Seconds time, const BiasSettings& settings = {})
{
    Bias bias(settings);
    for (int i = 0; i < static_cast<int>(time / kTick + 0.5F); ++i) {
        static_cast<void>(bias.apply(1, Vec3(1, 0, 0), Vec3::Zero(), {}, kTick));
    }
    return bias;
}

TEST(Bias, NobodyAheadChangesNothing)
{
    Bias bias;
    const Vec3 wanted(1.0F, 0.5F, 0.1F);
    EXPECT_EQ(bias.apply(1, wanted, wanted, {}, kTick).preferred, wanted);
    for (const Vec3& offset : {Vec3(-2, 0, 0), Vec3(4.01F, 0, 0), Vec3(-1.0F, 2.0F, 0.0F)}) {
        const std::vector<BiasNeighbour> others{at(2, offset)};
        EXPECT_EQ(bias.apply(1, wanted, wanted, others, kTick).preferred, wanted);
    }
}
/// H-bias: v_pref += 0.05 |v_pref| side(p).
TEST(Bias, PassesToTheRight)
{
    Bias bias;
    const std::vector<BiasNeighbour> others{at(2, Vec3(3, 0, 0))};
    const Biased biased = bias.apply(1, Vec3(2, 0, 0), Vec3(2, 0, 0), others, kTick);
    EXPECT_LT((biased.preferred - Vec3(2, -0.1F, 0)).norm(), 1e-6F);
    EXPECT_FALSE(biased.blocked);
}
TEST(Bias, TheNearestOneAheadDecides)
{
    Bias bias;
    const std::vector<BiasNeighbour> others{at(2, Vec3(3, 1, 0)), at(3, Vec3(-0.5F, 0, 0)), at(4, Vec3(1, -1, 0))};
    const Biased biased = bias.apply(1, Vec3(2, 0, 0), Vec3(2, 0, 0), others, kTick);
    EXPECT_LT((biased.preferred - Vec3(2, 0, 0) - 0.1F * others[2].side).norm(), 1e-6F);
}
/// Two vehicles head-on decide for opposite sides, and for opposite directions up and down, without a word.
TEST(Bias, IsAntisymmetric)
{
    Bias a = stalled_for(3.0F);
    Bias b = stalled_for(3.0F);
    const std::vector<BiasNeighbour> seen_by_a{at(9, Vec3(3, 0.5F, 0.2F))};
    const std::vector<BiasNeighbour> seen_by_b{at(7, Vec3(-3, -0.5F, -0.2F))};
    const Vec3 of_a = a.apply(7, Vec3(1, 0, 0), Vec3::Zero(), seen_by_a, kTick).preferred - Vec3(1, 0, 0);
    const Vec3 of_b = b.apply(9, Vec3(-1, 0, 0), Vec3::Zero(), seen_by_b, kTick).preferred - Vec3(-1, 0, 0);
    EXPECT_LT((of_a + of_b).norm(), 1e-6F);
    EXPECT_NEAR(of_a.z(), 0.2F, 1e-6F) << "the smaller id climbs";
}
/// V-bias: nothing for a second, then growing for a second to 0.2 |v_pref|.
TEST(Bias, ClimbsOnceItHasStalled)
{
    const std::vector<BiasNeighbour> others{at(2, Vec3(3, 0, 0))};
    for (const auto& [time, climb] : {std::pair{0.9F, 0.0F}, {1.475F, 0.1F}, {1.975F, 0.2F}, {4.0F, 0.2F}}) {
        Bias bias = stalled_for(time);
        const Biased biased = bias.apply(1, Vec3(0, 0, 0) + Vec3(1, 0, 0), Vec3::Zero(), others, kTick);
        EXPECT_NEAR(biased.preferred.z(), climb, 1e-3F) << time;
        Bias other = stalled_for(time);
        EXPECT_NEAR(other.apply(3, Vec3(1, 0, 0), Vec3::Zero(), others, kTick).preferred.z(), -climb, 1e-3F) << time;
    }
}
/// BLOCKED after 5 s of stalling, not before; without any neighbour too.
TEST(Bias, ReportsABlockedVehicle)
{
    Bias bias = stalled_for(4.95F);
    EXPECT_FALSE(bias.apply(1, Vec3(1, 0, 0), Vec3::Zero(), {}, kTick).blocked);
    bool blocked = false;
    for (int i = 0; i < 3; ++i) {
        blocked = bias.apply(1, Vec3(1, 0, 0), Vec3::Zero(), {}, kTick).blocked;
    }
    EXPECT_TRUE(blocked);
}
/// Time counts down again while it moves, and an hour's block is over as soon as ten seconds'.
TEST(Bias, ABlockEnds)
{
    Bias bias = stalled_for(3600.0F);
    EXPECT_EQ(bias.stalled(), 10.0F);
    const auto move = [&](float speed) { return bias.apply(1, Vec3(1, 0, 0), Vec3(speed, 0, 0), {}, kTick); };
    EXPECT_TRUE(move(0.29F).blocked);
    for (int i = 0; i < 198; ++i) {
        EXPECT_TRUE(move(0.31F).blocked) << i;
    }
    for (int i = 0; i < 4; ++i) {
        static_cast<void>(move(0.31F));
    }
    EXPECT_FALSE(move(0.31F).blocked);
    bias.reset();
    EXPECT_EQ(bias.stalled(), 0.0F);
}
/// An intentional stop is not a stall.
TEST(Bias, StandingOnPurposeIsNoStall)
{
    Bias bias;
    for (int i = 0; i < 1000; ++i) {
        const Biased biased = bias.apply(1, Vec3::Zero(), Vec3::Zero(), {}, kTick);
        ASSERT_FALSE(biased.blocked);
        ASSERT_EQ(biased.preferred, Vec3::Zero());
    }
}

TEST(SlowDown, FollowsTheOverlapAtItsRate)
{
    SlowDown slow;
    EXPECT_EQ(slow.update(std::numeric_limits<float>::infinity(), kTick), 1.0F);
    EXPECT_EQ(slow.update(1.0F, kTick), 1.0F);
    EXPECT_NEAR(slow.update(0.5F, kTick), 0.975F, 1e-6F);
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(slow.update(0.5F, kTick));
    }
    EXPECT_NEAR(slow.factor(), 0.5F, 1e-6F) << "g = rho_min / R_c";
    for (int i = 0; i < 100; ++i) {
        static_cast<void>(slow.update(0.01F, kTick));
    }
    EXPECT_NEAR(slow.factor(), 0.2F, 1e-6F) << "g_min";
    EXPECT_NEAR(slow.update(2.0F, kTick), 0.225F, 1e-6F) << "and back no faster";
    slow.reset();
    EXPECT_EQ(slow.factor(), 1.0F);
}

}  // namespace
}  // namespace jink::orca
