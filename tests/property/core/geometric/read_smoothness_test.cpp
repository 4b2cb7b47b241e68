// SPDX-License-Identifier: BSD-3-Clause
// Smoothness read from a table instead of computed: the choice is as good.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/planner.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"
#include "firmware/vehicles/uav2/cost_tables.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

namespace jink::geometric {
namespace {

using cost::tables::kDefault;

world::PlanStatus run(const RandomProblem& p, const Settings& settings, Result& result)
{
    WorkBudget budget(10'000'000);
    return solve(p.problem, settings, p.limits, p.airframe, budget, result);
}

Settings every_family(Random& random)
{
    Settings settings;
    settings.smooth = settings.plateau = settings.wait = true;
    settings.offset_rule = random.below(2) == 0 ? OffsetRule::source : OffsetRule::clearing;
    settings.check_acceleration = false;
    settings.evaluate_all = true;
    settings.check_units = 100'000'000;
    return settings;
}

/// Greatest share by which the table's smoothness may be off; 0 where it is not read.
float bound_of(const Candidate& c)
{
    const auto family = static_cast<std::size_t>(c.shape.family);
    return family < kDefault.families.size() ? kDefault.families[family].bounds.smoothness : 0.0F;
}

TEST(ReadSmoothness, IsWithinTheTablesBoundAndNothingElseChanges)
{
    static Result computed;
    static Result read;
    int chosen = 0;
    int another = 0;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
        const RandomProblem p(seed);
        Random random(seed * 31);
        Settings settings = every_family(random);
        const world::PlanStatus status = run(p, settings, computed);
        settings.tables = &kDefault;
        ASSERT_EQ(run(p, settings, read), status) << "seed " << seed;
        ASSERT_EQ(read.candidates.size(), computed.candidates.size());
        for (std::size_t i = 0; i < read.candidates.size(); ++i) {
            const Candidate& a = computed.candidates[i];
            const Candidate& b = read.candidates[i];
            // Rounding of the computed one in single precision comes on top of the bound.
            ASSERT_NEAR(b.terms.smoothness, a.terms.smoothness, (bound_of(a) + 1e-5F) * a.terms.smoothness)
                << "seed " << seed << ", candidate " << i;
            ASSERT_EQ(b.terms.time, a.terms.time) << "seed " << seed << ", candidate " << i;
            ASSERT_EQ(b.terms.closeness, a.terms.closeness) << "seed " << seed << ", candidate " << i;
        }
        if (status == world::PlanStatus::found) {
            ++chosen;
            another += read.chosen != computed.chosen ? 1 : 0;
            const auto total = [](const Result& from, std::size_t i) {
                return from.candidates[i].total + from.candidates[i].flip_penalty;
            };
            ASSERT_LE(total(computed, read.chosen), total(computed, computed.chosen) + 5e-4F) << "seed " << seed;
        }
    }
    EXPECT_GT(chosen, 500);
    std::printf("[ measured ] %d plans found, in %d of them another candidate\n", chosen, another);
}

TEST(ReadSmoothness, IsTheSameForEveryVehicle)
{
    static Result one;
    static Result other;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const RandomProblem p(seed);
        Settings settings;
        settings.tables = &kDefault;
        const world::PlanStatus status = run(p, settings, one);
        settings.tables = &cost::tables::kUav2;
        ASSERT_EQ(run(p, settings, other), status);
        ASSERT_EQ(one.chosen, other.chosen);
        for (std::size_t i = 0; i < one.candidates.size(); ++i) {
            ASSERT_EQ(one.candidates[i].total, other.candidates[i].total) << "seed " << seed;
        }
    }
}

TEST(ReadSmoothness, IsComputedWhereTheTableIsOfOtherCurves)
{
    static Result computed;
    static Result read;
    const auto same = [](Settings settings) {
        for (std::uint64_t seed = 1; seed <= 50; ++seed) {
            const RandomProblem p(seed);
            settings.tables = nullptr;
            static_cast<void>(run(p, settings, computed));
            settings.tables = &kDefault;
            static_cast<void>(run(p, settings, read));
            for (std::size_t i = 0; i < read.candidates.size(); ++i) {
                ASSERT_EQ(read.candidates[i].terms.smoothness, computed.candidates[i].terms.smoothness)
                    << "seed " << seed;
            }
        }
    };
    Settings other_number;
    other_number.waypoints = 24;
    same(other_number);
    Settings other_method;
    other_method.smoothness = cost::SmoothnessMethod::deviation;
    same(other_method);
}

}  // namespace
}  // namespace jink::geometric
