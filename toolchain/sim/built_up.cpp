// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/built_up.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kLeg = 160.0;      ///< [m]
constexpr double kFreeEnds = 30.0;  ///< no centre of a box within this distance of an end, along the leg [m]
constexpr double kBeside = 14.0;    ///< greatest distance of a centre from the leg [m]

/// Directions of a leg.
struct LegAxes {
    Vec forward = Vec::UnitX();
    Vec left = Vec::UnitY();
};

LegAxes axes_of(const Vec& leg)
{
    const Vec forward = Vec(leg.x(), leg.y(), 0.0).normalized();
    return {forward, {-forward.y(), forward.x(), 0.0}};
}

/// @param across  the leg passes through the box
Threat draw_box(Random& random, const Vec& start, const LegAxes& axes, bool across)
{
    Threat box;
    box.form = Form::box;
    box.sensed_by = SensedBy::lidar;
    box.half_extents.x() = uniform(random, 2.0, 12.0);
    box.half_extents.y() = uniform(random, 2.0, 12.0);
    box.half_extents.z() = 0.5 * (start.z() + uniform(random, 2.0, 20.0));
    const double along = uniform(random, kFreeEnds, kLeg - kFreeEnds);
    const double beside = across ? box.half_extents.dot(axes.left.cwiseAbs()) : kBeside;
    box.position = start + along * axes.forward + uniform(random, -beside, beside) * axes.left;
    box.position.z() = box.half_extents.z();
    return box;
}

std::vector<Threat> draw_boxes(Random& random, const Vec& start, const LegAxes& axes)
{
    std::vector<Threat> boxes;
    const std::size_t count = 2 + random.below(5);
    for (std::size_t i = 0; i < count; ++i) {
        boxes.push_back(draw_box(random, start, axes, i == 0));
        boxes.back().name = "box_" + std::to_string(i + 1);
    }
    return boxes;
}

}  // namespace

Scenario built_up_area(std::uint64_t seed)
{
    Random random(seed * 49979687U + 211U);
    Scenario s;
    s.name = "built_up_" + std::to_string(seed);
    s.seed = seed;
    s.stack = random.below(2) == 0 ? Stack::ardupilot : Stack::px4;
    s.duration = 150.0;
    s.floor = 2.7;
    s.ground = 0.0;
    s.to_goal = true;
    const double height = std::array{12.0, 15.0, 20.0}[random.below(3)];
    const double course = uniform(random, -std::numbers::pi, std::numbers::pi);
    const Vec start(0.0, 0.0, height);
    s.mission = {start, start + kLeg * Vec(std::cos(course), std::sin(course), 0.0)};
    s.start_position = start;
    s.start_velocity = along(s.mission[1] - start, s.vehicle.cruise, s.vehicle);
    const LegAxes axes = axes_of(s.mission[1] - start);
    s.threats = draw_boxes(random, start, axes);
    s.title = std::to_string(s.threats.size()) + " boxes about the leg, seen by a LiDAR, seed " + std::to_string(seed);
    s.lidar = LidarSensor{};
    s.lidar->rate = 10.0;
    s.lidar->range = 60.0;
    s.lidar->pitch = 2.0;
    s.expect.outcomes = {Outcome::avoided, Outcome::braked};
    s.expect.goal_reached = true;
    default_noise(s);
    return s;
}

}  // namespace jink::sim
