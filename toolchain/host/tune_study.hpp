// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/cost/cost.hpp"
#include "toolchain/sim/encounter.hpp"

// Weights by numbers: what the planner's weights do in the closed loop, over the same random encounters for all of
// them.

namespace jink::host {

/// What a combination of weights comes to over its encounters. Less is better in each but `separation`.
struct Outcomes {
    std::size_t flights = 0;
    std::size_t broken = 0;     ///< promises: breach or collision
    std::size_t avoidable = 0;  ///< of these, says the judge
    std::size_t braked = 0;
    std::size_t failed = 0;     ///< a rule of the protocol or of the airspace
    double separation = 0.0;    ///< least of a flight; below it 5 % of the flights [m]
    double deviation = 0.0;     ///< from the leg, root mean square of a flight; mean [m]
    double acceleration = 0.0;  ///< integral of its square; mean [m2/s3]
    double jerk = 0.0;          ///< the same [m2/s5]
};
/// @param results  not empty
[[nodiscard]] Outcomes outcomes_of(const std::vector<sim::EncounterResult>& results);

/// A combination, and how it flew.
struct Tried {
    cost::Weights weights;
    int published = 0;  ///< the source's number of it (Pinheiro tab. 4.8), 0: not one of the seven
    Outcomes outcomes;
    bool on_front = false;
};

/// The seven of the source first, then all others on a grid of `step`: each weight a multiple of it, closeness above 0,
/// and such that the parameters GEO_K_S and GEO_K_T take them, which is what cost::is_valid says.
[[nodiscard]] std::vector<Tried> combinations(double step);

/// The co-processor's parameters for these weights, with the geometric planner alone.
[[nodiscard]] sim::Variant variant_of(const cost::Weights& weights);

/// True when `a` is at least as good in every outcome that is compared (broken, braked, separation, deviation,
/// acceleration, jerk) and better in one.
[[nodiscard]] bool dominates(const Outcomes& a, const Outcomes& b);
/// Marks those that no other one dominates. O(n^2).
void mark_front(std::vector<Tried>& tried);

/// Deviation, acceleration, jerk and the inverse of separation as a geometric mean of what they are for the other one;
/// below 1: better. All four have to be above zero.
[[nodiscard]] double relative_effort(const Outcomes& outcomes, const Outcomes& other);

/// Index of the fit: the least relative effort among those on the front that break no more promises and no more rules,
/// and brake no more often, than the default. The default itself where there is none, so it always exists.
/// @param standard  index of the default weights
[[nodiscard]] std::size_t fit_of(const std::vector<Tried>& tried, std::size_t standard);

struct TuneSetup {
    std::filesystem::path out;  ///< one folder of encounters for each combination (sim/encounter_campaign.hpp)
    std::uint64_t from = 1;
    std::size_t count = 100;
    std::size_t block = 25;
    double step = 0.1;
    unsigned threads = 1;
};

/// Flies all combinations; what lies finished in the folders is read and not flown again.
/// @param done  called before each with its number and how many there are
/// @throws sim::BadFolder
[[nodiscard]] std::vector<Tried> fly_combinations(const TuneSetup& setup,
                                                  const std::function<void(std::size_t, std::size_t)>& done);
/// The same for these weights alone.
[[nodiscard]] std::vector<sim::EncounterResult> fly_weights(const TuneSetup& setup, const cost::Weights& weights);

/// What a pair of combinations differs by, flight by flight with the same seeds.
struct Difference {
    double mean = 0.0;
    double error = 0.0;  ///< standard error of the mean
};
/// @param value  of one flight. Both lists have the same seeds in the same order, two flights or more.
[[nodiscard]] Difference difference_of(const std::vector<sim::EncounterResult>& a,
                                       const std::vector<sim::EncounterResult>& b,
                                       const std::function<double(const sim::EncounterResult&)>& value);

}  // namespace jink::host
