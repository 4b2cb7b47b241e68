// SPDX-License-Identifier: BSD-3-Clause
// Half-spaces of pairs within their regions, and which vehicles are chosen, at their edges.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/orca/agent_plane.hpp"
#include "core/orca/neighbours.hpp"

namespace jink::orca {
namespace {

/// Conflict::at_rest with a conflict region of 0.7 m, in the space where it is a sphere.
class RestPlanes : public ::testing::Test {
protected:
    RestPlanes() { settings.conflict = Conflict::at_rest; }
    HalfSpace at(float distance)
    {
        pair.position = {distance, 0, 0};
        return pair_planes(pair, settings).conflict;
    }
    Pair pair;
    PairSettings settings;
};

TEST_F(RestPlanes, OutsideNeitherClosesInByMoreThanHalfOfTheGap)
{
    const HalfSpace shared = at(0.9F);
    EXPECT_EQ(shared.normal, Vec3(-1, 0, 0));
    EXPECT_NEAR(shared.offset, -0.5F * 0.2F / 0.25F, 1e-5F);
    pair.own_velocity = {3, 1, 0};
    pair.other_velocity = {-2, 0, 0};
    EXPECT_NEAR(at(0.9F).offset, shared.offset, 1e-6F) << "it depends on the positions alone";
    pair.weights = kAlone;
    EXPECT_NEAR(at(0.9F).offset, 2.0F - 0.2F / 0.25F, 1e-5F) << "the whole gap, and its velocity as it is";
}

TEST_F(RestPlanes, WithinItIsLeftInItsTimeAndNoFasterThanTheRecovery)
{
    EXPECT_NEAR(at(0.56F).offset, 0.5F * 0.14F / 1.4F, 1e-5F) << "0.14 m too near, in 1.4 s, half of it ours";
    EXPECT_NEAR(at(0.1F).offset, 0.5F * 0.3F, 1e-5F) << "0.43 m/s would be faster than the recovery";
    pair.weights = kAlone;
    pair.other_velocity = {-2, 0, 0};
    EXPECT_NEAR(at(0.56F).offset, 2.0F + 0.1F, 1e-5F);
    EXPECT_NEAR(at(0.7F).offset, 2.0F, 1e-5F) << "at its rim";
}

/// For comparison only: at the conflict region's rim all of the answer is the original's, at the warning region's rim
/// none.
TEST(InterpolatedRamp, MixesBothAnswersByTheDepth)
{
    PairSettings settings;
    settings.ramp = Ramp::interpolated;
    settings.conflict_ratio = 0.5F;
    Pair pair;
    pair.own_velocity = {1, 0.5F, 0};
    pair.position = {0.5F, 0, 0};
    const Exit original = original_exit(pair.position, pair.own_velocity, 1.0F, settings.period);
    const HalfSpace inner = pair_plane(pair, settings);
    EXPECT_NEAR((inner.normal - original.normal).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR(inner.offset, original.normal.dot(pair.own_velocity) + 0.5F * original.depth, 1e-4F);
    pair.position = {0.75F, 0, 0};
    const Exit soon = original_exit(pair.position, pair.own_velocity, 1.0F, settings.period);
    const Vec3 change = 0.5F * soon.depth * soon.normal + 0.5F * 1.0F * Vec3(-1, 0, 0);
    const Vec3 normal = (soon.normal + Vec3(-1, 0, 0)).normalized();
    const HalfSpace half = pair_plane(pair, settings);
    EXPECT_NEAR((half.normal - normal).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR(half.offset, normal.dot(pair.own_velocity) + 0.5F * change.dot(normal), 1e-4F);
}

TEST(PairGeometry, TheSideIsAUnitVectorAlsoNearTheUpright)
{
    for (const Vec3& position : {Vec3(0, 9e-4F, 1), Vec3(0, -9e-4F, -1), Vec3(1e-4F, 0, 3), Vec3(3, 4, 0)}) {
        const Vec3 to = side(position);
        EXPECT_NEAR(to.norm(), 1.0F, 2e-7F);
        EXPECT_NEAR(to.dot(position.normalized()), 0.0F, 2e-6F);
        EXPECT_EQ(side(-position), -to);
    }
}

TEST(PairGeometry, ARangeLeavesAShorterHorizon)
{
    EXPECT_FLOAT_EQ(effective_horizon(10.0F, 2.0F, 10.0F, 1.0F, 1.0F, 1.0F), 4.0F);
    EXPECT_FLOAT_EQ(effective_horizon(10.0F, 2.0F, 10.0F, 1.0F, 1.0F, 2.0F), 2.0F) << "heights count twice";
    EXPECT_FLOAT_EQ(effective_horizon(10.0F, 2.0F, 10.0F, 1.0F, 1.0F, 0.5F), 4.0F) << "widths count as they are";
    EXPECT_FLOAT_EQ(effective_horizon(100.0F, 2.0F, 10.0F, 1.0F, 1.0F, 1.0F), 10.0F);
    EXPECT_EQ(effective_horizon(1.0F, 2.0F, 10.0F, 1.0F, 1.0F, 1.0F), 0.0F);
    EXPECT_FLOAT_EQ(reach(2.0F, 10.0F, 1.0F, 1.5F, 2.0F), 52.0F);
    EXPECT_FLOAT_EQ(reach(2.0F, 10.0F, 1.0F, 1.5F, 0.5F), 27.0F);
}

/// A neighbour of 1 m width, 2 m/s, with an equal own vehicle: a conflict is possible within 41 m.
Neighbour at_distance(float x, std::uint32_t id = 1)
{
    Neighbour n;
    n.position = {x, 0, 0};
    n.id = id;
    return n;
}
Selection selected(const std::vector<Neighbour>& all, const NeighbourSettings& settings = {})
{
    WorkBudget budget(1'000'000);
    return select(settings, all, budget);
}

TEST(NeighbourEdges, WhoCanJustNotBeMetIsLeftOut)
{
    EXPECT_TRUE(selected({at_distance(41.0F)}).chosen.empty());
    EXPECT_EQ(selected({at_distance(40.99F)}).chosen.size(), 1U);
    NeighbourSettings near;
    near.range = 20.0F;
    EXPECT_EQ(selected({at_distance(20.0F)}, near).chosen.size(), 1U) << "beyond the range nobody is looked at";
    EXPECT_EQ(selected({at_distance(20.0F)}, near).horizon, 10.0F);
    EXPECT_TRUE(selected({at_distance(20.1F)}, near).chosen.empty());
    EXPECT_FLOAT_EQ(selected({at_distance(20.1F)}, near).horizon, 19.0F / 4.0F);
    Neighbour slow = at_distance(25.0F, 2);
    slow.max_speed = 1.0F;
    EXPECT_FLOAT_EQ(selected({at_distance(20.1F), slow}, near).horizon, 19.0F / 4.0F) << "the shorter one";
    EXPECT_FLOAT_EQ(selected({slow, at_distance(20.1F)}, near).horizon, 19.0F / 4.0F);
}

TEST(NeighbourEdges, AnAgeOfJustTheLimitIsFresh)
{
    NeighbourSettings settings;
    Neighbour n = at_distance(10.0F);
    n.age = settings.stale;
    EXPECT_EQ(pair_of(settings, Vec3::Zero(), n, 0).weights.react, kShared.react);
    EXPECT_EQ(selected({n}).stale, 0U);
    n.age = std::nextafter(settings.stale, 2.0F);
    EXPECT_EQ(pair_of(settings, Vec3::Zero(), n, 0).weights.react, kAlone.react);
    EXPECT_EQ(selected({n}).stale, 1U);
}

TEST(NeighbourEdges, AnAgeIsPartOfTheWidths)
{
    NeighbourSettings settings;
    Neighbour n = at_distance(10.0F);
    n.age = 0.5F;
    n.acceleration = 1.0F;
    const Pair pair = pair_of(settings, {1, 2, 3}, n, 9);
    EXPECT_EQ(pair.across, 1.0F);
    EXPECT_EQ(pair.upright, 1.0F);
    EXPECT_EQ(pair.own_velocity, Vec3(1, 2, 3));
    EXPECT_EQ(pair.source, 9U);
    n.age = 100.0F;
    EXPECT_EQ(pair_of(settings, Vec3::Zero(), n, 0).across, 1.0F);
    settings.own_id = 5;
    EXPECT_FALSE(pair_of(settings, Vec3::Zero(), n, 0).above);
    n.id = 6;
    EXPECT_TRUE(pair_of(settings, Vec3::Zero(), n, 0).above);
}

TEST(NeighbourEdges, TheMostUrgentComesFirstAndTiesGoById)
{
    Neighbour wide = at_distance(10.0F, 1);
    wide.half_width = wide.half_height = 5.0F;  // 4.5 m between them
    const std::vector<Neighbour> two{at_distance(8.0F, 2), wide};
    EXPECT_EQ(selected(two).chosen[0], 1U);
    for (const bool rising : {true, false}) {
        std::vector<Neighbour> many;
        for (std::uint32_t i = 0; i <= kMaxOrcaNeighbours; ++i) {
            const std::uint32_t id = rising ? i + 1 : static_cast<std::uint32_t>(kMaxOrcaNeighbours) + 1 - i;
            many.push_back(at_distance(20.0F, id));
        }
        const Selection out = selected(many);
        ASSERT_EQ(out.chosen.size(), kMaxOrcaNeighbours);
        EXPECT_EQ(out.truncated, 1U);
        for (std::size_t k = 0; k < out.chosen.size(); ++k) {
            EXPECT_EQ(many[out.chosen[k]].id, k + 1) << rising;
        }
    }
}

/// The cap for one that is left out.
TEST(NeighbourEdges, TheCapKeepsClearOfWhoIsLeftOut)
{
    const auto cap = [](const Neighbour& last, NeighbourSettings settings = {}) {
        std::vector<Neighbour> many(kMaxOrcaNeighbours, at_distance(1.0F, 1));
        for (std::size_t i = 0; i < many.size(); ++i) {
            many[i].id = static_cast<std::uint32_t>(i + 1);
            many[i].cooperative = false;
            many[i].half_height = last.half_height;
        }
        many.push_back(last);
        const Selection out = selected(many, settings);
        EXPECT_EQ(out.truncated, 1U);
        return out.speed_cap;
    };
    EXPECT_FLOAT_EQ(cap(at_distance(31.0F, 99)), 1.0F) << "30 m in 10 s, less its own 2 m/s";
    EXPECT_FLOAT_EQ(cap(at_distance(21.0F, 99)), 1.0F) << "where that is nothing, half of the gap";
    EXPECT_FLOAT_EQ(cap(at_distance(11.0F, 99)), 0.5F);
    EXPECT_EQ(cap(at_distance(0.5F, 99)), 0.0F) << "never below standing still";
    Neighbour alone = at_distance(21.0F, 99);
    alone.cooperative = false;
    EXPECT_EQ(cap(alone), 0.0F) << "it caps nothing for us";
    // A region that is taller than wide shrinks heights: the horizontal distance is unchanged.
    Neighbour tall = at_distance(31.0F, 99);
    tall.half_height = 1.5F;
    EXPECT_FLOAT_EQ(cap(tall), 1.0F);
    // A flat one stretches heights threefold: with 4 m of half width, (0.5 + 4) / (0.5 + 1) = 3.
    Neighbour flat = at_distance(4.5F + 90.0F, 99);
    flat.half_width = 4.0F;
    flat.half_height = 1.0F;
    EXPECT_FLOAT_EQ(cap(flat), 1.0F) << "90 m in 10 s, by a third, less 2 m/s";
}

}  // namespace
}  // namespace jink::orca
