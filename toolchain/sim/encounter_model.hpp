// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "core/base/random.hpp"

// Bayesian network models of manned aircraft: the parameter files of MIT Lincoln Laboratory's encounter models
// (Airspace-Encounter-Models/em-model-manned-bayes; Kochenderfer et al., Project Report ATC-345, 2008).

namespace jink::sim {

/// One state of a sampled aircraft. SI units; heights above ground.
struct ModelState {
    double speed = 0.0;         ///< true airspeed [m/s]
    double acceleration = 0.0;  ///< [m/s2]
    double climb = 0.0;         ///< [m/s]
    double turn_rate = 0.0;     ///< to the right [rad/s]
};

/// A sampled track: the state of each second, and what holds for all of it.
struct ModelTrack {
    double height = 0.0;  ///< at the start, above ground [m]
    std::vector<ModelState> states;
};

/// Draws tracks of one model.
class EncounterModel {
public:
    /// @throws std::runtime_error, "file:line:column: what was expected": sections that are missing or come twice,
    /// other sizes than the networks have, texts in place of numbers, variables that are not known, a cycle
    [[nodiscard]] static EncounterModel load(const std::filesystem::path& file);
    [[nodiscard]] static EncounterModel read(std::istream& in, const std::string& name);

    /// A track of so many seconds. O(seconds * variables).
    [[nodiscard]] ModelTrack sample(Random& random, std::size_t seconds) const;

    /// The bins of the initial network's variables, in the file's order: for checks of the distribution. O(variables).
    [[nodiscard]] std::vector<std::size_t> sample_bins(Random& random) const;
    [[nodiscard]] std::size_t variables() const noexcept { return initial_.size(); }
    [[nodiscard]] std::size_t bins(std::size_t variable) const { return initial_[variable].bins; }
    /// Exact chances of a variable's bins. O(product of all bins).
    [[nodiscard]] std::vector<double> marginal(std::size_t variable) const;

private:
    /// A variable of a network, with the counts of its bins for each combination of its parents' bins.
    struct Node {
        std::size_t bins = 0;
        std::vector<std::size_t> parents;  ///< by index, ascending
        std::vector<std::size_t> parent_bins;
        std::vector<double> counts;  ///< own bin fastest, then the first parent's

        /// Of the first of the own bins. `values`: of all variables.
        [[nodiscard]] std::size_t row(const std::vector<std::size_t>& values) const;
    };
    /// Where the file has the variables that move an aircraft.
    enum Variable : std::size_t { layer, speed, acceleration, climb, turn, kVariables };

    [[nodiscard]] static std::size_t draw(Random& random, const Node& node, const std::vector<std::size_t>& values,
                                          std::size_t otherwise);
    [[nodiscard]] double value_in(Random& random, std::size_t variable, std::size_t bin) const;
    [[nodiscard]] std::vector<std::size_t> order() const;

    std::vector<Node> initial_;
    std::vector<Node> next_;             ///< of the dynamic network: the variables of the next second alone
    std::vector<std::size_t> followed_;  ///< the initial variable that each of these becomes
    std::vector<std::vector<double>> edges_;
    std::vector<double> resampled_;  ///< chance per second
    std::array<std::size_t, kVariables> index_{};
};

}  // namespace jink::sim
