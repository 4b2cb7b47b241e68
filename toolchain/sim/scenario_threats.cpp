// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/random.hpp"
#include "toolchain/sim/scenario_parts.hpp"

namespace jink::sim::detail {
namespace {

constexpr int kMaxInGrid = 64;
constexpr int kMaxScattered = 256;
constexpr int kScatterTries = 100'000;

/// Reads threats; holds their common data.
struct Threats {
    std::string file;
    std::uint64_t seed;
    Complaints& complaints;
    std::vector<Threat>& out;
};

void read_turns(Threats& reader, YamlMap& map, Threat& threat)
{
    const auto list = map.list("turns");
    if (!list) {
        return;
    }
    double last = 0.0;
    for (std::size_t i = 0; i < list->size(); ++i) {
        YamlMap item((*list)[i], map.name(item_name("turns", i)), reader.file, reader.complaints);
        if (!item.is_map()) {
            continue;
        }
        Turn turn;
        number(item, "at", turn.at, kAnyTime, kNeed);
        vector(item, "velocity", turn.velocity, kVelocity, kNeed);
        if (item.has("at") && turn.at <= last) {
            item.complain("at", "turns come in order of time, after 0");
        }
        last = turn.at;
        item.finish();
        threat.turns.push_back(turn);
    }
}

/// `position` at time 0, or the point passed at a time.
void read_place(YamlMap& map, Threat& threat)
{
    if (map.has("position") == map.has("passes")) {
        map.complain(map.has("position") ? "passes" : "position", "a threat has either 'position' or 'passes'");
    }
    vector(map, "position", threat.position, kPlace);
    auto passes = map.map("passes");
    if (!passes) {
        return;
    }
    Vec point = Vec::Zero();
    double at = 0.0;
    vector(*passes, "point", point, kPlace, kNeed);
    number(*passes, "at", at, kAnyTime, kNeed);
    passes->finish();
    threat.position = point - threat.velocity * at;
    if (!threat.turns.empty() && threat.turns.front().at < at) {
        map.complain("passes", "speaks of the time before the first turn");
    }
}

void read_grid(YamlMap& map, const Threat& first, std::vector<Threat>& threats)
{
    auto grid = map.map("grid");
    if (!grid) {
        return;
    }
    constexpr Range kCount{1.0F, static_cast<float>(kMaxInGrid)};
    const auto across = static_cast<int>(grid->whole("across", kCount, kNeed).value_or(1.0F));
    const auto up = static_cast<int>(grid->whole("up", kCount, kNeed).value_or(1.0F));
    double step = 0.0;
    Vec direction = Vec::Zero();
    number(*grid, "step", step, {0.0F, 1e4F}, kNeed);
    vector(*grid, "direction", direction, kPlace, kNeed);
    if (across * up > kMaxInGrid) {
        map.complain("grid", "has more than " + std::to_string(kMaxInGrid) + " threats");
        return;
    }
    if (grid->has("direction") && direction.norm() == 0.0) {
        grid->complain("direction", "has no length");
        direction = Vec::UnitX();
    }
    grid->finish();
    for (int row = 0; row < up; ++row) {
        for (int column = 0; column < across; ++column) {
            Threat threat = first;
            threat.name = first.name + "_" + std::to_string(row) + "_" + std::to_string(column);
            threat.position += direction.normalized() * (step * (column - 0.5 * (across - 1))) +
                               Vec::UnitZ() * (step * (row - 0.5 * (up - 1)));
            threats.push_back(threat);
        }
    }
}

/// Copies of a threat at random places of a level rectangle about its position, each at least `apart` from the others.
void read_scatter(YamlMap& map, const Threat& first, std::uint64_t seed, std::vector<Threat>& threats)
{
    auto scatter = map.map("scatter");
    if (!scatter) {
        return;
    }
    const auto count = static_cast<std::size_t>(
        scatter->whole("count", {1.0F, static_cast<float>(kMaxScattered)}, kNeed).value_or(1.0F));
    if (const auto own = scatter->whole("seed", {0.0F, 1e6F})) {
        seed = static_cast<std::uint64_t>(*own);
    }
    Vec half = Vec::Zero();
    double apart = 0.0;
    vector(*scatter, "half", half, {0.0F, 1e4F}, kNeed);
    number(*scatter, "apart", apart, {0.0F, 1e4F}, kNeed);
    scatter->finish();
    Random random(seed);
    const std::size_t before = threats.size();
    for (int tries = kScatterTries; tries > 0 && threats.size() < before + count; --tries) {
        Threat threat = first;
        threat.name = first.name + "_" + std::to_string(threats.size() - before);
        for (const int axis : {0, 1, 2}) {
            threat.position[axis] += half[axis] * (2.0 * static_cast<double>(random.uniform()) - 1.0);
        }
        const bool is_free =
            std::all_of(threats.begin() + static_cast<std::ptrdiff_t>(before), threats.end(),
                        [&](const Threat& other) { return (other.position - threat.position).norm() >= apart; });
        if (is_free) {
            threats.push_back(threat);
        }
    }
    if (threats.size() < before + count) {
        map.complain("scatter", "so many do not fit so far apart");
    }
}

void read_sensing(YamlMap& map, Threat& threat)
{
    threat.sensed_by = threat.at_rest() ? SensedBy::point : SensedBy::traffic;
    constexpr std::array kAll{SensedBy::traffic, SensedBy::point, SensedBy::scan, SensedBy::lidar};
    if (const auto by = one_of(map, "sensed_by", kAll)) {
        threat.sensed_by = *by;
    }
    if (threat.sensed_by != SensedBy::traffic && !threat.at_rest()) {
        map.complain("sensed_by", "what moves is sensed by traffic");
    }
    const bool is_seen = threat.sensed_by == SensedBy::scan || threat.sensed_by == SensedBy::lidar;
    if (threat.half_height > 0.0 && !is_seen) {
        map.complain("half_height", "only a scan sees something tall; traffic and points are spheres");
    }
    if (threat.form != Form::sphere && threat.sensed_by != SensedBy::lidar) {
        map.complain("form", "only a lidar sees what is no sphere");
    }
    number(map, "appears_at", threat.appears_at, kAnyTime);
    number(map, "appears_when_own_within", threat.appears_when_own_within, {0.0F, 1e4F});
    if (map.has("appears_when_own_within")) {
        vector(map, "collision_point", threat.collision_point, kPlace, kNeed);
    }
}

void read_threat(Threats& reader, const YAML::Node& node, std::size_t index)
{
    YamlMap map(node, item_name("threats", index), reader.file, reader.complaints);
    if (!map.is_map()) {
        return;
    }
    Threat threat;
    threat.name = map.text("name").value_or("threat_" + std::to_string(reader.out.size() + 1));
    threat.form = one_of(map, "form", std::array{Form::sphere, Form::cylinder, Form::box}).value_or(threat.form);
    const bool is_box = threat.form == Form::box;
    if (is_box != map.has("half_extents")) {
        map.complain(is_box ? "form" : "half_extents", "a box, and nothing else, has 'half_extents'");
    }
    vector(map, "half_extents", threat.half_extents, {0.05F, 500.0F});
    if (is_box && (map.has("radius") || map.has("half_height"))) {
        map.complain("form", "a box has neither 'radius' nor 'half_height'");
    }
    number(map, "radius", threat.radius, {0.05F, 500.0F});
    number(map, "half_height", threat.half_height, {0.0F, 500.0F},
           threat.form == Form::cylinder ? kNeed : YamlMap::Need::optional);
    vector(map, "velocity", threat.velocity, kVelocity);
    read_turns(reader, map, threat);
    read_place(map, threat);
    read_sensing(map, threat);
    if (map.has("grid")) {
        read_grid(map, threat, reader.out);
    } else if (map.has("scatter")) {
        read_scatter(map, threat, reader.seed, reader.out);
    } else {
        reader.out.push_back(threat);
    }
    map.finish();
}

}  // namespace

void read_threats(YamlMap& root, std::uint64_t seed, std::vector<Threat>& out, Complaints& complaints)
{
    const auto list = root.list("threats");
    if (!list) {
        return;
    }
    Threats reader{root.file(), seed, complaints, out};
    for (std::size_t i = 0; i < list->size(); ++i) {
        read_threat(reader, (*list)[i], i);
    }
}

}  // namespace jink::sim::detail
