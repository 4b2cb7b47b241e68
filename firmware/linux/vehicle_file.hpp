// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/cost/cost.hpp"
#include "core/vehicle/vehicle.hpp"
#include "firmware/linux/complaint.hpp"
#include "firmware/linux/param_file.hpp"
#include "firmware/linux/yaml_map.hpp"

// Vehicle files (YAML, firmware/vehicles/): what a vehicle can do and what costs depend on. What decides how it flies
// is required, so that no vehicle is flown on another one's limits; rotors and the air have defaults, since no decision
// depends on them.

namespace jink::files {

struct Vehicle {
    std::string name;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    cost::Caps caps;  ///< of the file, or else those that cost::caps_for computes
};

/// Keys, units and ranges: docs in firmware/vehicles/default/vehicle.yaml; ranges are those of the parameters of the
/// same meaning.
[[nodiscard]] std::optional<Vehicle> read_vehicle_file(const std::filesystem::path& path, Complaints& complaints);

/// The same for a mapping within another file, `where` in complaints.
[[nodiscard]] std::optional<Vehicle> read_vehicle(const YAML::Node& node, const std::string& where,
                                                  const std::string& file, Complaints& complaints);

/// The vehicles that need no file: `default` (Pinheiro tab. 1.1) and `uav2` (tab. 4.5). Nothing for another name.
[[nodiscard]] std::optional<Vehicle> built_in_vehicle(std::string_view name);

/// `values` with VEH_*, JNK_HALF_* and GEO_T_* of the vehicle in place of theirs.
///
/// Each value is judged alone; `apply_together` asks whether they fit. Rotors and air density have no parameter: the
/// co-processor's cost does not depend on them.
[[nodiscard]] std::optional<ParamValues> apply_vehicle_file(const std::filesystem::path& path,
                                                            const ParamValues& values, Complaints& complaints);
[[nodiscard]] ParamValues apply_vehicle(const Vehicle& vehicle, const ParamValues& values);

}  // namespace jink::files
