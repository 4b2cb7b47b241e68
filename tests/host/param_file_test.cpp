// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "firmware/linux/param_file.hpp"

#include "core/base/random.hpp"
#include "tests/host/scratch.hpp"

namespace {

using namespace jink;
using namespace jink::files;
using app::Param;
using test::Scratch;
using test::with;

float at(const ParamValues& values, Param p) { return values[static_cast<std::size_t>(p)]; }

ParamValues defaults() { return app::Parameters().values(); }

TEST(ParamFile, TakesBothWaysOfWritingCommentsAndBlankLines)
{
    Complaints complaints;
    const auto values = apply_param_text("\xEF\xBB\xBF# saved by a ground station\r\n"
                                         "JNK_MODE,1\r\n"
                                         "\r\n"
                                         "JNK_LOOKAHEAD 12.5   # seconds\n"
                                         "\t VEH_MASS ,\t 4.25\t\n"
                                         "#TRK_AGE,7\n"
                                         "JNK_FLOOR\t-3",
                                         "f", defaults(), complaints);
    ASSERT_TRUE(values) << test::all_of(complaints);
    EXPECT_EQ(at(*values, Param::mode), 1.0F);
    EXPECT_EQ(at(*values, Param::lookahead), 12.5F);
    EXPECT_EQ(at(*values, Param::mass), 4.25F);
    EXPECT_EQ(at(*values, Param::floor), -3.0F);
    EXPECT_EQ(at(*values, Param::track_age), at(defaults(), Param::track_age));
}

TEST(ParamFile, AnEmptyFileChangesNothing)
{
    Complaints complaints;
    EXPECT_EQ(apply_param_text("", "f", defaults(), complaints), defaults());
    EXPECT_EQ(apply_param_text("\n\n# nothing\n", "f", defaults(), complaints), defaults());
    EXPECT_TRUE(complaints.empty());
}

TEST(ParamFile, StopsAtTwentyErrorsAndSaysWhere)
{
    std::string text;
    for (int i = 0; i < 20; ++i) {
        text += "NOT_A_NAME,1\n";
    }
    Complaints complaints;
    EXPECT_FALSE(apply_param_text(text, "f", defaults(), complaints));
    EXPECT_EQ(complaints.size(), 20U) << "nothing follows that would not be checked";
    complaints.clear();
    EXPECT_FALSE(apply_param_text(text + "# more\n" + text, "f", defaults(), complaints));
    ASSERT_EQ(complaints.size(), 21U);
    EXPECT_EQ(complaints.back().line, 21U);
    EXPECT_NE(with(complaints, "too many errors: nothing is read from this line on"), nullptr);
}

TEST(ParamFile, RefusesEachWrongLineByItsNumber)
{
    const struct {
        const char* line;
        const char* complaint;
    } cases[] = {
        {"JNK_LOOKAHED,5", "unknown parameter 'JNK_LOOKAHED'; did you mean 'JNK_LOOKAHEAD'?"},
        {"THR_MIN,5", "unknown parameter 'THR_MIN'"},
        {"JNK_MODE", "JNK_MODE has no value"},
        {"JNK_MODE,", "JNK_MODE has no value"},
        {"TRK_RADIUS,1", "TRK_RADIUS was given in line 1 already"},
        {"VEH_MASS,heavy", "'heavy' is not a number"},
        {"VEH_MASS,nan", "'nan' is not finite"},
        {"VEH_MASS,-inf", "'-inf' is not finite"},
        {"VEH_MASS,1e60", "'1e60' is beyond what single precision can hold"},
        {"VEH_MASS,-1", "'-1' is out of range: 0.05 to 5000"},
        {"GEO_PLANES,2.5", "'2.5' is not a whole number"},
        {"VEH_MASS,1,2", "'1,2' is not a number"},
        {"VEH_MASS 1 2", "'1 2' is not a number"},
        {",5", "unknown parameter ''"},
        {"veh_mass,5", "did you mean 'VEH_MASS'?"},
        {"\x01\x02,5", "unknown parameter '\\x01\\x02'"},
    };
    for (const auto& c : cases) {
        Complaints complaints;
        EXPECT_FALSE(apply_param_text("TRK_RADIUS,2\n# comment\n" + std::string(c.line) + "\nHB_AGE,5", "f", defaults(),
                                      complaints));
        ASSERT_EQ(complaints.size(), 1U) << c.line << "\n" << test::all_of(complaints);
        EXPECT_EQ(complaints[0].line, 3U) << c.line;
        EXPECT_EQ(complaints[0].file, "f");
        EXPECT_NE(with(complaints, c.complaint), nullptr) << c.line << "\n" << test::all_of(complaints);
    }
}

TEST(ParamFile, RefusesAZeroByteInACommentToo)
{
    Complaints complaints;
    EXPECT_FALSE(apply_param_text(std::string("HB_AGE,5\n# a\0b\n", 15), "f", defaults(), complaints));
    EXPECT_EQ(test::all_of(complaints), "f:2:4: a zero byte: the file has to be text\n");
}

TEST(ParamFile, NamesAllWrongLinesNotOnlyTheFirst)
{
    Complaints complaints;
    EXPECT_FALSE(apply_param_text("A,1\nB,2\nJNK_MODE,9\nC,3", "f", defaults(), complaints));
    EXPECT_EQ(complaints.size(), 4U) << test::all_of(complaints);
}

TEST(ParamFile, ComplaintOfAFileThatIsNotThere)
{
    Complaints complaints;
    EXPECT_FALSE(apply_param_file("/nowhere/at/all.parm", defaults(), complaints));
    EXPECT_NE(with(complaints, "no such file"), nullptr);
}

TEST(ParamFile, WhatItWritesReadsBackBitForBit)
{
    const std::uint64_t seed = 7;
    Random random(seed);
    for (int i = 0; i < 300; ++i) {
        ParamValues values{};
        for (std::size_t k = 0; k < values.size(); ++k) {
            const app::ParamInfo& info = app::param_table()[k];
            values[k] = random.uniform(info.low, info.high);
            values[k] = info.integer ? std::floor(values[k]) : values[k];
        }
        Complaints complaints;
        const auto back = apply_param_text(param_file_text(values), "f", defaults(), complaints);
        ASSERT_TRUE(back) << "seed " << seed << " case " << i << "\n" << test::all_of(complaints);
        ASSERT_EQ(*back, values) << "seed " << seed << " case " << i;
    }
}

TEST(ParamFile, TakesItsOwnLinesOfAQGroundControlFile)
{
    Complaints complaints;
    const auto values = apply_param_text("# Onboard parameters for Vehicle 3\n"
                                         "#\n"
                                         "# Vehicle-Id Component-Id Name Value Type\n"
                                         "3\t1\tFRAME_CLASS\t1\t2\n"
                                         "3\t1\tJNK_FLOOR\t77\t9\r\n"
                                         "3\t196\tJNK_LOOKAHEAD\t12.500000000000000000\t9\r\n"
                                         "3\t196\tTRK_LATENCY\t0.300000011920928955\t9\n"
                                         "VEH_MASS,4\n",
                                         "f", defaults(), complaints);
    ASSERT_TRUE(values) << test::all_of(complaints);
    EXPECT_EQ(at(*values, Param::lookahead), 12.5F);
    EXPECT_EQ(at(*values, Param::track_latency), 0.3F);
    EXPECT_EQ(at(*values, Param::mass), 4.0F);
    EXPECT_EQ(at(*values, Param::floor), at(defaults(), Param::floor)) << "another component's";
}

TEST(ParamFile, RefusesWrongLinesOfAQGroundControlFile)
{
    const struct {
        const char* line;
        const char* complaint;
    } cases[] = {
        {"1\t196\tJNK_MODE\t3\t9", "'3' is out of range: 0 to 2"},
        {"1\t196\tJNK_MOOD\t1\t9", "unknown parameter 'JNK_MOOD'; did you mean 'JNK_MODE'?"},
        {"1\t196\tTRK_RADIUS\t1\t9", "TRK_RADIUS was given in line 1 already"},
        {"1\t196\tVEH_MASS\tnan\t9", "'nan' is not finite"},
        {"1\t196\tVEH_MASS\t9", "unknown parameter '1'"},         // no type
        {"1\t196\tVEH_MASS\t4\t9\t9", "unknown parameter '1'"},   // a column more
        {"1\t-196\tVEH_MASS\t4\t9", "unknown parameter '1'"},     // no id
        {"256\t196\tVEH_MASS\t4\t9", "unknown parameter '256'"},  // no id
        {"1\t452\tVEH_MASS\t4\t9", "unknown parameter '1'"},      // 196 in eight bits
        {"1\t196\tVEH_MASS\t4\tfloat", "unknown parameter '1'"},  // no type
        {"1\t196.0\tVEH_MASS\t4\t9", "unknown parameter '1'"},    // no id
    };
    for (const auto& c : cases) {
        Complaints complaints;
        EXPECT_FALSE(apply_param_text("TRK_RADIUS,2\n" + std::string(c.line) + "\n", "f", defaults(), complaints));
        ASSERT_EQ(complaints.size(), 1U) << c.line << "\n" << test::all_of(complaints);
        EXPECT_EQ(complaints[0].line, 2U) << c.line;
        EXPECT_NE(with(complaints, c.complaint), nullptr) << c.line << "\n" << test::all_of(complaints);
    }
    Complaints complaints;
    EXPECT_FALSE(apply_param_text("1\t1\tFRAME_CLASS\t1\t2\n", "f", defaults(), complaints));
    EXPECT_NE(with(complaints, "has parameters of other components alone"), nullptr) << test::all_of(complaints);
}

TEST(ParamFile, EveryReachableSetIsAcceptedInItsSettingOrder)
{
    // Sets that fit as a whole, far from the defaults; floor, ceiling, weights and times need an order of their own.
    const std::uint64_t seed = 11;
    Random random(seed);
    int table_order_fails = 0;
    for (int i = 0; i < 50; ++i) {
        ParamValues wanted = defaults();
        const auto put = [&](Param p, float value) { wanted[static_cast<std::size_t>(p)] = value; };
        put(Param::bounds, 3.0F);
        put(Param::floor, random.uniform(-100.0F, 400.0F));
        put(Param::ceiling, at(wanted, Param::floor) + random.uniform(4.0F, 200.0F));
        put(Param::time_low, random.uniform(0.0F, 100.0F));
        put(Param::time_high, at(wanted, Param::time_low) + random.uniform(1.0F, 100.0F));
        put(Param::weight_smoothness, random.uniform(0.0F, 0.5F));
        put(Param::weight_time, random.uniform(0.3F, 0.5F));
        app::Parameters whole;
        ASSERT_EQ(whole.set_all(wanted), app::ParamStatus::ok) << "seed " << seed << " case " << i;
        app::Parameters one_by_one;
        for (const std::size_t k : setting_order(wanted)) {
            ASSERT_EQ(one_by_one.set(static_cast<Param>(k), wanted[k]), app::ParamStatus::ok)
                << "seed " << seed << " case " << i << " " << app::param_table()[k].name;
        }
        ASSERT_EQ(one_by_one.values(), wanted);
        app::Parameters by_table;
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            table_order_fails += by_table.set(static_cast<Param>(k), wanted[k]) == app::ParamStatus::ok ? 0 : 1;
        }
        Complaints complaints;
        EXPECT_EQ(apply_param_text(qgroundcontrol_text(wanted, 1), "f", defaults(), complaints), wanted)
            << test::all_of(complaints);
    }
    EXPECT_GT(table_order_fails, 10) << "else this test shows nothing";
}

TEST(ParamFile, TheSettingOrderHasEachParameterOnceAndTheModeLastEvenIfNoneIsAccepted)
{
    ParamValues wanted{};
    wanted.fill(-1e30F);  // out of every range
    std::vector<std::size_t> order = setting_order(wanted);
    EXPECT_EQ(order.back(), static_cast<std::size_t>(Param::mode));
    EXPECT_EQ(setting_order(defaults()).back(), static_cast<std::size_t>(Param::mode));
    std::sort(order.begin(), order.end());
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        ASSERT_EQ(order.at(k), k);
    }
    EXPECT_EQ(order.size(), wanted.size());
}

TEST(ApplyTogether, ASetThatOnlyFitsAsAWholeIsTaken)
{
    // GEO_K_S = 0 alone leaves closeness 0.8, more than it may have; with GEO_K_T = 0.5 it is 0.5.
    app::Parameters alone;
    ASSERT_EQ(alone.set("GEO_K_S", 0.0F), app::ParamStatus::inconsistent);
    Complaints complaints;
    const auto values = apply_param_text("GEO_K_S,0\nGEO_K_T,0.5", "f", defaults(), complaints);
    ASSERT_TRUE(values);
    app::Parameters parameters;
    EXPECT_TRUE(apply_together(*values, "f", parameters, complaints)) << test::all_of(complaints);
    EXPECT_EQ(parameters.values(), *values);
}

TEST(ApplyTogether, SaysWhichDoNotFit)
{
    const struct {
        const char* text;
        const char* complaint;
    } cases[] = {
        {"JNK_BOUNDS,3\nJNK_CEILING,3\nJNK_FLOOR,2", "JNK_CEILING must lie at least 4 JNK_HALF_Z above JNK_FLOOR"},
        {"GEO_T_LOW,10\nGEO_T_HIGH,5", "GEO_T_HIGH * 1.15 must be greater than GEO_T_LOW"},
        {"GEO_K_S,0\nGEO_K_T,0.1", "their sum must be 0.3 to 1"},
        {"GEO_K_S,0.9\nGEO_K_T,0.9", "their sum must be 0.3 to 1"},
        {"GEO_K_A,0.3\nGEO_K_B,0.3", "their sum must be 0.3 to 1"},
        {"GEO_OFFSETS,5", "GEO_OFFSETS must be even"},
        {"GEO_OFFSETS,64\nGEO_PLANES,31", "candidates per family are more than"},
    };
    for (const auto& c : cases) {
        Complaints complaints;
        const auto values = apply_param_text(c.text, "f", defaults(), complaints);
        ASSERT_TRUE(values) << c.text << "\n" << test::all_of(complaints);
        app::Parameters parameters;
        EXPECT_FALSE(apply_together(*values, "f", parameters, complaints)) << c.text;
        ASSERT_EQ(complaints.size(), 1U) << c.text << "\n" << test::all_of(complaints);
        EXPECT_NE(with(complaints, c.complaint), nullptr) << c.text << "\n" << test::all_of(complaints);
        EXPECT_EQ(parameters.values(), defaults()) << "a refused set must change nothing: " << c.text;
    }
}

TEST(LoadParameters, LaysTheParameterFileOverTheVehicleFile)
{
    const Scratch scratch;
    Complaints complaints;
    const auto both = load_parameters(JINK_SOURCES "/firmware/vehicles/uav2/vehicle.yaml",
                                      scratch.write("p", "VEH_CRUISE,12\nJNK_MODE,1"), complaints);
    ASSERT_TRUE(both) << test::all_of(complaints);
    EXPECT_EQ(both->get(Param::cruise), 12.0F);
    EXPECT_EQ(both->get(Param::climb), 8.0F);
    EXPECT_EQ(both->get(Param::mode), 1.0F);

    const auto neither = load_parameters({}, {}, complaints);
    ASSERT_TRUE(neither);
    EXPECT_EQ(neither->values(), defaults());

    EXPECT_FALSE(load_parameters("/none.yaml", "/none.parm", complaints));
    EXPECT_EQ(complaints.size(), 2U) << "both files are looked at\n" << test::all_of(complaints);
    complaints.clear();
    EXPECT_FALSE(load_parameters({}, scratch.write("q", "GEO_OFFSETS,5"), complaints));
    EXPECT_EQ(complaints.size(), 1U) << test::all_of(complaints);
}

}  // namespace
