// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "toolchain/sim/encounter_summary.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/judge.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace jink::sim {
namespace {

TEST(OpenEncounter, IsWhatItsHeaderSays)
{
    std::set<std::size_t> counts;
    double fastest = 0.0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const Scenario s = open_encounter(seed);
        counts.insert(s.threats.size());
        EXPECT_EQ(s.traffic.sigma_position, 0.3);
        EXPECT_EQ(s.traffic.sigma_velocity, 0.2);
        EXPECT_EQ(s.traffic.latency, 0.1);
        EXPECT_EQ(s.traffic.dropout, 0.05);
        for (const Threat& threat : s.threats) {
            fastest = std::max(fastest, threat.velocity.norm());
            EXPECT_GE(threat.appears_at, 10.0 - 8.0);
            EXPECT_LE(threat.appears_at, 13.0 - 2.0);
        }
    }
    EXPECT_EQ(counts, (std::set<std::size_t>{1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_GT(fastest, 14.5);
    EXPECT_LE(fastest, 15.0);
}

TEST(EncounterResult, RepeatsAndReadsBackBitByBit)
{
    const EncounterResult flown = fly_encounter(22, {});
    const std::string line = to_line(flown);
    EXPECT_EQ(to_line(fly_encounter(22, {})), line);
    const std::optional<EncounterResult> read = parse_line(line);
    ASSERT_TRUE(read);
    EXPECT_EQ(to_line(*read), line);
    EXPECT_EQ(read->separation, flown.separation);
    EXPECT_EQ(read->jerk, flown.jerk);
    for (const std::string& bad : {line + " 1", line.substr(0, line.rfind(' ')), std::string("x") + line, std::string(),
                                   line + " ", line + "x"}) {
        EXPECT_FALSE(parse_line(bad)) << bad;
    }
}

/// Trials that end when they break the promise give the same counts as trials flown to the end.
TEST(EncounterResult, TheShortTrialsCountAsTheLongOnes)
{
    for (const std::uint64_t seed : {5U, 21U, 2047U}) {
        const Scenario s = open_encounter(seed);
        const Verdict all = judge(s);
        const Verdict brief = judge(s, 12.0, Trials::until_broken);
        EXPECT_EQ(brief.keep, all.keep);
        EXPECT_EQ(brief.tried, all.tried);
        EXPECT_EQ(brief.avoidable, all.avoidable);
        EXPECT_EQ(brief.detected, all.detected);
        if (all.avoidable) {
            EXPECT_EQ(brief.best, all.best);
        }
        const Verdict first = judge(s, 12.0, Trials::until_kept);
        EXPECT_EQ(first.avoidable, all.avoidable);
        EXPECT_EQ(first.keep, all.avoidable ? 1U : 0U);
        EXPECT_EQ(first.conflict, all.conflict);
    }
}

/// A flight straight along x, 2 m off, then on: its measures are computed by hand.
TEST(EncounterResult, MeasuresDeviationDetourAndEffort)
{
    const Scenario s = encounter_scenario(3, {});
    Record record = fly_in_process(s);
    const Vec forward = (s.mission[1] - s.mission[0]).normalized();
    const Vec aside = Vec(-forward.y(), forward.x(), 0.0).normalized();
    record.samples.clear();
    for (int i = 0; i < 5; ++i) {
        Sample sample;
        sample.time = 0.5 * i;
        sample.position = s.mission[0] + forward * i + aside * (i < 4 ? 2.0 : 4.0);
        sample.acceleration = aside * (i % 2 == 0 ? 0.0 : 3.0);
        sample.mode = i < 3 ? Mode::external : Mode::mission;
        record.samples.push_back(sample);
    }
    const EncounterResult r = result_of(s, record);
    EXPECT_NEAR(r.deviation_most, 4.0, 1e-9);
    EXPECT_NEAR(r.deviation_rms, std::sqrt((4 * 4.0 + 16.0) / 5.0), 1e-9);
    EXPECT_NEAR(r.acceleration, 4 * 0.5 * 4.5, 1e-9);  // trapezoids of 0 and 9
    EXPECT_NEAR(r.jerk, 4 * 9.0 / 0.5, 1e-9);
    EXPECT_NEAR(r.away, 1.0, 1e-9);
    const double leg = (s.mission[1] - s.mission[0]).norm();
    const double flown = 3.0 + std::sqrt(5.0);
    EXPECT_NEAR(r.detour, flown + std::hypot(leg - 4.0, 4.0) - std::hypot(leg, 2.0), 1e-9);
}

EncounterResult ended(std::uint64_t seed, Outcome outcome, double separation, bool avoidable)
{
    EncounterResult r;
    r.seed = seed;
    r.intruders = 1;
    r.outcome = outcome;
    r.separation = separation;
    r.failed_avoidable = avoidable;
    return r;
}

TEST(EncounterSummary, RanksAvoidableFirstThenBrokenRulesThenSeparation)
{
    std::vector<EncounterResult> results{ended(1, Outcome::avoided, 3.0, false),
                                         ended(2, Outcome::collision, -1.0, false),
                                         ended(3, Outcome::breach, 0.6, true), ended(4, Outcome::failed, 5.0, false),
                                         ended(5, Outcome::avoided, 3.0, false)};
    const std::vector<EncounterResult> worst = worst_of(results);
    ASSERT_EQ(worst.size(), 5U);
    const std::vector<std::uint64_t> expected{3, 4, 2, 1, 5};
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(worst[i].seed, expected[i]) << i;
    }
    for (std::uint64_t seed = 10; seed < 30; ++seed) {
        results.push_back(ended(seed, Outcome::avoided, 9.0, false));
    }
    EXPECT_EQ(worst_of(results).size(), 10U);
}

/// Seed 519 of the campaign: avoidable for a judge that knows, and avoided by the co-processor when its sensors know.
TEST(EncounterResult, WhatWasAvoidableIsFlownAgainWithoutNoise)
{
    constexpr std::uint64_t kSeed = 9337;
    const EncounterResult lost = fly_encounter(kSeed, {});
    ASSERT_TRUE(lost.failed_avoidable);
    EXPECT_LT(lost.separation, 0.7);
    Scenario quiet = open_encounter(kSeed);
    quiet.traffic.sigma_position = quiet.traffic.sigma_velocity = 0.0;
    EXPECT_EQ(lost.noiseless, fly_in_process(quiet).closest.surface);
    EXPECT_GT(lost.noiseless, 0.7);
    EXPECT_EQ(fly_encounter(22, {}).noiseless, 0.0) << "not asked";
}

TEST(EncounterSummary, TellsNoiseFromChoice)
{
    std::vector<EncounterResult> results(3, ended(3, Outcome::breach, 0.6, true));
    results[0].noiseless = 0.69;
    results[1].noiseless = 0.7;
    results[2].noiseless = 3.0;
    results.push_back(ended(4, Outcome::collision, -1.0, false));
    const std::string text = summary_text({}, results);
    const std::size_t at = text.find("without the sensors' noise too");
    ASSERT_NE(at, std::string::npos);
    EXPECT_NE(text.substr(at, 60).find(" 1 of        4"), std::string::npos) << text;
}

TEST(EncounterSummary, CountsWhatItSays)
{
    FolderSetup setup;
    setup.seeds_text = "from 1";
    const std::vector<EncounterResult> results{
        ended(1, Outcome::avoided, 3.0, false), ended(2, Outcome::collision, -1.0, false),
        ended(3, Outcome::breach, 0.6, true), ended(4, Outcome::avoided, 5.0, false)};
    const std::string text = summary_text(setup, results);
    // 1 of 4: Wilson gives 4.5587 % to 69.9358 %; 2 of 4: 15.0039 % to 84.9961 %; none of 4: up to 3 in 4.
    EXPECT_NE(text.find("1 of        4    25.0000 %  [4.5587, 69.9358]"), std::string::npos) << text;
    EXPECT_NE(text.find("2 of        4    50.0000 %  [15.0039, 84.9961]"), std::string::npos) << text;
    EXPECT_NE(text.find("0 of        4     0.0000 %  [0.0000, 75.0000]"), std::string::npos) << text;
    EXPECT_EQ(summary_text(setup, results), text);
}

}  // namespace
}  // namespace jink::sim
