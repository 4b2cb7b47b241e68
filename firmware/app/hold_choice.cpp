// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/hold_choice.hpp"

#include <algorithm>

namespace jink::app {

bool is_stopping_safer(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                       const world::Conflict& conflict, const world::Track* track) noexcept
{
    constexpr float kStands = 0.5F;  // [m/s]
    if (track == nullptr || track->velocity.norm() < kStands) {
        return true;
    }
    const float speed = own.velocity.norm();
    if (speed < vehicle::kStandstillSpeed) {
        return false;  // it stands already
    }
    const Vec3 rest = own.position + own.velocity * (vehicle::stopping_distance(speed, limits) / speed);
    const Seconds stopped = vehicle::stopping_time(speed, limits);
    const Vec3 apart = track->position + track->velocity * stopped - rest;
    const Seconds closest = std::clamp(-apart.dot(track->velocity) / track->velocity.squaredNorm(), 0.0F, kHoldAhead);
    return (apart + track->velocity * closest).norm() > conflict.miss_distance + kHoldBetter;
}

}  // namespace jink::app
