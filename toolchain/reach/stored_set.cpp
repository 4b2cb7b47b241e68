// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/stored_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace jink::reach::build {
namespace {

double cost_of(Movement movement, const CostRule& rule)
{
    const Turn turn = turn_of(movement);
    const int axes = std::abs(turn.pitch) + std::abs(turn.yaw);
    return 1.0 + (axes == 0 ? 0.0 : axes == 1 ? rule.turn : rule.diagonal);
}

template <class T>
T stored(double value, double unit, const char* what)
{
    const double rounded = std::round(value / unit);
    if (!(rounded >= static_cast<double>(std::numeric_limits<T>::min()) &&
          rounded <= static_cast<double>(std::numeric_limits<T>::max()))) {
        throw std::length_error(std::string(what) + " " + std::to_string(value) + " does not fit");
    }
    return static_cast<T>(rounded);
}

}  // namespace

std::vector<double> costs_of(const Set& set, const CostRule& rule)
{
    std::vector<double> additive(set.members.size(), 0.0);
    std::vector<double> costs(set.members.size(), 0.0);
    for (std::size_t i = 1; i < set.members.size(); ++i) {
        const Node& node = set.members[i].node;
        const bool changes = node.parent != 0 && set.members[node.parent].node.movement != node.movement;
        additive[i] = additive[node.parent] + cost_of(node.movement, rule) + (changes ? rule.change : 0.0);
        costs[i] = additive[i] * (rule.by_smoothness ? 2.0 - node.smoothness() : 1.0);
    }
    return costs;
}

StoredSet::StoredSet(std::string name, const Settings& settings, const Set& set, const CostRule& rule)
    : name_(std::move(name)),
      grid_(settings.grid.layers(), settings.grid.columns(), settings.grid.rows(),
            static_cast<float>(settings.grid.distance()), static_cast<float>(settings.grid.horizontal()),
            static_cast<float>(settings.grid.vertical())),
      step_{static_cast<float>(settings.step.length), static_cast<float>(settings.step.pitch),
            static_cast<float>(settings.step.yaw)}
{
    if (set.members.size() > kMaxNodes) {
        throw std::length_error(std::to_string(set.members.size()) + " nodes are more than " +
                                std::to_string(kMaxNodes));
    }
    const std::vector<double> costs = costs_of(set, rule);
    for (std::size_t i = 0; i < set.members.size(); ++i) {
        const Node& node = set.members[i].node;
        parent_.push_back(static_cast<NodeIndex>(node.parent));
        movement_.push_back(static_cast<std::uint8_t>(node.movement));
        end_.push_back(i == 0 ? kNoCell : settings.grid.index(node.end));
        for (const double coordinate : node.pose.position) {
            position_.push_back(stored<std::int16_t>(coordinate, static_cast<double>(kPositionUnit), "coordinate"));
        }
        attitude_.push_back(node.pitch_steps);
        attitude_.push_back(node.yaw_steps);
        cost_.push_back(stored<std::uint16_t>(costs[i], static_cast<double>(kCostUnit), "cost"));
        depth_.push_back(node.depth);
        first_entry_.push_back(static_cast<std::uint16_t>(entries_.size()));
        for (const Entered& entered : node.entered) {
            entries_.push_back({entered.cell, entered.first, entered.last});
        }
        if (entries_.size() > std::numeric_limits<std::uint16_t>::max()) {
            throw std::length_error("more footprint entries than 65535");
        }
    }
    first_entry_.push_back(static_cast<std::uint16_t>(entries_.size()));
    checksum_ = checksum_of(view());
}

ReachSet StoredSet::view() const
{
    ReachSet set;
    set.name = name_;
    set.grid = grid_;
    set.step = step_;
    set.samples = kSamples;
    set.parent = parent_;
    set.movement = movement_;
    set.end = end_;
    set.position = position_;
    set.attitude = attitude_;
    set.cost = cost_;
    set.depth = depth_;
    set.first_entry = first_entry_;
    set.entries = entries_;
    set.checksum = checksum_;
    return set;
}

std::size_t bytes_of(const ReachSet& set)
{
    return set.parent.size_bytes() + set.movement.size_bytes() + set.end.size_bytes() + set.position.size_bytes() +
           set.attitude.size_bytes() + set.cost.size_bytes() + set.depth.size_bytes() + set.first_entry.size_bytes() +
           set.entries.size_bytes();
}

std::size_t bytes_of(const Set& set)
{
    // Parent, movement, end, position, attitude, cost, depth, first entry.
    constexpr std::size_t kNode = 2 + 1 + 2 + 6 + 2 + 2 + 1 + 2;
    std::size_t bytes = sizeof(std::uint16_t) + kNode * set.members.size();
    for (const Set::Member& member : set.members) {
        bytes += sizeof(FootprintEntry) * member.node.entered.size();
    }
    return bytes;
}

bool StoredSet::has_tables_of(const StoredSet& other) const
{
    const auto same = [](const FootprintEntry& a, const FootprintEntry& b) {
        return a.cell == b.cell && a.first == b.first && a.last == b.last;
    };
    // The grid and the step are in the checksum.
    return checksum_ == other.checksum_ && parent_ == other.parent_ && movement_ == other.movement_ &&
           end_ == other.end_ && position_ == other.position_ && attitude_ == other.attitude_ && cost_ == other.cost_ &&
           depth_ == other.depth_ && first_entry_ == other.first_entry_ && entries_.size() == other.entries_.size() &&
           std::equal(entries_.begin(), entries_.end(), other.entries_.begin(), same);
}

}  // namespace jink::reach::build
