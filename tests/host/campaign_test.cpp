// SPDX-License-Identifier: BSD-3-Clause
// REFERENCE RESULTS of the distribution study (Pinheiro 4.2).
#include <cstdio>

#include <gtest/gtest.h>

#include "toolchain/host/campaign.hpp"

namespace {

using jink::host::CampaignFigure;

TEST(Campaign, DistributionStudyAgreesWithTheSourceWhereItsTextIsComplete)
{
    std::size_t calls = 0;
    std::size_t last = 0;
    const jink::host::CampaignResult result = jink::host::run_campaign([&](std::size_t done, std::size_t all) {
        ++calls;
        EXPECT_GE(done, last);
        EXPECT_LE(done, all);
        last = done;
    });
    EXPECT_EQ(result.environments, 16200U);
    EXPECT_EQ(last, 16200U);
    EXPECT_GT(calls, 100U);
    int agreeing = 0;
    for (const CampaignFigure& f : result.figures) {
        std::printf("%-32s published %12.4f ours %12.4f %s\n", f.name.c_str(), f.published, f.ours, f.unit.c_str());
        if (f.expected_to_agree) {
            ++agreeing;
            EXPECT_LT(std::abs(f.deviation()), jink::host::kCampaignTolerance) << f.name;
        }
    }
    EXPECT_EQ(agreeing, 2);
    // Figures of an independent program for the same set-up (specification, section 8), which the text's own cannot
    // confirm.
    const auto ours = [&](const char* name) {
        for (const CampaignFigure& f : result.figures) {
            if (f.name == name) {
                return f.ours;
            }
        }
        ADD_FAILURE() << name;
        return 0.0;
    };
    EXPECT_NEAR(ours("energy, least"), 249.56, 0.05);
    EXPECT_NEAR(ours("time, least"), 1.305, 0.001);
    EXPECT_NEAR(ours("time, 99.5 %"), 7.084, 0.005 * 7.084);
    EXPECT_NEAR(ours("time, greatest"), 8.14, 0.02);
    EXPECT_NEAR(ours("energy, 99.5 %"), 1435.0, 0.01 * 1435.0);
    EXPECT_NEAR(ours("energy, greatest"), 1631.0, 2.0);
    // Published 0.9120 and T = 1.0013 E + 0.0060. They depend on energies that differ from the text's set-up, and are
    // not reproduced: checked here so that docs/evidence/reproduction_pinheiro.md stays true.
    EXPECT_NEAR(ours("correlation of time and energy"), 0.8575, 0.001);
    EXPECT_NEAR(ours("slope of time over energy"), 0.8856, 0.001);
    EXPECT_NEAR(ours("intercept"), 0.0496, 0.001);
}

/// Blocks that were flown in another order, and went through bytes, merge to the same figures, bit by bit.
TEST(Campaign, BlocksComeBackFromBytesAndMergeInTheirOwnOrder)
{
    using namespace jink::host;
    std::vector<StudyBlock> flown(kStudyBlocks);
    std::vector<StudyBlock> received(kStudyBlocks);
    for (const std::size_t index : {std::size_t{224}, std::size_t{7}, std::size_t{24}, std::size_t{100}}) {
        flown[index] = fly_study_block(index, index == 7);
        const std::string bytes = packed(index, flown[index]);
        unpack(bytes, received);
        EXPECT_EQ(received[index].rows, flown[index].rows);
        EXPECT_EQ(received[index].environments_skipped, flown[index].environments_skipped);
        std::vector<StudyBlock> cut(kStudyBlocks);
        EXPECT_THROW(unpack(std::string_view(bytes).substr(0, bytes.size() - 1), cut), std::runtime_error);
    }
    EXPECT_FALSE(flown[7].rows.empty());
    EXPECT_GT(flown[224].times.size(), 1000U);
    EXPECT_EQ(flown[24].environments_skipped, kStudyEnvironments);  // 3 m from a radius of 3 m
    const CampaignResult one = merge_study(flown);
    const CampaignResult other = merge_study(received);
    ASSERT_EQ(one.figures.size(), other.figures.size());
    for (std::size_t i = 0; i < one.figures.size(); ++i) {
        EXPECT_EQ(one.figures[i].ours, other.figures[i].ours) << one.figures[i].name;
    }
    EXPECT_EQ(one.closeness_median, other.closeness_median);
    EXPECT_THROW(unpack(packed(0, flown[7]).replace(0, 8, 8, '\xff'), received), std::out_of_range);
}

}  // namespace
