// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/reach/reach_set.hpp"

// Reach sets made by hand, movement by movement.

namespace jink::reach::test {

/// A tree whose nodes are at the ends of their movements. Each movement enters only the cell of its end.
class SmallTree {
public:
    explicit SmallTree(const Grid<float>& grid = {}) : grid_(grid)
    {
        append(0, Movement::straight, 0, {}, kNoCell);
        first_entry_ = {0, 0};
    }

    /// The node that `movement` leads to from `from`; `cost` is of the whole trajectory [1 / 1024].
    NodeIndex add(NodeIndex from, Movement movement, std::uint16_t cost)
    {
        const Pose<float> to = apply(poses_[from], movement, step_);
        const Located at = grid_.locate(to.position);
        append(from, movement, cost, to, grid_.index(at.place));
        entries_.push_back({end_.back(), 1, 8});
        first_entry_.push_back(static_cast<std::uint16_t>(entries_.size()));
        return static_cast<NodeIndex>(parent_.size() - 1);
    }
    /// `first`, and straight flight after it: `movements` in all. The last node.
    NodeIndex chain(Movement first, std::size_t movements, std::uint16_t cost_each)
    {
        NodeIndex at = 0;
        for (std::size_t i = 0; i < movements; ++i) {
            at = add(at, i == 0 ? first : Movement::straight, static_cast<std::uint16_t>((i + 1) * cost_each));
        }
        return at;
    }
    /// The last movement enters `cell` as well.
    void enter(CellIndex cell)
    {
        entries_.push_back({cell, 1, 8});
        first_entry_.back() = static_cast<std::uint16_t>(entries_.size());
    }

    [[nodiscard]] CellIndex end(NodeIndex node) const { return end_[node]; }
    [[nodiscard]] const Vec3& position(NodeIndex node) const { return poses_[node].position; }
    [[nodiscard]] ReachSet view() const
    {
        ReachSet set;
        set.name = "small";
        set.grid = grid_;
        set.step = step_;
        set.samples = 8;
        set.parent = parent_;
        set.movement = movement_;
        set.end = end_;
        set.position = position_;
        set.attitude = attitude_;
        set.cost = cost_;
        set.depth = depth_;
        set.first_entry = first_entry_;
        set.entries = entries_;
        set.checksum = checksum_of(set);
        return set;
    }

private:
    void append(NodeIndex from, Movement movement, std::uint16_t cost, const Pose<float>& to, CellIndex cell)
    {
        const auto steps = [](float angle, float step) { return static_cast<std::int8_t>(std::lround(angle / step)); };
        depth_.push_back(static_cast<std::uint8_t>(parent_.empty() ? 0 : depth_[from] + 1));
        parent_.push_back(from);
        movement_.push_back(static_cast<std::uint8_t>(movement));
        end_.push_back(cell);
        for (const float coordinate : {to.position.x(), to.position.y(), to.position.z()}) {
            position_.push_back(static_cast<std::int16_t>(std::lround(coordinate / kPositionUnit)));
        }
        attitude_.push_back(steps(to.pitch, step_.pitch));
        attitude_.push_back(steps(to.yaw, step_.yaw));
        cost_.push_back(cost);
        poses_.push_back(to);
    }

    Grid<float> grid_;
    MovementStep<float> step_;
    std::vector<Pose<float>> poses_;
    std::vector<NodeIndex> parent_;
    std::vector<std::uint8_t> movement_, depth_;
    std::vector<CellIndex> end_;
    std::vector<std::int16_t> position_;
    std::vector<std::int8_t> attitude_;
    std::vector<std::uint16_t> cost_, first_entry_;
    std::vector<FootprintEntry> entries_;
};

}  // namespace jink::reach::test
