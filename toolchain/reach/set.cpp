// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/set.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace jink::reach::build {
namespace {

/// Children of each node, in the order of their movements.
std::vector<std::vector<NodeId>> children_of(const std::vector<Node>& nodes, const std::vector<bool>& keeps)
{
    std::vector<std::vector<NodeId>> children(nodes.size());
    for (NodeId id = 1; id < nodes.size(); ++id) {
        if (keeps[id]) {
            children[nodes[id].parent].push_back(id);
        }
    }
    for (std::vector<NodeId>& of : children) {
        std::sort(of.begin(), of.end(), [&](NodeId a, NodeId b) { return nodes[a].movement < nodes[b].movement; });
    }
    return children;
}

}  // namespace

std::size_t Set::trajectories() const
{
    return static_cast<std::size_t>(
        std::count_if(members.begin(), members.end(), [](const Member& m) { return m.in_front; }));
}

Set kept(const WaveFront& grown, std::uint8_t origin)
{
    std::vector<bool> keeps(grown.nodes.size(), false);
    std::vector<bool> in_front(grown.nodes.size(), false);
    std::vector<bool> lateral(grown.nodes.size(), false);
    keeps[0] = true;
    const auto keep = [&](NodeId id, std::vector<bool>& as) {
        for (as[id] = true; !keeps[id]; id = grown.nodes[id].parent) {
            keeps[id] = true;
        }
    };
    for (const NodeId id : grown.front) {
        keep(id, in_front);
    }
    for (const NodeId id : grown.lateral) {
        keep(id, lateral);
    }
    const std::vector<std::vector<NodeId>> children = children_of(grown.nodes, keeps);
    Set set;
    std::vector<NodeId> order{0};
    set.members.push_back({grown.nodes[0], origin, false, false});
    for (std::size_t at = 0; at < order.size(); ++at) {
        for (const NodeId child : children[order[at]]) {
            order.push_back(child);
            set.members.push_back({grown.nodes[child], origin, in_front[child], lateral[child]});
            set.members.back().node.parent = static_cast<NodeId>(at);
        }
    }
    return set;
}

Set merged(const Set& a, const Set& b)
{
    using Pair = std::array<std::optional<NodeId>, 2>;
    const std::array<const Set*, 2> sets{&a, &b};
    std::array<std::map<std::pair<NodeId, Movement>, NodeId>, 2> child;
    for (std::size_t s = 0; s < 2; ++s) {
        for (NodeId id = 1; id < sets[s]->members.size(); ++id) {
            const Node& node = sets[s]->members[id].node;
            child[s][{node.parent, node.movement}] = id;
        }
    }
    Set out;
    std::vector<Pair> pairs;
    const auto add = [&](const Pair& pair, NodeId parent) {
        Set::Member member = sets[pair[0] ? 0 : 1]->members[pair[0] ? *pair[0] : *pair[1]];
        if (pair[0] && pair[1]) {
            const Set::Member& other = b.members[*pair[1]];
            member.origins = static_cast<std::uint8_t>(member.origins | other.origins);
            member.in_front = member.in_front || other.in_front;
            // A trajectory that ends in one set may continue in the other; it is still an exit.
            member.is_lateral = member.is_lateral || other.is_lateral;
        }
        member.node.parent = parent;
        out.members.push_back(std::move(member));
        pairs.push_back(pair);
    };
    add({0, 0}, 0);
    for (std::size_t at = 0; at < pairs.size(); ++at) {
        const Pair here = pairs[at];
        for (const Movement movement : kAllMovements) {
            Pair next;
            for (std::size_t s = 0; s < 2; ++s) {
                if (here[s]) {
                    const auto found = child[s].find({*here[s], movement});
                    next[s] = found != child[s].end() ? std::optional(found->second) : std::nullopt;
                }
            }
            if (next[0] || next[1]) {
                add(next, static_cast<NodeId>(at));
            }
        }
    }
    return out;
}

Metrics measure(const Set& set)
{
    Metrics m;
    std::set<CellIndex> cells;
    std::set<std::vector<CellIndex>> footprints;
    m.nodes = set.members.size();
    for (const Set::Member& member : set.members) {
        m.most_entered = std::max(m.most_entered, member.node.entered.size());
        if (!member.in_front && !member.is_lateral) {
            continue;
        }
        const Node& node = member.node;
        cells.insert(node.footprint.begin(), node.footprint.end());
        footprints.insert(node.footprint);
        if (member.in_front) {
            ++m.trajectories;
            m.mean_smoothness += node.smoothness();
        } else {
            ++m.laterals;
        }
        m.most_depth = std::max<std::size_t>(m.most_depth, node.depth);
        m.longest_footprint = std::max(m.longest_footprint, node.footprint.size());
    }
    m.cells = cells.size();
    m.footprints = footprints.size();
    m.mean_smoothness /= static_cast<double>(std::max<std::size_t>(m.trajectories, 1));
    return m;
}

Set full_set(const Settings& settings)
{
    Constraint everything;
    everything.keeps_equals = true;
    everything.select = [](const std::vector<Node>&, std::span<const NodeId> passing) {
        return std::vector<NodeId>(passing.begin(), passing.end());
    };
    return kept(grow(settings, everything), 0);
}

}  // namespace jink::reach::build
