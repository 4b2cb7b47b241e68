// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/random.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::timing {

/// One case of the crossing scene: own box or sphere and threat, each moving along its path in one second.
struct CrossingCase {
    geometry::Motion own, threat;
};

/// The crossing scene: own from x = -5 to +5, threat from y = -5 to +5, the other coordinates of each end uniform
/// within 2 m (the threat's x within 3 m).
struct CrossingScene {
    Vec3 half{0.5F, 0.4F, 0.15F};
    float own_radius = 0.5F;
    float radius = 1.0F;
    std::vector<CrossingCase> cases;

    explicit CrossingScene(std::size_t count = 2000, std::uint64_t seed = 42)
    {
        Random random(seed);
        const auto within = [&](float side) { return random.uniform(-side, side); };
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 own_from(-5.0F, within(2.0F), within(2.0F));
            const Vec3 own_to(5.0F, within(2.0F), within(2.0F));
            const Vec3 threat_from(within(3.0F), -5.0F, within(2.0F));
            const Vec3 threat_to(within(3.0F), 5.0F, within(2.0F));
            cases.push_back({{own_from, own_to - own_from}, {threat_from, threat_to - threat_from}});
        }
    }
};

}  // namespace jink::timing
