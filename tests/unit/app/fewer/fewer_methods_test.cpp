// SPDX-License-Identifier: BSD-3-Clause
// The co-processor built with reach sets alone: accepted parameters and flown manoeuvres.
#include <algorithm>

#include <gtest/gtest.h>

#include "firmware/app/reach_sets.hpp"
#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

static_assert(!kHasGeometric && kHasReach && !kHasReciprocal, "this program is built with reach sets alone");

constexpr float kReachAlone = 2.0F;

void set_methods(StepBench& bench, float value)
{
    bench.wire.in.params.unchecked_push_back({});
    link::ParamRequest& request = bench.wire.in.params.back();
    constexpr std::string_view kName = "JNK_METHODS";
    request.kind = link::ParamRequestKind::set;
    std::copy(kName.begin(), kName.end(), request.name.begin());
    request.value = value;
    request.value_finite = true;
}

/// A mast ahead on the leg, until the co-processor asks for control.
std::unique_ptr<StepBench> before_a_mast(bool without_reach_sets)
{
    auto bench = std::make_unique<StepBench>();
    if (without_reach_sets) {
        bench->coprocessor.leave_out_reach_sets();
    }
    for (int i = 0; i < 350 && !bench->last.guidance.wants_control; ++i) {
        if (i % 10 == 0) {
            bench->hear_mast(7, Vec3(0.4F, 40.0F, 50.0F));
        }
        bench->fly(1);
    }
    EXPECT_TRUE(bench->last.guidance.wants_control);
    return bench;
}

TEST(FewerMethods, TheInitialMethodsAreThoseOfTheBuild)
{
    EXPECT_EQ(Parameters().get(Param::methods), kReachAlone);
    EXPECT_EQ(kBuiltMethods, static_cast<unsigned>(kReachAlone));
}

TEST(FewerMethods, SetsWithAMethodThatIsLeftOutAreRefused)
{
    Parameters parameters;
    for (const float value : {1.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F}) {
        EXPECT_EQ(parameters.set(Param::methods, value), ParamStatus::not_built) << value;
    }
    EXPECT_EQ(parameters.set(Param::methods, 8.0F), ParamStatus::out_of_range);
    EXPECT_EQ(parameters.set(Param::methods, kReachAlone), ParamStatus::ok);
    ParamValues values = parameters.values();
    values[static_cast<std::size_t>(Param::methods)] = 5.0F;
    values[static_cast<std::size_t>(Param::lookahead)] = 11.0F;
    EXPECT_EQ(parameters.set_each(values), 1U) << "the others of a set are taken";
    EXPECT_EQ(parameters.get(Param::lookahead), 11.0F);
    EXPECT_EQ(parameters.get(Param::methods), kReachAlone);
}

TEST(FewerMethods, ARefusalIsAnsweredWithTheValueThatHoldsAndSaid)
{
    StepBench bench;
    bench.fly(5);
    set_methods(bench, 5.0F);
    bench.fly(1);
    ASSERT_EQ(bench.wire.params.size(), 1U);
    EXPECT_EQ(bench.wire.params[0].value, kReachAlone);
    EXPECT_EQ(bench.counted().params_refused, 1U);
    EXPECT_EQ(bench.said("jink: JNK_METHODS refused, method not built in"), 1);
    set_methods(bench, kReachAlone);
    bench.fly(1);
    EXPECT_EQ(bench.counted().params_set, 1U);
    EXPECT_EQ(bench.said("jink: JNK_METHODS refused, method not built in"), 1);
}

TEST(FewerMethods, TheSetsAreThoseThatTheBuildNames) { EXPECT_EQ(&reach_sets(), &reach::kDefaultReducedSets); }

TEST(FewerMethods, ReachSetsPlanByThemselves)
{
    const auto bench = before_a_mast(false);
    ASSERT_NE(bench->coprocessor.flying(), nullptr);
    EXPECT_EQ(bench->coprocessor.flying()->by, kReach);
    EXPECT_GT(bench->coprocessor.supervisor_diagnostics().plans_found, 0U);
}

TEST(FewerMethods, WithoutItsOnlyMethodTheCoProcessorBrakes)
{
    const auto bench = before_a_mast(true);
    EXPECT_EQ(bench->last.guidance.kind, world::ManoeuvreKind::brake);
    EXPECT_EQ(bench->coprocessor.supervisor_diagnostics().plans, 0U) << "damaged sets are never asked";
    EXPECT_EQ(bench->said("jink: reach sets damaged, left out"), 1);
}

}  // namespace
}  // namespace jink::app::test
