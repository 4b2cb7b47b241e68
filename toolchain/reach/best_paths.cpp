// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/best_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <tuple>

#include <Eigen/Geometry>

#include "core/reach/reach_set.hpp"
#include "toolchain/reach/expansion.hpp"

namespace jink::reach::build {
namespace {

/// Distances within this tolerance are equal, so that every host builds the same set.
constexpr double kFinest = 1e-9;

/// Distance of a node's place from the line from the vehicle through the centre of its column [movements' lengths].
double off_centre_line(const Settings& settings, const Node& node)
{
    const Point<double> centre = settings.grid.centre(node.end);
    return node.pose.position.cross(centre.normalized()).norm();
}

int turns_of(const Node& node) { return node.depth - node.smooth; }

/// Fewer turns, then fewer movements, then nearer to the centre line; of equals the older one.
using Rank = std::tuple<int, int, double, NodeId>;

class BestSearch {
public:
    BestSearch(const Settings& settings, const BestRule& rule) : settings_(settings), rule_(rule) {}

    WaveFront run()
    {
        out_.nodes.push_back(root_of(settings_));
        extra_.push_back(0);
        expand(0);
        while (!waiting_.empty()) {
            const NodeId id = std::get<NodeId>(waiting_.top());
            waiting_.pop();
            const Node& node = out_.nodes[id];
            if (node.end.layer + 1U == settings_.grid.layers()) {
                ends_.push_back(id);
            } else if (std::size_t& known = known_[state_of(node)]; known < rule_.positions) {
                ++known;
                expand(id);
            }
        }
        choose_columns();
        if (rule_.wanted == BestFor::cells) {
            choose_cells();
        }
        std::sort(out_.front.begin(), out_.front.end());
        std::sort(out_.lateral.begin(), out_.lateral.end());
        return std::move(out_);
    }

private:
    using State = std::array<int, 6>;
    [[nodiscard]] State state_of(const Node& node) const
    {
        const bool fine = turns_of(node) <= rule_.fine_turns;
        const std::array<int, 3> part = part_of_cell(settings_.grid, node, fine ? rule_.parts : 1);
        return {settings_.grid.index(node.end), node.pitch_steps, node.yaw_steps, part[0], part[1], part[2]};
    }

    [[nodiscard]] Rank rank_of(NodeId id) const
    {
        const Node& node = out_.nodes[id];
        return {turns_of(node), node.depth, std::round(off_centre_line(settings_, node) / kFinest), id};
    }

    void expand(NodeId id)
    {
        for (const Movement movement : kAllMovements) {
            std::optional<Node> node = child_of(settings_, out_.nodes[id], id, movement);
            if (!node || node->depth > kMaxDepth) {
                continue;
            }
            const bool beyond = id == 0 || node->end.layer > out_.nodes[id].end.layer;
            const int extra = beyond ? 0 : extra_[id] + 1;
            if (extra > settings_.most_extra) {
                ++out_.extra_dropped;
                continue;
            }
            const auto next = static_cast<NodeId>(out_.nodes.size());
            out_.nodes.push_back(*std::move(node));
            extra_.push_back(extra);
            waiting_.push(rank_of(next));
        }
    }

    /// Ends are in rank order except for the distance, which here counts before the number of movements.
    void choose_columns()
    {
        std::map<CellIndex, NodeId> best;
        const auto ahead = [&](NodeId a, NodeId b) {
            const auto [turns_a, depth_a, off_a, id_a] = rank_of(a);
            const auto [turns_b, depth_b, off_b, id_b] = rank_of(b);
            return std::tie(turns_a, off_a, depth_a, id_a) < std::tie(turns_b, off_b, depth_b, id_b);
        };
        for (const NodeId id : ends_) {
            const auto [place, is_new] = best.try_emplace(settings_.grid.index(out_.nodes[id].end), id);
            if (!is_new && ahead(id, place->second)) {
                place->second = id;
            }
        }
        for (const auto& [cell, id] : best) {
            out_.front.push_back(id);
        }
    }

    /// Chooses whole trajectories again, in order of increasing cost: fewest new movements, fewest turns.
    void choose_cells()
    {
        std::vector<bool> kept(out_.nodes.size(), false);
        std::set<CellIndex> ended;
        kept[0] = true;
        const auto keep = [&](NodeId id) {
            for (; !kept[id]; id = out_.nodes[id].parent) {
                kept[id] = true;
                ended.insert(settings_.grid.index(out_.nodes[id].end));
            }
        };
        for (const NodeId id : out_.front) {
            keep(id);
        }
        std::map<CellIndex, std::vector<NodeId>> through;
        for (const NodeId end : ends_) {
            for (NodeId id = end; id != 0; id = out_.nodes[id].parent) {
                std::vector<NodeId>& of = through[settings_.grid.index(out_.nodes[id].end)];
                if (of.empty() || of.back() != end) {
                    of.push_back(end);
                }
            }
        }
        const auto adds = [&](NodeId end) {
            int movements = 0;
            for (NodeId id = end; !kept[id]; id = out_.nodes[id].parent) {
                ++movements;
            }
            return movements;
        };
        const std::map<CellIndex, NodeId> sides = best_at_sides();
        // From far to near cells: a trajectory to a far cell also ends movements in nearer cells.
        for (std::size_t at = settings_.grid.cells(); at-- > 0;) {
            const auto cell = static_cast<CellIndex>(at);
            if (ended.count(cell) != 0) {
                continue;
            }
            std::optional<std::tuple<int, int, NodeId>> best;
            for (const NodeId end : through[cell]) {
                const std::tuple<int, int, NodeId> rank{turns_of(out_.nodes[end]), adds(end), end};
                best = best ? std::min(*best, rank) : rank;
            }
            const auto side = sides.find(cell);
            if (side != sides.end() && (!best || turns_of(out_.nodes[side->second]) < std::get<0>(*best))) {
                out_.lateral.push_back(side->second);
                keep(side->second);
            } else if (best) {
                out_.front.push_back(std::get<NodeId>(*best));
                keep(out_.front.back());
            }
        }
    }

    /// Per cell at a side the trajectory with the fewest turns that ends there: continuing from the near ones requires
    /// turning back.
    [[nodiscard]] std::map<CellIndex, NodeId> best_at_sides() const
    {
        std::map<CellIndex, NodeId> best;
        for (NodeId id = 1; id < out_.nodes.size(); ++id) {
            const Node& node = out_.nodes[id];
            if (!ends_at_side(settings_, node) || node.end.layer + 1U == settings_.grid.layers()) {
                continue;
            }
            const auto [known, is_new] = best.try_emplace(settings_.grid.index(node.end), id);
            if (!is_new && rank_of(id) < rank_of(known->second)) {
                known->second = id;
            }
        }
        return best;
    }

    const Settings& settings_;
    const BestRule& rule_;
    WaveFront out_;
    std::vector<int> extra_;  ///< per node: number of consecutive movements up to the node that ended in the layer
                              ///< where they began
    std::vector<NodeId> ends_;
    std::map<State, std::size_t> known_;
    std::priority_queue<Rank, std::vector<Rank>, std::greater<>> waiting_;
};

}  // namespace

Set best_paths(const Settings& settings, const BestRule& rule)
{
    return kept(BestSearch(settings, rule).run(), kFromBest);
}

}  // namespace jink::reach::build
