// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "firmware/linux/complaint.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// A scenario file that cannot be used; what() has a line "file:line:column: why" for everything that is wrong with it.
class BadScenario : public std::runtime_error {
public:
    explicit BadScenario(files::Complaints complaints);

    /// In the order of the file; at least one.
    [[nodiscard]] const files::Complaints& complaints() const noexcept { return complaints_; }

private:
    files::Complaints complaints_;
};

/// Reads a scenario file (format: tests/scenario/README.md). Unknown keys, wrong types, missing and impossible values
/// are refused.
/// @param seed  where given, stands for the file's
/// @throws BadScenario
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file,
                                     std::optional<std::uint64_t> seed = std::nullopt);

/// The same from text; `name` stands for the file in messages, and its stem for the scenario's name.
[[nodiscard]] Scenario parse_scenario(const std::string& text, const std::filesystem::path& name);

/// All *.yaml of a folder in order of name.
[[nodiscard]] std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& folder);

/// Sets TRK_RADIUS and TRK_RADIUS_PT to the largest radius that is sensed as traffic and as a point, where the scenario
/// does not: ADSB_VEHICLE carries no size, so the co-processor has to be told.
void default_radii(Scenario& scenario);

/// Sets TRK_SIGMA_P to 0.5 m where the scenario does not: its traffic sensor is better than the ADS-B that the
/// parameter is delivered for.
void default_noise(Scenario& scenario);

}  // namespace jink::sim
