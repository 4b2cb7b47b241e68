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

// Vehicle files (YAML, firmware/vehicles/): limits of a vehicle and parameters of its costs. All keys that affect how
// the vehicle flies are required, so that no vehicle flies with another one's limits. Rotors and the air have defaults,
// since no decision depends on them.

namespace jink::files {

struct Vehicle {
    std::string name;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    cost::Caps caps;  ///< of the file, or else computed by cost::caps_for
};

/// Keys, units and ranges are documented in firmware/vehicles/default/vehicle.yaml; ranges are those of the parameters
/// with the same meaning.
[[nodiscard]] std::optional<Vehicle> read_vehicle_file(const std::filesystem::path& path, Complaints& complaints);

/// The same for a mapping within another file; `where` is its name in complaints.
[[nodiscard]] std::optional<Vehicle> read_vehicle(const YAML::Node& node, const std::string& where,
                                                  const std::string& file, Complaints& complaints);

/// The vehicles without a file: `default` (Pinheiro tab. 1.1) and `uav2` (tab. 4.5). Nothing for another name.
[[nodiscard]] std::optional<Vehicle> built_in_vehicle(std::string_view name);

/// `values`, with VEH_*, JNK_HALF_* and GEO_T_* replaced by the vehicle's.
///
/// Each value is checked alone; `apply_together` checks their consistency. Rotors and air density have no parameter:
/// the co-processor's cost does not depend on them.
[[nodiscard]] std::optional<ParamValues> apply_vehicle_file(const std::filesystem::path& path,
                                                            const ParamValues& values, Complaints& complaints);
[[nodiscard]] ParamValues apply_vehicle(const Vehicle& vehicle, const ParamValues& values);

}  // namespace jink::files
