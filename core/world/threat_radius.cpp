// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/world/world.hpp"

// How threats grow.

namespace jink::world {

float threat_radius(const Situation& situation, const Track& track, Seconds t) noexcept
{
    const Seconds age = std::max(0.0F, (situation.now - track.stamp) + t);
    const float own = situation.own.sigma_position;
    const float places = std::sqrt(own * own + track.sigma_position * track.sigma_position);
    return track.radius + situation.rules.k_sigma * (places + track.sigma_velocity * age) +
           0.5F * track.max_acceleration * age * age;
}

Growth growth_of(const Situation& situation, const Track& track) noexcept
{
    const Seconds age = std::max(situation.now - track.stamp, 0.0F);
    return {threat_radius(situation, track, 0.0F),
            situation.rules.k_sigma * track.sigma_velocity + track.max_acceleration * age, track.max_acceleration};
}

}  // namespace jink::world
