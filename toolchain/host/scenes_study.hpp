// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

// One scene, flown with several configurations.

namespace jink::host {

/// A configuration to fly a scene: co-processor parameters in addition to the scene's own.
struct FlownBy {
    std::string name;
    bool alone = false;  ///< without a co-processor, no avoidance
    std::map<std::string, double> parameters;
};

/// Straight flight, each method alone, the two that plan, and all of them.
[[nodiscard]] std::vector<FlownBy> ways_to_fly();

struct SceneFlight {
    FlownBy by;
    sim::Record record;
    double held = 0.0;  ///< total time of commanded stops [s]
};

struct Scene {
    sim::Scenario scenario;
    std::vector<SceneFlight> flights;
};

/// Flies in process. O(ways) flights.
[[nodiscard]] Scene fly_scene(const sim::Scenario& scenario, const std::vector<FlownBy>& ways);

/// One line per configuration, with a header line.
[[nodiscard]] std::string table_of(const Scene& scene);

/// Summary of scenes that differ by their seed alone: one line per configuration.
[[nodiscard]] std::string summary_of(const std::vector<Scene>& scenes);

/// Bodies and paths as JSON, for toolchain/report/reach_flights.py.
[[nodiscard]] std::string drawing_of(const std::vector<Scene>& scenes);

}  // namespace jink::host
