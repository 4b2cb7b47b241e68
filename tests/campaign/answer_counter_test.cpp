// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "toolchain/sim/bench.hpp"

namespace jink::sim {
namespace {

using world::PlanStatus;

avoid::Guidance step(PlanStatus status, std::uint8_t by = 0, bool is_new = false)
{
    avoid::Guidance guidance;
    guidance.plan_status = status;
    guidance.by = by;
    guidance.new_manoeuvre = is_new;
    return guidance;
}

StepsToAnswer after(const std::vector<avoid::Guidance>& steps)
{
    AnswerCounter counter;
    for (const avoid::Guidance& one : steps) {
        counter.note(one);
    }
    return counter.counted();
}

TEST(AnswerCounter, CountsBothEndsOfAPlan)
{
    EXPECT_EQ(after({step(PlanStatus::found, 1)}).first, 1U);
    EXPECT_EQ(after({step(PlanStatus::running), step(PlanStatus::running), step(PlanStatus::found, 1)}).first, 3U);
    EXPECT_EQ(after({step(PlanStatus::running), step(PlanStatus::found)}).first, 0U) << "found, but not flown";
}

TEST(AnswerCounter, CountsFromTheFirstPlanThroughPlansWithoutAnAnswer)
{
    const auto conflicting = [](PlanStatus status, std::uint8_t by = 0) {
        avoid::Guidance guidance = step(status, by);
        guidance.conflict.emplace();
        return guidance;
    };
    EXPECT_EQ(after({conflicting(PlanStatus::found, 1)}).from_first_plan, 1U);
    EXPECT_EQ(after({conflicting(PlanStatus::no_conflict), conflicting(PlanStatus::running),
                     conflicting(PlanStatus::none_available), conflicting(PlanStatus::no_conflict),
                     conflicting(PlanStatus::found, 1), conflicting(PlanStatus::found, 1)})
                  .from_first_plan,
              4U);
    EXPECT_EQ(
        after({conflicting(PlanStatus::running), step(PlanStatus::no_conflict), conflicting(PlanStatus::found, 1)})
            .from_first_plan,
        1U)
        << "another conflict";
    EXPECT_EQ(after({conflicting(PlanStatus::running)}).from_first_plan, 0U);
}

TEST(AnswerCounter, APlanWithoutAnAnswerOrThatIsDroppedDoesNotCount)
{
    const StepsToAnswer one = after({step(PlanStatus::running), step(PlanStatus::none_available),
                                     step(PlanStatus::running), step(PlanStatus::found, 1)});
    EXPECT_EQ(one.first, 2U);
    const StepsToAnswer dropped =
        after({step(PlanStatus::running), step(PlanStatus::no_conflict), step(PlanStatus::found, 1)});
    EXPECT_EQ(dropped.first, 1U);
}

TEST(AnswerCounter, ARenewedVelocityIsNoNewAnswerAndAReplacedPathIs)
{
    std::vector<avoid::Guidance> flight{step(PlanStatus::found, 3)};
    for (int i = 0; i < 5; ++i) {
        flight.push_back(step(PlanStatus::found, 3));
        flight.push_back(step(PlanStatus::running, 3));
    }
    EXPECT_EQ(after(flight).slowest, 1U);
    for (int i = 0; i < 3; ++i) {
        flight.push_back(step(PlanStatus::running, 3));
    }
    flight.push_back(step(PlanStatus::found, 1, true));
    EXPECT_EQ(after(flight).slowest, 5U) << "with the step that was running before";
    EXPECT_EQ(after(flight).first, 1U);
}

}  // namespace
}  // namespace jink::sim
