// SPDX-License-Identifier: BSD-3-Clause
// Each attempt, family and shape of a threat has a planning problem of its own in tests/scenario/problems, which uses
// it.
#include <algorithm>
#include <gtest/gtest.h>
#include <optional>
#include <string>

#include "core/geometry/sweep.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/host/problem_file.hpp"

namespace {

using namespace jink;
using namespace jink::host;
using geometric::Attempt;
using geometric::Family;
using geometry::ShapeKind;
using world::PlanStatus;

ProblemFile problem(const std::string& name)
{
    auto read = read_problem(JINK_SOURCES "/tests/scenario/problems/" + name + ".yaml");
    if (const auto* complaints = std::get_if<files::Complaints>(&read)) {
        ADD_FAILURE() << name << "\n" << test::all_of(*complaints);
        return {};
    }
    return std::get<ProblemFile>(read);
}

/// Least distance to the surfaces of the spheres along the path, sampled every 5 ms.
double least_margin(const ProblemFile& file, const path::TimedPath& path)
{
    double least = 1e9;
    for (float t = 0.0F; t <= path.duration(); t += 0.005F) {
        const Vec3 own = path::sample(path, t).position;
        for (const NamedThreat& named : file.threats) {
            const world::Threat& threat = named.threat;
            const Vec3 apart = threat.position + t * threat.velocity - own;
            least =
                std::min(least, static_cast<double>(geometry::box_distance(file.vehicle.limits.half_extents, apart) -
                                                    threat.growth.radius));
        }
    }
    return least;
}

struct Named {
    const char* file;
    std::size_t attempt;
    std::optional<Family> family;
    std::optional<ShapeKind> main_shape;  ///< of a main threat that is an obstacle
    bool moves = false;
};

class NamedProblem : public ::testing::TestWithParam<Named> {};

TEST_P(NamedProblem, IsSolvedAsItSays)
{
    const Named& named = GetParam();
    const ProblemFile file = problem(named.file);
    const auto outcome = solve_problem(file, 20'000);  // the co-processor's
    ASSERT_EQ(outcome->status, PlanStatus::found);
    EXPECT_FALSE(outcome->result.cut_short);
    EXPECT_EQ(outcome->result.attempt, named.attempt);
    EXPECT_EQ(outcome->tries, named.attempt + 1);
    const geometric::Candidate& chosen = outcome->result.candidates[outcome->result.chosen];
    if (named.family) {
        EXPECT_EQ(chosen.shape.family, *named.family);
    }
    EXPECT_GE(least_margin(file, outcome->result.path), -1e-3);
    if (named.attempt > 0) {  // without it, nothing
        ProblemFile fewer = file;
        fewer.settings.retries = static_cast<std::uint8_t>(named.attempt - 1);
        EXPECT_EQ(solve_problem(fewer, 1'000'000)->status, PlanStatus::none_available);
    }
    if (!named.main_shape) {
        return;
    }
    ASSERT_TRUE(file.main_is_obstacle);
    EXPECT_EQ(file.main_is_moving_solid, named.moves);
    const geometry::Shape& main =
        named.moves ? file.moving_solids[file.main].shape : file.obstacles[file.main].obstacle.shape;
    EXPECT_EQ(main.kind, *named.main_shape);
    // Either solid is in contact: the main one on the leg itself, the other one by some candidate.
    const auto is_hit = [&](const PlanOutcome& of, std::size_t index) {
        const auto& all = of.result.candidates;
        return std::any_of(all.begin(), all.end(), [&](const geometric::Candidate& c) {
            return c.hit.kind == world::ThreatKind::obstacle && c.hit.index == index &&
                   (c.status == geometric::CandidateStatus::hits_moving) == named.moves;
        });
    };
    EXPECT_TRUE(is_hit(*outcome, 1)) << "the one beside";
    ProblemFile straight = file;
    straight.settings.simple = straight.settings.symmetric = false;
    straight.settings.wait = true;
    straight.settings.retries = 0;
    EXPECT_TRUE(is_hit(*solve_problem(straight, 1'000'000), 0)) << "the main one";
}

INSTANTIATE_TEST_SUITE_P(
    Attempts, NamedProblem,
    ::testing::Values(Named{"attempt_slower", 1, {}, {}}, Named{"attempt_end_further", 2, {}, {}},
                      Named{"attempt_offsets_further", 3, {}, {}}, Named{"attempt_slow", 4, {}, {}},
                      Named{"attempt_plateau", 5, Family::plateau, {}}, Named{"attempt_offsets_farthest", 6, {}, {}},
                      Named{"attempt_wait", 7, Family::wait, {}}, Named{"attempt_more_planes", 8, {}, {}},
                      Named{"attempt_in_a_row", 9, Family::symmetric, {}}),
    [](const auto& tested) { return std::string(tested.param.file); });
INSTANTIATE_TEST_SUITE_P(Families, NamedProblem,
                         ::testing::Values(Named{"family_simple", 0, Family::simple, {}},
                                           Named{"family_symmetric", 0, Family::symmetric, {}},
                                           Named{"family_smooth", 0, Family::smooth, {}},
                                           Named{"family_plateau", 0, Family::plateau, {}},
                                           Named{"family_wait", 0, Family::wait, {}}),
                         [](const auto& tested) { return std::string(tested.param.file); });
INSTANTIATE_TEST_SUITE_P(Shapes, NamedProblem,
                         ::testing::Values(Named{"shape_sphere", 0, {}, ShapeKind::sphere},
                                           Named{"shape_box", 0, {}, ShapeKind::box},
                                           Named{"shape_capsule", 0, {}, ShapeKind::capsule},
                                           Named{"shape_cylinder", 0, {}, ShapeKind::cylinder},
                                           Named{"shape_hull", 0, {}, ShapeKind::hull},
                                           Named{"shape_moving_capsule", 0, {}, ShapeKind::capsule, true},
                                           Named{"shape_moving_box", 0, {}, ShapeKind::box, true}),
                         [](const auto& tested) { return std::string(tested.param.file); });

TEST(NamedProblems, EveryAttemptAndFamilyHasOne)
{
    // Families and shapes are solved in the first attempt.
    EXPECT_EQ(geometric::kAttempts.size(), 10U) << "one file for each further attempt, above";
    EXPECT_EQ(geometric::kFamilies.size(), 5U);
    EXPECT_EQ(geometric::kAttempts[7].kind, Attempt::Kind::wait);
    EXPECT_EQ(geometric::kAttempts[8].kind, Attempt::Kind::more_planes);
    EXPECT_EQ(geometric::kAttempts[9].kind, Attempt::Kind::in_a_row);
}

TEST(NamedProblems, WhatCrossesIsPassedInFrontForClosenessAndBehindForPassing)
{
    const auto chosen_of = [](const PlanOutcome& outcome) { return outcome.result.candidates[outcome.result.chosen]; };
    const auto near = solve_problem(problem("cost_closeness"), 20'000);
    const auto behind = solve_problem(problem("cost_passing"), 20'000);
    ASSERT_EQ(near->status, PlanStatus::found);
    ASSERT_EQ(behind->status, PlanStatus::found);
    // The crossing threat comes from the right, y < 0: passing behind it means there.
    EXPECT_GT(chosen_of(*near).shape.offset, 0.0F);
    EXPECT_LT(chosen_of(*behind).shape.offset, 0.0F);
    EXPECT_GT(chosen_of(*near).terms.passing, 0.5F);
    EXPECT_LT(chosen_of(*behind).terms.passing, 0.5F);
}

}  // namespace
