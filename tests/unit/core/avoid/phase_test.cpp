// SPDX-License-Identifier: BSD-3-Clause
// The transitions of the state machine against their table.
#include "core/avoid/phase.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

TEST(Phases, AreSubStatesOfTheStates)
{
    EXPECT_EQ(state_of(Phase::watching), State::watching);
    EXPECT_EQ(state_of(Phase::giving_back), State::watching);
    EXPECT_EQ(state_of(Phase::given_up), State::watching);
    EXPECT_EQ(state_of(Phase::avoiding), State::avoiding);
    EXPECT_EQ(state_of(Phase::rejoining), State::rejoining);
    EXPECT_EQ(state_of(Phase::parallel_offset), State::rejoining);
    EXPECT_EQ(state_of(Phase::braking), State::braking);
}

TEST(Transitions, HaveOneBitEach)
{
    std::uint32_t all = 0;
    for (const Transition& t : kTransitions) {
        EXPECT_NE(t.from, t.to);
        EXPECT_EQ(all & transition_bit(t), 0U) << "twice in the table";
        all |= transition_bit(t);
    }
    EXPECT_EQ(all & kUnknownTransition, 0U);
    EXPECT_EQ(transition_bit({Phase::watching, Phase::braking}), kUnknownTransition);
}

/// A flight among random traffic, now and then towards a wall, with a method that fails now and then and control that
/// is lost now and then: every transition that its updates make.
std::uint32_t transitions_of(std::uint64_t seed)
{
    Random random(seed);
    Flight f;
    f.scene.own.position += Vec3(0, random.uniform(-8, 8), random.uniform(-4, 4));
    for (int n = 0; n < 3; ++n) {
        const Seconds meets = random.uniform(2.0F, 12.0F);
        const Vec3 velocity(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-1, 1));
        f.scene.track(f.scene.own.position + Vec3(5, 0, 0) * meets - velocity * meets, velocity, 1.5F);
    }
    if (random.below(2) == 0) {
        f.scene.obstacle(geometry::make_box(Vec3(40, 0, 30), Vec3(1, 200, 200)));
    }
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        const float angle = random.uniform(-kPi, kPi);
        out = detour(s, Vec3(0, std::cos(angle), std::sin(angle)), random.uniform(3, 12), random.uniform(20, 60));
        return random.below(3) == 0 ? PlanStatus::none_available : PlanStatus::found;
    }};
    Settings settings = quick();
    settings.patience = 2.0F;
    settings.least_control = 1.0F;
    Supervisor supervisor(settings, method);
    bool in_control = false;
    std::uint32_t made = 0;
    for (int i = 0; i < 300; ++i) {
        const Guidance g = f.update(supervisor, in_control);
        made |= g.transitions;
        // Released late, taken early, lost at times.
        in_control = random.below(100) != 0 && (g.wants_control || (in_control && random.below(10) != 0));
        const world::Way way = world::way_of(f.scene.situation());
        f.pass(in_control ? g.velocity : Vec3(way.direction * way.speed), 0.05F);
        if (in_control && g.state == State::watching && random.below(4) == 0) {
            f.scene.track(f.scene.own.position + Vec3(8, 0, 0), Vec3(-3, 0, 0));
        }
        if (random.below(100) == 0) {
            f.scene.track(f.scene.own.position + Vec3(random.uniform(-20, 20), random.uniform(-20, 20), 0),
                          Vec3(random.uniform(-3, 3), random.uniform(-3, 3), 0));
        }
        if (random.below(200) == 0) {
            f.scene.tracks.clear();
        }
    }
    return made;
}

/// Each transition of the table is made by some flight, and none that the table does not have.
TEST(Transitions, AreThoseOfTheTable)
{
    std::uint32_t made = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        made |= transitions_of(seed);
        ASSERT_EQ(made & kUnknownTransition, 0U) << "seed " << seed;
    }
    for (const Transition& t : kTransitions) {
        EXPECT_NE(made & transition_bit(t), 0U)
            << "never from " << static_cast<int>(t.from) << " to " << static_cast<int>(t.to);
    }
}

}  // namespace
}  // namespace jink::avoid
