// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/world/threat_set.hpp"

namespace jink::oracle {

/// Threats of obstacles at rest; the own place is exact. The obstacles outlive them.
inline std::vector<world::Threat> threats_of(std::span<const world::Obstacle> obstacles)
{
    std::vector<world::Threat> threats;
    for (const world::Obstacle& obstacle : obstacles) {
        threats.push_back(world::obstacle_threat(threats.size(), obstacle.shape, obstacle.uncertainty));
        threats.back().slack = obstacle.uncertainty;
    }
    return threats;
}

}  // namespace jink::oracle
