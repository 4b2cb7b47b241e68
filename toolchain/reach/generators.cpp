// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/generators.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace jink::reach::build {
namespace {

/// Rank offset of trajectories without a smooth movement.
constexpr double kNotSmooth = 1e6;
/// Mirrored trajectories are equally near to mirrored walls up to rounding. Distances within this tolerance, in
/// movements' lengths, are equal, so that every host builds the same set.
constexpr double kTie = 1e-9;

/// The best of each key, then the best `spread` of these.
std::vector<NodeId> best_of(const std::vector<Node>& all, std::span<const NodeId> passing, std::size_t spread,
                            std::size_t tail, bool attitude, const std::function<double(const Node&)>& measure)
{
    std::map<std::vector<std::uint16_t>, std::size_t> known;
    std::vector<NodeId> ids;
    for (const NodeId id : passing) {
        const auto [place, is_new] = known.try_emplace(key_of(all[id], tail, attitude), ids.size());
        if (is_new) {
            ids.push_back(id);
        } else if (measure(all[id]) < measure(all[ids[place->second]])) {
            ids[place->second] = id;
        }
    }
    std::stable_sort(ids.begin(), ids.end(), [&](NodeId a, NodeId b) { return measure(all[a]) < measure(all[b]); });
    ids.resize(std::min(ids.size(), spread));
    return ids;
}

}  // namespace

double performance(const Node& node)
{
    const double smoothness = node.smoothness();
    return smoothness > 0.0 ? node.centre / smoothness : kNotSmooth + node.centre;
}

Constraint chaotic(const Settings& settings, std::size_t spread, std::size_t tail)
{
    Constraint c;
    c.measure = [](const Node& node) { return std::round(node.wall / kTie); };
    c.select = [=, attitude = settings.attitude_in_key, measure = c.measure](const std::vector<Node>& all,
                                                                             std::span<const NodeId> passing) {
        return best_of(all, passing, spread, tail, attitude, measure);
    };
    return c;
}

Constraint harmonic(const Settings& settings, std::size_t spread)
{
    Constraint c;
    c.measure = performance;
    c.select = [=, attitude = settings.attitude_in_key](const std::vector<Node>& all, std::span<const NodeId> passing) {
        return best_of(all, passing, spread, 0, attitude, performance);
    };
    return c;
}

Constraint acas(const Settings& settings, std::uint8_t separations, std::size_t spread, SpreadOf spread_of)
{
    Constraint c;
    c.measure = [](const Node& node) { return -node.smoothness(); };
    c.allows = [=](const Node& node) { return (node.separations & separations) != 0; };
    c.select = [=, attitude = settings.attitude_in_key](const std::vector<Node>& all, std::span<const NodeId> passing) {
        if (spread == kNoLimit) {
            return std::vector<NodeId>(passing.begin(), passing.end());
        }
        if (spread_of == SpreadOf::cell) {
            return best_of(all, passing, spread, 0, attitude, performance);
        }
        std::set<NodeId> ids;
        for (const std::uint8_t plane : {kHorizontal, kVertical, kSlash, kBackslash}) {
            std::vector<NodeId> in_plane;
            std::copy_if(passing.begin(), passing.end(), std::back_inserter(in_plane),
                         [&](NodeId id) { return (all[id].separations & separations & plane) != 0; });
            const std::vector<NodeId> best = best_of(all, in_plane, spread, 0, attitude, performance);
            ids.insert(best.begin(), best.end());
        }
        return std::vector<NodeId>(ids.begin(), ids.end());
    };
    return c;
}

}  // namespace jink::reach::build
