// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/side_log.hpp"

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

const std::vector<Vec> kLeg{Vec(0, 0, 30), Vec(100, 0, 30)};

/// Records commands that represent a side: the vehicle's position in a second, level and off the leg along east.
struct Flight {
    SideLog log{kLeg};
    void side(double time, double left, unsigned takeover = 1)
    {
        log.note(time, takeover, Vec(time, 0, 30), Vec(5, left, 0));
    }
};

TEST(SideLog, CountsAChangeOnlyBeyondTheDeadBand)
{
    Flight flight;
    flight.side(1.0, 0.4);   // no side yet
    flight.side(2.0, 2.0);   // left
    flight.side(3.0, -0.4);  // within the band
    flight.side(4.0, 2.0);
    EXPECT_EQ(flight.log.counts({0.5}).same_picture, 0U);
    flight.side(5.0, -0.6);
    EXPECT_EQ(flight.log.counts({0.5}).same_picture, 1U);
    EXPECT_EQ(flight.log.counts({0.5}).changed_picture, 0U);
    EXPECT_EQ(flight.log.counts({0.5}).broken, 0U);
}

TEST(SideLog, APictureChangesWhenSomebodyNewIsReportedOfSinceTheSideBefore)
{
    Flight flight;
    flight.side(2.0, 2.0);
    flight.side(5.0, -2.0);
    flight.side(7.0, 2.0);
    flight.side(9.0, -2.0);
    // Known before the first side, or after the change: the same picture. A threat never reported does not count.
    EXPECT_EQ(flight.log.counts({1.0, 2.0, 9.1, -1.0}).same_picture, 3U);
    EXPECT_EQ(flight.log.counts({1.0, 2.0, 9.1, -1.0}).broken, 1U);
    // One at 4 s explains the change at 5 s alone.
    const SideCounts one = flight.log.counts({1.0, 4.0});
    EXPECT_EQ(one.changed_picture, 1U);
    EXPECT_EQ(one.same_picture, 2U);
    EXPECT_EQ(one.most_same, 2U);
    EXPECT_EQ(one.broken, 1U);
    // One more at the instant of the change at 9 s: a single change is left, which the promise allows.
    const SideCounts two = flight.log.counts({1.0, 4.0, 9.0});
    EXPECT_EQ(two.changed_picture, 2U);
    EXPECT_EQ(two.most_same, 1U);
    EXPECT_EQ(two.broken, 0U);
}

TEST(SideLog, ChosenSidesChangeWithAManoeuvreThatPointsTheOtherWay)
{
    SideLog log(kLeg);
    log.choose(1.0, 1, Vec(0, 1, 0));
    log.choose(2.0, 1, Vec(0, 0.1, 0.9));   // over instead: not away from the one before
    log.choose(2.5, 1, Vec(0, 0.9, -0.1));  // at right angles, but for a little
    log.choose(2.7, 1, Vec(0, 0.1, 0.9));
    log.choose(3.0, 1, Vec::Zero());         // along the leg: none
    log.choose(4.0, 1, Vec(0, -0.9, -0.2));  // away from it: a change
    log.choose(5.0, 1, Vec(0, 0.9, 0.1));    // and another
    EXPECT_EQ(log.chosen({0.5}).conflicts, 1U);
    EXPECT_EQ(log.chosen({0.5}).same_picture, 2U);
    EXPECT_EQ(log.chosen({0.5}).broken, 1U);
    EXPECT_EQ(log.chosen({0.5, 4.5}).same_picture, 1U);
    EXPECT_EQ(log.chosen({0.5, 4.5}).changed_picture, 1U);
    EXPECT_EQ(log.chosen({0.5, 4.5}).broken, 0U);
    log.choose(9.0, 2, Vec(0, -1, 0));  // another stretch of control begins without a side
    EXPECT_EQ(log.chosen({0.5}).conflicts, 2U);
    EXPECT_EQ(log.chosen({0.5}).same_picture, 2U);
    EXPECT_EQ(log.counts({0.5}).conflicts, 0U) << "nothing was flown";
}

TEST(SideLog, EachStretchOfControlIsAConflictOfItsOwn)
{
    Flight flight;
    flight.side(1.0, 2.0, 1);
    flight.side(2.0, -2.0, 1);
    flight.side(3.0, 2.0, 2);  // the first side of the second: no change
    flight.side(4.0, -2.0, 2);
    const SideCounts counts = flight.log.counts({0.5});
    EXPECT_EQ(counts.conflicts, 2U);
    EXPECT_EQ(counts.same_picture, 2U);
    EXPECT_EQ(counts.most_same, 1U);
    EXPECT_EQ(counts.broken, 0U);
}

TEST(SideLog, UpAndDownAreSidesToo)
{
    SideLog log(kLeg);
    log.note(1.0, 1, Vec(0, 0, 30), Vec(5, 0, 2));
    log.note(2.0, 1, Vec(5, 0, 30), Vec(5, 2, 0));  // a quarter turn about the leg is no change
    log.note(3.0, 1, Vec(10, 0, 30), Vec(5, 0, -2));
    EXPECT_EQ(log.counts({}).same_picture, 1U);
}

}  // namespace
}  // namespace jink::sim
