// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/vehicle/vehicle.hpp"

namespace jink::vehicle {

/// Pinheiro's second vehicle (tab. 4.5), as vehicle.yaml; what the table does not give is as of the default vehicle.
[[nodiscard]] inline VehicleLimits uav2_limits() noexcept
{
    VehicleLimits limits;
    limits.cruise_speed = 15.0F;
    limits.max_climb = 8.0F;
    limits.max_descent = 8.0F;
    return limits;
}

[[nodiscard]] inline Airframe uav2_airframe() noexcept
{
    Airframe airframe;
    airframe.mass = 10.0F;
    airframe.drag_coefficient = 0.8F;
    airframe.effective_area = 10.0F;
    return airframe;
}

}  // namespace jink::vehicle
