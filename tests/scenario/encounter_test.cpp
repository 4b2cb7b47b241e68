// SPDX-License-Identifier: BSD-3-Clause
// Conflict prediction on recorded encounters of manned aircraft: predictions against the later recording.
//
// Size: a sphere of 0.66 nmi about the intruder, the horizontal well-clear distance of DO-365; a sphere cannot express
// its 450 ft in height, and the aircraft here fly at one height. The own box of 1 m is negligible.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "core/world/conflict.hpp"
#include "core/world/track_table.hpp"
#include "tests/oracle/collected.hpp"
#include "toolchain/sim/recorded_encounter.hpp"

namespace jink::test {
namespace {

namespace fs = std::filesystem;
using sim::Aircraft;
using sim::Fix;
using sim::Paired;

constexpr float kWellClear = 0.66F * 1852.0F;
constexpr float kLookahead = 60.0F;
constexpr int kSkipped = 77;

fs::path folder()
{
    for (const char* name : {"JINK_ENCOUNTERS", "JINK_ENCOUNTERS_DEFAULT"}) {
        if (const char* value = std::getenv(name); value != nullptr) {
            return value;
        }
    }
    return {};
}

std::vector<fs::path> files()
{
    std::vector<fs::path> all;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(folder(), missing)) {
        if (entry.path().extension() == ".daa") {
            all.push_back(entry.path());
        }
    }
    std::sort(all.begin(), all.end());
    return all;
}

/// The truth of the recording, sampled every 10 ms.
struct Truth {
    double closest_at = 0.0;
    double miss = 1e12;
    double loss_at = -1.0;  ///< first instant of lost well-clear; negative: never
};

Truth truth_of(const Aircraft& own, const Aircraft& other)
{
    Truth truth;
    const double end = std::min(own.fixes.back().time, other.fixes.back().time);
    for (double t = own.fixes.front().time; t <= end; t += 0.01) {
        const double distance = (own.at(t).position - other.at(t).position).norm();
        if (distance < truth.miss) {
            truth.miss = distance;
            truth.closest_at = t;
        }
        if (truth.loss_at < 0.0 && distance < static_cast<double>(kWellClear)) {
            truth.loss_at = t;
        }
    }
    return truth;
}

/// A prediction at one time.
struct Prediction {
    double time = 0.0;
    bool conflict = false;
    world::Conflict what;
};

TimePoint at(double seconds) { return {static_cast<std::int64_t>(std::llround(seconds * 1e6)) + 1'000'000}; }

/// Feeds the intruder through the track table at the recording's rate and asks for a conflict after each fix.
std::vector<Prediction> predict(const Aircraft& own, const Aircraft& other, float k_sigma)
{
    world::TrackTableSettings settings;
    settings.max_range = 200'000.0F;
    world::TrackTable table(settings);
    vehicle::VehicleLimits limits;
    limits.max_climb = limits.max_descent = 100.0F;
    const vehicle::Airframe airframe;
    const world::Airspace airspace;
    const world::FlightRules rules{.k_sigma = k_sigma};
    std::vector<Prediction> all;
    for (const auto& [mine, theirs] : sim::pair_by_time(own, other).fixes) {
        vehicle::VehicleState state;
        state.stamp = at(mine.time);
        state.position = mine.position.cast<float>();
        state.velocity = mine.velocity.cast<float>();
        world::TrackMeasurement seen;
        seen.id = 1;
        seen.stamp = at(theirs.time);
        seen.position = theirs.position.cast<float>();
        seen.velocity = theirs.velocity.cast<float>();
        seen.has_velocity = true;
        seen.radius = kWellClear;
        seen.sigma_position = 10.0F;  // a GPS position
        seen.sigma_velocity = 1.0F;
        const world::TrackStatus status = table.update(seen, state, at(mine.time));
        EXPECT_TRUE(status == world::TrackStatus::updated || status == world::TrackStatus::created) << mine.time;
        limits.cruise_speed = state.velocity.norm();
        const world::Reference reference(
            {state.position, state.position + state.velocity * 300.0F, limits.cruise_speed});
        const oracle::Collected collected(world::Situation{at(mine.time), state, limits, airframe, reference, rules},
                                          {table.snapshot(at(mine.time)), {}, airspace});
        const world::Situation& situation = *collected;
        Prediction prediction;
        prediction.time = mine.time;
        WorkBudget budget(100'000);
        prediction.conflict = world::conflict_with(situation, world::way_of(situation), situation.threats.front(),
                                                   kLookahead, budget, prediction.what);
        all.push_back(prediction);
    }
    return all;
}

class RecordedEncounter : public ::testing::TestWithParam<fs::path> {
protected:
    sim::RecordedEncounter encounter = sim::read_encounter(GetParam());
    const Aircraft& own = encounter.aircraft[0];
    const Aircraft& other = encounter.aircraft[1];
    Truth truth = truth_of(own, other);
};

TEST_P(RecordedEncounter, BothAircraftAreRecordedTogether)
{
    const Paired paired = sim::pair_by_time(own, other);
    ASSERT_GE(paired.fixes.size(), 60U);
    EXPECT_EQ(paired.fixes.size(), own.fixes.size());
    EXPECT_EQ(paired.unmatched, 0U);
    EXPECT_EQ(paired.interpolated, 0U);
    EXPECT_EQ(encounter.reordered, 0U);
    // Positions and velocities of the file belong together: a wrong unit or a wrong column would show here.
    for (const Aircraft* aircraft : {&own, &other}) {
        for (std::size_t i = 1; i < aircraft->fixes.size(); ++i) {
            const Fix& a = aircraft->fixes[i - 1];
            const Fix& b = aircraft->fixes[i];
            const Eigen::Vector3d flown = (b.position - a.position) / (b.time - a.time);
            ASSERT_LT((flown - 0.5 * (a.velocity + b.velocity)).norm(), 0.01 * a.velocity.norm())
                << aircraft->name << " " << a.time;
        }
    }
    std::cout << GetParam().filename().string() << ": closest " << truth.miss << " m at " << truth.closest_at
              << " s, well clear lost at " << truth.loss_at << " s\n";
}

TEST_P(RecordedEncounter, TheClosestApproachIsPredictedAndTheErrorShrinks)
{
    double far_error = 0.0;
    double near_error = 0.0;
    int compared = 0;
    for (const Prediction& p : predict(own, other, 0.0F)) {
        const double left = truth.closest_at - p.time;
        if (left <= 1.0 || left >= static_cast<double>(kLookahead) - 1.0) {
            continue;
        }
        ++compared;
        ASSERT_TRUE(p.conflict) << p.time;
        const double time_error = std::abs(static_cast<double>(p.what.time_to_closest) - left);
        const double miss_error = std::abs(static_cast<double>(p.what.miss_distance) - truth.miss);
        // The recording flies great circles, the prediction straight lines of a local plane: 1 % of the time left, and
        // 50 ms for the truth's raster and the file's rounding.
        EXPECT_LE(time_error, 0.01 * left + 0.05) << p.time;
        EXPECT_LE(miss_error, 1.0 * left + 5.0) << p.time;
        (left > 30.0 ? far_error : near_error) = std::max(left > 30.0 ? far_error : near_error, miss_error);
    }
    EXPECT_GE(compared, 40);
    EXPECT_LE(near_error, far_error + 1.0);
    std::cout << GetParam().filename().string() << ": miss distance off by " << far_error
              << " m at most before the last 30 s, by " << near_error << " m in them\n";
}

TEST_P(RecordedEncounter, TheLossIsSeenAsSoonAsItLiesWithinTheLookahead)
{
    ASSERT_GE(truth.loss_at, 0.0);
    for (const Prediction& p : predict(own, other, 0.0F)) {
        const double left = truth.loss_at - p.time;
        if (left > static_cast<double>(kLookahead) + 1.0) {
            EXPECT_FALSE(p.conflict) << p.time;
        } else if (left > 0.0 && left < static_cast<double>(kLookahead) - 1.0) {
            EXPECT_TRUE(p.conflict) << p.time;
            EXPECT_NEAR(static_cast<double>(p.what.time_to_loss), left, 0.01 * left + 0.05) << p.time;
        } else if (p.time > truth.closest_at + 1.0) {
            EXPECT_FALSE(p.conflict) << p.time;
        }
    }
}

TEST_P(RecordedEncounter, WithItsUncertaintyTheLossIsNeverPredictedTooLate)
{
    int compared = 0;
    for (const Prediction& p : predict(own, other, 3.0F)) {
        const double left = truth.loss_at - p.time;
        if (left > 0.0 && left < static_cast<double>(kLookahead) - 1.0) {
            ++compared;
            ASSERT_TRUE(p.conflict) << p.time;
            EXPECT_LE(static_cast<double>(p.what.time_to_loss), left + 0.02) << p.time;
        }
    }
    EXPECT_GE(compared, 40);
}

std::string name_of(const ::testing::TestParamInfo<fs::path>& info)
{
    std::string name = info.param.stem().string();
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Files, RecordedEncounter, ::testing::ValuesIn(files()), name_of);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RecordedEncounter);

}  // namespace
}  // namespace jink::test

int main(int argc, char** argv)
{
    ::testing::InitGoogleTest(&argc, argv);
    if (jink::test::files().empty()) {
        std::cout << "No recorded encounters in '" << jink::test::folder().string()
                  << "'; say where they are with JINK_ENCOUNTERS. Skipped.\n";
        return jink::test::kSkipped;
    }
    return RUN_ALL_TESTS();
}
