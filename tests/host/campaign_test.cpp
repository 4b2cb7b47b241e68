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
    // Published 0.9120 and T = 1.0013 E + 0.0060. They hang on energies that are not those of the text's set-up, and
    // are not met: held here so that docs/reproduction.md stays true.
    EXPECT_NEAR(ours("correlation of time and energy"), 0.8575, 0.001);
    EXPECT_NEAR(ours("slope of time over energy"), 0.8856, 0.001);
    EXPECT_NEAR(ours("intercept"), 0.0496, 0.001);
}

}  // namespace
