// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "firmware/linux/complaint.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// An invalid scenario file; what() has a line "file:line:column: why" for each error.
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
/// @param seed  where given, replaces the file's seed
/// @throws BadScenario
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file,
                                     std::optional<std::uint64_t> seed = std::nullopt);

/// The same from text. Messages use `name` as the file's name; its stem is the scenario's name.
[[nodiscard]] Scenario parse_scenario(const std::string& text, const std::filesystem::path& name);

/// All *.yaml of a folder, sorted by name.
[[nodiscard]] std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& folder);

/// Sets TRK_RADIUS and TRK_RADIUS_PT, unless the scenario does, to the largest radius sensed as traffic and as a point.
/// ADSB_VEHICLE carries no size, so the parameters must set the radius.
void default_radii(Scenario& scenario);

/// Sets TRK_SIGMA_P to 0.5 m unless the scenario does: its traffic sensor is better than the ADS-B of the default.
void default_noise(Scenario& scenario);

}  // namespace jink::sim
