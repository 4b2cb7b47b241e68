// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/stick_watch.hpp"

#include <gtest/gtest.h>

namespace jink::app {
namespace {

using link::SticksReport;

constexpr float kThreshold = 0.3F;

SticksReport at(float roll, float throttle = -0.8F, bool radio = true) { return {radio, {roll, 0.0F, throttle, 0.0F}}; }

bool see(StickWatch& watch, const SticksReport& report, bool streaming = true, float threshold = kThreshold)
{
    return watch.update(&report, streaming, threshold);
}

TEST(StickWatch, RestIsWhereTheyWereBeforeTheTakeover)
{
    StickWatch watch;
    EXPECT_FALSE(see(watch, at(0.5F), false));
    EXPECT_FALSE(see(watch, at(0.5F)));
    EXPECT_FALSE(see(watch, at(0.79F)));
    EXPECT_FALSE(see(watch, at(0.81F)));
    EXPECT_TRUE(see(watch, at(0.81F))) << "twice in a row";
    EXPECT_TRUE(watch.update(nullptr, true, kThreshold)) << "kept";
    EXPECT_FALSE(watch.update(nullptr, false, kThreshold)) << "until the stream ends";
}

TEST(StickWatch, RestIsTheNewestReportBeforeTheTakeover)
{
    StickWatch watch;
    see(watch, at(-0.5F), false);
    see(watch, at(0.5F), false);
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(see(watch, at(0.5F)));
    }
    see(watch, at(-0.5F));
    EXPECT_TRUE(see(watch, at(-0.5F)));
}

TEST(StickWatch, ThresholdItselfCounts)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    see(watch, at(kThreshold));
    EXPECT_TRUE(see(watch, at(kThreshold)));
}

TEST(StickWatch, SticksThatMovedAndReturnedHaveMoved)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    see(watch, at(0.9F));
    EXPECT_TRUE(see(watch, at(0.9F)));
    EXPECT_TRUE(see(watch, at(0.0F)));
    EXPECT_TRUE(see(watch, at(0.9F, 0.9F, false))) << "the first report of another source";
}

TEST(StickWatch, ReportOfAFormerTakeoverDoesNotCount)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F)));
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F))) << "one in this one";
    EXPECT_TRUE(see(watch, at(0.9F)));
}

TEST(StickWatch, OneReportAloneIsNoise)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(see(watch, at(1.0F)));
        EXPECT_FALSE(see(watch, at(0.0F)));
    }
}

TEST(StickWatch, EachStickCounts)
{
    for (std::size_t i = 0; i < 4; ++i) {
        StickWatch watch;
        SticksReport report = at(0.0F);
        see(watch, report, false);
        report.sticks[i] += 0.31F;
        see(watch, report);
        EXPECT_TRUE(see(watch, report)) << i;
    }
}

TEST(StickWatch, SourcesAreNotMixed)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F, 0.9F, false)));
    EXPECT_FALSE(see(watch, at(0.9F, 0.9F, false))) << "the joystick's first place is its rest";
    EXPECT_FALSE(see(watch, at(0.9F)));
    EXPECT_FALSE(see(watch, at(0.9F, 0.9F, false)));
    EXPECT_TRUE(see(watch, at(0.9F)));
}

TEST(StickWatch, FirstReportOfTheStreamIsTheRestWhereNoneCameBefore)
{
    StickWatch watch;
    EXPECT_FALSE(see(watch, at(0.9F)));
    EXPECT_FALSE(see(watch, at(0.9F)));
    see(watch, at(0.5F));
    EXPECT_TRUE(see(watch, at(0.5F)));
}

TEST(StickWatch, FormerTakeoverLeavesNothingForTheNextOne)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F))) << "one report away";
    EXPECT_FALSE(watch.update(nullptr, false, 0.3F));
    EXPECT_FALSE(see(watch, at(0.9F))) << "the rest of this one";
    EXPECT_FALSE(see(watch, at(0.9F)));
}

TEST(StickWatch, ThresholdZeroWatchesNothing)
{
    StickWatch watch;
    see(watch, at(0.0F), false, 0.0F);
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(see(watch, at(1.0F), true, 0.0F));
    }
    see(watch, at(0.0F), false);
    see(watch, at(1.0F));
    EXPECT_TRUE(see(watch, at(1.0F)));
    EXPECT_FALSE(watch.update(nullptr, true, 0.0F)) << "set to 0 in flight";
}

TEST(StickWatch, RestIsKnownHoweverLongBeforeTheTakeoverItWasReported)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(watch.update(nullptr, false, kThreshold));
    }
    EXPECT_FALSE(watch.update(nullptr, true, kThreshold));
    EXPECT_FALSE(see(watch, at(0.9F)));
    EXPECT_TRUE(see(watch, at(0.9F))) << "the pilot moved them as the take-over began";
}

TEST(StickWatch, MovementEitherWayCounts)
{
    for (const float side : {-0.31F, 0.31F}) {
        StickWatch watch;
        see(watch, at(0.0F), false);
        see(watch, at(side));
        EXPECT_TRUE(see(watch, at(side))) << side;
    }
}

TEST(StickWatch, TicksWithoutAReportDoNotBreakTheRow)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F)));
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(watch.update(nullptr, true, kThreshold));
    }
    EXPECT_TRUE(see(watch, at(0.9F)));
}

TEST(StickWatch, AnotherStickMayBeAwayInTheSecondReport)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    EXPECT_FALSE(see(watch, at(0.9F)));
    EXPECT_TRUE(see(watch, at(0.0F, 0.5F)));
}

TEST(StickWatch, WatchIsBackWhenTheThresholdIs)
{
    StickWatch watch;
    see(watch, at(0.0F), false);
    see(watch, at(0.9F));
    ASSERT_TRUE(see(watch, at(0.9F)));
    EXPECT_FALSE(see(watch, at(0.9F), true, 0.0F));
    EXPECT_FALSE(watch.update(nullptr, true, kThreshold)) << "what was seen before is forgotten";
}

}  // namespace
}  // namespace jink::app
