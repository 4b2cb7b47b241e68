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
