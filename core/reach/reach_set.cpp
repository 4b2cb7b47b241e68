// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/reach_set.hpp"

#include "core/base/crc.hpp"

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

std::uint32_t checksum_of(const ReachSet& s) noexcept
{
    Crc crc;
    crc.add16(static_cast<std::uint16_t>(s.grid.layers()));
    crc.add16(static_cast<std::uint16_t>(s.grid.columns()));
    crc.add16(static_cast<std::uint16_t>(s.grid.rows()));
    for (const float number :
         {s.grid.distance(), s.grid.horizontal(), s.grid.vertical(), s.step.length, s.step.pitch, s.step.yaw}) {
        crc.add(number);
    }
    crc.add(s.samples);
    for (const NodeIndex parent : s.parent) {
        crc.add16(parent);
    }
    for (const std::uint8_t movement : s.movement) {
        crc.add(movement);
    }
    for (const CellIndex cell : s.end) {
        crc.add16(cell);
    }
    for (const std::int16_t number : s.position) {
        crc.add16(static_cast<std::uint16_t>(number));
    }
    for (const std::int8_t number : s.attitude) {
        crc.add(static_cast<std::uint8_t>(number));
    }
    for (const std::uint16_t cost : s.cost) {
        crc.add16(cost);
    }
    for (const std::uint8_t depth : s.depth) {
        crc.add(depth);
    }
    for (const std::uint16_t first : s.first_entry) {
        crc.add16(first);
    }
    for (const FootprintEntry& entry : s.entries) {
        crc.add16(entry.cell);
        crc.add(entry.first);
        crc.add(entry.last);
    }
    return crc.value();
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
