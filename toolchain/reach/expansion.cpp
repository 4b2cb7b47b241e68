// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/reach/expansion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

void note(Node& node, CellIndex cell, std::uint8_t sample)
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

std::uint8_t separations_of(Movement movement)
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

/// Fields that are known before the movement is sampled.
Node turned(const Node& from, std::uint32_t id, Movement movement)
{
    Node node;
    node.parent = id;
    node.movement = movement;
    node.depth = static_cast<std::uint8_t>(from.depth + 1);
    node.smooth = static_cast<std::uint8_t>(from.smooth + (is_smooth(movement) ? 1 : 0));
    const Turn turn = turn_of(movement);
    node.pitch_steps = static_cast<std::int8_t>(from.pitch_steps + turn.pitch);
    node.yaw_steps = static_cast<std::int8_t>(from.yaw_steps + turn.yaw);
    node.separations = static_cast<std::uint8_t>(from.separations & separations_of(movement));
    return node;
}

}  // namespace

Node root_of(const Settings& settings)
{
    Node root;
    root.pitch_steps = settings.root_pitch;
    root.pose.pitch = settings.root_pitch * settings.step.pitch;
    return root;
}

std::optional<Node> child_of(const Settings& settings, const Node& from, std::uint32_t id, Movement movement)
{
    Node node = turned(from, id, movement);
    if (node.pitch_steps > settings.most_down || -node.pitch_steps > settings.most_up) {
        return std::nullopt;
    }
    std::array<Point<double>, kSamples> samples;
    std::array<CellPlace, kSamples> cells;
    for (int i = 0; i < kSamples; ++i) {
        node.pose = at_share(from.pose, movement, static_cast<double>(i + 1) / kSamples, settings.step, settings.model);
        const Located at = settings.grid.locate(node.pose.position);
        if (at.status != LocateStatus::inside) {
            return std::nullopt;
        }
        samples[static_cast<std::size_t>(i)] = node.pose.position;
        cells[static_cast<std::size_t>(i)] = at.place;
    }
    node.end = cells.back();
    node.footprint = from.footprint;
    node.wall = node.centre = std::numeric_limits<double>::infinity();
    const Point<double> centre = settings.grid.centre(node.end);
    for (std::size_t i = 0; i < kSamples; ++i) {
        note(node, settings.grid.index(cells[i]), static_cast<std::uint8_t>(i + 1));
        if (cells[i] == node.end) {
            node.wall = std::min(node.wall, wall_distance(settings.grid, node.end, to_polar(samples[i])));
            node.centre = std::min(node.centre, (samples[i] - centre).norm());
        }
    }
    return node;
}

std::optional<Node> replay(const Settings& settings, std::span<const Movement> movements)
{
    std::optional<Node> at = root_of(settings);
    for (std::size_t i = 0; i < movements.size() && at; ++i) {
        at = child_of(settings, *at, static_cast<std::uint32_t>(i), movements[i]);
    }
    return at;
}

bool ends_at_side(const Settings& settings, const Node& node)
{
    return node.depth > 0 && (node.end.column == 0 || node.end.column + 1U == settings.grid.columns() ||
                              node.end.row == 0 || node.end.row + 1U == settings.grid.rows());
}

std::array<int, 3> part_of_cell(const Grid<double>& grid, const Node& node, int parts)
{
    const Polar<double> p = to_polar(node.pose.position);
    const auto part = [&](double at, double start, double end) {
        return static_cast<int>(std::ceil(parts * (at - start) / (end - start) - 1e-9));
    };
    return {part(p.distance, grid.layer_start(node.end.layer), grid.layer_end(node.end.layer)),
            part(p.horizontal, grid.column_start(node.end.column), grid.column_start(node.end.column + 1U)),
            part(p.vertical, grid.row_start(node.end.row), grid.row_start(node.end.row + 1U))};
}

}  // namespace jink::reach::build
