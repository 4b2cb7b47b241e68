// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "toolchain/host/problem_parts.hpp"

namespace jink::host::detail {
namespace {

using files::YamlMap;

template <class Out>
void put_whole(Out& out, std::optional<float> value)
{
    if (value) {
        out = static_cast<Out>(*value);
    }
}

void put(float& out, std::optional<float> value) { out = value.value_or(out); }
void put(bool& out, std::optional<bool> value) { out = value.value_or(out); }

void read_kinds(YamlMap& map, geometric::Settings& settings, files::Complaints& complaints)
{
    const auto node = map.node("kinds");
    if (!node) {
        return;
    }
    const auto use = [&](std::string_view word) {
        for (const geometric::Family family : geometric::kFamilies) {
            const bool is_meant =
                word == to_string(family) || (word == "both" && family <= geometric::Family::symmetric);
            settings.*flag_of(family) = settings.*flag_of(family) || is_meant;
        }
    };
    const std::initializer_list<std::string_view> words{"simple", "symmetric", "smooth", "plateau", "wait", "both"};
    const auto clear = [&] {
        for (const geometric::Family family : geometric::kFamilies) {
            settings.*flag_of(family) = false;
        }
    };
    if (node->IsScalar()) {
        if (const auto kind = map.choice("kinds", words)) {
            clear();
            use(*(words.begin() + *kind));
        }
        return;
    }
    const auto list = map.list("kinds");
    if (!list) {
        return;
    }
    clear();
    for (const YAML::Node& kind : *list) {
        const std::string word = kind.IsScalar() ? kind.Scalar() : std::string();
        if (std::find(words.begin(), words.end() - 1, word) != words.end() - 1) {
            use(word);
        } else {
            complaints.push_back(files::complaint_at(kind.Mark(), map.file(),
                                                     map.name("kinds") + ": " + files::in_quotes(word) +
                                                         " is none of: simple, symmetric, smooth, plateau, wait"));
        }
    }
    if (list->empty()) {
        map.complain("kinds", "at least one of simple, symmetric, smooth, plateau, wait is wanted");
    }
}

void read_counts(YamlMap& map, geometric::Settings& settings)
{
    const auto offsets = map.whole("l", {2.0F, 64.0F});
    if (offsets && std::fmod(*offsets, 2.0F) != 0.0F) {
        map.complain("l", "must be even: half of the candidates lie on each side");
    } else {
        put_whole(settings.offsets, offsets);
    }
    put_whole(settings.extra_planes, map.whole("n", {0.0F, 31.0F}));
    put_whole(settings.waypoints, map.whole("waypoints", {8.0F, static_cast<float>(kMaxPathPoints)}));
    put_whole(settings.closeness_nearest, map.whole("closeness_nearest", {0.0F, static_cast<float>(kMaxTracks)}));
    put_whole(settings.moving_nearest, map.whole("moving_nearest", {0.0F, static_cast<float>(kMaxTracks)}));
    put_whole(settings.check_units, map.whole("check_units", {0.0F, 1e6F}));
    put_whole(settings.retries, map.whole("retries", {0.0F, static_cast<float>(geometric::kAttempts.size() - 1)}));
}

void read_weights(YamlMap& map, geometric::Settings& settings)
{
    auto weights = map.map("weights");
    if (!weights) {
        return;
    }
    using files::kNeed;
    const auto smoothness = weights->number("k_S", {0.0F, 1.0F}, kNeed);
    const auto time = weights->number("k_T", {0.1F, 1.0F}, kNeed);
    const auto closeness = weights->number("k_C", {0.0F, 0.7F}, kNeed);
    const float passing = weights->number("k_A", {0.0F, 0.9F}).value_or(0.0F);
    const float beyond = weights->number("k_B", {0.0F, 0.9F}).value_or(0.0F);
    weights->finish();
    if (smoothness && time && closeness) {
        settings.weights = {*smoothness, *time, *closeness, passing, beyond};
        if (!cost::is_valid(settings.weights)) {
            map.complain("weights", "k_S + k_T + k_C + k_A + k_B must be 1, not " +
                                        files::to_text(*smoothness + *time + *closeness + passing + beyond));
        }
    }
}

void read_methods(YamlMap& map, geometric::Settings& settings)
{
    using geometric::OffsetRule;
    using geometric::SecurityMode;
    if (const auto mode = map.choice("security", {"time-aware", "swept"})) {
        settings.security = *mode == 0 ? SecurityMode::time_aware : SecurityMode::swept;
    }
    if (const auto rule = map.choice("offset_rule", {"clearing", "source"})) {
        settings.offset_rule = *rule == 0 ? OffsetRule::clearing : OffsetRule::source;
    }
    if (const auto method = map.choice("closeness", {"time-aware", "swept"})) {
        settings.closeness = *method == 0 ? cost::ClosenessMethod::time_aware : cost::ClosenessMethod::swept;
    }
    if (const auto method = map.choice("smoothness", {"curvature", "deviation", "second-derivative"})) {
        settings.smoothness = *method == 0   ? cost::SmoothnessMethod::curvature
                              : *method == 1 ? cost::SmoothnessMethod::deviation
                                             : cost::SmoothnessMethod::second_derivative;
    }
    put(settings.main_swept_to_collision_point, map.boolean("main_swept_to_collision_point"));
    put(settings.check_acceleration, map.boolean("check_acceleration"));
    put(settings.verify_flight, map.boolean("verify_flight"));
    put(settings.escape_from_margin, map.boolean("escape_from_margin"));
}

}  // namespace

void read_settings(YamlMap& root, const cost::Caps& caps, geometric::Settings& settings, files::Complaints& complaints)
{
    settings.caps = caps;
    auto map = root.map("settings");
    if (!map) {
        return;
    }
    const std::size_t before = complaints.size();
    if (const auto preset = map->choice("preset", {"default", "source"}); preset && *preset == 1) {
        settings = geometric::source_settings();
        settings.caps = caps;
    }
    read_counts(*map, settings);
    read_kinds(*map, settings, complaints);
    read_weights(*map, settings);
    read_methods(*map, settings);
    put(settings.rotation_penalty, map->number("k_p", {0.0F, 10.0F}));
    put(settings.flip_penalty, map->number("flip_penalty", {0.0F, 1.0F}));
    put(settings.max_cost, map->number("max_cost", {0.01F, 1.0F}));
    put(settings.source_drop_margin, map->number("source_drop_margin", {0.0F, 10.0F}));
    map->finish();

    const std::size_t candidates = geometric::count_of_candidates(settings);
    if (complaints.size() == before && candidates > kMaxCandidates) {
        root.complain("settings", std::to_string(candidates) + " candidates, l (n + 1) for each kind, are more than " +
                                      std::to_string(kMaxCandidates));
    }
}

}  // namespace jink::host::detail
