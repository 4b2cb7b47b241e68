// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/work_units.hpp"
#include "core/reach/near.hpp"

// Finds which threats may come near to which cells of a placed set.

namespace jink::reach::detail {
namespace {

/// No point of a movement is farther than this from one of its ends [movement's length].
constexpr float kHalfMovement = 0.5F;

}  // namespace

/// Least and greatest depth of the nodes that end in each cell.
struct NearThreats::Depths {
    std::array<std::uint8_t, kMaxReachCells> least{};
    std::array<std::uint8_t, kMaxReachCells> most{};  ///< 0: no node ends in it

    explicit Depths(const ReachSet& set) noexcept
    {
        least.fill(0xFF);
        for (std::size_t node = 1; node < set.nodes(); ++node) {
            const CellIndex end = set.end[node];
            least[end] = std::min(least[end], set.depth[node]);
            most[end] = std::max(most[end], set.depth[node]);
        }
    }
};

/// The cells of a layer in which a node ends, in the set's frame.
struct NearThreats::LayerCells {
    using Numbers = std::array<float, CellSpheres::kMaxDirections>;

    std::size_t count = 0;
    Numbers x;
    Numbers y;
    Numbers z;
    Numbers radius;
    Numbers first;  ///< earliest time at which a node comes from the cell before [movements]
    Numbers last;   ///< latest time at which a node has left the cell [movements]
    std::array<CellIndex, CellSpheres::kMaxDirections> cell;

    // Elements are set up to `count`.
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
    LayerCells(const Placed& placed, const CellSpheres& spheres, std::size_t layer, const Depths& depths) noexcept
    {
        const Grid<float>& grid = placed.set->grid;
        CellIndex at = grid.index({static_cast<std::uint8_t>(layer), 0, 0});
        for (std::size_t column = 0; column < grid.columns(); ++column) {
            for (std::size_t row = 0; row < grid.rows(); ++row, ++at) {
                if (depths.most[at] == 0) {
                    continue;
                }
                const Vec3 centre = spheres.distance(layer) * spheres.direction(column, row);
                x[count] = centre.x();
                y[count] = centre.y();
                z[count] = centre.z();
                radius[count] = spheres.radius(layer, row);
                first[count] = static_cast<float>(depths.least[at] - 1);
                last[count] = static_cast<float>(depths.most[at] + 1);
                cell[count++] = at;
            }
        }
        bound();
    }

    /// Bounds of all cells and their times: a threat far from the box between these times is near to no cell.
    void bound() noexcept
    {
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 at(x[i], y[i], z[i]);
            low = low.cwiseMin(at - Vec3::Constant(radius[i]));
            high = high.cwiseMax(at + Vec3::Constant(radius[i]));
            earliest = std::min(earliest, first[i]);
            latest = std::max(latest, last[i]);
        }
    }
    static constexpr float kUnbounded = std::numeric_limits<float>::infinity();
    Vec3 low = Vec3::Constant(kUnbounded);  ///< of a box about all of them
    Vec3 high = Vec3::Constant(-kUnbounded);
    float earliest = kUnbounded;
    float latest = 0.0F;
};

bool NearThreats::mark(const Placed& placed, const CellSpheres& spheres, WorkBudget& budget) noexcept
{
    const ReachSet& set = *placed.set;
    if (!budget.spend(static_cast<std::uint32_t>(units::kReachMark + set.nodes() / 16 * units::kReachDepths))) {
        return false;
    }
    const Depths depths(set);
    std::fill_n(of_cell_.begin(), set.grid.cells(), ThreatBits{});
    // The cells are paid for threat by threat, layer by layer: no piece of work is large.
    const std::size_t all = set.grid.cells() * (1 + near_.size()) / 4 * units::kReachCells;
    const std::size_t parts = set.grid.layers() * (1 + near_.size());
    std::size_t part = 0;
    const auto pay = [&]() noexcept {
        const std::size_t before = all * part / parts;
        ++part;
        return budget.spend(static_cast<std::uint32_t>(all * part / parts - before));
    };
    for (std::size_t layer = 0; layer < set.grid.layers(); ++layer) {
        if (!pay()) {
            return false;
        }
        const LayerCells cells(placed, spheres, layer, depths);
        for (std::size_t i = 0; i < near_.size(); ++i) {
            const bool is_solid = near_[i].shape != nullptr;
            if (!pay() ||
                (is_solid && !budget.spend(units::kReachSolidCell * static_cast<std::uint32_t>(cells.count)))) {
                return false;
            }
            mark_layer(placed, cells, i);
        }
    }
    return true;
}

/// Works in the set's frame, where the cells are the same for every plan.
void NearThreats::mark_layer(const Placed& placed, const LayerCells& cells, std::size_t threat) noexcept
{
    const NearThreat& near = near_[threat];
    // No point of a movement is farther from one of its ends than half of it.
    const Seconds longest = placed.period * static_cast<float>(kMaxDepth);
    const float around = kHalfMovement + (bulge_ + near.room + near.growth.at(longest) + near.body) / placed.unit;
    if (near.shape != nullptr) {
        for (std::size_t i = 0; i < cells.count; ++i) {
            const Vec3 centre(cells.x[i], cells.y[i], cells.z[i]);
            if (distance_to(near, placed.to_world(centre)) <= (cells.radius[i] + around) * placed.unit) {
                of_cell_[cells.cell[i]].add(threat);
            }
        }
        return;
    }
    const Vec3 at_start = placed.to_set(near.position);
    Vec3 per_period = placed.to_set(near.position + placed.period * near.velocity) - at_start;
    // A tall threat climbs little of its height meanwhile: its whole climb counts as height, so that the closest
    // approach is found in the level plane.
    const float climb = near.is_tall ? std::abs(near.velocity.z()) * longest : 0.0F;
    per_period.z() = near.is_tall ? 0.0F : per_period.z();
    const float speed_squared = per_period.squaredNorm();
    const float per_speed = speed_squared > 0.0F ? 1.0F / speed_squared : 0.0F;
    const float height = near.is_tall ? (near.half.z() + climb) / placed.unit : 0.0F;
    const Vec3 early = at_start + cells.earliest * per_period;
    const Vec3 late = at_start + cells.latest * per_period;
    const Vec3 size(around, around, around + height);
    if ((early.cwiseMin(late) - size - cells.high).maxCoeff() > 0.0F ||
        (cells.low - early.cwiseMax(late) - size).maxCoeff() > 0.0F) {
        return;
    }
    // Plain arrays, so that the compiler vectorises over cells.
    std::array<float, CellSpheres::kMaxDirections> spare{};
    for (std::size_t i = 0; i < cells.count; ++i) {
        const float x = cells.x[i] - at_start.x();
        const float y = cells.y[i] - at_start.y();
        const float z = cells.z[i] - at_start.z();
        // Closest instant within the interval in which some node comes to the cell, or leaves it.
        const float wanted = (x * per_period.x() + y * per_period.y() + z * per_period.z()) * per_speed;
        const float when = std::min(std::max(wanted, cells.first[i]), cells.last[i]);
        const float apart_x = x - when * per_period.x();
        const float apart_y = y - when * per_period.y();
        const float apart_z = std::max(std::abs(z - when * per_period.z()) - height, 0.0F);
        const float together = cells.radius[i] + around;
        spare[i] = apart_x * apart_x + apart_y * apart_y + apart_z * apart_z - together * together;
    }
    for (std::size_t i = 0; i < cells.count; ++i) {
        if (spare[i] <= 0.0F) {
            of_cell_[cells.cell[i]].add(threat);
        }
    }
}

}  // namespace jink::reach::detail
