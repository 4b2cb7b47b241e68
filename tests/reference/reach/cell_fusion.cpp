// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/cell_fusion.hpp"

#include <algorithm>
#include <cmath>

#include "core/world/threat_set.hpp"

namespace jink::reach {
namespace {

// Work units.
constexpr std::uint32_t kUnitsStay = 6;        // sample of a node, when cell times are computed
constexpr std::uint32_t kUnitsCellBounds = 8;  // cell against the bounds of the airspace
constexpr std::uint32_t kUnitsCellTrack = 6;   // and a track
constexpr std::uint32_t kUnitsCellSolid = 30;  // or an obstacle

void lower(Level& level, AvoidanceRun run) noexcept { level = std::min(level, static_cast<Level>(run)); }

/// A direction of the world in the set's frame.
Vec3 turned(const Placed& placed, const Vec3& world) noexcept
{
    return placed.to_set(placed.origin + placed.unit * world);
}

}  // namespace

MapBody body_of(const geometry::Shape& shape, const Placed& placed, float about, float margin) noexcept
{
    MapBody body;
    Vec3 centre = shape.centre;
    Vec3 half = Vec3::Zero();
    float rounding = about;
    switch (shape.kind) {
    case geometry::ShapeKind::sphere: rounding += shape.radius; break;
    case geometry::ShapeKind::box: half = shape.half; break;
    case geometry::ShapeKind::capsule:
        half = Vec3(0.0F, 0.0F, shape.half.z());
        rounding += shape.radius;
        break;
    case geometry::ShapeKind::cylinder: half = Vec3(shape.radius, shape.radius, shape.half.z()); break;
    case geometry::ShapeKind::hull: {
        Vec3 low = Vec3::Zero();
        Vec3 high = Vec3::Zero();
        for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
            low = i == 0 ? shape.vertices[0].vec() : Vec3(low.cwiseMin(shape.vertices[i].vec()));
            high = i == 0 ? shape.vertices[0].vec() : Vec3(high.cwiseMax(shape.vertices[i].vec()));
        }
        centre += shape.axes * (0.5F * (low + high));
        half = 0.5F * (high - low);
        break;
    }
    }
    body.centre = placed.to_set(centre);
    for (Eigen::Index i = 0; i < 3; ++i) {
        body.axes.col(i) = turned(placed, shape.axes.col(i));
    }
    body.half = half / placed.unit;
    body.rounding = rounding / placed.unit;
    body.margin = margin / placed.unit;
    return body;
}

bool CellFusion::find_times(const Placed& placed, WorkBudget& budget) noexcept
{
    const ReachSet& set = *placed.set;
    if (times_of_ == &set && period_ == placed.period) {
        return true;
    }
    if (!budget.spend(static_cast<std::uint32_t>(set.nodes() * set.samples) * kUnitsStay)) {
        return false;
    }
    cell_times(set, placed.period, {times_.data(), set.grid.cells()});
    times_of_ = &set;
    period_ = placed.period;
    return true;
}

void CellFusion::rate_track(const world::Situation& situation, const world::Threat& track, const Placed& placed,
                            const CellSpheres& spheres, Seconds lead, std::span<Level> blocks) const noexcept
{
    const ReachSet& set = *placed.set;
    const Seconds longest = placed.period * static_cast<float>(kMaxDepth);
    Intruder intruder;
    intruder.position = placed.to_set(track.nearest_in_height(lead, placed.origin.z()));
    intruder.velocity = turned(placed, track.velocity) / placed.unit;
    intruder.radius = (track.growth_from(lead).at(longest) + situation.limits.half_extents.norm()) / placed.unit;
    intruder.horizontal = rule_.horizontal;
    intruder.vertical = rule_.vertical;
    intruder.speed_share = 0.0F;  // its growth has the error of its speed
    const CombinedModel model(set.grid, intruder, rule_.models, rule_.clock);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const auto cell = static_cast<CellIndex>(i);
        const CellPlace place = set.grid.place(cell);
        const CellSphere sphere{spheres.centre(place), spheres.radius(place.layer, place.row)};
        const std::optional<Stay> vehicle = is_never(times_[i]) ? std::nullopt : std::optional(times_[i]);
        if (vehicle && model.in(cell, sphere, vehicle).rate >= kThreshold) {
            lower(blocks[i], AvoidanceRun::intruders);
        }
    }
}

void CellFusion::rate_obstacle(const world::Situation& situation, const world::Threat& obstacle, const Placed& placed,
                               std::span<Level> blocks) const noexcept
{
    const Grid<float>& grid = placed.set->grid;
    const float about = situation.limits.half_extents.norm() + world::own_uncertainty(situation);
    const MapBody body = body_of(*obstacle.solid, placed, about, rule_.room);
    if (body.centre.norm() - body.half.norm() - body.rounding - body.margin > grid.distance()) {
        return;
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const CellPlace place = grid.place(static_cast<CellIndex>(i));
        const Closure closure = closure_of(grid, place, box_of(grid, place), body);
        if (closure == Closure::hard) {
            lower(blocks[i], AvoidanceRun::obstacles);
        } else if (closure == Closure::soft) {
            lower(blocks[i], AvoidanceRun::soft_constraints);
        }
    }
}

void CellFusion::rate_airspace(const world::Situation& situation, const Placed& placed, const CellSpheres& spheres,
                               std::span<Level> blocks) noexcept
{
    const Vec3& half = situation.limits.half_extents;
    const Grid<float>& grid = placed.set->grid;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const CellPlace place = grid.place(static_cast<CellIndex>(i));
        const Heights heights = heights_of(grid, place);
        const float bottom = placed.unit * (placed.upside_down ? -heights.top : heights.bottom) + placed.origin.z();
        const float top = placed.unit * (placed.upside_down ? -heights.bottom : heights.top) + placed.origin.z();
        const Vec3 centre = placed.to_world(spheres.centre(place));
        const float reach = placed.unit * spheres.radius(place.layer, place.row);
        const auto passes = [&](const world::Threat& bound) {
            const float extra = bound.growth.radius;
            switch (bound.form) {
            case world::ThreatForm::floor: return bottom < bound.position.z() + half.z() + extra;
            case world::ThreatForm::ceiling: return top > bound.position.z() - half.z() - extra;
            case world::ThreatForm::keep_in:
                return (centre - bound.position).head<2>().norm() + reach >
                       bound.level_radius - std::hypot(half.x(), half.y()) - extra;
            default: return false;
            }
        };
        if (std::any_of(situation.threats.begin(), situation.threats.end(), passes)) {
            lower(blocks[i], AvoidanceRun::hard_constraints);
        }
    }
}

RateStatus CellFusion::rate(const world::Situation& situation, const Placed& placed, const CellSpheres& spheres,
                            Seconds lead, std::span<Level> blocks, WorkBudget& budget) noexcept
{
    const auto cells = static_cast<std::uint32_t>(blocks.size());
    const std::span tracks = world::of_kind(situation.threats, world::ThreatKind::track);
    const std::span obstacles = world::of_kind(situation.threats, world::ThreatKind::obstacle);
    const auto units = static_cast<std::uint32_t>(kUnitsCellBounds + tracks.size() * kUnitsCellTrack +
                                                  obstacles.size() * kUnitsCellSolid);
    if (!find_times(placed, budget) || !budget.spend(cells * units)) {
        return RateStatus::budget_spent;
    }
    for (const world::Threat& track : tracks) {
        rate_track(situation, track, placed, spheres, lead, blocks);
    }
    for (const world::Threat& obstacle : obstacles) {
        rate_obstacle(situation, obstacle, placed, blocks);
    }
    rate_airspace(situation, placed, spheres, blocks);
    return RateStatus::rated;
}

}  // namespace jink::reach
