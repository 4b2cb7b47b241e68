// SPDX-License-Identifier: BSD-3-Clause
// Effect of JNK_METHODS, parameters shared by methods, and the parameters as served on a bus.
#include <array>
#include <string>

#include <gtest/gtest.h>

#include "firmware/app/method_orders.hpp"
#include "firmware/app/param_service.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"
#include "tests/numbers.hpp"

namespace jink::app {
namespace {

using Order = avoid::MethodOrder;

/// By the value of JNK_METHODS, from 1 on.
const std::array<Order, 7> kSets{
    Order(kGeometric),        Order(kReach),        Order(kGeometric, kReach),       Order(kOrca),
    Order(kGeometric, kOrca), Order(kReach, kOrca), Order(kGeometric, kReach, kOrca)};

TEST(ParamMethods, EachNumberIsASetOfMethods)
{
    Parameters parameters;
    EXPECT_EQ(parameters.configuration().supervisor.order, kSets.back()) << "as delivered: all";
    static_assert(kSets.size() == kAllMethods && kBuiltMethods == kAllMethods);
    for (std::size_t i = 0; i < kSets.size(); ++i) {
        ASSERT_EQ(parameters.set(Param::methods, static_cast<float>(i + 1)), ParamStatus::ok);
        const Configuration& c = parameters.configuration();
        EXPECT_EQ(c.supervisor.order, kSets[i]) << i;
        EXPECT_EQ(c.orca.gives_up_blocked, i + 1 != 4) << "alone: no other method is asked";
    }
    EXPECT_EQ(parameters.set(Param::methods, 0.0F), ParamStatus::out_of_range);
    EXPECT_EQ(parameters.set(Param::methods, 8.0F), ParamStatus::out_of_range);
}

TEST(ParamMethods, WithoutSetsTheOthersAreLeftOrTheGeometricMethod)
{
    const std::array<Order, 7> left{Order(kGeometric),        Order(kGeometric), Order(kGeometric),       Order(kOrca),
                                    Order(kGeometric, kOrca), Order(kOrca),      Order(kGeometric, kOrca)};
    for (std::size_t i = 0; i < left.size(); ++i) {
        EXPECT_EQ(without_sets(kSets[i]), left[i]) << i;
        EXPECT_EQ(is_reactive(kSets[i]), i + 1 >= 4) << i;
        EXPECT_EQ(needs_sets(kSets[i]), kSets[i].contains(kReach)) << i;
    }
}

/// A plane cannot fly what a reactive method asks for.
TEST(ParamMethods, AWingIsNotAskedForAVelocityWhereThereIsAnotherMethod)
{
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::fixed_wing, 1.0F), ParamStatus::ok);
    for (std::size_t i = 0; i < kSets.size(); ++i) {
        ASSERT_EQ(parameters.set(Param::methods, static_cast<float>(i + 1)), ParamStatus::ok);
        EXPECT_EQ(is_reactive(parameters.configuration().supervisor.order), i + 1 == 4) << i;
    }
}

TEST(ParamMethods, AllSeeAsFarAndAnswerAsLate)
{
    Parameters parameters;
    ASSERT_EQ(parameters.set(Param::lookahead, 13.0F), ParamStatus::ok);
    ASSERT_EQ(parameters.set(Param::latency, 0.3F), ParamStatus::ok);
    const Configuration& c = parameters.configuration();
    EXPECT_EQ(c.rules.lookahead, 13.0F);
    EXPECT_EQ(c.rules.latency, 0.3F);
    EXPECT_EQ(c.reach.sets, &reach_sets());
    EXPECT_FALSE(c.planner.check_acceleration) << "the predicted flight shows it";
    EXPECT_EQ(c.planner.tables, &cost::tables::kDefault);
}

TEST(ParamMethods, WeightsAddUpToOne)
{
    Parameters parameters;
    auto values = parameters.values();
    values[static_cast<std::size_t>(Param::weight_smoothness)] = 0.2F;
    values[static_cast<std::size_t>(Param::weight_time)] = 0.15F;
    values[static_cast<std::size_t>(Param::weight_passing)] = 0.1F;
    values[static_cast<std::size_t>(Param::weight_beyond)] = 0.05F;
    ASSERT_EQ(parameters.set_all(values), ParamStatus::ok);
    EXPECT_NEAR(parameters.configuration().planner.weights.closeness, 0.5F, 1e-6F);
}

TEST(ParamMethods, TheReachSetsOnlySuitTheirVehicle)
{
    Parameters parameters;
    EXPECT_EQ(parameters.configuration().reach_unsuited,
              !reach::suits(reach_sets(), parameters.configuration().limits));
    EXPECT_FALSE(parameters.configuration().reach_unsuited) << "the default vehicle is theirs";
}

/// Sets in place of the built ones stay when parameters change, and are judged as those are.
TEST(ParamMethods, OtherReachSetsStayWhenAParameterChanges)
{
    const reach::VehicleSets others = reach_sets();
    Parameters parameters;
    const std::uint32_t before = parameters.generation();
    parameters.use(others);
    EXPECT_NE(parameters.generation(), before) << "who holds the old configuration takes the new one over";
    ASSERT_EQ(parameters.set(Param::lookahead, 13.0F), ParamStatus::ok);
    EXPECT_EQ(parameters.configuration().reach.sets, &others);
    EXPECT_FALSE(parameters.configuration().reach_unsuited);
    reach::VehicleSets unsuited = reach_sets();
    unsuited.cruise_speed *= 0.1F;
    parameters.use(unsuited);
    EXPECT_TRUE(parameters.configuration().reach_unsuited);
}

/// The time of cost 1 is stretched by Pinheiro's 1.15 and must be above the time of cost 0.
TEST(ParamMethods, TimesThatCostNothingAndAllLieApart)
{
    const auto fit = [](float low, float high) {
        Parameters parameters;
        auto values = parameters.values();
        values[static_cast<std::size_t>(Param::time_low)] = low;
        values[static_cast<std::size_t>(Param::time_high)] = high;
        return parameters.set_all(values);
    };
    EXPECT_EQ(fit(9.0F, 8.0F), ParamStatus::ok);
    EXPECT_EQ(fit(8.0F * 1.15F, 8.0F), ParamStatus::inconsistent) << "the same is not apart";
    EXPECT_EQ(fit(9.3F, 8.0F), ParamStatus::inconsistent);
}

class ServedParams : public ::testing::Test {
protected:
    static link::ParamName name_of(std::string_view text)
    {
        link::ParamName name{};
        std::copy(text.begin(), text.end(), name.begin());
        return name;
    }
    static Parameters started_with(float lookahead)
    {
        Parameters parameters;
        EXPECT_EQ(parameters.set(Param::lookahead, lookahead), ParamStatus::ok);
        return parameters;
    }
    Parameters parameters = started_with(9.0F);
    std::uint32_t set = 0;
    std::uint32_t refused = 0;
    ParamService service{parameters, set, refused};
};

TEST_F(ServedParams, ReadsEachWithItsLimitsAndWhatARestartBrings)
{
    for (std::uint16_t i = 0; i < kParamCount; ++i) {
        link::ParamEntry entry;
        ASSERT_TRUE(service.read(i, entry));
        const ParamInfo& info = param_table()[i];
        EXPECT_EQ(std::string(entry.name.data(), ::strnlen(entry.name.data(), entry.name.size())), info.name);
        EXPECT_EQ(entry.low, info.low);
        EXPECT_EQ(entry.high, info.high);
        EXPECT_EQ(entry.integer, info.integer);
        EXPECT_EQ(entry.value, parameters.values()[i]);
        EXPECT_EQ(entry.initial, parameters.values()[i]);
        std::uint16_t index = 0;
        EXPECT_TRUE(service.find(entry.name, index));
        EXPECT_EQ(index, i);
    }
    link::ParamEntry entry;
    entry.name = name_of("LEFT_FROM_BEFORE");
    EXPECT_FALSE(service.read(kParamCount, entry));
    EXPECT_FALSE(service.read(65535, entry));
    ASSERT_TRUE(service.read(0, entry));
    EXPECT_EQ(entry.name[8], '\0') << "nothing of a longer one";
    std::uint16_t index = 0;
    EXPECT_FALSE(service.find(name_of("JNK_NOTHING"), index));
    EXPECT_FALSE(service.find({}, index));
}

TEST(ServedParamsAtTheStart, NothingIsStoredBeforeItIsNoted)
{
    Parameters parameters;
    std::uint32_t set = 0;
    std::uint32_t refused = 0;
    ParamService service(parameters, set, refused);
    EXPECT_FALSE(service.save());
    service.note_stored(0);
    EXPECT_TRUE(service.save());
}

TEST_F(ServedParams, WritesWhatIsInRangeAndCountsTheRest)
{
    constexpr auto kIndex = static_cast<std::uint16_t>(Param::lookahead);
    service.write(kIndex, 12.0F);
    EXPECT_EQ(parameters.get(Param::lookahead), 12.0F);
    EXPECT_EQ(set, 1U);
    for (const float bad : {0.5F, 61.0F, kNan}) {
        service.write(kIndex, bad);
    }
    service.write(kParamCount, 1.0F);
    service.write(65535, 1.0F);
    EXPECT_EQ(parameters.get(Param::lookahead), 12.0F);
    EXPECT_EQ(set, 1U);
    EXPECT_EQ(refused, 5U);
    link::ParamEntry entry;
    ASSERT_TRUE(service.read(kIndex, entry));
    EXPECT_EQ(entry.value, 12.0F);
    EXPECT_EQ(entry.initial, 9.0F) << "what it was started with";
    EXPECT_FALSE(service.save());
    EXPECT_TRUE(service.erase());
    EXPECT_EQ(parameters.get(Param::lookahead), 9.0F);
    EXPECT_EQ(set, 2U);
    EXPECT_EQ(refused, 5U);
}

}  // namespace
}  // namespace jink::app
