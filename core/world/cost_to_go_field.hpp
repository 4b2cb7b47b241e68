// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "core/base/service.hpp"
#include "core/base/static_vector.hpp"
#include "core/base/work_budget.hpp"
#include "core/world/cost_to_go.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// CostToGo on a grid of cells about the vehicle (world frame, the vehicle in the middle cell).
///
/// A cell is blocked where the own box about its middle comes nearer than kSpare to an obstacle, to a closed area with
/// its margin or to the airspace's bounds, as they are now; the box counts as round, and as no narrower than a wall has
/// to be grown to be tight. Beside slanted solids a cell may be free up to 0.2 m nearer. From free cell to free cell
/// (26 neighbours) the way takes the level distance at the reference's speed plus the climb at the slower of climb and
/// descent. It leads to the route's point kAhead farther along than abeam: from the grid's sides straight on to it, and
/// from its top or bottom where that point lies beyond; or, where it lies in the grid, to the free cells nearest to it.
/// What is not known to be blocked counts as free.
///
/// A background service: `begin` takes over what is around the vehicle, `advance` builds the field, `show` makes it the
/// one that answers. The cells are swept in eight orders until nothing changes (fast sweeping), so the result is that
/// of Dijkstra's algorithm, however the work is divided.
///
/// Memory: about 110 KiB, for computers that have LiDARs. Work: some hundred thousand units for a field among houses.
class CostToGoField final : public CostToGo {  // NOLINT(cppcoreguidelines-virtual-class-destructor): final
public:
    static constexpr int kColumns = 33;  ///< to the east, and rows to the north
    static constexpr int kLayers = 11;
    static constexpr std::size_t kCells = std::size_t{kColumns} * kColumns * kLayers;
    static constexpr float kWidth = 2.0F;   ///< of a cell, to the east and to the north [m]
    static constexpr float kHeight = 2.5F;  ///< [m]
    static constexpr float kAhead = 60.0F;  ///< of the goal along the route [m]
    static constexpr float kSpare = 0.5F;   ///< [m]
    /// What is lost where no way is known [s].
    static constexpr Seconds kNoWay = 30.0F;
    /// Work units that `advance` pays at once, at most.
    static constexpr std::uint32_t kPiece = 1200;

    /// Takes over obstacles, closed areas, bounds and route; what was being built is dropped. Without a route, and
    /// where nothing is within the grid, there is nothing to build, and nothing is known once that is shown.
    /// O(threats).
    void begin(const Situation& situation) noexcept;
    /// Nothing is being built, and nothing waits to be shown.
    [[nodiscard]] bool is_idle() const noexcept { return stage_ == Stage::idle; }
    /// `done` once the field is complete; `running` also when idle.
    [[nodiscard]] Progress advance(WorkBudget& budget) noexcept;
    /// What is complete answers from now on; otherwise nothing changes. Not while a plan runs: its result would depend
    /// on when it is run.
    void show() noexcept;
    /// Nothing is known any more.
    void forget() noexcept;

    [[nodiscard]] std::optional<Seconds> lost_from(const Vec3& place) const noexcept override;
    [[nodiscard]] std::optional<Vec3> way_around(const Vec3& from, float distance) const noexcept override;

private:
    struct Cell {
        int x, y, z;
    };
    /// What a cell's middle must be farther from than `reach`, sideways and beyond the own half height.
    struct Block {
        geometry::Shape shape;
        float reach;
        std::array<Cell, 2> cells;  ///< the first and the last that may be blocked
    };
    /// Of a step to a neighbour by its axes: bit 0 for x, 1 for y, 2 for z.
    using Times = std::array<Seconds, 8>;
    /// From a place of the grid over the cells about it.
    struct Way {
        Cell first{};  ///< cell of the quickest way
        Seconds cost = std::numeric_limits<Seconds>::infinity();
        Seconds open = std::numeric_limits<Seconds>::infinity();  ///< the same through open air
    };
    struct Field {
        Vec3 origin = Vec3::Zero();  ///< middle of cell 0, 0, 0
        Vec3 goal = Vec3::Zero();
        float speed = 1.0F;
        float climb = 1.0F;
        std::array<Seconds, kCells> cost{};  ///< infinity: blocked, or no way

        [[nodiscard]] Vec3 middle(const Cell& cell) const noexcept;
        [[nodiscard]] Seconds time_of(const Vec3& way) const noexcept;
        [[nodiscard]] Seconds straight(const Vec3& from) const noexcept { return time_of(goal - from); }
        [[nodiscard]] bool contains(const Vec3& place) const noexcept;
        [[nodiscard]] Times times_of_steps() const noexcept;
        [[nodiscard]] Way way_from(const Vec3& place) const noexcept;
    };
    /// What `advance` does next.
    enum class Stage : std::uint8_t { idle, bounds, blocks, goal, sources, sweeps, complete };

    [[nodiscard]] static std::size_t index(const Cell& cell) noexcept;
    template <class Visit>
    static void for_each_neighbour(const Cell& cell, const Visit& visit) noexcept;
    [[nodiscard]] Field& built() noexcept { return fields_[1 - shown_]; }
    void add_block(const geometry::Shape& shape, float reach) noexcept;
    [[nodiscard]] std::uint32_t units_of_next() const noexcept;
    void do_next() noexcept;
    void next_stage(Stage stage) noexcept;
    void mark_bounds(int z) noexcept;
    void mark_block(const Block& block, int z) noexcept;
    void find_goal(int z) noexcept;
    void set_sources(int z) noexcept;
    void sweep(unsigned order, int layer) noexcept;

    std::array<Field, 2> fields_;
    std::size_t shown_ = 0;
    bool known_ = false;

    Stage stage_ = Stage::idle;
    std::size_t piece_ = 0;   ///< of the stage
    bool is_needed_ = false;  ///< there is a route, and something within the grid
    int rounds_ = 0;
    bool changed_ = false;
    Seconds nearest_to_goal_ = 0.0F;
    Vec3 half_ = Vec3::Zero();  ///< of the own box; x and y: the larger of both
    struct Bounds {
        static constexpr float kNone = std::numeric_limits<float>::infinity();
        float floor = -kNone;
        float ceiling = kNone;
        Vec3 home = Vec3::Zero();
        float keep_in = kNone;
    };
    Bounds bounds_;
    StaticVector<Block, kMaxObstacles + kMaxCylinders> blocks_;
    std::array<bool, kCells> blocked_{};
};

/// And the cell itself.
template <class Visit>
void CostToGoField::for_each_neighbour(const Cell& cell, const Visit& visit) noexcept
{
    for (int z = std::max(0, cell.z - 1); z <= std::min(kLayers - 1, cell.z + 1); ++z) {
        for (int y = std::max(0, cell.y - 1); y <= std::min(kColumns - 1, cell.y + 1); ++y) {
            for (int x = std::max(0, cell.x - 1); x <= std::min(kColumns - 1, cell.x + 1); ++x) {
                visit(Cell{x, y, z});
            }
        }
    }
}

}  // namespace jink::world
