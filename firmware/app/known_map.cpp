// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/known_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "firmware/app/constraints.hpp"
#include "firmware/link/mavlink/geodesy.hpp"

namespace jink::app {
namespace {

/// Before a vehicle that meets something coarse begins to brake [s].
constexpr Seconds kReaction = 1.0F;

float level(const Vec3& v) noexcept { return std::hypot(v.x(), v.y()); }

}  // namespace

void KnownMap::use(const geometry::MeshMap& map, world::ObstacleTable& table) noexcept
{
    map_ = &map;
    table.keep_places_for_map();
}

std::optional<world::MapPlace> KnownMap::place(const std::optional<link::GlobalPosition>& origin, const Vec3& own,
                                               float reach) const noexcept
{
    const geometry::MapOrigin& at = map_->origin;
    if (!at.known) {
        return world::MapPlace{};
    }
    if (!origin) {
        return std::nullopt;
    }
    using namespace link::mavlink;
    const Vec3 shift = to_local({at.latitude, at.longitude, at.altitude}, *origin);
    if (!(shift.norm() <= kMapReach)) {
        return std::nullopt;
    }
    constexpr float kRadians = 1e-7F * kPi / 180.0F;
    const float from_origin = level(own) + reach;
    const float from_map = level(own - shift) + reach;
    const float turned = std::abs(shift.x() / kEarthRadius * std::tan(static_cast<float>(at.latitude) * kRadians));
    const float curved = from_map / (2.0F * kEarthRadius);
    return world::MapPlace{shift, ConstraintTable::kMapError * from_origin + (turned + curved) * from_map};
}

void KnownMap::append_to(world::ObstacleTable& table, const std::optional<link::GlobalPosition>& origin,
                         const vehicle::VehicleState& own, const Configuration& c) noexcept
{
    leave_out();
    if (map_ == nullptr) {
        return;
    }
    const float speed = own.velocity.norm();
    const float stop = vehicle::stopping_distance(speed, c.limits) + kReaction * speed;
    const float own_size = c.limits.half_extents.norm() + c.rules.k_sigma * own.sigma_position;
    const float fastest = std::max(speed, kFastest * c.limits.cruise_speed);
    const float reach = own_size + std::max(stop, kLookaheads * c.rules.lookahead * fastest);
    const std::optional<world::MapPlace> placed = place(origin, own.position, reach);
    lacks_place_ = !placed;
    if (!placed) {
        return;
    }
    WorkBudget budget(kUnits);
    selection_ = world::append_map(*map_, *placed, own.position, reach, budget, table);
    is_unresolved_ = selection_.exact_within <= own_size;
    is_coarse_ = selection_.exact_within <= own_size + stop;
}

}  // namespace jink::app
