// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "toolchain/reach/vehicle_build.hpp"

// Reach sets as a C++ header.

namespace jink::host {

/// `inline constexpr VehicleSets k<Vehicle>Sets`, or k<Vehicle>ReducedSets, in jink::reach, with its tables before it.
/// The vehicle has a name that identifier_of takes.
[[nodiscard]] std::string reach_sets_header(const reach::build::BuiltVehicle& built);

}  // namespace jink::host
