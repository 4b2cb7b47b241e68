// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/wave_front.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <tuple>

#include "toolchain/reach/expansion.hpp"

namespace jink::reach::build {
namespace {

class Growth {
public:
    Growth(const Settings& settings, const Constraint& constraint) : settings_(settings), constraint_(constraint)
    {
        out_.nodes.push_back(root_of(settings));
    }

    WaveFront run()
    {
        std::vector<NodeId> stack = expand(0, -1);
        purge(stack);
        for (std::size_t layer = 0; layer + 1 < settings_.grid.layers(); ++layer) {
            std::map<CellIndex, std::vector<NodeId>> buckets;
            for (const NodeId id : stack) {
                buckets[settings_.grid.index(out_.nodes[id].end)].push_back(id);
            }
            std::vector<NodeId> next;
            for (auto& [cell, passing] : buckets) {
                std::sort(passing.begin(), passing.end());
                for (const NodeId id : constraint_.select(out_.nodes, passing)) {
                    expanded_.push_back(id);
                    const std::vector<NodeId> leaves = expand(id, static_cast<int>(layer));
                    next.insert(next.end(), leaves.begin(), leaves.end());
                }
            }
            purge(next);
            stack = std::move(next);
        }
        out_.front = std::move(stack);
        if (settings_.keep_lateral) {
            keep_lateral();
        }
        return std::move(out_);
    }

private:
    /// Children that end beyond `layer`, with up to most_extra movements before them that do not.
    std::vector<NodeId> expand(NodeId id, int layer)
    {
        std::vector<NodeId> leaves;
        expand(id, layer, 0, leaves);
        return leaves;
    }
    void expand(NodeId id, int layer, int extra, std::vector<NodeId>& leaves)
    {
        for (const Movement movement : kAllMovements) {
            std::optional<Node> node = child_of(settings_, out_.nodes[id], id, movement);
            if (!node || !constraint_.allows(*node)) {
                continue;
            }
            if (out_.nodes.size() >= settings_.most_nodes) {
                out_.truncated = true;
                return;
            }
            const bool beyond = static_cast<int>(node->end.layer) > layer;
            if (!beyond && extra >= settings_.most_extra) {
                ++out_.extra_dropped;
                continue;
            }
            const auto next = static_cast<NodeId>(out_.nodes.size());
            out_.nodes.push_back(std::move(*node));
            if (beyond) {
                leaves.push_back(next);
            } else {
                expand(next, layer, extra + 1, leaves);
            }
        }
    }

    /// Of expanded nodes without kept successors: keeps those that end at a side, the smoothest and shortest of each
    /// cell.
    void keep_lateral()
    {
        std::vector<bool> leads(out_.nodes.size(), false);
        const auto mark = [&](NodeId id) {
            for (leads[0] = true; !leads[id]; id = out_.nodes[id].parent) {
                leads[id] = true;
            }
        };
        for (const NodeId id : out_.front) {
            mark(id);
        }
        // Children have greater ids than their parents: in descending order, the last node of a trajectory comes first.
        std::sort(expanded_.begin(), expanded_.end(), std::greater<>());
        std::map<CellIndex, std::vector<NodeId>> ends;
        for (const NodeId id : expanded_) {
            if (!leads[id] && ends_at_side(settings_, out_.nodes[id])) {
                mark(id);
                ends[settings_.grid.index(out_.nodes[id].end)].push_back(id);
            }
        }
        for (auto& [cell, ids] : ends) {
            std::sort(ids.begin(), ids.end(), [&](NodeId a, NodeId b) {
                const Node& m = out_.nodes[a];
                const Node& n = out_.nodes[b];
                return std::make_tuple(-m.smoothness(), m.depth, a) < std::make_tuple(-n.smoothness(), n.depth, b);
            });
            ids.resize(std::min(ids.size(), settings_.most_lateral));
            out_.lateral.insert(out_.lateral.end(), ids.begin(), ids.end());
        }
        std::sort(out_.lateral.begin(), out_.lateral.end());
    }

    /// Keeps the best of each key, in the order of their ids.
    void purge(std::vector<NodeId>& ids) const
    {
        std::sort(ids.begin(), ids.end());
        if (constraint_.keeps_equals) {
            return;
        }
        std::map<std::vector<std::uint16_t>, NodeId> best;
        for (const NodeId id : ids) {
            const auto [place, is_new] = best.try_emplace(key_of(out_.nodes[id], 0, settings_.attitude_in_key), id);
            if (!is_new && constraint_.measure(out_.nodes[id]) < constraint_.measure(out_.nodes[place->second])) {
                place->second = id;
            }
        }
        ids.clear();
        for (const auto& [key, id] : best) {
            ids.push_back(id);
        }
        std::sort(ids.begin(), ids.end());
    }

    const Settings& settings_;
    const Constraint& constraint_;
    std::vector<NodeId> expanded_;
    WaveFront out_;
};

}  // namespace

std::vector<std::uint16_t> key_of(const Node& node, std::size_t tail, bool attitude)
{
    const std::size_t length = tail == 0 ? node.footprint.size() : std::min(tail, node.footprint.size());
    std::vector<std::uint16_t> key(node.footprint.end() - static_cast<std::ptrdiff_t>(length), node.footprint.end());
    if (attitude) {
        key.push_back(static_cast<std::uint16_t>(node.yaw_steps + 0x4000));
        key.push_back(static_cast<std::uint16_t>(node.pitch_steps + 0x4000));
    }
    return key;
}

WaveFront grow(const Settings& settings, const Constraint& constraint) { return Growth(settings, constraint).run(); }

}  // namespace jink::reach::build
