// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/world/threat_set.hpp"

namespace jink::oracle {

/// Threats of obstacles at rest whose place and that of the vehicle are exact. The obstacles outlive them.
inline std::vector<world::Threat> threats_of(std::span<const world::Obstacle> obstacles)
{
    std::vector<world::Threat> threats;
    for (const world::Obstacle& obstacle : obstacles) {
        threats.push_back(world::obstacle_threat(threats.size(), obstacle.shape, 0.0F));
    }
    return threats;
}

}  // namespace jink::oracle
