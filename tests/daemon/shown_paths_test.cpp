// SPDX-License-Identifier: BSD-3-Clause
// Candidates and nominal paths in events of the live page, against formulas of their own.
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "tests/daemon/snapshot_fixture.hpp"

namespace jink::livepage {
namespace {

using ShownPathsTest = SnapshotTest;

TEST_F(ShownPathsTest, TheNewestDecisionComesOnceAndToEachNewClient)
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
TEST_F(ShownPathsTest, CurvesOfCandidatesArePinheiros)
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

TEST_F(ShownPathsTest, CandidatesOfOtherDecisionsAndUnknownShapesHaveNoCurve)
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

TEST_F(ShownPathsTest, MoreCandidatesThanShownKeepTheChosenOneAndTheEventStaysSmall)
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
TEST_F(ShownPathsTest, TheGreatestCostIsFollowed)
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

TEST_F(ShownPathsTest, NominalPathsBeginAbeamOfTheVehicleAndLeadAsFarAsConflictsAreLookedFor)
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
TEST_F(ShownPathsTest, NominalTurnsAreArcs)
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

TEST_F(ShownPathsTest, SegmentsThatNoRouteHasAreNotDrawn)
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

}  // namespace
}  // namespace jink::livepage
