// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/mission_client.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace jink::link::mavlink {
namespace {

constexpr std::uint16_t kWaypoint = 16;
constexpr std::uint16_t kChangeSpeed = 178;

MissionItem at(std::int32_t x, std::uint16_t command = kWaypoint) { return {true, 0, command, x, 0, 0.0F, 0.0F}; }

struct MavlinkMissionClient : ::testing::Test {
    MissionClient client;
    TimePoint now{5'000'000};
    MissionProgress progress;

    void wait(float s)
    {
        for (float t = 0.0F; t < s; t += 0.1F) {
            now = now + 0.1F;
            client.heard(now);
        }
    }
    MissionStep next() { return client.next(now); }
    void current(std::uint16_t sequence)
    {
        progress.sequence = sequence;
        client.current(progress, now);
    }
    /// All steps of a while, at 10 Hz.
    std::vector<MissionStep> steps(float seconds)
    {
        std::vector<MissionStep> all;
        for (float t = 0.0F; t < seconds; t += 0.1F) {
            if (const MissionStep step = next(); step != MissionStep::none) {
                all.push_back(step);
            }
            wait(0.1F);
        }
        return all;
    }
    /// Answers a whole transfer, begun by MISSION_REQUEST_LIST, and returns the items requested.
    std::vector<std::uint16_t> read(const std::vector<MissionItem>& mission, std::uint32_t id = 0)
    {
        std::vector<std::uint16_t> requested;
        EXPECT_EQ(next(), MissionStep::list);
        client.count(static_cast<std::uint16_t>(mission.size()), id, now);
        while (next() == MissionStep::item) {
            requested.push_back(client.wanted());
            EXPECT_TRUE(client.item(client.wanted(), mission[client.wanted()], 0.0F, 0.0F, now));
        }
        return requested;
    }
    /// Answers a comparison, which is due.
    void compare(const std::vector<MissionItem>& mission)
    {
        EXPECT_EQ(next(), MissionStep::list);
        client.count(static_cast<std::uint16_t>(mission.size()), 0, now);
        EXPECT_EQ(next(), MissionStep::item);
        EXPECT_EQ(client.wanted(), progress.sequence);
        EXPECT_TRUE(client.item(client.wanted(), mission[client.wanted()], 0.0F, 0.0F, now));
        EXPECT_EQ(next(), MissionStep::none);
    }
    static std::vector<MissionItem> mission_of(std::size_t n)
    {
        std::vector<MissionItem> mission;
        for (std::size_t i = 0; i < n; ++i) {
            mission.push_back(at(static_cast<std::int32_t>(100 + i)));
        }
        return mission;
    }
};

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
    client.refused(14, now);  // denied: somebody uploads
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

TEST_F(MavlinkMissionClient, ALongMissionIsKeptAroundItsCurrentItem)
{
    const std::size_t n = 3 * kMaxMissionItems;
    const auto mission = mission_of(n);
    const std::size_t kStart = kMaxMissionItems + 10;
    current(static_cast<std::uint16_t>(kStart));
    const auto requested = read(mission);
    for (std::size_t i = 0; i < requested.size(); ++i) {
        ASSERT_EQ(requested[i], i) << "in order from 0";
    }
    EXPECT_LT(requested.size(), n);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, static_cast<std::int32_t>(100 + kStart));
    EXPECT_EQ(steps(2.0F), std::vector<MissionStep>(2, MissionStep::cancel)) << "the first is taken by read()";
    for (const std::size_t seq : {kStart - 1, requested.size() - 1, requested.size(), std::size_t{0}, n - 1}) {
        current(static_cast<std::uint16_t>(seq));
        EXPECT_TRUE(client.goal() == nullptr || client.goal()->x == static_cast<std::int32_t>(100 + seq)) << seq;
    }
    steps(0.05F);
}

TEST_F(MavlinkMissionClient, DoItemsArePassedOverAndUnknownOnesAreNot)
{
    auto mission = mission_of(6);
    mission[1].command = kChangeSpeed;
    mission[2].command = 112;  // CONDITION_DELAY
    mission[4].command = 177;  // DO_JUMP
    progress.total = 6;
    current(1);
    read(mission);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, 103);
    const std::uint32_t version = client.version();
    current(3);
    EXPECT_EQ(client.version(), version) << "the same item";
    current(4);
    EXPECT_EQ(client.goal(), nullptr) << "a jump leads who knows where";
    current(5);
    EXPECT_EQ(client.goal()->x, 105);
    progress.complete = true;
    current(5);
    EXPECT_EQ(client.goal(), nullptr) << "flown to its end";
}

TEST_F(MavlinkMissionClient, SpeedItemsBeforeTheCurrentOneCount)
{
    current(5);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(7, 0, now);
    struct Sent {
        std::uint16_t command;
        float param1, param2;
        float expected;
    };
    const std::vector<Sent> sent{{16, 0, 0, 0},  {178, 1, 12, 12}, {178, 2, 3, 12}, {178, 0, -1, 12},
                                 {16, 0, 0, 12}, {178, 0, -2, 0},  {178, 0, 7, 7}};
    for (std::uint16_t i = 0; i < sent.size(); ++i) {
        ASSERT_EQ(next(), MissionStep::item);
        client.item(i, at(i, sent[i].command), sent[i].param1, sent[i].param2, now);
    }
    progress.total = 0;
    current(4);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->speed, 12.0F);
}

TEST_F(MavlinkMissionClient, ArduPilotsCurrentItemIsComparedEveryFiveSeconds)
{
    client.set_lone(true);
    current(2);
    auto mission = mission_of(4);
    read(mission);
    EXPECT_EQ(client.goal(), nullptr) << "it may have been replaced while it was read";
    int lists = 0;
    for (int tick = 0; tick < 600; ++tick) {
        const MissionStep step = next();
        if (step == MissionStep::list) {
            ++lists;
            client.count(4, 0, now);
        } else if (step == MissionStep::item) {
            EXPECT_EQ(client.wanted(), 2);
            client.item(2, mission[2], 0.0F, 0.0F, now);
        } else {
            EXPECT_EQ(step, MissionStep::none);
        }
        wait(0.1F);
    }
    EXPECT_NEAR(lists, 13, 2);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, 102);

    // Another mission of the same length, and no id: 35 of 58 were hit.
    mission[2].x = 999;
    wait(6.0F);
    const std::uint32_t version = client.version();
    EXPECT_EQ(next(), MissionStep::list);
    client.count(4, 0, now);
    EXPECT_EQ(next(), MissionStep::item);
    client.item(2, mission[2], 0.0F, 0.0F, now);
    EXPECT_EQ(client.goal(), nullptr) << "not known until it is read";
    read(mission);
    compare(mission);
    ASSERT_NE(client.goal(), nullptr);
    EXPECT_EQ(client.goal()->x, 999);
    EXPECT_GT(client.version(), version);
}

TEST_F(MavlinkMissionClient, ArduPilotsItemZeroIsHomeAndNoGoal)
{
    client.set_lone(true);
    current(0);
    read(mission_of(3));
    compare(mission_of(3));
    EXPECT_EQ(client.goal(), nullptr);
    current(1);
    EXPECT_EQ(client.goal(), nullptr) << "not compared yet";
    compare(mission_of(3));
    EXPECT_NE(client.goal(), nullptr);
}

TEST_F(MavlinkMissionClient, AnotherCountReadsAnewAtOnce)
{
    client.set_lone(true);
    current(1);
    read(mission_of(3));
    compare(mission_of(3));
    EXPECT_NE(client.goal(), nullptr);
    wait(6.0F);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(5, 0, now);
    EXPECT_EQ(client.goal(), nullptr);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_EQ(client.wanted(), 0);
}

TEST_F(MavlinkMissionClient, APx4WithoutAnIdIsReadAgainAndKeepsItsLeg)
{
    current(1);
    read(mission_of(3));
    steps(2.0F);
    wait(21.0F);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(3, 0, now);
    EXPECT_NE(client.goal(), nullptr);
    const std::uint32_t version = client.version();
    for (std::uint16_t i = 0; i < 3; ++i) {
        EXPECT_EQ(next(), MissionStep::item);
        client.item(i, at(100 + i), 0.0F, 0.0F, now);
        EXPECT_NE(client.goal(), nullptr);
    }
    EXPECT_EQ(client.version(), version);
}

TEST_F(MavlinkMissionClient, ForgetsEverything)
{
    current(1);
    read(mission_of(3));
    client.forget();
    EXPECT_EQ(client.goal(), nullptr);
    EXPECT_EQ(next(), MissionStep::none);
}

}  // namespace
}  // namespace jink::link::mavlink
