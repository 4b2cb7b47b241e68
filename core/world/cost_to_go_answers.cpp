// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/world/cost_to_go_field.hpp"

namespace jink::world {
namespace {

/// Less than this counts as nothing [s]: rounding, and places between cells.
constexpr Seconds kNothing = 0.1F;
/// Of the time of a step that counts where a way goes on: of steps that are as quick, the longest.
constexpr float kOfStep = 1.0F - 1e-4F;
/// Steps of a way that winds; it goes on from there with the next answer.
constexpr int kMaxSteps = 32;

}  // namespace

/// The way through open air is counted over the cells too: a place between cells loses nothing by that.
CostToGoField::Way CostToGoField::Field::way_from(const Vec3& place) const noexcept
{
    const Vec3 in = place - origin;
    const auto cell = [](float at, int count) { return std::clamp(static_cast<int>(std::lround(at)), 0, count - 1); };
    Way way;
    for_each_neighbour(
        {cell(in.x() / kWidth, kColumns), cell(in.y() / kWidth, kColumns), cell(in.z() / kHeight, kLayers)},
        [&](const Cell& other) {
            const Vec3 at = middle(other);
            const Seconds there = time_of(place - at);
            const Seconds over = cost[index(other)] + there;
            way.open = std::min(way.open, straight(at) + there);
            if (over < way.cost) {
                way.cost = over;
                way.first = other;
            }
        });
    return way;
}

std::optional<Seconds> CostToGoField::lost_from(const Vec3& place) const noexcept
{
    const Field& field = fields_[shown_];
    if (!known_ || !field.contains(place)) {
        return std::nullopt;
    }
    const Way way = field.way_from(place);
    return std::isfinite(way.cost) ? std::clamp(way.cost - way.open, 0.0F, kNoWay) : kNoWay;
}

std::optional<Vec3> CostToGoField::way_around(const Vec3& from, float distance) const noexcept
{
    const Field& field = fields_[shown_];
    const std::optional<Seconds> lost = lost_from(from);
    if (!lost || *lost <= kNothing || *lost >= kNoWay) {
        return std::nullopt;
    }
    const Times time = field.times_of_steps();
    Cell cell = field.way_from(from).first;
    for (int i = 0; i < kMaxSteps && (field.middle(cell) - from).norm() < distance; ++i) {
        Cell next = cell;
        Seconds best = field.cost[index(cell)];
        for_each_neighbour(cell, [&](const Cell& other) {
            const unsigned step =
                (other.x != cell.x ? 1U : 0U) | (other.y != cell.y ? 2U : 0U) | (other.z != cell.z ? 4U : 0U);
            const Seconds over = field.cost[index(other)] + kOfStep * time[step];
            if (over < best) {
                best = over;
                next = other;
            }
        });
        if (index(next) == index(cell)) {
            break;
        }
        cell = next;
    }
    return field.middle(cell);
}

}  // namespace jink::world
