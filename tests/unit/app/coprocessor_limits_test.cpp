// SPDX-License-Identifier: BSD-3-Clause
// Limits that the autopilot tells bound those of the parameters.
#include <string>

#include <gtest/gtest.h>

#include "firmware/link/mavlink/text.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

class CoprocessorLimits : public ::testing::Test {
protected:
    void SetUp() override
    {
        ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
    }

    /// The texts of the step that hears of it.
    std::vector<std::string> tell(std::string_view name, float value)
    {
        ParamValue m;
        m.param_id = wire::param_name(name);
        m.param_value = value;
        m.param_type = 9;
        f.feed(m);
        f.fly(1);
        std::vector<std::string> texts;
        for (const Statustext& text : f.said_of<Statustext>()) {
            texts.emplace_back(text_of(text.text));
        }
        return texts;
    }
    void set(std::string_view name, float value)
    {
        ParamSet m;
        m.param_id = wire::param_name(name);
        m.param_value = value;
        m.param_type = 9;
        m.target_system = wire::kSystem;
        m.target_component = wire::kUs;
        f.feed(m);
        f.fly(1);
    }
    [[nodiscard]] const Configuration& configuration() const { return f.coprocessor.parameters().configuration(); }
    [[nodiscard]] const vehicle::VehicleLimits& limits() const { return configuration().limits; }

    Flight f;
};
using Texts = std::vector<std::string>;

TEST_F(CoprocessorLimits, TheLowerOneHoldsAndOfLagsTheLonger)
{
    EXPECT_EQ(tell("WPNAV_ACCEL", 250.0F), Texts{"jink: VEH_ACC counts as 2.5, the autopilot's"});
    EXPECT_EQ(tell("WPNAV_ACCEL_Z", 100.0F), Texts{"jink: VEH_ACC_Z counts as 1.0, the autopilot's"});
    EXPECT_EQ(tell("PSC_JERK_XY", 5.0F), Texts{"jink: VEH_LAG counts as 0.6, the autopilot's"});
    EXPECT_EQ(limits().max_acceleration, 2.5F);
    EXPECT_EQ(limits().max_vertical_acceleration, 1.0F);
    EXPECT_FLOAT_EQ(limits().velocity_lag, 0.6F);
    EXPECT_EQ(limits().max_climb, 3.0F);
    EXPECT_EQ(limits().max_descent, 3.0F);
    EXPECT_EQ(tell("WPNAV_ACCEL", 250.0F), Texts{}) << "nothing new";
    EXPECT_EQ(tell("WPNAV_ACCEL", 900.0F),
              (Texts{"jink: VEH_ACC counts as 5.0 again", "jink: VEH_LAG counts as 1.9, the autopilot's"}))
        << "it flies harder than the parameter allows, and with the same jerk later";
    EXPECT_EQ(limits().max_acceleration, 5.0F);
}

TEST_F(CoprocessorLimits, ParametersThatAreSetLaterAreBoundedToo)
{
    static_cast<void>(tell("WPNAV_ACCEL", 250.0F));
    set("VEH_ACC", 4.0F);
    EXPECT_EQ(f.coprocessor.parameters().get(Param::acceleration), 4.0F);
    EXPECT_EQ(limits().max_acceleration, 2.5F);
    set("VEH_ACC", 2.0F);
    EXPECT_EQ(limits().max_acceleration, 2.0F);
    set("VEH_ACC", 6.0F);
    EXPECT_EQ(limits().max_acceleration, 2.5F);
}

TEST_F(CoprocessorLimits, WhereJinkMayNotAskTheParametersAloneCount)
{
    static_cast<void>(tell("WPNAV_ACCEL", 250.0F));
    set("JNK_ASK_RATES", 0.0F);
    EXPECT_EQ(limits().max_acceleration, 5.0F);
    set("JNK_ASK_RATES", 1.0F);
    EXPECT_EQ(limits().max_acceleration, 2.5F);
}

TEST_F(CoprocessorLimits, OthersMayAccelerateAsTheParameterSaysAndReachSetsStay)
{
    const bool unsuited = configuration().reach_unsuited;
    static_cast<void>(tell("WPNAV_ACCEL", 250.0F));
    EXPECT_EQ(configuration().rules.fellow_acceleration, 5.0F);
    EXPECT_EQ(configuration().reach_unsuited, unsuited);
}

/// A reported limit is no parameter: nothing is written into flash for it.
TEST_F(CoprocessorLimits, NoParameterChanges)
{
    const std::uint32_t generation = f.coprocessor.parameters().generation();
    const ParamValues values = f.coprocessor.parameters().values();
    static_cast<void>(tell("WPNAV_ACCEL", 250.0F));
    EXPECT_EQ(f.coprocessor.parameters().generation(), generation);
    EXPECT_EQ(f.coprocessor.parameters().values(), values);
}

TEST(CoprocessorLimitsOfPx4, AFasterDescentThanItFliesIsNotPlanned)
{
    Flight f;
    f.px4 = true;
    f.mode = px4_mode(4, 4);
    ASSERT_TRUE(f.until([](const StepReport& r) { return r.faults == 0; }, 200));
    EXPECT_EQ(f.coprocessor.parameters().configuration().limits.max_descent, 3.0F);
    ParamValue m;
    m.param_id = wire::param_name("MPC_Z_VEL_MAX_DN");
    m.param_value = 1.5F;
    m.param_type = 9;
    f.feed(m);
    f.fly(1);
    EXPECT_EQ(f.coprocessor.parameters().configuration().limits.max_descent, 1.5F);
    EXPECT_EQ(f.coprocessor.parameters().configuration().limits.max_climb, 3.0F);
}

}  // namespace
}  // namespace jink::app::test
