// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/reach/reach_set.hpp"
#include "toolchain/reach/set.hpp"

// A set as flight tables.

namespace jink::reach::build {

/// Cost of a trajectory: its length first, steering second.
struct CostRule {
    double turn = 0.1;       ///< of a turn or a climb, in addition to its length
    double diagonal = 0.15;  ///< of turn and climb at once
    double change = 0.05;    ///< of a movement that differs from the previous movement
    /// Non-smooth trajectories cost up to twice as much (Gomola eq. 6.84). Not additive: for ranking only.
    bool by_smoothness = false;
};
/// Cost of each member [movements' lengths].
[[nodiscard]] std::vector<double> costs_of(const Set& set, const CostRule& rule);

/// Size of a set's tables in flash.
[[nodiscard]] std::size_t bytes_of(const ReachSet& set);
/// Size that the tables would have; the set may be too large for them.
[[nodiscard]] std::size_t bytes_of(const Set& set);

/// The tables, owned.
class StoredSet {
public:
    /// @throws std::length_error when the set exceeds the tables' limits.
    StoredSet(std::string name, const Settings& settings, const Set& set, const CostRule& rule);

    /// A view of this set, which must outlive the view.
    [[nodiscard]] ReachSet view() const;
    /// True if all is equal except the name.
    [[nodiscard]] bool has_tables_of(const StoredSet& other) const;

private:
    std::string name_;
    Grid<float> grid_;
    MovementStep<float> step_;
    std::vector<NodeIndex> parent_;
    std::vector<std::uint8_t> movement_;
    std::vector<CellIndex> end_;
    std::vector<std::int16_t> position_;
    std::vector<std::int8_t> attitude_;
    std::vector<std::uint16_t> cost_;
    std::vector<std::uint8_t> depth_;
    std::vector<std::uint16_t> first_entry_;
    std::vector<FootprintEntry> entries_;
    std::uint32_t checksum_ = 0;
};

}  // namespace jink::reach::build
