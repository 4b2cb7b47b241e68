// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/shown_shapes.hpp"

#include <algorithm>

#include "firmware/linux/live_page/json_text.hpp"

namespace jink::livepage {
namespace {

constexpr int kTurnDecimals = 4;

template <class T>
bool are_same(const std::vector<T>& a, const std::vector<T>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const T& x, const T& y) { return flightlog::is_same(x, y); });
}

template <std::size_t N>
void add_numbers(std::string& out, const char* key, const std::array<float, N>& values, int decimals = 3)
{
    add(out, ",\"%s\":", key);
    for (std::size_t k = 0; k < N; ++k) {
        out += k == 0 ? '[' : ',';
        add_number(out, static_cast<double>(values[k]), decimals);
    }
    out += ']';
}

void add_value(std::string& out, const char* key, float value)
{
    add(out, ",\"%s\":", key);
    add_number(out, static_cast<double>(value));
}

void add_flag(std::string& out, const char* key, bool value) { add(out, ",\"%s\":%s", key, value ? "true" : "false"); }

void add_obstacle(std::string& out, const flightlog::ObstacleTopic& o)
{
    add(out, "{\"id\":%u", o.id);
    add_name(out, "kind", flightlog::name_of_shape(o.kind));
    add_numbers(out, "position", o.centre);
    add_numbers(out, "half", o.half);
    add_numbers(out, "turn", o.turn, kTurnDecimals);
    add_value(out, "radius", o.radius);
    add_value(out, "uncertainty", o.uncertainty);
    add_flag(out, "of_map", o.of_map);
    add_flag(out, "is_bound", o.is_bound);
    out += '}';
}

void add_area(std::string& out, const flightlog::AreaTopic& a)
{
    add(out, "{\"number\":%u", unsigned{a.number});
    add_numbers(out, "position", a.centre);
    add_numbers(out, "velocity", a.velocity);
    add_value(out, "radius", a.radius);
    add_value(out, "bottom", a.bottom);
    add_value(out, "top", a.top);
    add_value(out, "margin", a.margin);
    out += '}';
}

template <class T, class Add>
void add_all(std::string& out, const std::vector<T>& all, Add add_one)
{
    out += '[';
    for (std::size_t i = 0; i < all.size(); ++i) {
        out += i == 0 ? "" : ",";
        add_one(out, all[i]);
    }
    out += ']';
}

}  // namespace

/// A round of before the step that knew nothing may come behind it.
void ShownShapes::take_round()
{
    const flightlog::Shapes& round = rounds_.complete();
    if (!knows_any_) {
        return;
    }
    newest_ = round.known;
    if (!are_same(round.obstacles, shown_.obstacles) || !are_same(round.areas, shown_.areas)) {
        shown_ = round;
        is_new_ = true;
    }
}

void ShownShapes::note_step(std::uint64_t timestamp, bool knows_any)
{
    knows_any_ = knows_any;
    const bool is_old = timestamp < newest_ || timestamp - newest_ > flightlog::kShapeLife;
    if ((!knows_any || is_old) && !(shown_.obstacles.empty() && shown_.areas.empty())) {
        shown_ = {timestamp, {}, {}};
        is_new_ = true;
    }
}

void ShownShapes::add(std::string& out, double time) const
{
    livepage::add(out, "{\"time\":%.3f,\"obstacles\":", time);
    add_all(out, shown_.obstacles, add_obstacle);
    out += ",\"closed_areas\":";
    add_all(out, shown_.areas, add_area);
    out += '}';
}

}  // namespace jink::livepage
