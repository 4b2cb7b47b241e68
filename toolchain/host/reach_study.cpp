// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/reach_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

#include "toolchain/reach/best_paths.hpp"
#include "toolchain/reach/generators.hpp"

namespace jink::host {
namespace {

namespace rb = reach::build;

bool have_the_same_whole(const rb::Settings& a, const rb::Settings& b)
{
    return a.step.pitch == b.step.pitch && a.step.yaw == b.step.yaw && a.root_pitch == b.root_pitch &&
           a.most_up == b.most_up && a.most_down == b.most_down && a.keep_lateral == b.keep_lateral &&
           a.grid.horizontal() == b.grid.horizontal() && a.grid.vertical() == b.grid.vertical();
}

/// Best smoothness of the trajectories through each member.
std::vector<double> smoothness_through(const rb::Set& set)
{
    std::vector<double> best(set.members.size(), 0.0);
    for (std::size_t i = set.members.size(); i-- > 1;) {
        const rb::Set::Member& member = set.members[i];
        if (member.in_front || member.is_lateral) {
            best[i] = std::max(best[i], member.node.smoothness());
        }
        best[member.node.parent] = std::max(best[member.node.parent], best[i]);
    }
    return best;
}

nlohmann::json drawing_of(const NamedSet& named)
{
    constexpr int kParts = 4;
    const reach::Grid<double>& grid = named.settings.grid;
    nlohmann::json json{{"name", named.name},          {"layers", grid.layers()},
                        {"columns", grid.columns()},   {"rows", grid.rows()},
                        {"distance", grid.distance()}, {"horizontal", grid.horizontal()},
                        {"vertical", grid.vertical()}, {"movements", nlohmann::json::array()}};
    const std::vector<double> smoothness = smoothness_through(named.set);
    const auto rounded = [](double coordinate) { return std::round(1e4 * coordinate) / 1e4; };
    for (std::size_t i = 1; i < named.set.members.size(); ++i) {
        const rb::Node& node = named.set.members[i].node;
        nlohmann::json points = nlohmann::json::array();
        for (int part = 0; part <= kParts; ++part) {
            const auto pose =
                reach::at_share(named.set.members[node.parent].node.pose, node.movement,
                                static_cast<double>(part) / kParts, named.settings.step, named.settings.model);
            points.push_back({rounded(pose.position.x()), rounded(pose.position.y()), rounded(pose.position.z())});
        }
        json["movements"].push_back({{"smoothness", rounded(smoothness[i])}, {"points", std::move(points)}});
    }
    return json;
}

}  // namespace

std::vector<NamedSet> sets_of(const rb::BuiltVehicle& built)
{
    std::vector<NamedSet> sets;
    for (const rb::BuiltSet& of : built.sets) {
        sets.push_back({std::string(of.stored.view().name), of.settings, of.make, of.set});
    }
    return sets;
}

std::vector<NamedSet> sets_of_source()
{
    std::vector<NamedSet> sets;
    const auto add = [&](const std::string& name, const std::function<rb::Set(const rb::Settings&)>& make) {
        const rb::Settings settings;
        sets.push_back({name, settings, make, make(settings)});
    };
    const auto add_grown = [&](const std::string& name, const std::function<rb::Constraint(const rb::Settings&)>& by) {
        add(name, [by](const rb::Settings& s) { return rb::kept(rb::grow(s, by(s)), 0); });
    };
    for (const std::size_t spread : {8U, 9U, 36U}) {
        add_grown("chaotic " + std::to_string(spread) + "/3",
                  [spread](const rb::Settings& s) { return rb::chaotic(s, spread, 3); });
    }
    for (const std::size_t spread : {1U, 9U}) {
        add_grown("harmonic " + std::to_string(spread),
                  [spread](const rb::Settings& s) { return rb::harmonic(s, spread); });
    }
    add("fewest turns, columns", [](const rb::Settings& s) { return rb::best_paths(s, {rb::BestFor::columns}); });
    add("fewest turns, cells", [](const rb::Settings& s) { return rb::best_paths(s, {rb::BestFor::cells}); });
    add("combined 8/3/1", [](const rb::Settings& s) {
        return rb::merged(rb::kept(rb::grow(s, rb::chaotic(s, 8, 3)), rb::kFromChaotic),
                          rb::kept(rb::grow(s, rb::harmonic(s, 1)), rb::kFromHarmonic));
    });
    const std::array<std::pair<const char*, std::uint8_t>, 4> planes{{{"planes H 9", rb::kHorizontal},
                                                                      {"planes V 9", rb::kVertical},
                                                                      {"planes HV 9", rb::kHorizontal | rb::kVertical},
                                                                      {"planes all 9", rb::kAllSeparations}}};
    for (const auto& [name, separations] : planes) {
        add_grown(name, [of = separations](const rb::Settings& s) { return rb::acas(s, of, 9); });
    }
    add_grown("planes all 9 each",
              [](const rb::Settings& s) { return rb::acas(s, rb::kAllSeparations, 9, rb::SpreadOf::separation); });
    return sets;
}

std::vector<SetFigures> measure_all(const std::vector<NamedSet>& sets)
{
    std::vector<std::pair<rb::Settings, rb::Whole>> known;
    std::vector<SetFigures> figures;
    for (const NamedSet& named : sets) {
        auto whole = std::find_if(known.begin(), known.end(),
                                  [&](const auto& k) { return have_the_same_whole(k.first, named.settings); });
        if (whole == known.end()) {
            whole = known.insert(known.end(), {named.settings, rb::whole_of(named.settings)});
        }
        figures.push_back({rb::measure(named.set),
                           rb::coverage_of(named.settings, named.set, named.make, whole->second),
                           rb::bytes_of(named.set)});
    }
    return figures;
}

std::string table_of(const std::vector<NamedSet>& sets, const std::vector<SetFigures>& figures)
{
    std::array<char, 200> line{};
    std::snprintf(line.data(), line.size(), "%-34s %11s %6s %6s %6s %6s %6s %6s %7s %6s %7s\n", "", "steps [deg]",
                  "nodes", "front", "sides", "cells", "of all", "prints", "smooth", "depth", "bytes");
    std::string out = line.data();
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < sets.size(); ++i) {
        const rb::Metrics& m = figures[i].metrics;
        const auto degrees = [](double angle) { return angle * 180.0 / std::numbers::pi; };
        std::snprintf(line.data(), line.size(), "%-34s %5.1f %5.1f %6zu %6zu %6zu %6zu %6.2f %6.2f %7.3f %6zu %7zu\n",
                      sets[i].name.c_str(), degrees(sets[i].settings.step.yaw), degrees(sets[i].settings.step.pitch),
                      m.nodes, m.trajectories, m.laterals, m.cells, figures[i].coverage.cells,
                      figures[i].coverage.footprints, m.mean_smoothness, m.most_depth, figures[i].bytes);
        out.append(line.data());
        bytes += figures[i].bytes;
    }
    return out.append(std::to_string(bytes)).append(" bytes in all\n");
}

std::string drawing_of(const std::vector<NamedSet>& sets)
{
    nlohmann::json json = nlohmann::json::array();
    for (const NamedSet& named : sets) {
        json.push_back(drawing_of(named));
    }
    return json.dump();
}

}  // namespace jink::host
