// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "toolchain/reach/coverage.hpp"
#include "toolchain/reach/vehicle_build.hpp"

// Measurement and drawing of reach sets.

namespace jink::host {

/// A set, and the function that builds it with other settings.
struct NamedSet {
    std::string name;
    reach::build::Settings settings;
    std::function<reach::build::Set(const reach::build::Settings&)> make;
    reach::build::Set set;
};

/// The sets of a vehicle, and those of Gomola's unit vehicle, used to compare generators (Gomola 6.4).
[[nodiscard]] std::vector<NamedSet> sets_of(const reach::build::BuiltVehicle& built);
[[nodiscard]] std::vector<NamedSet> sets_of_source();

struct SetFigures {
    reach::build::Metrics metrics;
    reach::build::Coverage coverage;
    std::size_t bytes = 0;  ///< size of its tables
};
[[nodiscard]] std::vector<SetFigures> measure_all(const std::vector<NamedSet>& sets);

/// One line per set, with a header line.
[[nodiscard]] std::string table_of(const std::vector<NamedSet>& sets, const std::vector<SetFigures>& figures);

/// The movements of each set as JSON, for toolchain/report/reach_sets.py.
[[nodiscard]] std::string drawing_of(const std::vector<NamedSet>& sets);

}  // namespace jink::host
