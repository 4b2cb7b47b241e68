// SPDX-License-Identifier: BSD-3-Clause
// Which requests a mission client makes, and when.
#include "tests/unit/link/mission_client_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkMissionClient = MissionClientTest;

TEST_F(MavlinkMissionClient, RequestsItemsInOrderFromZeroAndEndsTheTransferThreeTimes)
{
    EXPECT_EQ(next(), MissionStep::none);
    current(4);
    const auto mission = mission_of(6);
    EXPECT_EQ(next(), MissionStep::list);
    EXPECT_EQ(next(), MissionStep::none);
    client.count(6, 0, now);
    for (std::uint16_t i = 0; i < 6; ++i) {
        ASSERT_EQ(next(), MissionStep::item);
        EXPECT_EQ(client.wanted(), i);
        EXPECT_TRUE(client.item(i, mission[i], 0.0F, 0.0F, now));
    }
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, 104);
    EXPECT_EQ(steps(4.0F), std::vector<MissionStep>(3, MissionStep::accept));
}

TEST_F(MavlinkMissionClient, AnotherCurrentItemOfAKnownMissionIsNotRequestedAgain)
{
    progress.total = 6;
    current(4);
    EXPECT_EQ(read(mission_of(6)).size(), 6U);
    steps(2.0F);
    const std::uint32_t version = client.version();
    current(5);
    EXPECT_EQ(client.goal()->x, 105);
    EXPECT_GT(client.version(), version);
    EXPECT_TRUE(steps(60.0F).empty()) << "PX4 says by id and total when there is another mission";
}

TEST_F(MavlinkMissionClient, AnEmptyMissionIsEndedToo)
{
    current(0);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(0, 0, now);
    EXPECT_EQ(steps(2.0F), std::vector<MissionStep>(3, MissionStep::accept)) << "else PX4: Operation timeout";
    EXPECT_EQ(client.goal(), nullptr);
}

TEST_F(MavlinkMissionClient, AnotherIdOrTotalDropsTheCopyAndReadsAnew)
{
    for (const bool by_id : {true, false}) {
        client.forget();
        progress = {0, 3, 77, false};
        current(1);
        read(mission_of(3), 77);
        steps(2.0F);
        EXPECT_EQ(client.goal(), nullptr) << "it may have been replaced while it was read";
        current(1);
        ASSERT_NE(client.goal(), nullptr);
        progress.id += by_id ? 1 : 0;
        progress.total = by_id ? 3 : 4;
        current(1);
        EXPECT_EQ(client.goal(), nullptr) << "not known until it is read";
        EXPECT_EQ(read(mission_of(by_id ? 3 : 4), progress.id).size(), by_id ? 3U : 4U);
        current(1);
        EXPECT_NE(client.goal(), nullptr);
    }
}

TEST_F(MavlinkMissionClient, AMissionReplacedDuringTheTransferEndsIt)
{
    progress = {0, 5, 77, false};
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(5, 77, now);
    EXPECT_EQ(next(), MissionStep::item);
    client.item(0, at(1), 0.0F, 0.0F, now);
    progress = {0, 2, 78, false};  // now of two items: a request for the third brings PX4's CRITICAL text
    current(1);
    EXPECT_EQ(steps(1.05F), std::vector<MissionStep>(3, MissionStep::cancel));
    EXPECT_EQ(read(mission_of(2), 78), (std::vector<std::uint16_t>{0, 1}));
}

TEST_F(MavlinkMissionClient, AnotherCountThatAnswersARepetitionEndsTheTransfer)
{
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    wait(1.05F);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(10, 77, now);
    EXPECT_EQ(next(), MissionStep::item);
    client.count(2, 78, now);  // replaced between the two: PX4 takes requests for two items
    EXPECT_EQ(steps(1.05F), std::vector<MissionStep>(3, MissionStep::cancel));
    EXPECT_EQ(read(mission_of(2), 78), (std::vector<std::uint16_t>{0, 1}));
}

TEST_F(MavlinkMissionClient, AnotherItemThatBecomesCurrentDuringTheComparisonIsNotVerifiedByIt)
{
    client.set_lone(true);
    current(2);
    const auto mission = mission_of(6);
    read(mission);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(6, 0, now);
    EXPECT_EQ(next(), MissionStep::item);
    current(4);
    EXPECT_TRUE(client.item(2, mission[2], 0.0F, 0.0F, now));
    EXPECT_EQ(client.goal(), nullptr);
    compare(mission);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, 104);
}

TEST_F(MavlinkMissionClient, OnlyWhatWasAskedForIsTaken)
{
    EXPECT_FALSE(client.item(0, at(0), 0.0F, 0.0F, now));
    client.count(5, 0, now);
    EXPECT_EQ(next(), MissionStep::none);
    current(1);
    EXPECT_FALSE(client.item(0, at(0), 0.0F, 0.0F, now)) << "not asked yet";
    EXPECT_EQ(next(), MissionStep::list);
    client.count(5, 0, now);
    client.count(5, 0, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_FALSE(client.item(1, at(1), 0.0F, 0.0F, now));
    EXPECT_TRUE(client.item(0, at(0), 0.0F, 0.0F, now));
    EXPECT_FALSE(client.item(0, at(9), 0.0F, 0.0F, now)) << "doubled by the line";
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_EQ(client.wanted(), 1);
}

TEST_F(MavlinkMissionClient, AListThatIsNotAnsweredIsRepeatedBeforePx4TimesOutAndNeverEnded)
{
    current(1);
    TimePoint last = now;
    int lists = 0;
    for (int tick = 0; tick < 600; ++tick) {
        const MissionStep step = next();
        ASSERT_TRUE(step == MissionStep::none || step == MissionStep::list) << "PX4: partner id mismatch";
        if (step == MissionStep::list) {
            EXPECT_LT(now - last, 4.9F);
            last = now;
            ++lists;
        }
        wait(0.1F);
    }
    EXPECT_LE(lists, 32);
    EXPECT_GE(lists, 24);
}

TEST_F(MavlinkMissionClient, AnItemThatIsLostIsRequestedAgainAndAGivenUpTransferIsEnded)
{
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(2, 0, now);
    const std::vector<MissionStep> all = steps(4.4F);
    EXPECT_EQ(all, (std::vector<MissionStep>{MissionStep::item, MissionStep::item, MissionStep::item,
                                             MissionStep::cancel, MissionStep::cancel, MissionStep::cancel}));
    EXPECT_EQ(client.wanted(), 0);
}

TEST_F(MavlinkMissionClient, ARefusalEndsTheTransferWithoutAnAnswer)
{
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.refused(0, now);
    client.refused(14, now);  // denied: an upload is in progress
    EXPECT_TRUE(steps(0.8F).empty());
    wait(0.3F);
    EXPECT_EQ(read(mission_of(2)).size(), 2U);
}

TEST_F(MavlinkMissionClient, NothingIsSentDuringSomebodyElsesTransfer)
{
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(2, 0, now);
    EXPECT_EQ(next(), MissionStep::item);
    client.others(true, false, now);
    EXPECT_FALSE(client.item(0, at(0), 0.0F, 0.0F, now));
    EXPECT_TRUE(steps(8.5F).empty());
    client.others(true, true, now);
    EXPECT_TRUE(steps(0.8F).empty());
    wait(0.3F);
    EXPECT_EQ(read(mission_of(2)).size(), 2U) << "it may be another mission";
}

TEST_F(MavlinkMissionClient, SilenceIsTakenForARestartAndTheTransferBeginsAnew)
{
    client.heard(now);
    current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(2, 0, now);
    EXPECT_EQ(next(), MissionStep::item);
    now = now + 2.5F;
    client.heard(now);
    EXPECT_TRUE(steps(1.8F).empty()) << "late answers are no answers to the next request";
    wait(0.3F);
    EXPECT_EQ(next(), MissionStep::list) << "a rebooted PX4 answers an item's request with partner id mismatch";
}

}  // namespace
}  // namespace jink::link::mavlink
