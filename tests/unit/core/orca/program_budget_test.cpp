// SPDX-License-Identifier: BSD-3-Clause
// A program's answers at the end of the budget, unspent work units, and rounding at large speeds.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "core/orca/program.hpp"
#include "tests/unit/core/orca/half_space.hpp"

namespace jink::orca {
namespace {

using test::at_least;

struct Answer {
    Solution solution;
    std::uint32_t spent = 0;
    bool exhausted = false;
};
Answer answer_of(const std::vector<HalfSpace>& planes, Spheres spheres, const Vec3& preferred, const Vec3& reference,
                 std::uint32_t units = 1'000'000)
{
    Scratch<16> scratch;
    WorkBudget budget(units);
    Answer out;
    out.solution = solve({planes, spheres, preferred, reference}, scratch.view(), budget);
    out.spent = budget.spent();
    out.exhausted = budget.exhausted();
    return out;
}

/// A partial result is kept: if the budget ends after the first half-space, that one holds.
TEST(ProgramBudget, TheBestPointSoFarIsKept)
{
    const std::array<Sphere, 1> spheres{{{Vec3::Zero(), 10.0F}}};
    const std::vector<HalfSpace> planes{at_least(Vec3::UnitX(), 1.0F), at_least(Vec3::UnitY(), 0.75F)};
    const std::uint32_t needed = answer_of(planes, spheres, Vec3::Zero(), Vec3::Zero()).spent;
    int halves = 0;
    for (std::uint32_t units = 0; units < needed; ++units) {
        const Answer answer = answer_of(planes, spheres, Vec3::Zero(), Vec3::Zero(), units);
        ASSERT_NE(answer.solution.status & kWorkLimit, 0U);
        halves += answer.solution.velocity == Vec3(1, 0, 0) ? 1 : 0;
    }
    EXPECT_GT(halves, 0);
}

/// A spent budget is reported only if spent, also if double-float does not finish.
TEST(ProgramBudget, AWorkLimitIsABudgetThatIsSpent)
{
    std::vector<HalfSpace> planes{
        at_least({0.0118558519F, 0.363487303F, -0.93152374F}, 0.154353321F, Level::obstacles),
        at_least({0.00706972042F, 0.36052835F, -0.932721496F}, 0.155091509F, Level::obstacles),
        at_least({0.00142205157F, -0.356435776F, 0.934318781F}, -0.15646565F, Level::obstacles),
        at_least({-0.00187124196F, -0.362364709F, 0.932034552F}, -0.156213552F),
        at_least({0.0104439035F, 0.346133649F, -0.93812716F}, 0.153496474F),
        at_least({-0.00856055599F, -0.356205553F, 0.934368432F}, -0.154523477F)};
    const std::array<Sphere, 2> spheres{
        {{Vec3::Zero(), 40.0F}, {{-0.105102196F, -0.0589452498F, -0.0186291505F}, 1.39221787F}}};
    const Answer answer = answer_of(planes, spheres, Vec3::Zero(), {0.398079515F, 0.252900422F, 0.064772591F});
    EXPECT_FALSE(answer.exhausted);
    EXPECT_EQ(answer.solution.status & kWorkLimit, 0U);
}

/// Empty levels cost no work units, before or after the yielding one.
TEST(ProgramBudget, EmptyLevelsCostNothing)
{
    const std::array<Sphere, 1> spheres{{{Vec3::Zero(), 10.0F}}};
    std::vector<std::uint32_t> spent;
    for (const Level level : {Level::obstacles, Level::conflict, Level::warning}) {
        std::vector<HalfSpace> planes{at_least(Vec3::UnitZ(), 1.0F, Level::limits)};
        planes.resize(8, at_least(Vec3::UnitY(), -5.0F, level));
        planes.push_back(at_least(Vec3::UnitX(), 1.0F, level));
        planes.push_back(at_least(-Vec3::UnitX(), 1.0F, level));
        const Answer answer = answer_of(planes, spheres, Vec3::Zero(), Vec3::Zero());
        EXPECT_NEAR(answer.solution.broken[static_cast<std::size_t>(level)], 1.0F, 1e-4F);
        spent.push_back(answer.spent);
    }
    EXPECT_EQ(spent[0], spent[1]);
    EXPECT_EQ(spent[1], spent[2]);
}

/// Without a sphere no sphere is read: the reference, or zero velocity.
TEST(ProgramBudget, WithoutASphereNoneIsRead)
{
    const std::array<Sphere, 2> none{{{{7, 7, 7}, 1.0F}, {{7, 7, 7}, 1.0F}}};
    const Vec3 no_number(std::numeric_limits<float>::quiet_NaN(), 0, 0);
    const Answer answer = answer_of({}, Spheres(none.data() + 1, 0), Vec3::Zero(), no_number);
    EXPECT_EQ(answer.solution.status, kBadInput);
    EXPECT_EQ(answer.solution.velocity, Vec3::Zero());
}

/// At a thousand metres per second half a millimetre is rounding, and a half-space that lacks it is not broken.
TEST(ProgramBudget, RoundingFollowsTheLargestSpeed)
{
    const std::array<Sphere, 2> spheres{{{Vec3::Zero(), 1000.0F}, {Vec3::Zero(), 1.0F}}};
    const Answer answer = answer_of({at_least(Vec3::UnitX(), 4e-4F)}, spheres, Vec3::Zero(), Vec3::Zero());
    EXPECT_EQ(answer.solution.status, 0U);
    EXPECT_EQ(answer.solution.velocity, Vec3::Zero());
    EXPECT_EQ(answer.solution.actives, 0U);
}

}  // namespace
}  // namespace jink::orca
