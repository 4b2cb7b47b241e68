// SPDX-License-Identifier: BSD-3-Clause
// A belief as a line of JSON, and as a line for people.
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "toolchain/sim/replay.hpp"

namespace jink::sim {
namespace {

using BeliefJson = nlohmann::ordered_json;

/// Rounded to the wire's resolution, so that lines stay short.
double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

BeliefJson numbers_of(const Vec& v)
{
    constexpr double kMillimetres = 1e3;
    return {rounded(v.x(), kMillimetres), rounded(v.y(), kMillimetres), rounded(v.z(), kMillimetres)};
}

template <class T>
BeliefJson value_of(const std::optional<T>& value)
{
    return value ? BeliefJson(*value) : BeliefJson(nullptr);
}

BeliefJson vector_of(const std::optional<Vec>& v) { return v ? numbers_of(*v) : BeliefJson(nullptr); }

std::string place_of(const std::optional<Vec>& v)
{
    if (!v) {
        return "-";
    }
    char text[64];
    static_cast<void>(std::snprintf(text, sizeof text, "%.1f %.1f %.1f", v->x(), v->y(), v->z()));
    return text;
}

}  // namespace

std::string to_json(const Belief& belief)
{
    BeliefJson json;
    json["t"] = rounded(belief.time, 1e3);
    json["stack"] = belief.stack ? BeliefJson(to_string(*belief.stack)) : BeliefJson(nullptr);
    json["vehicle"] = value_of(belief.vehicle);
    json["mode"] = value_of(belief.mode);
    json["armed"] = value_of(belief.armed);
    json["control"] = belief.control;
    json["position"] = vector_of(belief.position);
    json["velocity"] = vector_of(belief.velocity);
    json["home"] = nullptr;
    if (belief.home) {
        json["home"] = {rounded(belief.home->lat, 1e7), rounded(belief.home->lon, 1e7), rounded(belief.home->alt, 1e3)};
    }
    json["nominal"] = nullptr;
    if (belief.nominal) {
        json["nominal"] = {{"kind", belief.nominal->is_route ? "route" : "motion"},
                           {"end", numbers_of(belief.nominal->end)},
                           {"speed", rounded(belief.nominal->speed, 1e3)}};
    }
    json["tracks"] = belief.tracks;
    json["conflict"] = belief.conflict;
    return json.dump();
}

std::string to_text(const Belief& belief)
{
    char head[160];
    static_cast<void>(std::snprintf(
        head, sizeof head, "%8.2f  %-9s %-12s %-8s %-10s", belief.time,
        belief.stack ? std::string(to_string(*belief.stack)).c_str() : "-", belief.mode.value_or("-").c_str(),
        belief.armed ? (*belief.armed ? "armed" : "disarmed") : "-", belief.control.c_str()));
    std::string text = head;
    text += "  at " + place_of(belief.position) + "  v " + place_of(belief.velocity);
    if (belief.nominal) {
        char speed[32];
        static_cast<void>(std::snprintf(speed, sizeof speed, " at %.1f m/s", belief.nominal->speed));
        text += belief.nominal->is_route ? "  route to " : "  motion to ";
        text += place_of(belief.nominal->end) + speed;
    }
    text += "  " + std::to_string(belief.tracks) + (belief.tracks == 1 ? " track" : " tracks");
    text += belief.conflict ? "  conflict" : "";
    return text;
}

}  // namespace jink::sim
