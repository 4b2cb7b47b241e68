// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/world/world.hpp"

// How threats grow.

namespace jink::world {

Doubt doubt_of(const Situation& situation, const Track& track) noexcept
{
    /// As long as the supervisor waits on top of the stopping time before it forces anything [s].
    constexpr Seconds kReserve = 0.75F;
    const float own = situation.limits.max_acceleration;
    const float hidden = unheard_acceleration(track, situation.limits, situation.rules) -
                         track.max_acceleration;  // the rest is in the track's own growth
    if (!track.cooperative || !(hidden > 0.0F)) {
        return {};
    }
    const Seconds age = std::max(situation.now - track.stamp - kFreshReport, 0.0F);
    return {0.5F * hidden * age * age, hidden * age, situation.own.velocity.norm() / own + kReserve};
}

float threat_radius(const Situation& situation, const Track& track, Seconds t) noexcept
{
    const Seconds age = std::max(0.0F, (situation.now - track.stamp) + t);
    const float own = situation.own.sigma_position;
    const float places = std::sqrt(own * own + track.sigma_position * track.sigma_position);
    const float radius = track.radius + situation.rules.k_sigma * (places + track.sigma_velocity * age) +
                         0.5F * track.max_acceleration * age * age;
    if (!track.cooperative) {
        return radius;
    }
    const Doubt doubt = doubt_of(situation, track);
    return radius + doubt.position + doubt.velocity * std::min(std::max(t, 0.0F), doubt.ends);
}

Growth growth_of(const Situation& situation, const Track& track) noexcept
{
    const Seconds age = std::max(situation.now - track.stamp, 0.0F);
    return {threat_radius(situation, track, 0.0F),
            situation.rules.k_sigma * track.sigma_velocity + track.max_acceleration * age, track.max_acceleration};
}

}  // namespace jink::world
