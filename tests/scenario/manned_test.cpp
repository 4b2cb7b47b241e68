// SPDX-License-Identifier: BSD-3-Clause
// Encounter models of manned aircraft, and flights beside their tracks. The models are not part of this repository.
#include "toolchain/sim/manned.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> models()
{
    std::vector<fs::path> files;
    if (fs::is_directory(JINK_ENCOUNTER_MODELS)) {
        for (const auto& entry : fs::directory_iterator(JINK_ENCOUNTER_MODELS)) {
            if (entry.path().extension() == ".txt") {
                files.push_back(entry.path());
            }
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

#define SKIP_WITHOUT_MODELS(files)                                                                                     \
    if ((files).empty()) {                                                                                             \
        GTEST_SKIP() << "encounter models are not there: set JINK_ENCOUNTER_MODELS";                                   \
    }

/// Two layers, two speeds that depend on the layer, nothing else moves; the second speed is never left.
const char* const kSmall = R"MODEL(# labels_initial
"L","v","\dot v","\dot h","\dot \psi"
# G_initial
0 1 0 0 0
0 0 0 0 0
0 0 0 0 0
0 0 0 0 0
0 0 0 0 0
# r_initial
2 2 1 1 1
# N_initial
30 10 1 3 8 2 5 5 5
# labels_transition
"L","v","\dot v","\dot h","\dot \psi","\dot \psi(t+1)"
# G_transition
0 0 0 0 0 0
0 0 0 0 0 0
0 0 0 0 0 0
0 0 0 0 0 0
0 0 0 0 0 1
0 0 0 0 0 0
# r_transition
2 2 1 1 1 1
# N_transition
7
# boundaries
100 200 300
50 100 150
-1 1
-100 100
-0.5 0.5
# resample_rates
0 0 0 0 0
)MODEL";

TEST(EncounterModel, SmallModelByHand)
{
    std::istringstream in(kSmall);
    const EncounterModel model = EncounterModel::read(in, "small");
    EXPECT_NEAR(model.marginal(0)[0], 0.75, 1e-12);
    EXPECT_NEAR(model.marginal(1)[0], 0.75 * 0.25 + 0.25 * 0.8, 1e-12);
    Random random(1);
    const ModelTrack track = model.sample(random, 10);
    ASSERT_EQ(track.states.size(), 10U);
    for (const ModelState& state : track.states) {
        EXPECT_EQ(state.turn_rate, 0.0) << "a bin about zero is zero";
        EXPECT_EQ(state.speed, track.states[0].speed);
        EXPECT_GE(state.speed, 50.0 * 1852.0 / 3600.0);
    }
    EXPECT_GE(track.height, 100.0 * 0.3048);
    EXPECT_LE(track.height, 300.0 * 0.3048);
}

TEST(EncounterModel, RefusesWhatIsNoModel)
{
    const std::string good = kSmall;
    const auto refusal_of_changed = [&](const std::string& old, const std::string& now) {
        std::string text = good;
        text.replace(text.find(old), old.size(), now);
        std::istringstream in(text);
        try {
            static_cast<void>(EncounterModel::read(in, "model"));
        } catch (const std::runtime_error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal_of_changed("# r_initial", "# s_initial"), "model: no section r_initial");
    EXPECT_EQ(refusal_of_changed("# r_initial", "# G_initial"), "model:9:1: section 'G_initial' comes twice");
    EXPECT_EQ(refusal_of_changed("# labels_initial", "labels"),
              "model:1:1: expected '# ' and a section's name, not 'labels'");
    EXPECT_EQ(refusal_of_changed("30 10 1", "30 10"), "model:12:18: N_initial: has too few counts");
    EXPECT_EQ(refusal_of_changed("5 5 5", "5 5 5 5"), "model:12:21: N_initial: has too many counts");
    EXPECT_EQ(refusal_of_changed("10 1 3", "10 -1 3"), "model:12:7: N_initial: a count is not below 0");
    EXPECT_EQ(refusal_of_changed("10 1 3", "10 x 3"), "model:12:7: N_initial: expected a number, not 'x'");
    EXPECT_EQ(refusal_of_changed("10 1 3", "10 inf 3"), "model:12:7: N_initial: expected a number, not 'inf'");
    EXPECT_EQ(refusal_of_changed("10 1 3", "10 0x1 3"), "model:12:7: N_initial: expected a number, not '0x1'");
    EXPECT_EQ(refusal_of_changed("2 2 1 1 1\n# N_initial", "2 2 1 1.5 1\n# N_initial"),
              "model:10:7: r_initial: expected a number of bins, a whole one from 1 to 1000");
    EXPECT_EQ(refusal_of_changed("2 2 1 1 1\n# N_initial", "2 2 1 1\n# N_initial"),
              "model:10:8: r_initial: expected 5 numbers, not 4");
    EXPECT_EQ(refusal_of_changed("0 1 0 0 0\n", "0 1 0 0 0 0\n"), "model:8:9: G_initial: expected 25 numbers, not 26");
    EXPECT_EQ(refusal_of_changed("\"v\"", "\"w\""), "model:1:1: no variable v");
    EXPECT_EQ(refusal_of_changed("100 200 300", "100 300 200"),
              "model:27:9: boundaries: expected an edge that is not below the one before it");
    EXPECT_EQ(refusal_of_changed("-1 1\n", "-1\n"), "model:29:3: boundaries: expected 2 numbers, not 1");
    EXPECT_EQ(refusal_of_changed("-1 1\n", "*\n"), "model:29:1: \\dotv has no edges");
    EXPECT_EQ(refusal_of_changed("-1 1\n", ""), "model:26:1: boundaries: expected a line for each of 5 variables");
    EXPECT_EQ(refusal_of_changed("0 1 0 0 0\n0 0 0 0 0", "0 1 0 0 0\n1 0 0 0 0"),
              "model:12:20: N_initial: has too few counts");
    EXPECT_EQ(refusal_of_changed("0 1 0 0 0\n0 0 0 0 0\n0 0 0 0 0", "0 1 0 0 0\n0 0 0 0 0\n0 0 1 0 0"),
              "model:3:1: the initial network has a cycle");
    for (std::size_t cut = 0; cut + 20 < good.size(); cut += 7) {
        std::istringstream in(good.substr(0, cut));
        EXPECT_THROW(static_cast<void>(EncounterModel::read(in, "model")), std::runtime_error) << cut;
    }
}

TEST(EncounterModel, SampledBinsHaveTheExactChances)
{
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    constexpr std::size_t kSamples = 60'000;
    for (const fs::path& file : files) {
        const EncounterModel model = EncounterModel::load(file);
        std::vector<std::vector<double>> seen;
        for (std::size_t i = 0; i < model.variables(); ++i) {
            seen.emplace_back(model.bins(i), 0.0);
        }
        Random random(3442);
        for (std::size_t k = 0; k < kSamples; ++k) {
            const std::vector<std::size_t> bins = model.sample_bins(random);
            for (std::size_t i = 0; i < bins.size(); ++i) {
                seen[i][bins[i]] += 1.0 / static_cast<double>(kSamples);
            }
        }
        for (std::size_t i = 0; i < model.variables(); ++i) {
            const std::vector<double> exact = model.marginal(i);
            for (std::size_t bin = 0; bin < exact.size(); ++bin) {
                const double sigma = std::sqrt(exact[bin] * (1.0 - exact[bin]) / static_cast<double>(kSamples));
                EXPECT_NEAR(seen[i][bin], exact[bin], 5.0 * sigma + 1e-9)
                    << file.filename() << ", variable " << i << ", bin " << bin;
            }
        }
    }
}

TEST(Manned, TheTrackMeetsTheMissionWhereItIsSaidTo)
{
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    const EncounterModel model = EncounterModel::load(files[0]);
    double weights = 0.0;
    constexpr std::uint64_t kCount = 300;
    for (std::uint64_t seed = 0; seed < kCount; ++seed) {
        const MannedEncounter e = manned_encounter(model, MannedSensor::range, seed);
        const Scenario& s = e.scenario;
        const Vec gap = s.threats[0].position_at(75.0) - (s.start_position + 75.0 * s.start_velocity);
        const double level = gap.head<2>().norm();
        const double height = std::abs(gap.z());
        const bool near = level < kNearMidAirVolume.radius && height < kNearMidAirVolume.height;
        const bool lost = level < kWellClearVolume.radius && height < kWellClearVolume.height;
        EXPECT_EQ(near, seed % 3 == 0) << seed;
        EXPECT_EQ(lost && !near, seed % 3 == 1) << seed;
        EXPECT_GE(s.start_position.z(), 40.0);
        EXPECT_LE(s.start_position.z(), 250.0);
        const double seen = s.threats[0].appears_at;
        const Vec first = s.threats[0].position_at(seen) - (s.start_position + seen * s.start_velocity);
        EXPECT_TRUE(seen == 0.0 || std::abs(first.norm() - 2000.0) < 30.0) << seed;
        weights += e.weight;
    }
    EXPECT_NEAR(weights / static_cast<double>(kCount), 1.0, 1e-9);
}

/// Two that begin in each other's volume have met already: nobody could have kept them apart.
TEST(Manned, EncountersBeginWellClear)
{
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    for (const fs::path& file : files) {
        const EncounterModel model = EncounterModel::load(file.string());
        for (std::uint64_t seed = 0; seed < 60; ++seed) {
            const Scenario s = manned_encounter(model, MannedSensor::adsb, seed).scenario;
            const Vec gap = s.threats[0].position_at(0.0) - s.start_position;
            EXPECT_TRUE(gap.head<2>().norm() >= kWellClearVolume.radius || std::abs(gap.z()) >= kWellClearVolume.height)
                << file << ", seed " << seed << ": " << gap.head<2>().norm() << " m, " << gap.z() << " m higher";
        }
    }
}

/// Of the summary: by hand.
TEST(Manned, RatiosAreWeightedAndZeroIsNotCertain)
{
    std::vector<MannedResult> results(300);
    for (std::size_t i = 0; i < results.size(); ++i) {
        results[i].seed = i;
        results[i].weight = i % 3 == 0 ? 0.1 : i % 3 == 1 ? 1.0 : 1.9;
        results[i].near_alone = i % 3 == 0;
        results[i].lost_alone = i % 3 != 2;
        results[i].lost = i % 6 == 1;
    }
    const MannedSummary sum = summary_of(results);
    EXPECT_EQ(sum.near_alone, 100U);
    EXPECT_EQ(sum.near_mid_air.value, 0.0);
    EXPECT_NEAR(sum.near_mid_air.high, 0.03, 1e-12) << "rule of three";
    EXPECT_NEAR(sum.well_clear.value, 50.0 / 110.0, 1e-12);
    EXPECT_LT(sum.well_clear.low, sum.well_clear.value);
    EXPECT_GT(sum.well_clear.high, sum.well_clear.value);
    // One event of hardly any weight: samples of it alone would leave next to nothing.
    results[3].weight = 1e-6;
    results[3].near = true;
    const MannedSummary one = summary_of(results);
    EXPECT_LT(one.near_mid_air.value, 1e-6);
    EXPECT_GT(one.near_mid_air.high, 0.05) << "one of a hundred, 95 %";
    EXPECT_LT(one.near_mid_air.high, 0.06);
}

TEST(Manned, NearMidAirCollisionsAreAvoidedWhereTheyCanBe)
{
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    for (const fs::path& file : files) {
        const EncounterModel model = EncounterModel::load(file);
        for (const MannedSensor sensor : {MannedSensor::adsb, MannedSensor::range}) {
            for (std::uint64_t seed = 3; seed < 18; seed += 3) {
                const MannedResult r = fly_manned(model, sensor, seed, {}, {});
                EXPECT_TRUE(r.near_alone);
                EXPECT_TRUE(r.took_over);
                EXPECT_FALSE(r.broke_rule);
                EXPECT_TRUE(!r.near || r.unavoidable) << file.filename() << ", " << to_string(sensor) << ", " << seed;
            }
        }
    }
}

/// Near mid-air collisions before turn rates were estimated.
TEST(Manned, TurnsThatReportsShowAreReckonedWith)
{
    const fs::path folder(JINK_ENCOUNTER_MODELS);
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    const char* const single_engine = "uncor_1200only_fwse_v1p2.txt";
    for (const auto& [name, seed] : {std::pair<const char*, std::uint64_t>{single_engine, 747},
                                     {single_engine, 1182},
                                     {single_engine, 1983},
                                     {single_engine, 2412},
                                     {"uncor_1200only_rotorcraft_v1p2.txt", 990}}) {
        const MannedResult r = fly_manned(EncounterModel::load(folder / name), MannedSensor::adsb, seed, {}, {});
        EXPECT_TRUE(r.near_alone) << name << ", " << seed;
        EXPECT_FALSE(r.near) << name << ", " << seed;
    }
}

/// Near mid-air collisions while descents to the floor failed their check.
TEST(Manned, DescendsBelowAnAircraftThatDescendsUntilTheFloor)
{
    const fs::path folder(JINK_ENCOUNTER_MODELS);
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    for (const auto& [name, seed] : {std::pair<const char*, std::uint64_t>{"uncor_1200only_fwse_v1p2.txt", 1216},
                                     {"uncor_1200only_fwse_v1p2.txt", 1839},
                                     {"uncor_1200only_rotorcraft_v1p2.txt", 1087},
                                     {"glider_v1.txt", 742}}) {
        EXPECT_FALSE(fly_manned(EncounterModel::load(folder / name), MannedSensor::adsb, seed, {}, {}).near)
            << name << ", " << seed;
    }
}

TEST(Manned, WithoutTheRuleTheyAreNot)
{
    const std::vector<fs::path> files = models();
    SKIP_WITHOUT_MODELS(files)
    const EncounterModel model = EncounterModel::load(files.back());
    EXPECT_TRUE(fly_manned(model, MannedSensor::adsb, 3, {{"JNK_WELL_CLEAR", 0.0}}, {}).near);
}

}  // namespace
}  // namespace jink::sim
