// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/hold_choice.hpp"

#include <algorithm>
#include <limits>

namespace jink::app {
namespace {

/// Chords of the braking path: within 0.1 m of it up to 15 m/s.
constexpr int kSlices = 8;

/// Least distance within `time` of two that are `apart` and part with `velocity`.
float closest_distance(const Vec3& apart, const Vec3& velocity, Seconds time) noexcept
{
    const float squared = velocity.squaredNorm();
    const Seconds at = squared > 0.0F ? std::clamp(-apart.dot(velocity) / squared, 0.0F, time) : 0.0F;
    return (apart + velocity * at).norm();
}

}  // namespace

bool is_stopping_safer(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                       const world::Conflict& conflict, const world::Track* track) noexcept
{
    if (track == nullptr || track->velocity.norm() < kHoldStands) {
        return true;
    }
    const float speed = own.velocity.norm();
    if (speed < vehicle::kStandstillSpeed) {
        return false;  // it stands already
    }
    const Seconds slice = vehicle::stopping_time(speed, limits) / static_cast<float>(kSlices);
    vehicle::VehicleState stopping = own;
    Vec3 other = track->position;
    float closest = std::numeric_limits<float>::max();
    for (int i = 0; i < kSlices; ++i) {
        const Vec3 before = stopping.position;
        vehicle::advance(stopping, Vec3::Zero(), limits, slice);
        const Vec3 chord = (stopping.position - before) / slice;
        closest = std::min(closest, closest_distance(other - before, track->velocity - chord, slice));
        other += track->velocity * slice;
    }
    closest = std::min(closest, closest_distance(other - stopping.position, track->velocity, kHoldAhead));
    return closest >= conflict.miss_distance + kHoldBetter;
}

}  // namespace jink::app
