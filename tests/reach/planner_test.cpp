// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/planner.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "core/avoid/guard.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/random_situation.hpp"
#include "tests/reach/unit_sets.hpp"

// The reach planner on random situations: what it returns must pass the check of the supervisor, which measures by
// other means, and must never touch a track that grows as world::threat_radius says.

namespace jink::reach {
namespace {

using oracle::RandomSituation;
using world::PlanStatus;

Settings unit_settings()
{
    Settings settings;
    settings.sets = &test::unit_sets();
    return settings;
}

TEST(ReachPlannerLaws, WhatIsFoundPassesTheFinalCheck)
{
    static Planner planner{unit_settings()};
    std::size_t found = 0;
    std::size_t none = 0;
    std::size_t rejected = 0;
    std::size_t emergencies = 0;
    std::array<std::size_t, 9> tries{};
    std::uint32_t most_work = 0;
    double work = 0.0;
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
        const RandomSituation s(seed);
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        const PlanStatus status = planner.plan(s.view(), budget, manoeuvre);
        most_work = std::max(most_work, budget.spent());
        work += budget.spent();
        if (status != PlanStatus::found) {
            ASSERT_EQ(status, PlanStatus::none_available) << "seed " << seed;
            ++none;
            continue;
        }
        ++found;
        emergencies += planner.last().emergency ? 1U : 0U;
        ++tries[planner.last().tries];
        const float planned = world::least_separation(s.view(), manoeuvre.path, 100.0F, budget).margin;
        ASSERT_GE(planned, -0.06F) << "seed " << seed;
        rejected += avoid::check_manoeuvre(s.view(), manoeuvre, avoid::Settings{}, budget).margin < 0.0F ? 1U : 0U;
    }
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf("[ measured ] %zu plans, %zu of them by the emergency set; %zu rejected by the final check; %zu times "
                "nothing; tries %zu %zu %zu; work mean %.0f most %u; %.1f us each\n",
                found, emergencies, rejected, none, tries[1], tries[2], tries[3], work / 5000.0, most_work,
                took / 5000.0 * 1e6);
}

}  // namespace
}  // namespace jink::reach
