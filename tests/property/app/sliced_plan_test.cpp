// SPDX-License-Identifier: BSD-3-Clause
// A plan that is made in slices against the same plan in one piece.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/avoid/sliced_plan.hpp"
#include "core/avoid/supervisor.hpp"
#include "core/base/random.hpp"
#include "core/geometric/planner.hpp"
#include "core/orca/planner.hpp"
#include "core/reach/planner.hpp"
#include "firmware/app/fiber_flow.hpp"
#include "firmware/app/parameters.hpp"
#include "tests/unit/core/world/same_bits.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::avoid {
namespace {

using world::test::Scene;

int cases()
{
    const char* const given = std::getenv("JINK_CASES");
    return given != nullptr ? std::atoi(given) : 150;
}

int slicings()
{
    const char* const given = std::getenv("JINK_SLICINGS");
    return given != nullptr ? std::atoi(given) : 5;
}

/// Traffic and obstacles about a leg, some of them in the way.
void draw(Random& random, Scene& scene)
{
    scene.leg(Vec3(-50, 0, 30), Vec3(150, 0, 30), 5.0F);
    scene.own.position = Vec3(0, random.uniform(-1.0F, 1.0F), 30.0F);
    scene.own.velocity = Vec3(5, 0, 0);
    scene.own.sigma_position = random.below(2) == 0 ? 0.0F : 0.2F;
    const bool crowded = random.below(10) == 0;
    const std::uint32_t tracks = crowded ? static_cast<std::uint32_t>(kMaxTracks) : random.below(8);
    for (std::uint32_t i = 0; i < tracks; ++i) {
        const float meets = random.uniform(1.5F, 8.0F);
        const Vec3 velocity(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F), random.uniform(-1.0F, 1.0F));
        const Vec3 miss(0.0F, random.uniform(-4.0F, 4.0F), random.uniform(-3.0F, 3.0F));
        world::Track& track = scene.track(scene.own.position + meets * (scene.own.velocity - velocity) + miss, velocity,
                                          random.uniform(0.5F, 2.0F));
        track.sigma_position = random.uniform(0.0F, 0.3F);
        track.sigma_velocity = random.uniform(0.0F, 0.2F);
        track.cooperative = random.below(3) == 0;
    }
    const std::uint32_t obstacles = crowded ? static_cast<std::uint32_t>(kMaxObstacles) : random.below(6);
    for (std::uint32_t i = 0; i < obstacles; ++i) {
        const Vec3 at(random.uniform(10.0F, 60.0F), random.uniform(-10.0F, 10.0F), 30.0F);
        scene.obstacle(random.below(4) == 0 ? geometry::make_box(at, Vec3(2, 1, 8)) : geometry::make_sphere(at, 2.0F));
    }
    if (random.below(3) == 0) {
        scene.airspace.has_floor = true;
        scene.airspace.floor = 5.0F;
        scene.cylinder(world::Vec2(random.uniform(10.0F, 60.0F), random.uniform(-15.0F, 15.0F)), 4.0F);
    }
}

/// The methods with the settings of a co-processor at its default parameters.
struct Methods {
    app::Configuration configuration = app::Parameters().configuration();
    geometric::Planner geometric{configuration.planner};
    reach::Planner reach{configuration.reach};
    orca::Planner orca{configuration.orca};
    Supervisor<geometric::Planner, reach::Planner, orca::Planner> all{configuration.supervisor, geometric, reach, orca};
    int which = 0;

    static world::PlanStatus plan(void* self, const Situations& situations, const Settings& settings,
                                  WorkBudget& budget, Diagnostics& diagnostics, world::Manoeuvre& out,
                                  Choice& choice) noexcept
    {
        auto& m = *static_cast<Methods*>(self);
        const world::Situation& s = m.which == 0 ? situations.inflated : situations.plain;
        switch (m.which) {
        case 0:
        case 1: return m.geometric.plan(s, budget, out);
        case 2: return m.reach.plan(s, budget, out);
        case 3: m.orca.reset(); return m.orca.plan(s, budget, out);
        default:
            m.orca.reset();
            return m.all.planning().plan(&m.all, situations, settings, budget, diagnostics, out, choice);
        }
    }
};

TEST(SlicedPlans, AreThoseInOnePieceBitForBitWhileTheTablesChange)
{
    constexpr std::uint64_t kSeed = 20261127;
    Random random(kSeed);
    const auto stack = std::make_unique<std::array<std::byte, 512 * 1024>>();
    app::FiberFlow fiber(*stack);
    const auto sliced = std::make_unique<SlicedPlan>(fiber);
    const auto methods = std::make_unique<Methods>();
    Settings settings;
    Diagnostics diagnostics;
    int found = 0;
    int slices = 0;
    int most = 0;
    for (int i = 0; i < cases(); ++i) {
        Scene scene;
        draw(random, scene);
        const world::Situation s = scene.situation();
        settings.plan_budget = random.below(3) == 0 ? settings.kept_for_next + random.below(8000) : 23000;
        for (methods->which = 0; methods->which < 5; ++methods->which) {
            const Planning planning{methods.get(), {}, {}, &Methods::plan};
            world::Manoeuvre whole;
            Choice choice;
            WorkBudget budget(settings.plan_budget);
            const Inflated inflated(s, s.rules.clearance);
            const world::PlanStatus status =
                Methods::plan(methods.get(), {inflated.situation, s}, settings, budget, diagnostics, whole, choice);
            found += status == world::PlanStatus::found ? 1 : 0;
            for (int slicing = 0; slicing < slicings(); ++slicing) {
                const std::uint32_t longest = slicing == 0 ? 1 : 1 + random.below(6000);
                sliced->begin(s, planning, settings, diagnostics);
                // What the situation views is gone from now on.
                Scene gone;
                std::swap(gone.tracks, scene.tracks);
                std::swap(gone.obstacles, scene.obstacles);
                std::swap(gone.cylinders, scene.cylinders);
                static_cast<void>(scene.situation());
                std::uint32_t spent = 0;
                int turns = 1;
                for (; !sliced->advance(1 + random.below(longest)); ++turns) {
                    spent += sliced->spent();
                }
                spent += sliced->spent();
                std::swap(gone.tracks, scene.tracks);
                std::swap(gone.obstacles, scene.obstacles);
                std::swap(gone.cylinders, scene.cylinders);
                static_cast<void>(scene.situation());
                slices += turns;
                most = std::max(most, turns);
                ASSERT_EQ(sliced->status(), status) << "seed " << kSeed << ", case " << i << ", " << methods->which;
                ASSERT_EQ(sliced->ran_out(), budget.exhausted()) << i;
                ASSERT_LE(spent, settings.plan_budget) << "case " << i << ", " << methods->which;
                if (status == world::PlanStatus::found) {
                    ASSERT_TRUE(world::test::same_bits(sliced->answer(), whole))
                        << "case " << i << ", " << methods->which;
                }
            }
        }
    }
    std::printf("[ measured ] %d plans found of %d; %d slices, %d of one plan at most; %zu bytes of stack\n", found,
                4 * cases(), slices, most, fiber.fiber().deepest());
    EXPECT_GT(found, cases() / 4);
    std::printf("[ measured ] the largest piece of work: %u units\n", sliced->largest_piece());
    EXPECT_LE(sliced->largest_piece(), WorkPerUpdate::kMinSlice);
    EXPECT_GT(most, 1000);
}

}  // namespace
}  // namespace jink::avoid
