// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/crc.hpp"
#include "core/reach/grid.hpp"
#include "core/reach/movement.hpp"

// A reach set as stored: a tree of movements from the vehicle's position, made on the host (`jink reach build`) and
// kept as constant tables (Gomola 6.4).

namespace jink::reach {

/// Capacity of one set. A node is the end of a trajectory, the movements from the root to the node. 16-bit indices; a
/// set of 10 layers, 7 columns and 5 rows has about 2300 nodes (combined) or 1100 (planes).
inline constexpr std::size_t kMaxNodes = 4096;
inline constexpr std::size_t kMaxCells = 1024;
/// Capacity for the movements of a trajectory.
inline constexpr std::size_t kMaxDepth = 16;

/// A cell that a movement enters as the first of its trajectory, and when: from sample `first` to sample `last` of
/// ReachSet::samples equal parts of the movement, counted from 1. The movement is in the cell during the parts that end
/// with these samples, and may be during the part after them.
struct FootprintEntry {
    CellIndex cell = kNoCell;
    std::uint8_t first = 0;
    std::uint8_t last = 0;
};

using NodeIndex = std::uint16_t;
inline constexpr NodeIndex kNoNode = 0xFFFF;

/// Positions are stored in this share of a movement's length.
inline constexpr float kPositionUnit = 1.0F / 1024.0F;
/// Unit of stored costs.
inline constexpr float kCostUnit = 1.0F / 1024.0F;

/// A view of constant tables, structure of arrays. Node 0 is the root; parents come before their children. Lengths are
/// in movements' lengths, so one set serves every speed at which the vehicle turns by the same steps per movement.
///
/// Memory: 18 bytes a node, 4 an entry: about 55 KiB for 2300 nodes.
struct ReachSet {
    std::string_view name;
    Grid<float> grid;
    MovementStep<float> step;  ///< length 1
    std::uint8_t samples = 0;

    std::span<const NodeIndex> parent;
    std::span<const std::uint8_t> movement;      ///< Movement that leads from the parent; of the root: straight
    std::span<const CellIndex> end;              ///< cell of the node; of the root: kNoCell
    std::span<const std::int16_t> position;      ///< x, y, z of each [kPositionUnit]
    std::span<const std::int8_t> attitude;       ///< pitch and yaw of each, in steps
    std::span<const std::uint16_t> cost;         ///< of the trajectory [kCostUnit]
    std::span<const std::uint8_t> depth;         ///< movements from the root
    std::span<const std::uint16_t> first_entry;  ///< of each node, in `entries`; one more than there are nodes
    std::span<const FootprintEntry> entries;
    std::uint32_t checksum = 0;  ///< of all of the above (`checksum_of`)

    [[nodiscard]] std::size_t nodes() const noexcept { return parent.size(); }
    [[nodiscard]] std::span<const FootprintEntry> entered(std::size_t node) const noexcept
    {
        return entries.subspan(first_entry[node], static_cast<std::size_t>(first_entry[node + 1] - first_entry[node]));
    }
    [[nodiscard]] Vec3 position_of(std::size_t node) const noexcept
    {
        return kPositionUnit * Vec3(position[3 * node], position[3 * node + 1], position[3 * node + 2]);
    }
    [[nodiscard]] float cost_of(std::size_t node) const noexcept { return kCostUnit * static_cast<float>(cost[node]); }
};

/// Result of `check`. A set is accepted as a whole or refused as a whole.
enum class SetStatus : std::uint8_t {
    good,
    empty,         ///< no root
    too_large,     ///< more nodes, cells or entries than the capacities
    sizes_differ,  ///< the tables do not belong together
    not_a_tree,    ///< a parent after its child, or a child's depth other than its parent's plus one
    unknown_movement,
    unknown_cell,
    bad_entry,  ///< times out of order, or beyond the movement
    wrong_checksum,
    bad_segments,  ///< of a vehicle: numbers or sets that do not belong together (vehicle_sets.hpp)
};

/// `checksum_of` in parts.
class SetChecksum {
public:
    /// The set outlives this.
    [[gnu::cold]] explicit SetChecksum(const ReachSet& set) noexcept;
    /// Goes on by so many numbers or entries of the tables; true at their end. O(elements).
    [[nodiscard]] bool advance(std::size_t elements) noexcept;
    /// At the end of the tables.
    [[nodiscard]] std::uint32_t value() const noexcept { return crc_.value(); }

private:
    const ReachSet* set_;
    Crc crc_;
    std::size_t done_ = 0;
};

/// CRC-32 (IEEE 802.3) of the tables and of the set's numbers, in a byte order that is the same on every machine.
/// O(bytes).
[[nodiscard]] std::uint32_t checksum_of(const ReachSet& set) noexcept;
/// Checks everything that evaluation relies on. O(nodes + entries).
[[nodiscard]] SetStatus check(const ReachSet& set) noexcept;

}  // namespace jink::reach
