// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/mission_client.hpp"

#include <gtest/gtest.h>

namespace jink::link::mavlink {
namespace {

constexpr std::uint16_t kWaypoint = 16;

MissionPoint point(std::int32_t x) { return {true, 0, x, 0, 0.0F}; }

struct MavlinkMissionClient : ::testing::Test {
    MissionClient client;
    TimePoint now{5'000'000};
    void wait(float s) { now = now + s; }
    MissionStep next() { return client.next(now); }
};

TEST_F(MavlinkMissionClient, FetchesTheCurrentItemAndTheOneBefore)
{
    EXPECT_EQ(next(), MissionStep::none);
    client.current(4);
    EXPECT_EQ(next(), MissionStep::list);
    EXPECT_EQ(next(), MissionStep::none);
    client.count(9, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_EQ(client.wanted(), 4);
    EXPECT_TRUE(client.item(4, kWaypoint, point(44), now));
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_EQ(client.wanted(), 3);
    EXPECT_FALSE(client.take_leg());
    EXPECT_TRUE(client.item(3, kWaypoint, point(33), now));
    EXPECT_TRUE(client.take_leg());
    EXPECT_FALSE(client.take_leg()) << "once";
    EXPECT_TRUE(client.from().known);
    EXPECT_EQ(client.from().x, 33);
    EXPECT_EQ(client.to().x, 44);
    EXPECT_EQ(next(), MissionStep::finish);
    EXPECT_EQ(next(), MissionStep::none);
}

TEST_F(MavlinkMissionClient, TheFirstItemHasNoneBefore)
{
    client.current(0);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(1, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_TRUE(client.item(0, kWaypoint, point(1), now));
    EXPECT_TRUE(client.take_leg());
    EXPECT_FALSE(client.from().known);
}

TEST_F(MavlinkMissionClient, AnItemBeforeWithoutAPlaceStartsTheLegWhereTheVehicleIs)
{
    client.current(2);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(3, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_TRUE(client.item(2, kWaypoint, point(2), now));
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_TRUE(client.item(1, 178, point(1), now));  // DO_CHANGE_SPEED
    EXPECT_TRUE(client.take_leg());
    EXPECT_FALSE(client.from().known);
}

TEST_F(MavlinkMissionClient, ACurrentItemWithoutAPlaceGivesNoLeg)
{
    client.current(2);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(3, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_TRUE(client.item(2, 20, point(2), now));  // RETURN_TO_LAUNCH
    EXPECT_FALSE(client.take_leg());
    EXPECT_EQ(next(), MissionStep::none);
}

TEST_F(MavlinkMissionClient, OnlyWhatWasAskedForIsTaken)
{
    EXPECT_FALSE(client.item(0, kWaypoint, point(0), now));
    client.count(5, now);
    EXPECT_EQ(next(), MissionStep::none);
    client.current(3);
    EXPECT_FALSE(client.item(3, kWaypoint, point(3), now)) << "not asked yet";
    EXPECT_EQ(next(), MissionStep::list);
    client.count(5, now);
    client.count(5, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_FALSE(client.item(2, kWaypoint, point(2), now));
    EXPECT_FALSE(client.item(4, kWaypoint, point(4), now));
    EXPECT_TRUE(client.item(3, kWaypoint, point(3), now));
    EXPECT_FALSE(client.item(3, kWaypoint, point(9), now)) << "doubled by the line";
    EXPECT_EQ(client.to().x, 3);
}

TEST_F(MavlinkMissionClient, AsksThreeTimesThenSulks)
{
    client.current(1);
    int lists = 0;
    for (int tick = 0; tick < 50 * 8; ++tick) {
        lists += next() == MissionStep::list ? 1 : 0;
        wait(0.02F);
    }
    EXPECT_EQ(lists, 3);
    for (int tick = 0; tick < 50 * 10; ++tick) {
        lists += next() == MissionStep::list ? 1 : 0;
        wait(0.02F);
    }
    EXPECT_GT(lists, 3) << "tries again after 10 s";
}

TEST_F(MavlinkMissionClient, AnItemThatIsLostIsAskedForAgain)
{
    client.current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(2, now);
    int items = 0;
    for (int tick = 0; tick < 50 * 5; ++tick) {
        items += next() == MissionStep::item ? 1 : 0;
        wait(0.02F);
    }
    EXPECT_EQ(items, 3);
}

TEST_F(MavlinkMissionClient, ACurrentItemBeyondTheMissionIsGivenUp)
{
    client.current(7);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(7, now);
    EXPECT_EQ(next(), MissionStep::none);
    wait(10.5F);
    EXPECT_EQ(next(), MissionStep::none);
    EXPECT_EQ(next(), MissionStep::list);
}

TEST_F(MavlinkMissionClient, TheNextItemStartsOver)
{
    client.current(1);
    EXPECT_EQ(next(), MissionStep::list);
    client.count(5, now);
    EXPECT_EQ(next(), MissionStep::item);
    EXPECT_TRUE(client.item(1, kWaypoint, point(1), now));
    client.current(2);  // while item 0 is still on its way
    EXPECT_FALSE(client.item(0, kWaypoint, point(0), now));
    EXPECT_FALSE(client.take_leg());
    EXPECT_EQ(next(), MissionStep::list);
    client.current(2);
    EXPECT_EQ(next(), MissionStep::none) << "the same again changes nothing";
}

TEST_F(MavlinkMissionClient, ForgetsEverything)
{
    client.current(1);
    client.forget();
    EXPECT_EQ(next(), MissionStep::none);
    client.current(1);
    EXPECT_EQ(next(), MissionStep::list);
}

}  // namespace
}  // namespace jink::link::mavlink
