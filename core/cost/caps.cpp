// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "core/cost/cost.hpp"

namespace jink::cost {
namespace {

constexpr std::size_t kReferencePoints = std::min<std::size_t>(57, kMaxPathPoints);

/// Simple candidate on the leg along `leg` [m], offset `offset` [m] along the unit vector `side`.
path::TimedPath fly(const Vec3& leg, const Vec3& side, float offset, const vehicle::VehicleLimits& limits) noexcept
{
    std::array<Vec3, kReferencePoints> positions;
    for (std::size_t i = 0; i < kReferencePoints; ++i) {
        const float u = 1.5F * static_cast<float>(i) / static_cast<float>(kReferencePoints - 1);
        positions[i] = u * leg + (offset * u * u * (3.0F - 2.0F * u)) * side;
    }
    path::TimedPath path;
    // Always succeeds: the points lie centimetres apart.
    static_cast<void>(path::make_timed_path(positions, limits.cruise_speed, limits, path));
    return path;
}

}  // namespace

Caps reference_flights(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe) noexcept
{
    const path::TimedPath lower = fly(Vec3(3.0F, 0.0F, 0.0F), Vec3::UnitY(), 3.2F * 2.0F / 3.0F, limits);
    const Vec3 leg(8.25F, 0.0F, -1.75F);
    const Vec3 up = Vec3(-leg.z(), 0.0F, leg.x()).normalized();
    const path::TimedPath upper = fly(leg, up, -3.2F * 3.0F, limits);
    return {.time_low = flight_time(lower),
            .time_high = flight_time(upper),
            .energy_low = energy(lower, airframe),
            .energy_high = energy(upper, airframe)};
}

Caps caps_for(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe) noexcept
{
    const Caps published;
    const Caps base = reference_flights(vehicle::VehicleLimits{}, vehicle::Airframe{});
    const Caps own = reference_flights(limits, airframe);
    return {.time_low = published.time_low * (own.time_low / base.time_low),
            .time_high = published.time_high * (own.time_high / base.time_high),
            .energy_low = published.energy_low * (own.energy_low / base.energy_low),
            .energy_high = published.energy_high * (own.energy_high / base.energy_high)};
}

}  // namespace jink::cost
