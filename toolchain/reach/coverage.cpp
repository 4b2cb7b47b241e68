// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/coverage.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "toolchain/reach/expansion.hpp"

namespace jink::reach::build {
namespace {

class Flood {
public:
    explicit Flood(const Settings& settings) : settings_(settings) {}

    std::size_t run()
    {
        places_.push_back({root_of(settings_), 0});
        for (std::size_t at = 0; at < places_.size(); ++at) {
            if (at == 0 || places_[at].node.end.layer + 1U < settings_.grid.layers()) {
                expand(static_cast<NodeId>(at));
            }
        }
        const std::vector<bool> leads = leading();
        std::vector<bool> touched(settings_.grid.cells(), false);
        for (const Edge& edge : edges_) {
            for (const Entered& entered : edge.touched) {
                touched[entered.cell] = touched[entered.cell] || leads[edge.to];
            }
        }
        return static_cast<std::size_t>(std::count(touched.begin(), touched.end(), true));
    }

private:
    /// Near the vehicle, where most of each trajectory is still ahead, cells are divided finer.
    static constexpr std::size_t kNear = 4;
    static constexpr int kNearParts = 4;
    static constexpr int kParts = 2;
    using Key = std::array<int, 7>;
    struct Place {
        Node node;
        int extra = 0;
    };
    struct Edge {
        NodeId from = 0;
        NodeId to = 0;
        std::vector<Entered> touched;
    };

    [[nodiscard]] Key key_of_place(const Node& node, int extra) const
    {
        const std::array<int, 3> part =
            part_of_cell(settings_.grid, node, node.end.layer < kNear ? kNearParts : kParts);
        return {settings_.grid.index(node.end), node.pitch_steps, node.yaw_steps, part[0], part[1], part[2], extra};
    }

    void expand(NodeId id)
    {
        for (const Movement movement : kAllMovements) {
            std::optional<Node> node = child_of(settings_, places_[id].node, id, movement);
            if (!node) {
                continue;
            }
            const bool beyond = id == 0 || node->end.layer > places_[id].node.end.layer;
            const int extra = beyond ? 0 : places_[id].extra + 1;
            if (extra > settings_.most_extra) {
                continue;
            }
            const auto next = static_cast<NodeId>(places_.size());
            const auto [place, is_new] = known_.try_emplace(key_of_place(*node, extra), next);
            edges_.push_back({id, place->second, node->entered});
            if (is_new) {
                node->footprint.clear();  // a cell counts even if the path entered it before
                places_.push_back({*std::move(node), extra});
            }
        }
    }

    /// States from which an end is reached.
    [[nodiscard]] std::vector<bool> leading() const
    {
        std::vector<bool> leads(places_.size());
        for (std::size_t i = 0; i < places_.size(); ++i) {
            const Node& node = places_[i].node;
            leads[i] = i != 0 && (node.end.layer + 1U == settings_.grid.layers() ||
                                  (settings_.keep_lateral && ends_at_side(settings_, node)));
        }
        for (bool changed = true; changed;) {
            changed = false;
            for (auto edge = edges_.rbegin(); edge != edges_.rend(); ++edge) {
                if (leads[edge->to] && !leads[edge->from]) {
                    leads[edge->from] = changed = true;
                }
            }
        }
        return leads;
    }

    const Settings& settings_;
    std::vector<Place> places_;
    std::vector<Edge> edges_;
    std::map<Key, NodeId> known_;
};

/// The grid cut to few layers, without lateral ends: those do not count in the footprints.
Settings on_few_layers(Settings settings)
{
    const Grid<double>& g = settings.grid;
    const std::size_t layers = std::min(kFootprintLayers, g.layers());
    settings.grid = Grid<double>(layers, g.columns(), g.rows(), g.layer_end(layers - 1), g.horizontal(), g.vertical());
    settings.keep_lateral = false;
    return settings;
}

}  // namespace

std::size_t count_reachable_cells(const Settings& settings) { return Flood(settings).run(); }

Whole whole_of(const Settings& settings)
{
    return {count_reachable_cells(settings), measure(full_set(on_few_layers(settings))).footprints};
}

Coverage coverage_of(const Settings& settings, const Set& set, const std::function<Set(const Settings&)>& make,
                     const Whole& whole)
{
    const auto share = [](std::size_t part, std::size_t all) {
        return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1));
    };
    return {share(measure(set).cells, whole.cells),
            share(measure(make(on_few_layers(settings))).footprints, whole.footprints)};
}

}  // namespace jink::reach::build
