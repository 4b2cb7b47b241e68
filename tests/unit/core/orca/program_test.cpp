// SPDX-License-Identifier: BSD-3-Clause
// Velocity programs: the check vectors of the G-ORCA specification, section 17 (G1 - G9), statuses, refusals.
#include "core/orca/program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

constexpr std::uint32_t kProgramPlenty = 1'000'000;
constexpr float kProgramExact = 2e-6F;

void expect_vector_near(const Vec3& a, const Vec3& b, float tolerance = kProgramExact)
{
    EXPECT_NEAR(a.x(), b.x(), tolerance);
    EXPECT_NEAR(a.y(), b.y(), tolerance);
    EXPECT_NEAR(a.z(), b.z(), tolerance);
}

HalfSpace plane(const Vec3& q, const Vec3& normal, Level level = Level::warning)
{
    HalfSpace out;
    out.normal = normal;
    out.offset = q.dot(normal);
    out.level = level;
    return out;
}

Solution solve_for(const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres, const Vec3& preferred,
                   std::uint32_t units = kProgramPlenty)
{
    Scratch<64> scratch;
    WorkBudget budget(units);
    return solve({planes, spheres, preferred, Vec3::Zero()}, scratch.view(), budget);
}

const std::vector<Sphere> kTwo{{Vec3::Zero(), 2.0F}};

/// The program as in Alejo, row by row.
Optimum<float> row_by_row(const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres,
                          const Vec3& preferred)
{
    std::vector<Row> rows;
    for (const HalfSpace& p : planes) {
        rows.push_back({p.normal, p.offset});
    }
    WorkBudget budget(kProgramPlenty);
    return optimum<float>(rows, spheres, {preferred, false}, Tolerance<float>(2.0F), budget);
}

void expect_solved(const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres, const Vec3& preferred,
                   const Vec3& expected, float tolerance = kProgramExact)
{
    const Solution solution = solve_for(planes, spheres, preferred);
    EXPECT_EQ(solution.status, 0U);
    expect_vector_near(solution.velocity, expected, tolerance);
    const Optimum<float> incremental = row_by_row(planes, spheres, preferred);
    EXPECT_EQ(incremental.found, Found::optimum);
    EXPECT_EQ(incremental.satisfied, planes.size());
    expect_vector_near(incremental.x, expected, tolerance);
}

const HalfSpace kG2a = plane({0, 0.3F, 0}, {0, 1, 0});
const HalfSpace kG2b = plane({0.5F, 0, 0}, {-1, 0, 0});
const HalfSpace kG4a = plane({0, 1, 0}, {0, 1, 0});
const HalfSpace kG4b = plane({0, -1, 0}, {0, -1, 0});
const std::vector<Sphere> kG6{{Vec3::Zero(), 1.5F}, {{1.4F, 0, 0}, 0.2F}};

TEST(OrcaCheckVectors, G1) { expect_solved({plane(Vec3::Zero(), {0, 1, 0})}, kTwo, {1, -0.5F, 0}, {1, 0, 0}); }
TEST(OrcaCheckVectors, G2) { expect_solved({kG2a, kG2b}, kTwo, {1, -0.5F, 0.2F}, {0.5F, 0.3F, 0.2F}); }
TEST(OrcaCheckVectors, G3)
{
    const HalfSpace third = plane({0, 0, 0.4F}, {0, 0.6F, 0.8F});
    EXPECT_NEAR(third.offset, 0.32F, kProgramExact);
    expect_solved({kG2a, kG2b, third}, kTwo, {1, -0.5F, 0.2F}, {0.5F, 0.3F, 0.2F});
}
TEST(OrcaCheckVectors, G4)
{
    EXPECT_EQ(row_by_row({kG4a, kG4b}, kTwo, {1, 0, 0}).satisfied, 1U);
    const Solution solution = solve_for({kG4a, kG4b}, kTwo, {1, 0, 0});
    EXPECT_EQ(solution.status, kRelaxedWarning);
    EXPECT_EQ(solution.level, Level::warning);
    EXPECT_NEAR(solution.broken[3], 1.0F, 1e-5F);
    expect_vector_near(solution.velocity, {1, 0, 0}, 1e-5F);  // not (0, 0, 0), which would lose all progress
}
TEST(OrcaCheckVectors, G5)
{
    const HalfSpace hard = plane({-1, 0, 0}, {1, 0, 0}, Level::conflict);
    EXPECT_EQ(row_by_row({hard, kG4a, kG4b}, kTwo, {-2, 0, 0}).satisfied, 2U);
    const Solution solution = solve_for({hard, kG4a, kG4b}, kTwo, {-2, 0, 0});
    EXPECT_EQ(solution.status, kRelaxedWarning);
    EXPECT_EQ(solution.broken[2], 0.0F);
    EXPECT_NEAR(solution.broken[3], 1.0F, 1e-5F);
    expect_vector_near(solution.velocity, {-1, 0, 0}, 1e-5F);
}
TEST(OrcaCheckVectors, G6) { expect_solved({}, kG6, {3, 0.5F, 0}, {1.489286F, 0.178964F, 0}); }
TEST(OrcaCheckVectors, G7)
{
    expect_solved({plane({0, 0.05F, 0}, {0, 1, 0})}, kG6, {3, -0.5F, 0}, {1.499166F, 0.05F, 0});
}
TEST(OrcaCheckVectors, G8)
{
    const std::vector<HalfSpace> planes{plane({0.6F, 0, 0}, {-0.8F, 0, 0.6F}), plane({0, 0.2F, 0}, {0, 0.8F, 0.6F}),
                                        plane({0, 0, -0.1F}, {0.6F, 0, -0.8F}), plane({-0.2F, -0.4F, 0}, {0, 1, 0})};
    expect_solved(planes, kTwo, {1.5F, -0.7F, 0.3F}, {1.182353F, -0.382353F, 0.776471F});
}
TEST(OrcaCheckVectors, G9)
{
    const std::vector<HalfSpace> planes{plane({0, 0, 1}, {0, 0, 1}), plane({0, 0, -1}, {0, 0, -1}),
                                        plane({1, 0, 0}, {1, 0, 0}), plane({-0.2F, 0, 0}, {-1, 0, 0})};
    EXPECT_EQ(row_by_row(planes, kTwo, {0.3F, 0.2F, 0.1F}).satisfied, 1U);
    const Solution solution = solve_for(planes, kTwo, {0.3F, 0.2F, 0.1F});
    EXPECT_EQ(solution.status, kRelaxedWarning);
    EXPECT_NEAR(solution.broken[3], 1.0F, 1e-5F);
    expect_vector_near(solution.velocity, {0.3F, 0.2F, 0}, 2e-4F);  // the shift against rounding is 1e-4
}

TEST(Program, NamesTheHalfSpacesThatHold)
{
    const HalfSpace idle = plane({0, 0, -1.5F}, {0, 0, 1});
    const Solution solution = solve_for({idle, kG2b, kG2a}, kTwo, {1, -0.5F, 0.2F});
    ASSERT_EQ(solution.actives, 2);
    EXPECT_EQ(solution.active[0] + solution.active[1], 3);  // the second and the third
    EXPECT_EQ(solve_for({idle}, kTwo, {1, 0, 0}).actives, 0);
}

TEST(Program, EachLevelGivesWayForThoseBeforeIt)
{
    const auto clash = [](Level level, float gap) {
        return std::vector<HalfSpace>{plane({0, gap, 0}, {0, 1, 0}, level), plane({0, -gap, 0}, {0, -1, 0}, level)};
    };
    const auto joined = [](std::vector<HalfSpace> a, const std::vector<HalfSpace>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
    };
    const HalfSpace soft = plane({0.5F, 0, 0}, {1, 0, 0}, Level::warning);

    Solution solution = solve_for(joined(clash(Level::conflict, 0.25F), {soft}), kTwo, {0, 0, 1});
    EXPECT_EQ(solution.status, kRelaxedConflict);
    EXPECT_EQ(solution.level, Level::conflict);
    EXPECT_NEAR(solution.broken[2], 0.25F, 1e-5F);
    EXPECT_EQ(solution.broken[3], 0.0F);
    expect_vector_near(solution.velocity, {0.5F, 0, 1}, 2e-4F);

    solution = solve_for(joined(joined(clash(Level::obstacles, 0.5F), clash(Level::conflict, 0.25F)),
                                joined({soft}, clash(Level::warning, 0.75F))),
                         kTwo, {0, 0, 1});
    EXPECT_EQ(solution.status, kRelaxedObstacle | kRelaxedConflict | kRelaxedWarning);
    EXPECT_EQ(solution.level, Level::obstacles);
    EXPECT_NEAR(solution.broken[1], 0.5F, 1e-4F);
    EXPECT_NEAR(solution.broken[2], 0.25F, 2e-4F);
    EXPECT_NEAR(solution.broken[3], 0.75F, 3e-4F);
    EXPECT_LE(solution.velocity.norm(), 2.0F);

    // Limits never yield: the last command is flown.
    solution = solve_for(clash(Level::limits, 0.5F), kTwo, {0, 0, 1});
    EXPECT_EQ(solution.status, kInfeasibleDynamics);
    EXPECT_EQ(solution.level, Level::limits);
    EXPECT_EQ(solution.velocity, Vec3(Vec3::Zero()));
    EXPECT_NEAR(solution.broken[0], 0.5F, kProgramExact);
}

TEST(Program, WhatYieldsFasterGivesWayFarther)
{
    HalfSpace fast = kG4a;
    fast.yield = 3.0F;
    const Solution solution = solve_for({fast, kG4b}, kTwo, {1, 0.3F, 0});
    EXPECT_NEAR(solution.broken[3], 0.5F, 1e-4F);  // 2 m/s shared one to three
    EXPECT_NEAR(solution.velocity.y(), -0.5F, 3e-4F);
}

TEST(Program, SpheresThatDoNotMeetAreDynamicsThatContradict)
{
    const std::vector<Sphere> apart{{Vec3::Zero(), 1.0F}, {{3, 0, 0}, 1.0F}};
    Scratch<8> scratch;
    WorkBudget budget(kProgramPlenty);
    const Solution solution = solve({{}, apart, {1, 0, 0}, {2.5F, 0, 0}}, scratch.view(), budget);
    EXPECT_EQ(solution.status, kInfeasibleDynamics);
    EXPECT_TRUE(is_finite(solution.velocity));
}

TEST(Program, RefusesWhatIsNoNumber)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const Vec3 reference(0.4F, 0.1F, 0);
    Scratch<8> scratch;
    const auto refused = [&](const std::vector<HalfSpace>& planes, const std::vector<Sphere>& spheres,
                             const Vec3& wanted, const Vec3& last) {
        WorkBudget budget(kProgramPlenty);
        const Solution solution = solve({planes, spheres, wanted, last}, scratch.view(), budget);
        EXPECT_EQ(solution.status, kBadInput);
        EXPECT_TRUE(is_finite(solution.velocity));
        return solution.velocity;
    };
    for (const float bad : {nan, inf, -inf}) {
        EXPECT_EQ(refused({kG2a}, kTwo, {1, bad, 0}, reference), reference);
        EXPECT_LE(refused({kG2a}, kTwo, {1, 0, 0}, {0, 0, bad}).norm(), 2.0F);
        HalfSpace broken = kG2a;
        broken.offset = bad;
        EXPECT_EQ(refused({broken}, kTwo, {1, 0, 0}, reference), reference);
        broken = kG2a;
        broken.normal.z() = bad;
        EXPECT_EQ(refused({kG2b, broken}, kTwo, {1, 0, 0}, reference), reference);
        broken = kG2a;
        broken.yield = bad == inf ? 0.0F : bad;
        EXPECT_EQ(refused({broken}, kTwo, {1, 0, 0}, reference), reference);
        refused({}, {{Vec3::Zero(), bad}}, {1, 0, 0}, reference);
        refused({}, {{{bad, 0, 0}, 1.0F}}, {1, 0, 0}, reference);
    }
    HalfSpace longer = kG2a;
    longer.normal *= 2.0F;
    EXPECT_EQ(refused({longer}, kTwo, {1, 0, 0}, reference), reference);
    // Levels out of order, more half-spaces than scratch.
    EXPECT_EQ(refused({kG2a, plane({0, 0, 0}, {1, 0, 0}, Level::conflict)}, kTwo, {1, 0, 0}, reference), reference);
    EXPECT_EQ(refused(std::vector<HalfSpace>(9, kG2a), kTwo, {1, 0, 0}, reference), reference);
    EXPECT_TRUE(is_finite(refused({}, {}, {1, 0, 0}, reference)));
}

TEST(Program, OutOfWorkItTakesTheBestOfAFew)
{
    // A wall 0.1 m/s ahead, a neighbour that asks for 0.5 m/s to the left: braking breaks neither wall nor much else.
    const std::vector<HalfSpace> planes{plane({0.1F, 0, 0}, {-1, 0, 0}, Level::obstacles),
                                        plane({0, 0.5F, 0}, {0, 1, 0}, Level::conflict),
                                        plane({0, 0, 0.2F}, {0, 0, 1}, Level::warning)};
    const std::vector<Sphere> spheres{{Vec3::Zero(), 2.0F}, {{1, 0, 0}, 1.1F}};
    Scratch<8> scratch;
    for (const std::uint32_t units : {0U, 1U, 5U, 10U}) {
        WorkBudget budget(units);
        const Solution solution = solve({planes, spheres, {1.5F, 0, 0}, {1, 0, 0}}, scratch.view(), budget);
        EXPECT_EQ(solution.status, kWorkLimit | kRelaxedConflict | kRelaxedWarning) << units;
        EXPECT_EQ(solution.level, Level::conflict);
        EXPECT_EQ(solution.broken[1], 0.0F) << units;
        for (const HalfSpace& p : planes) {
            EXPECT_LE(p.violation(solution.velocity), solution.broken[static_cast<std::size_t>(p.level)] + 1e-6F);
        }
        EXPECT_LE((solution.velocity - Vec3(1, 0, 0)).norm(), 1.1F + 1e-6F);
        EXPECT_LE(budget.spent(), units);
    }
    WorkBudget budget(kProgramPlenty);
    EXPECT_EQ(solve({planes, spheres, {1.5F, 0, 0}, {1, 0, 0}}, scratch.view(), budget).status, 0U);
}

/// A known answer among many more half-spaces than hold it, in any order.
TEST(Program, OrderWithinALevelChangesNothing)
{
    std::vector<HalfSpace> planes{kG2a, kG2b};
    for (int i = 0; i < 40; ++i) {
        const float angle = 0.37F * static_cast<float>(i);
        const Vec3 normal(std::cos(angle) * 0.6F, std::sin(angle) * 0.6F, i % 2 == 0 ? 0.8F : -0.8F);
        planes.push_back(plane(Vec3(0.5F, 0.3F, 0.2F) - 0.1F * normal, normal));
    }
    for (int turn = 0; turn < 42; ++turn) {
        std::rotate(planes.begin(), planes.begin() + 1, planes.end());
        const Solution solution = solve_for(planes, kTwo, {1, -0.5F, 0.2F});
        EXPECT_EQ(solution.status, 0U);
        expect_vector_near(solution.velocity, {0.5F, 0.3F, 0.2F});
    }
}

TEST(Program, StandsStillWhereThatIsAll)
{
    // A cage of six half-spaces through 0: the feasible set in a crowd at the rim of the conflict region.
    std::vector<HalfSpace> planes;
    for (int axis = 0; axis < 3; ++axis) {
        planes.push_back(plane(Vec3::Zero(), Vec3::Unit(axis), Level::conflict));
        planes.push_back(plane(Vec3::Zero(), -Vec3::Unit(axis), Level::conflict));
    }
    const Solution solution = solve_for(planes, kTwo, {1, -0.5F, 0.2F});
    EXPECT_EQ(solution.status, 0U);
    expect_vector_near(solution.velocity, Vec3::Zero());
}

TEST(Program, IntoSpheresIsAlwaysWithin)
{
    const std::vector<Sphere> lens{{Vec3::Zero(), 1.0F}, {{1.9F, 0, 0}, 1.0F}};
    for (const Vec3& point : {Vec3(9, 9, 9), Vec3(-3, 0, 0), Vec3(0.95F, 0, 0), Vec3(1, 5, 0)}) {
        const Vec3 x = into_spheres(lens, point);
        for (const Sphere& sphere : lens) {
            EXPECT_LE((x - sphere.centre).norm(), sphere.radius + 1e-6F);
        }
    }
    EXPECT_TRUE(is_finite(into_spheres(lens, {std::nanf(""), 0, 0})));
    EXPECT_EQ(into_spheres(kTwo, {0.1F, 0.2F, 0.3F}), Vec3(0.1F, 0.2F, 0.3F));
}

}  // namespace
}  // namespace jink::orca
