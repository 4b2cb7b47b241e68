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

// Weight tuning: closed-loop effect of the planner's weights, over the same random encounters for all combinations.

namespace jink::host {

/// Outcomes of a combination of weights over its encounters. Less is better for all but `separation`.
struct Outcomes {
    std::size_t flights = 0;
    std::size_t broken = 0;     ///< broken promises: breach or collision
    std::size_t avoidable = 0;  ///< broken promises that the judge calls avoidable
    std::size_t braked = 0;
    std::size_t failed = 0;     ///< flights with a broken rule of the protocol or of the airspace
    double separation = 0.0;    ///< 5 % quantile of the least separation of a flight [m]
    double deviation = 0.0;     ///< from the leg, root mean square of a flight; mean over flights [m]
    double acceleration = 0.0;  ///< integral of the squared acceleration; mean over flights [m2/s3]
    double jerk = 0.0;          ///< integral of the squared jerk; mean over flights [m2/s5]
};
/// @param results  not empty
[[nodiscard]] Outcomes outcomes_of(const std::vector<sim::EncounterResult>& results);

/// A combination of weights, and its outcomes.
struct Tried {
    cost::Weights weights;
    int published = 0;  ///< its number in Pinheiro tab. 4.8; 0: not one of the seven
    Outcomes outcomes;
    bool on_front = false;
};

/// Pinheiro's seven combinations first, then all others on a grid of `step`: each weight a multiple of `step`,
/// closeness above 0, and cost::is_valid true, so that the parameters GEO_K_S and GEO_K_T accept the weights.
[[nodiscard]] std::vector<Tried> combinations(double step);

/// The co-processor's parameters for these weights, with the geometric planner alone.
[[nodiscard]] sim::Variant variant_of(const cost::Weights& weights);

/// True when `a` is at least as good in every compared outcome (broken, braked, separation, deviation, acceleration,
/// jerk) and better in at least one.
[[nodiscard]] bool dominates(const Outcomes& a, const Outcomes& b);
/// Marks the combinations that no other combination dominates. O(n^2).
void mark_front(std::vector<Tried>& tried);

/// Geometric mean of the ratios of deviation, acceleration, jerk and inverse separation to those of `other`; below 1:
/// better. All four must be above zero.
[[nodiscard]] double relative_effort(const Outcomes& outcomes, const Outcomes& other);

/// Index of the fit: the least relative effort on the front among combinations that break no more promises and rules,
/// and brake no more often, than the default. If there is none, the default.
/// @param standard  index of the default weights
[[nodiscard]] std::size_t fit_of(const std::vector<Tried>& tried, std::size_t standard);

struct TuneSetup {
    std::filesystem::path out;  ///< one folder of encounters per combination (sim/encounter_campaign.hpp)
    std::uint64_t from = 1;
    std::size_t count = 100;
    std::size_t block = 25;
    double step = 0.1;
    unsigned threads = 1;
};

/// Flies all combinations; finished blocks in the folders are read instead of flown.
/// @param done  called before each combination with its number and the total
/// @throws sim::BadFolder
[[nodiscard]] std::vector<Tried> fly_combinations(const TuneSetup& setup,
                                                  const std::function<void(std::size_t, std::size_t)>& done);
/// The same for these weights alone.
[[nodiscard]] std::vector<sim::EncounterResult> fly_weights(const TuneSetup& setup, const cost::Weights& weights);

/// Paired difference between two combinations, flight by flight with the same seeds.
struct Difference {
    double mean = 0.0;
    double error = 0.0;  ///< standard error of the mean
};
/// @param value  of one flight. Both lists have the same seeds in the same order, at least two flights.
[[nodiscard]] Difference difference_of(const std::vector<sim::EncounterResult>& a,
                                       const std::vector<sim::EncounterResult>& b,
                                       const std::function<double(const sim::EncounterResult&)>& value);

}  // namespace jink::host
