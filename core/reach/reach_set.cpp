// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/reach_set.hpp"

#include <algorithm>
#include <limits>

namespace jink::reach {
namespace {

bool has_sizes(const ReachSet& s) noexcept
{
    const std::size_t n = s.nodes();
    return s.movement.size() == n && s.end.size() == n && s.position.size() == 3 * n && s.attitude.size() == 2 * n &&
           s.cost.size() == n && s.depth.size() == n && s.first_entry.size() == n + 1 && s.first_entry.front() == 0 &&
           s.first_entry.back() == s.entries.size();
}

SetStatus check_node(const ReachSet& s, std::size_t node) noexcept
{
    if (s.parent[node] >= node || s.depth[node] != s.depth[s.parent[node]] + 1 || s.depth[node] > kMaxDepth) {
        return SetStatus::not_a_tree;
    }
    if (s.movement[node] >= kMovements) {
        return SetStatus::unknown_movement;
    }
    if (s.end[node] >= s.grid.cells()) {
        return SetStatus::unknown_cell;
    }
    if (s.first_entry[node] > s.first_entry[node + 1] || s.first_entry[node + 1] > s.entries.size()) {
        return SetStatus::bad_entry;
    }
    for (const FootprintEntry& entry : s.entered(node)) {
        if (entry.cell >= s.grid.cells()) {
            return SetStatus::unknown_cell;
        }
        if (entry.first == 0 || entry.last < entry.first || entry.last > s.samples) {
            return SetStatus::bad_entry;
        }
    }
    return SetStatus::good;
}

}  // namespace

SetChecksum::SetChecksum(const ReachSet& set) noexcept : set_(&set)
{
    crc_.add16(static_cast<std::uint16_t>(set.grid.layers()));
    crc_.add16(static_cast<std::uint16_t>(set.grid.columns()));
    crc_.add16(static_cast<std::uint16_t>(set.grid.rows()));
    for (const float number : {set.grid.distance(), set.grid.horizontal(), set.grid.vertical(), set.step.length,
                               set.step.pitch, set.step.yaw}) {
        crc_.add(number);
    }
    crc_.add(set.samples);
}

bool SetChecksum::advance(std::size_t elements) noexcept
{
    const std::size_t end = done_ + elements;
    std::size_t first = 0;  // of a table, among the elements of all
    const auto add_each = [&](const auto& table, auto add) noexcept {
        const std::size_t last = std::min(end, first + table.size());
        for (; done_ < last; ++done_) {
            add(table[done_ - first]);
        }
        first += table.size();
    };
    const auto add8 = [this](auto number) noexcept { crc_.add(static_cast<std::uint8_t>(number)); };
    const auto add16 = [this](auto number) noexcept { crc_.add16(static_cast<std::uint16_t>(number)); };
    add_each(set_->parent, add16);
    add_each(set_->movement, add8);
    add_each(set_->end, add16);
    add_each(set_->position, add16);
    add_each(set_->attitude, add8);
    add_each(set_->cost, add16);
    add_each(set_->depth, add8);
    add_each(set_->first_entry, add16);
    add_each(set_->entries, [&](const FootprintEntry& entry) noexcept {
        add16(entry.cell);
        add8(entry.first);
        add8(entry.last);
    });
    return done_ == first;
}

std::uint32_t checksum_of(const ReachSet& set) noexcept
{
    SetChecksum sum(set);
    static_cast<void>(sum.advance(std::numeric_limits<std::size_t>::max()));
    return sum.value();
}

SetStatus check(const ReachSet& s) noexcept
{
    if (s.nodes() == 0) {
        return SetStatus::empty;
    }
    if (s.nodes() > kMaxNodes || s.grid.cells() > kMaxCells || s.grid.layers() > kMaxLayers ||
        s.grid.columns() > kMaxColumns || s.grid.rows() > kMaxRows || s.entries.size() > 0xFFFFU) {
        return SetStatus::too_large;
    }
    if (!has_sizes(s)) {
        return SetStatus::sizes_differ;
    }
    if (s.parent[0] != 0 || s.depth[0] != 0 || s.first_entry[1] != 0) {
        return SetStatus::not_a_tree;
    }
    for (std::size_t node = 1; node < s.nodes(); ++node) {
        if (const SetStatus status = check_node(s, node); status != SetStatus::good) {
            return status;
        }
    }
    return checksum_of(s) == s.checksum ? SetStatus::good : SetStatus::wrong_checksum;
}

}  // namespace jink::reach
