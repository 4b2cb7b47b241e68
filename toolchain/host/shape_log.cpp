// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/shape_log.hpp"

#include <algorithm>
#include <utility>

namespace jink::host {
namespace {

constexpr double kLife = static_cast<double>(flightlog::kShapeLife) * 1e-6;

template <std::size_t N>
void take(const LogFields& fields, const char* name, std::array<float, N>& into)
{
    for (std::size_t k = 0; k < N; ++k) {
        into[k] = static_cast<float>(fields.number(name, k));
    }
}

/// The fields that both topics have. Times are read as microseconds, which a double holds exactly up to 2^53.
template <class T>
void take_place_in_round(const LogFields& fields, T& topic)
{
    const auto micros = [&](const char* name) {
        const double value = fields.number(name);
        return value >= 0.0 && value < 9e15 ? static_cast<std::uint64_t>(value) : std::uint64_t{0};
    };
    topic.timestamp = micros("timestamp");
    topic.known = micros("known");
    topic.number = static_cast<std::uint16_t>(fields.code("number"));
    topic.obstacles = static_cast<std::uint16_t>(fields.code("obstacles"));
    topic.areas = static_cast<std::uint16_t>(fields.code("areas"));
}

template <std::size_t N>
std::array<double, N> doubles(const std::array<float, N>& values)
{
    std::array<double, N> all{};
    std::copy(values.begin(), values.end(), all.begin());
    return all;
}

PageShape shape_of(const flightlog::ObstacleTopic& topic)
{
    PageShape shape;
    shape.kind = topic.kind;
    shape.of_map = topic.of_map;
    shape.centre = doubles(topic.centre);
    shape.half = doubles(topic.half);
    shape.turn = doubles(topic.turn);
    shape.radius = static_cast<double>(topic.radius);
    return shape;
}

PageShape shape_of(const flightlog::AreaTopic& topic)
{
    const auto bottom = static_cast<double>(topic.bottom);
    const auto top = static_cast<double>(topic.top);
    PageShape shape;
    shape.kind = PageShape::kArea;
    shape.centre = {static_cast<double>(topic.centre[0]), static_cast<double>(topic.centre[1]), 0.5 * (bottom + top)};
    shape.half[2] = 0.5 * (top - bottom);
    shape.radius = static_cast<double>(topic.radius);
    shape.velocity = doubles(topic.velocity);
    return shape;
}

/// Those of a round that the one before has too go on, in their shapes; the others end, and new ones begin.
/// @param at  where the shapes of the one before are, and then those of this round
template <class T>
void follow(const std::vector<T>& before, const std::vector<T>& round, double known, std::vector<std::size_t>& at,
            std::vector<PageShape>& shapes)
{
    for (const std::size_t i : at) {
        shapes[i].until = std::min(shapes[i].until, known);
    }
    std::vector<std::size_t> next;
    std::vector<bool> is_taken(before.size(), false);
    for (const T& topic : round) {
        std::size_t k = 0;
        while (k < before.size() && (is_taken[k] || !flightlog::is_same(before[k], topic))) {
            ++k;
        }
        const bool goes_on = k < before.size() && shapes[at[k]].until >= known;
        if (goes_on) {
            is_taken[k] = true;
            next.push_back(at[k]);
        } else {
            shapes.push_back(shape_of(topic));
            shapes.back().from = known;
            next.push_back(shapes.size() - 1);
        }
        shapes[next.back()].until = known + kLife;
    }
    at = std::move(next);
}

}  // namespace

void ShapeLog::take_round(double known)
{
    if (known < none_since_) {
        return;
    }
    const flightlog::Shapes& round = rounds_.complete();
    follow(believed_.obstacles, round.obstacles, known, obstacles_at_, shapes_);
    follow(believed_.areas, round.areas, known, areas_at_, shapes_);
    believed_ = round;
}

void ShapeLog::note_obstacle(const LogFields& topic, double time)
{
    flightlog::ObstacleTopic obstacle;
    take_place_in_round(topic, obstacle);
    obstacle.id = topic.code("id");
    take(topic, "centre", obstacle.centre);
    take(topic, "half", obstacle.half);
    take(topic, "turn", obstacle.turn);
    obstacle.radius = static_cast<float>(topic.number("radius"));
    obstacle.uncertainty = static_cast<float>(topic.number("uncertainty"));
    obstacle.kind = static_cast<std::uint8_t>(std::min(topic.code("kind"), 255U));
    obstacle.of_map = topic.code("of_map") != 0;
    obstacle.is_bound = topic.code("is_bound") != 0;
    if (rounds_.take(obstacle)) {
        take_round(time - static_cast<double>(obstacle.timestamp - obstacle.known) * 1e-6);
    }
}

void ShapeLog::note_area(const LogFields& topic, double time)
{
    flightlog::AreaTopic area;
    take_place_in_round(topic, area);
    take(topic, "centre", area.centre);
    take(topic, "velocity", area.velocity);
    area.radius = static_cast<float>(topic.number("radius"));
    area.bottom = static_cast<float>(topic.number("bottom"));
    area.top = static_cast<float>(topic.number("top"));
    area.margin = static_cast<float>(topic.number("margin"));
    if (rounds_.take(area)) {
        take_round(time - static_cast<double>(area.timestamp - area.known) * 1e-6);
    }
}

void ShapeLog::note_step(double time, bool knows_any)
{
    if (knows_any) {
        return;
    }
    none_since_ = time;
    for (const std::vector<std::size_t>* all : {&obstacles_at_, &areas_at_}) {
        for (const std::size_t i : *all) {
            shapes_[i].until = std::min(shapes_[i].until, time);
        }
    }
    obstacles_at_.clear();
    areas_at_.clear();
    believed_ = {};
}

}  // namespace jink::host
