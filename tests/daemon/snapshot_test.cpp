// SPDX-License-Identifier: BSD-3-Clause
// Events of the live page, made of messages of the flight log: read back by another JSON reader.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/linux/live_page/snapshot.hpp"

namespace jink::livepage {
namespace {

using flightlog::CandidateTopic;
using flightlog::DecisionTopic;
using flightlog::NominalTopic;
using flightlog::OwnTopic;
using flightlog::StepTopic;
using flightlog::TopicId;
using flightlog::TrackTopic;
using Json = nlohmann::json;

constexpr std::uint64_t kStart = 5'000'000'000;  // [us]

class SnapshotTest : public testing::Test {
protected:
    Snapshot snapshot{{1.5F, 8.0F, 1.0F}};

    void take(ulog::Type type, std::span<const std::byte> content)
    {
        std::array<std::byte, 70'000> buffer{};
        snapshot.take(ulog::Composer(buffer).begin(type).put_bytes(content).end());
    }
    template <class T>
    void take(TopicId id, const T& topic)
    {
        std::array<std::byte, 1024> buffer{};
        snapshot.take(ulog::Composer(buffer)
                          .begin(ulog::Type::data)
                          .put(static_cast<std::uint16_t>(id))
                          .put_bytes(flightlog::content_of(topic))
                          .end());
    }
    void take_step(double seconds, std::uint8_t own_source = 1)
    {
        StepTopic step;
        step.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        step.own_source = own_source;
        take(TopicId::step, step);
    }
    void take_track(std::uint32_t id, double seconds, const flightlog::Xyz& at, const flightlog::Xyz& velocity)
    {
        TrackTopic track;
        track.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        track.id = id;
        track.position = at;
        track.velocity = velocity;
        track.radius = 2.0F;
        take(TopicId::track, track);
    }
    void take_decision(std::uint32_t number, double seconds, std::size_t candidates, std::size_t chosen = 1000)
    {
        DecisionTopic decision;
        decision.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        decision.decision = number;
        decision.start = {10.0F, 20.0F, 30.0F};
        decision.own_at_closest = {50.0F, 20.0F, 30.0F};
        take(TopicId::decision, decision);
        for (std::size_t i = 0; i < candidates; ++i) {
            take_candidate(number, static_cast<float>(i), i == chosen ? 1 : 6);
        }
    }
    void take_candidate(std::uint32_t number, float offset, std::uint8_t status, std::uint8_t family = 0)
    {
        CandidateTopic candidate;
        candidate.decision = number;
        candidate.offset = offset;
        candidate.status = status;
        candidate.family = family;
        candidate.time = 2.0F;
        candidate.cost = 0.5F;
        take(TopicId::candidate, candidate);
    }
    void take_nominal(double seconds, std::uint8_t path, std::uint8_t segment, const flightlog::Xyz& start,
                      float length, float radius = 0.0F, float speed = 5.0F)
    {
        NominalTopic nominal;
        nominal.timestamp = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        nominal.start = start;
        nominal.along = {1.0F, 0.0F, 0.0F};
        nominal.towards = {0.0F, 1.0F, 0.0F};
        nominal.radius = radius;
        nominal.length = length;
        nominal.speed = speed;
        nominal.path = path;
        nominal.segment = segment;
        nominal.on_route = path == 0;
        take(TopicId::nominal, nominal);
    }
    void take_own(double seconds, const flightlog::Xyz& at)
    {
        OwnTopic own;
        own.timestamp = own.measured = kStart + static_cast<std::uint64_t>(seconds * 1e6);
        own.position = at;
        take(TopicId::own, own);
    }
    void take_text(std::string_view text)
    {
        std::array<std::byte, 512> buffer{};
        snapshot.take(
            ulog::Composer(buffer).begin(ulog::Type::text).put(ulog::Level::warning).put(kStart).put_text(text).end());
    }
    [[nodiscard]] Json event(bool all = false) const { return Json::parse(snapshot.json(all, {1, 2, 3, 4})); }
};

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

TEST_F(SnapshotTest, TheNewestDecisionComesOnceAndToEachNewClient)
{
    take_step(0.0);
    EXPECT_TRUE(event(true)["decision"].is_null());
    take_decision(1, 0.0, 2);
    take_candidate(1, -6.0F, 1);  // in another portion
    EXPECT_TRUE(event(true)["decision"].is_null()) << "candidates may still come";
    take_step(0.02);
    for (const bool is_first : {false, true}) {
        const Json decision = event(is_first)["decision"];
        EXPECT_EQ(decision["number"], 1);
        EXPECT_EQ(decision["time"], 0.0);
        EXPECT_EQ(decision["candidates_known"], 3);
        ASSERT_EQ(decision["candidates"].size(), 3U);
        EXPECT_EQ(decision["candidates"][0]["fate"], "more_expensive") << "there is a chosen one";
        EXPECT_EQ(decision["candidates"][2]["fate"], "chosen");
        EXPECT_EQ(decision["candidates"][2]["cost"], 0.5);
    }
    snapshot.begin_next();
    take_step(0.04);
    EXPECT_TRUE(event()["decision"].is_null());
    EXPECT_EQ(event(true)["decision"]["number"], 1);
    take_decision(2, 0.04, 1);
    take_decision(3, 0.06, 4);
    take_step(0.08);
    EXPECT_EQ(event()["decision"]["number"], 3);
    EXPECT_EQ(event()["decision"]["candidates"].size(), 4U);
    EXPECT_EQ(event()["decisions"], 3);
}

/// Pinheiro eq. 3.7: w (3u^2 - 2u^3), u = s / D, s up to 1.5 D.
TEST_F(SnapshotTest, CurvesOfCandidatesArePinheiros)
{
    take_step(0.0);
    take_decision(1, 0.0, 0);
    take_candidate(1, -6.0F, 2);
    take_step(0.02);
    const Json candidate = event()["decision"]["candidates"][0];
    EXPECT_EQ(candidate["fate"], "contact");
    const Json& points = candidate["points"];
    ASSERT_EQ(points[0].size(), 25U);
    for (std::size_t k = 0; k < 25; ++k) {
        const double u = 1.5 * static_cast<double>(k) / 24.0;
        EXPECT_NEAR(points[0][k], 10.0 + 40.0 * u, 6e-3);
        EXPECT_NEAR(points[1][k], 20.0 - 6.0 * (3.0 * u * u - 2.0 * u * u * u), 6e-3) << k;
        EXPECT_NEAR(points[2][k], 30.0, 6e-3);
    }
}

TEST_F(SnapshotTest, CandidatesOfOtherDecisionsAndUnknownShapesHaveNoCurve)
{
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    take_step(0.0);
    take_candidate(1, 1.0F, 1);  // its decision is lost
    take_decision(2, 0.0, 1);
    take_candidate(1, 1.0F, 1);
    take_candidate(3, 1.0F, 1);
    take_candidate(2, kNan, 0);
    take_candidate(2, 1.0F, 200, 99);
    take_step(0.02);
    take_candidate(2, 1.0F, 1);  // behind its end
    take_step(0.04);
    const Json candidates = event()["decision"]["candidates"];
    ASSERT_EQ(candidates.size(), 3U);
    EXPECT_EQ(candidates[0]["points"][0].size(), 25U);
    EXPECT_EQ(candidates[0]["fate"], "budget_spent") << "none is chosen";
    EXPECT_EQ(candidates[1]["points"], Json::parse("[[],[],[]]"));
    EXPECT_EQ(candidates[2]["points"], Json::parse("[[],[],[]]"));
    EXPECT_EQ(candidates[2]["fate"], "budget_spent");
    DecisionTopic decision;
    decision.decision = 4;
    decision.own_at_closest = {kNan, 0.0F, 0.0F};
    take(TopicId::decision, decision);
    take_candidate(4, 1.0F, 1);
    take_step(0.06);
    EXPECT_EQ(event()["decision"]["candidates"][0]["points"][0].size(), 0U);
}

TEST_F(SnapshotTest, MoreCandidatesThanShownKeepTheChosenOneAndTheEventStaysSmall)
{
    constexpr std::size_t kMax = ShownPaths::kMaxCandidates;
    take_step(0.0);
    for (const std::size_t n : {kMax - 1, kMax, kMax + 1, 4 * kMax}) {
        const auto number = static_cast<std::uint32_t>(n);
        take_decision(number, 0.0, n, n - 1);
        take_step(0.02);
        const Json decision = event()["decision"];
        EXPECT_EQ(decision["candidates_known"], n);
        ASSERT_EQ(decision["candidates"].size(), std::min(n, kMax));
        EXPECT_EQ(decision["candidates"].back()["fate"], "chosen") << n;
        EXPECT_EQ(decision["candidates"][0]["fate"], "more_expensive");
    }
    DecisionTopic far;  // every number as long as it can be
    far.start = {-9e6F, -9e6F, -9e6F};
    far.own_at_closest = {-8e6F, -8e6F, -8e6F};
    take(TopicId::decision, far);
    for (std::size_t i = 0; i < 2 * kMax; ++i) {
        take_candidate(0, -1234.5F, 6);
    }
    take_step(0.04);
    EXPECT_EQ(event()["decision"]["candidates"].size(), kMax);
    EXPECT_LT(snapshot.json(false, {}).size(), 128U * 1024U);
}

/// A plan that found nothing: what costs more than GEO_MAX_COST was not worth checking.
TEST_F(SnapshotTest, TheGreatestCostIsFollowed)
{
    take_step(0.0);
    take_decision(1, 0.0, 1);
    take_step(0.02);
    EXPECT_EQ(event()["decision"]["candidates"][0]["fate"], "budget_spent");
    ulog::Messages change;
    change.parameter("GEO_MAX_COST", 0.4F);
    snapshot.take(change.bytes());
    EXPECT_EQ(event()["decision"]["candidates"][0]["fate"], "more_expensive");
}

TEST_F(SnapshotTest, NominalPathsBeginAbeamOfTheVehicleAndLeadAsFarAsConflictsAreLookedFor)
{
    take_step(0.0);
    take_own(0.0, {30.0F, 4.0F, 10.0F});
    take_nominal(0.0, 0, 0, {0.0F, 0.0F, 10.0F}, 500.0F);
    take_nominal(0.0, 1, 0, {30.0F, 4.0F, 10.0F}, 3.0F);
    const Json paths = event()["nominal"];
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_EQ(paths[0]["kind"], "route");
    EXPECT_EQ(paths[0]["speed"], 5.0);
    EXPECT_EQ(paths[0]["points"], Json::parse("[[30,70],[0,0],[10,10]]")) << "8 s at 5 m/s";
    EXPECT_EQ(paths[1]["kind"], "motion");
    EXPECT_EQ(paths[1]["points"], Json::parse("[[30,33],[4,4],[10,10]]")) << "to its end";
    ulog::Messages change;
    change.parameter("JNK_LOOKAHEAD", 2.0F);
    snapshot.take(change.bytes());
    EXPECT_EQ(event()["nominal"][0]["points"][0][1], 40.0);
    take_step(0.49);
    EXPECT_EQ(event()["nominal"].size(), 2U);
    take_nominal(0.4, 1, 0, {30.0F, 4.0F, 10.0F}, 3.0F);
    EXPECT_EQ(event()["nominal"].size(), 1U) << "paths of another time are gone";
    take_step(0.91);
    EXPECT_EQ(event()["nominal"].size(), 0U) << "without news";
    take_nominal(1.0, 0, 0, {0.0F, 0.0F, 10.0F}, 500.0F);
    take_step(1.0, 0);
    EXPECT_EQ(event()["nominal"].size(), 0U) << "own position is unknown";
}

/// Half a turn to the left about (0, 20), then back west: every point lies on the circle or the line.
TEST_F(SnapshotTest, NominalTurnsAreArcs)
{
    constexpr float kHalf = 3.14159265F * 20.0F;
    take_step(0.0);
    take_own(0.0, {0.0F, 0.0F, 0.0F});
    take_nominal(0.0, 0, 0, {0.0F, 0.0F, 0.0F}, kHalf, 20.0F, 10.0F);
    NominalTopic back;
    back.timestamp = kStart;
    back.start = {0.0F, 40.0F, 0.0F};
    back.along = {-1.0F, 0.0F, 0.0F};
    back.length = 600.0F;
    back.speed = 10.0F;
    back.segment = 1;
    take(TopicId::nominal, back);
    const Json points = event()["nominal"][0]["points"];
    const std::size_t n = points[0].size();
    ASSERT_GE(n, 14U);
    double length = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const double x = points[0][i];
        const double y = points[1][i];
        EXPECT_NEAR(x >= -0.01 ? std::hypot(x, y - 20.0) : y - 20.0, 20.0, 0.02) << i;
        length += i == 0 ? 0.0 : std::hypot(x - double{points[0][i - 1]}, y - double{points[1][i - 1]});
    }
    EXPECT_NEAR(length, 80.0, 0.3) << "8 s at 10 m/s; chords of 15 degrees";
}

TEST_F(SnapshotTest, SegmentsThatNoRouteHasAreNotDrawn)
{
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    take_step(0.0);
    take_own(0.0, {});
    for (const auto& [start, length, radius, speed] :
         std::vector<std::tuple<float, float, float, float>>{{kNan, 9, 0, 5},
                                                             {3e38F, 9, 0, 5},
                                                             {0, kNan, 0, 5},
                                                             {0, -1, 0, 5},
                                                             {0, kEndless, 0, 5},
                                                             {0, 9, kNan, 5},
                                                             {0, 9, 1e-30F, 5},
                                                             {0, 9, -1, 5},
                                                             {0, 9, 0, kNan},
                                                             {0, 9, 0, 0}}) {
        take_nominal(0.0, 0, 0, {start, 0.0F, 0.0F}, length, radius, speed);
        EXPECT_EQ(event()["nominal"].size(), 0U) << start << ' ' << length << ' ' << radius << ' ' << speed;
    }
    for (int i = 0; i < 300; ++i) {
        take_nominal(0.0, 0, static_cast<std::uint8_t>(i), {}, 1.0F);
        take_nominal(0.0, static_cast<std::uint8_t>(2 + i % 200), 0, {}, 1.0F);
    }
    take_nominal(0.0, 1, 3, {}, 0.0F);
    const Json paths = event()["nominal"];
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_LE(paths[0]["points"][0].size(), flightlog::kMaxNominalPoints);
    EXPECT_EQ(paths[1]["points"][0].size(), 2U) << "a place";
}

/// Any bytes at all: every event is JSON.
TEST_F(SnapshotTest, AnyMessagesGiveJson)
{
    const std::uint64_t seed = std::random_device{}();
    std::mt19937_64 random(seed);
    constexpr std::string_view kTypes = "DDDDLPOSX";
    constexpr std::array<std::size_t, 6> kSizes{
        2 + flightlog::kBytesOf<StepTopic>,      2 + flightlog::kBytesOf<OwnTopic>,
        2 + flightlog::kBytesOf<TrackTopic>,     2 + flightlog::kBytesOf<DecisionTopic>,
        2 + flightlog::kBytesOf<CandidateTopic>, 2 + flightlog::kBytesOf<NominalTopic>};
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
            bytes[0] = static_cast<std::byte>(random() % 10);
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
