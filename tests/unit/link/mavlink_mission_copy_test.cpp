// SPDX-License-Identifier: BSD-3-Clause
// A mission client's copy of a mission, and when it is valid.
#include "tests/unit/link/mission_client_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkMissionCopy = MissionClientTest;

TEST_F(MavlinkMissionCopy, ALongMissionIsKeptAroundItsCurrentItem)
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

TEST_F(MavlinkMissionCopy, AMissionAnnouncedWhileOthersTransferIsNotTheCopy)
{
    progress = {0, 3, 77, false};
    current(1);
    read(mission_of(3), 77);
    current(1);
    ASSERT_NE(client.goal(), nullptr);
    client.others(true, false, now);
    current(1);
    EXPECT_NE(client.goal(), nullptr) << "an upload has changed nothing yet";
    progress.id = 78;
    current(1);
    EXPECT_EQ(client.goal(), nullptr);
}

TEST_F(MavlinkMissionCopy, DoItemsArePassedOverAndUnknownOnesAreNot)
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

TEST_F(MavlinkMissionCopy, SpeedItemsBeforeTheCurrentOneCount)
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

TEST_F(MavlinkMissionCopy, ArduPilotsCurrentItemIsComparedEveryFiveSeconds)
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

TEST_F(MavlinkMissionCopy, ArduPilotsItemZeroIsHomeAndNoGoal)
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

TEST_F(MavlinkMissionCopy, AnotherCountReadsAnewAtOnce)
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

TEST_F(MavlinkMissionCopy, APx4WithoutAnIdIsReadAgainAndKeepsItsLeg)
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

TEST_F(MavlinkMissionCopy, ForgetsEverything)
{
    current(1);
    read(mission_of(3));
    client.forget();
    EXPECT_EQ(client.goal(), nullptr);
    EXPECT_EQ(next(), MissionStep::none);
}

}  // namespace
}  // namespace jink::link::mavlink
