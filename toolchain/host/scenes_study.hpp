// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

// One scene, flown in several ways.

namespace jink::host {

/// A way of flying a scene: parameters of the co-processor on top of the scene's own.
struct FlownBy {
    std::string name;
    bool alone = false;  ///< without a co-processor, through whatever is in the way
    std::map<std::string, double> parameters;
};

/// Straight, and the four orders of methods that JNK_METHODS knows; then, of the order it is for, each JNK_CLUTTER.
[[nodiscard]] std::vector<FlownBy> ways_to_fly(const std::vector<unsigned>& clutters);

struct SceneFlight {
    FlownBy by;
    sim::Record record;
    double held = 0.0;  ///< standing still by command, all together [s]
};

struct Scene {
    sim::Scenario scenario;
    std::vector<SceneFlight> flights;
};

/// In process. O(ways) flights.
[[nodiscard]] Scene fly_scene(const sim::Scenario& scenario, const std::vector<FlownBy>& ways);

/// A line for each way, with a head.
[[nodiscard]] std::string table_of(const Scene& scene);

/// What the flights of scenes that differ by their seed alone have in common: a line for each way.
[[nodiscard]] std::string summary_of(const std::vector<Scene>& scenes);

/// Bodies and paths as JSON, for toolchain/report/reach_flights.py.
[[nodiscard]] std::string drawing_of(const std::vector<Scene>& scenes);

}  // namespace jink::host
