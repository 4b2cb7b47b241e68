// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/wave_front.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

namespace jink::reach::build {
namespace {

/// Least distance of a point of a cell from its four side walls: two half-planes and two cones through the vehicle.
double wall_distance(const Grid<double>& grid, const CellPlace& cell, const Polar<double>& p)
{
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t side : {0U, 1U}) {
        const double azimuth = grid.column_start(cell.column + side);
        const double elevation = grid.row_start(cell.row + side);
        least = std::min({least, p.distance * std::cos(p.vertical) * std::sin(std::abs(p.horizontal - azimuth)),
                          p.distance * std::sin(std::abs(p.vertical - elevation))});
    }
    return least;
}

class Growth {
public:
    Growth(const Settings& settings, const Constraint& constraint) : settings_(settings), constraint_(constraint)
    {
        out_.nodes.emplace_back();
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
                    const std::vector<NodeId> leaves = expand(id, static_cast<int>(layer));
                    next.insert(next.end(), leaves.begin(), leaves.end());
                }
            }
            purge(next);
            stack = std::move(next);
        }
        out_.front = std::move(stack);
        return std::move(out_);
    }

private:
    /// The child, unless it leaves the grid or is not allowed.
    std::optional<Node> child_of(NodeId id, Movement movement) const
    {
        const Node& from = out_.nodes[id];
        Node node;
        node.parent = id;
        node.movement = movement;
        node.depth = static_cast<std::uint8_t>(from.depth + 1);
        node.smooth = static_cast<std::uint8_t>(from.smooth + (is_smooth(movement) ? 1 : 0));
        const Turn turn = turn_of(movement);
        node.pitch_steps = static_cast<std::int8_t>(from.pitch_steps + turn.pitch);
        node.yaw_steps = static_cast<std::int8_t>(from.yaw_steps + turn.yaw);
        node.separations = static_cast<std::uint8_t>(from.separations & separations_of(movement));
        node.footprint = from.footprint;
        if (!constraint_.allows(node)) {
            return std::nullopt;
        }
        std::array<Point<double>, kSamples> samples;
        std::array<CellPlace, kSamples> cells;
        for (int i = 0; i < kSamples; ++i) {
            const Pose<double> pose =
                at_share(from.pose, movement, static_cast<double>(i + 1) / kSamples, settings_.step, settings_.model);
            const Located at = settings_.grid.locate(pose.position);
            if (at.status != LocateStatus::inside) {
                return std::nullopt;
            }
            samples[static_cast<std::size_t>(i)] = pose.position;
            cells[static_cast<std::size_t>(i)] = at.place;
            node.pose = pose;
        }
        node.end = cells.back();
        node.wall = node.centre = std::numeric_limits<double>::infinity();
        const Point<double> centre = settings_.grid.centre(node.end);
        for (std::size_t i = 0; i < kSamples; ++i) {
            note(node, settings_.grid.index(cells[i]), static_cast<std::uint8_t>(i + 1));
            if (cells[i] == node.end) {
                node.wall = std::min(node.wall, wall_distance(settings_.grid, node.end, to_polar(samples[i])));
                node.centre = std::min(node.centre, (samples[i] - centre).norm());
            }
        }
        return node;
    }

    static void note(Node& node, CellIndex cell, std::uint8_t sample)
    {
        const auto known =
            std::find_if(node.entered.begin(), node.entered.end(), [&](const Entered& e) { return e.cell == cell; });
        if (known != node.entered.end()) {
            known->last = sample;
        } else if (std::find(node.footprint.begin(), node.footprint.end(), cell) == node.footprint.end()) {
            node.footprint.push_back(cell);
            node.entered.push_back({cell, sample, sample});
        }
    }

    static std::uint8_t separations_of(Movement movement)
    {
        switch (movement) {
        case Movement::straight: return 0b1111;
        case Movement::left:
        case Movement::right: return 0b0001;
        case Movement::up:
        case Movement::down: return 0b0010;
        case Movement::up_left:
        case Movement::down_right: return 0b0100;
        case Movement::up_right:
        case Movement::down_left: return 0b1000;
        }
        return 0;
    }

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
            std::optional<Node> node = child_of(id, movement);
            if (!node) {
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

    /// Of each key the best stays, in the order of their ids.
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
