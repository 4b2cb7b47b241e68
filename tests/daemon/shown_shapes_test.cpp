// SPDX-License-Identifier: BSD-3-Clause
// Obstacles and closed areas in events of the live page.
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "tests/daemon/snapshot_fixture.hpp"

namespace jink::livepage {
namespace {

using ShownShapesTest = SnapshotTest;

TEST_F(ShownShapesTest, ARoundIsShownOnceWhenItIsCompleteAndToEachNewClient)
{
    take_knowing(0.0, 2, 1);
    EXPECT_EQ(event(true)["shapes"], Json::parse(R"({"time":0.0,"obstacles":[],"closed_areas":[]})"));
    take(TopicId::obstacle, box(0.0, 0, 2, 1));
    take(TopicId::obstacle, box(0.0, 1, 2, 1));
    take_knowing(0.02, 2, 1);
    EXPECT_TRUE(event()["shapes"].is_null()) << "an area is still to come";
    AreaTopic last = area(0.0, 0, 2, 1);
    last.timestamp += 20'000;
    take(TopicId::area, last);
    for (const bool is_first : {false, true}) {
        const Json shapes = event(is_first)["shapes"];
        EXPECT_EQ(shapes["time"], 0.0);
        ASSERT_EQ(shapes["obstacles"].size(), 2U);
        EXPECT_EQ(shapes["obstacles"][1], Json::parse(R"({"id":101,"kind":"box","position":[1.0,2.0,3.0],
            "half":[0.5,1.0,2.0],"turn":[1.0,0.0,0.0,0.0],"radius":0.0,"uncertainty":0.25,"of_map":false,
            "is_bound":false})"));
        ASSERT_EQ(shapes["closed_areas"].size(), 1U);
        EXPECT_EQ(shapes["closed_areas"][0], Json::parse(R"({"number":0,"position":[10.0,0.0],"velocity":[0.0,3.0],
            "radius":12.0,"bottom":-5.0,"top":120.0,"margin":6.0})"));
    }
    snapshot.begin_next();
    EXPECT_TRUE(event()["shapes"].is_null());
    EXPECT_EQ(event(true)["shapes"]["obstacles"].size(), 2U);
}

TEST_F(ShownShapesTest, WhatIsUnchangedIsNotSentAgain)
{
    take_knowing(0.0, 2, 0);
    take_round(0.0, 2, 0);
    snapshot.begin_next();
    take_knowing(1.0, 2, 0);
    take_round(1.0, 2, 0);
    EXPECT_TRUE(event()["shapes"].is_null());
    // One change in each field.
    const std::vector<std::function<void(ObstacleTopic&)>> changes{
        [](ObstacleTopic& o) { o.id = 7; },         [](ObstacleTopic& o) { o.centre[2] = 9.0F; },
        [](ObstacleTopic& o) { o.half[0] = 9.0F; }, [](ObstacleTopic& o) { o.turn = {0.0F, 1.0F, 0.0F, 0.0F}; },
        [](ObstacleTopic& o) { o.radius = 9.0F; },  [](ObstacleTopic& o) { o.uncertainty = 9.0F; },
        [](ObstacleTopic& o) { o.kind = 4; },       [](ObstacleTopic& o) { o.of_map = true; },
        [](ObstacleTopic& o) { o.is_bound = true; }};
    double seconds = 1.0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
        seconds += 1.0;
        take_knowing(seconds, 2, 0);
        take(TopicId::obstacle, box(seconds, 0, 2, 0));
        ObstacleTopic changed = box(seconds, 1, 2, 0);
        changes[i](changed);
        take(TopicId::obstacle, changed);
        EXPECT_EQ(event()["shapes"]["obstacles"].size(), 2U) << i;
        snapshot.begin_next();
    }
    take_round(seconds + 0.02, 1, 1);
    EXPECT_EQ(event()["shapes"]["closed_areas"].size(), 1U);
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 1U);
}

TEST_F(ShownShapesTest, TheyAreGoneWithoutNewsForTwoSecondsAndAtOnceWhereNothingIsKnown)
{
    take_knowing(0.0, 3, 0);
    take_round(0.0, 3, 0);
    snapshot.begin_next();
    take_knowing(2.0, 3, 0);
    EXPECT_TRUE(event()["shapes"].is_null());
    EXPECT_EQ(event(true)["shapes"]["obstacles"].size(), 3U);
    take_knowing(2.02, 3, 0);
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 0U);
    take_round(2.02, 3, 0);
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 3U);
    snapshot.begin_next();
    take(TopicId::obstacle, box(3.1, 0, 2, 0));
    take_knowing(3.12, 0, 0);
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 0U);
    take(TopicId::obstacle, box(3.1, 1, 2, 0));
    EXPECT_EQ(event(true)["shapes"]["obstacles"].size(), 0U) << "a round of before that step";
}

/// The queue to the page was full.
TEST_F(ShownShapesTest, ARoundThatLacksAMessageIsPassedOver)
{
    take_knowing(0.0, 4, 2);
    for (std::size_t lost = 0; lost < 6; ++lost) {
        const double seconds = 0.1 * static_cast<double>(lost);
        for (std::size_t i = 0; i < 6; ++i) {
            if (i == lost) {
                continue;
            }
            i < 4 ? take(TopicId::obstacle, box(seconds, i, 4, 2)) : take(TopicId::area, area(seconds, i - 4, 4, 2));
        }
        EXPECT_EQ(event(true)["shapes"]["obstacles"].size(), 0U) << lost;
    }
    // Twice, in another order, of another size, later than a round lasts.
    take(TopicId::obstacle, box(1.0, 0, 2, 0));
    take(TopicId::obstacle, box(1.0, 0, 2, 0));
    take(TopicId::obstacle, box(1.1, 1, 2, 0));
    take(TopicId::obstacle, box(1.1, 0, 2, 0));
    take(TopicId::obstacle, box(1.2, 0, 3, 0));
    take(TopicId::obstacle, box(1.2, 1, 2, 0));
    ObstacleTopic late = box(1.3, 0, 1, 0);
    late.timestamp += 2'000'001;
    take(TopicId::obstacle, late);
    late.timestamp = late.known - 1;
    take(TopicId::obstacle, late);
    EXPECT_EQ(event(true)["shapes"]["obstacles"].size(), 0U);
    take_round(1.4, 4, 2);
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 4U);
}

TEST_F(ShownShapesTest, AFullTableIsShownWholeAndTheEventStaysSmall)
{
    for (const std::size_t n : {95U, 96U, 97U, 1024U}) {
        take_knowing(0.001 * static_cast<double>(n), n, 40);
        take_round(0.001 * static_cast<double>(n), n, 40);
        EXPECT_EQ(event()["shapes"]["obstacles"].size(), std::min<std::size_t>(n, 96)) << n;
        EXPECT_EQ(event()["shapes"]["closed_areas"].size(), 32U);
    }
    take_knowing(2.0, 96, 0);
    for (std::size_t i = 0; i < 96; ++i) {  // every number as long as it can be
        ObstacleTopic o = box(2.0, i, 96, 0);
        o.id = 0xFFFFFFFF - static_cast<std::uint32_t>(i);
        o.centre = {-9e6F, -8e6F, -7e6F};
        o.half = {9e6F, 8e6F, 7e6F};
        o.turn = {-0.5F, -0.5F, -0.5F, -0.5F};
        o.radius = o.uncertainty = 9e6F;
        o.kind = 2;
        take(TopicId::obstacle, o);
    }
    EXPECT_EQ(event()["shapes"]["obstacles"].size(), 96U);
    EXPECT_LT(snapshot.json(false, {}).size(), 32U * 1024U);
}

TEST_F(ShownShapesTest, SolidsThatCannotBeAreLeftOut)
{
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    const std::vector<std::function<void(ObstacleTopic&)>> wrong{
        [](ObstacleTopic& o) { o.centre[1] = kNan; },   [](ObstacleTopic& o) { o.centre[0] = -3e38F; },
        [](ObstacleTopic& o) { o.half[2] = kEndless; }, [](ObstacleTopic& o) { o.half[2] = -1.0F; },
        [](ObstacleTopic& o) { o.radius = kNan; },      [](ObstacleTopic& o) { o.radius = -1.0F; },
        [](ObstacleTopic& o) { o.turn = {}; },          [](ObstacleTopic& o) { o.turn[3] = kNan; },
        [](ObstacleTopic& o) { o.kind = 5; },           [](ObstacleTopic& o) { o.uncertainty = kNan; }};
    take_knowing(0.0, wrong.size() + 1, 4);
    for (std::size_t i = 0; i <= wrong.size(); ++i) {
        ObstacleTopic o = box(0.0, i, wrong.size() + 1, 4);
        if (i < wrong.size()) {
            wrong[i](o);
        }
        take(TopicId::obstacle, o);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        AreaTopic a = area(0.0, i, wrong.size() + 1, 4);
        a.velocity[0] = i == 0 ? kNan : 0.0F;
        a.top = i == 1 ? -6.0F : 120.0F;
        a.radius = i == 2 ? kEndless : 12.0F;
        take(TopicId::area, a);
    }
    const Json shapes = event()["shapes"];
    ASSERT_EQ(shapes["obstacles"].size(), 1U);
    EXPECT_EQ(shapes["obstacles"][0]["id"], 100 + wrong.size());
    ASSERT_EQ(shapes["closed_areas"].size(), 1U);
    EXPECT_EQ(shapes["closed_areas"][0]["number"], 3);
}

}  // namespace
}  // namespace jink::livepage
