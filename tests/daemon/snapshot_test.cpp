// SPDX-License-Identifier: BSD-3-Clause
// Events of the live page, made of messages of the flight log: read back by another JSON reader.
#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/daemon/snapshot_fixture.hpp"

namespace jink::livepage {
namespace {

TEST_F(SnapshotTest, OwnStateAndTracksAreCarriedToTheStep)
{
    take_step(0.0);
    OwnTopic own;
    own.timestamp = kStart + 100'000;
    own.measured = kStart + 60'000;
    own.position = {10.0F, -20.0F, 30.0F};
    own.velocity = {5.0F, 0.0F, -2.0F};
    take(TopicId::own, own);
    take_track(7, 0.1, {100.0F, 0.0F, 30.0F}, {-10.0F, 1.0F, 0.0F});
    take_step(0.3);
    const Json e = event();
    EXPECT_DOUBLE_EQ(e["time"], 0.3);
    EXPECT_NEAR(e["own"]["position"][0], 11.0, 2e-3);
    EXPECT_NEAR(e["own"]["position"][2], 29.6, 2e-3);
    EXPECT_NEAR(e["own"]["age"], 0.24, 2e-3);
    ASSERT_EQ(e["tracks"].size(), 1U);
    EXPECT_NEAR(e["tracks"][0]["position"][0], 98.0, 2e-3);
    EXPECT_NEAR(e["tracks"][0]["position"][1], 0.2, 2e-3);
    EXPECT_EQ(e["tracks"][0]["radius"], 2.0);
    EXPECT_EQ(e["safety_distance"], 1.5);
    EXPECT_EQ(e["page"], Json({{"clients", 1}, {"slow", 2}, {"refused", 3}, {"messages_lost", 4}}));
    take_step(0.32, 0);
    EXPECT_TRUE(event()["own"].is_null()) << "an old position is shown as a present one";
}

TEST_F(SnapshotTest, ATrackWithoutNewsIsGoneAndThoseOfALaterTimeReplaceIt)
{
    take_step(0.0);
    take_track(1, 0.0, {}, {});
    take_track(2, 0.0, {}, {});
    take_step(0.49);
    EXPECT_EQ(event()["tracks"].size(), 2U);
    take_step(0.51);
    EXPECT_EQ(event()["tracks"].size(), 0U);
    take_track(3, 0.6, {}, {});
    take_step(0.6);
    ASSERT_EQ(event()["tracks"].size(), 1U);
    EXPECT_EQ(event()["tracks"][0]["id"], 3);
    for (std::uint32_t id = 0; id < 2 * Snapshot::kMaxTracks; ++id) {
        take_track(id, 0.7, {}, {});
    }
    take_step(0.7);
    EXPECT_EQ(event()["tracks"].size(), Snapshot::kMaxTracks);
}

TEST_F(SnapshotTest, TwoAircraftUnderOneIdDifferInTheirInstance)
{
    take_track(7, 0.0, {100.0F, 0.0F, 0.0F}, {}, 0);
    take_track(7, 0.0, {30.0F, 0.0F, 0.0F}, {}, 1);
    take_step(0.0);
    const Json e = event();
    ASSERT_EQ(e["tracks"].size(), 2U);
    EXPECT_EQ(e["tracks"][0]["instance"], 0);
    EXPECT_EQ(e["tracks"][1]["instance"], 1);
    EXPECT_EQ(e["tracks"][1]["id"], 7);
}

/// A page that was away hears by it that jinkd began anew.
TEST_F(SnapshotTest, EveryEventNamesItsRun)
{
    take_step(1.0);
    EXPECT_EQ(event(true)["run"], kStart + 1'000'000);
    snapshot.begin_next();
    take_step(2.0);
    EXPECT_EQ(event()["run"], kStart + 1'000'000);
    snapshot = Snapshot({1.5F, 8.0F, 1.0F});
    take_step(2.5);
    EXPECT_EQ(event()["run"], kStart + 2'500'000);
}

TEST_F(SnapshotTest, UnknownAndEndlessNumbersAreNull)
{
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    StepTopic step;
    step.wants_control = true;
    step.velocity = {kNan, kEndless, -3e38F};
    step.conflict_kind = 1;
    step.conflict_time = kNan;
    take(TopicId::step, step);
    const Json e = event();
    EXPECT_EQ(e["command"], Json::array({nullptr, nullptr, nullptr}));
    EXPECT_TRUE(e["conflict"]["time"].is_null());
    EXPECT_EQ(e["conflict"]["kind"], "track");
}

TEST_F(SnapshotTest, TextsAreEscapedAndComeOnce)
{
    take_step(0.0);
    take_text("a \"b\" \\ c\n</script>\x01\x7F\xC3\xA9");
    Json e = event();
    ASSERT_EQ(e["texts"].size(), 1U);
    EXPECT_EQ(e["texts"][0]["text"], "a \"b\" \\ c?</script>????");
    EXPECT_EQ(e["texts"][0]["level"], 4);
    snapshot.begin_next();
    EXPECT_EQ(event()["texts"].size(), 0U);
    EXPECT_FALSE(snapshot.has_news());
    for (std::size_t i = 0; i < Snapshot::kMaxTexts + 5; ++i) {
        take_text(std::to_string(i));
    }
    e = event(true);
    ASSERT_EQ(e["texts"].size(), Snapshot::kMaxTexts);
    EXPECT_EQ(e["texts"][0]["text"], "5");
    EXPECT_EQ(e["texts"].back()["number"], Snapshot::kMaxTexts + 5);
}

TEST_F(SnapshotTest, PeriodsKeepTheMostExpensiveStepAndTheParameterIsFollowed)
{
    for (const std::uint32_t work : {10U, 90U, 20U}) {
        StepTopic step;
        step.work = work;
        step.duration_us = 10 * work;
        step.deadline_missed = work == 90U;
        take(TopicId::step, step);
    }
    EXPECT_EQ(event()["work"], 90);
    EXPECT_EQ(event()["longest_step_ms"], 0.9);
    EXPECT_EQ(event()["deadlines_missed"], 1);
    snapshot.begin_next();
    EXPECT_EQ(event()["work"], 0);
    ulog::Messages change;
    change.parameter("JNK_HALF_Z", 9.0F);
    change.parameter("JNK_HALF_XY", 4.0F);
    snapshot.take(change.bytes());
    EXPECT_EQ(event()["safety_distance"], 4.0);
}

/// Any bytes at all: every event is JSON.
TEST_F(SnapshotTest, AnyMessagesGiveJson)
{
    const std::uint64_t seed = std::random_device{}();
    std::mt19937_64 random(seed);
    constexpr std::string_view kTypes = "DDDDLPOSX";
    constexpr std::array<std::size_t, 8> kSizes{
        2 + flightlog::kBytesOf<StepTopic>,      2 + flightlog::kBytesOf<OwnTopic>,
        2 + flightlog::kBytesOf<TrackTopic>,     2 + flightlog::kBytesOf<DecisionTopic>,
        2 + flightlog::kBytesOf<CandidateTopic>, 2 + flightlog::kBytesOf<NominalTopic>,
        2 + flightlog::kBytesOf<ObstacleTopic>,  2 + flightlog::kBytesOf<AreaTopic>};
    constexpr std::size_t kBools = 7;  // at the end of a step's topic
    for (int i = 0; i < 20'000; ++i) {
        std::vector<std::byte> bytes(random() % 2 == 0 ? 10 + random() % 200 : kSizes[random() % kSizes.size()]);
        for (std::byte& b : bytes) {
            b = static_cast<std::byte>(random());
        }
        for (std::size_t k = bytes.size() - kBools; k < bytes.size(); ++k) {
            bytes[k] &= std::byte{1};
        }
        if (random() % 4 != 0) {
            bytes[0] = static_cast<std::byte>(random() % 12);
            bytes[1] = std::byte{0};
        }
        take(static_cast<ulog::Type>(kTypes[random() % kTypes.size()]), bytes);
        snapshot.take(std::span(bytes).first(std::min<std::size_t>(bytes.size(), random() % 5)));  // cut
        if (i % 100 == 0) {
            EXPECT_TRUE(Json::accept(snapshot.json(random() % 2 == 0, {}))) << "seed " << seed << ", message " << i;
            snapshot.begin_next();
        }
    }
}

}  // namespace
}  // namespace jink::livepage
