// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "toolchain/sim/swarm.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

/// Least distance of an obstacle's start from every vehicle [m].
constexpr double kClearStart = 3.0;
/// An obstacle's speed, as a share of the vehicles' cruise speed.
constexpr double kSlowest = 0.2;
constexpr double kFastest = 0.6;

constexpr double kRadian = std::numbers::pi / 180.0;  // [1/deg]

/// The circle's lowest point is `height` above home.
Vec centre_of(const SwarmSetup& setup)
{
    return {0.0, 0.0, setup.height + setup.circle * std::sin(kRadian * setup.tilt)};
}

/// From the centre.
Vec on_circle(const SwarmSetup& setup, unsigned index)
{
    const double angle = kRadian * setup.sector * index / setup.vehicles;
    const double tilt = kRadian * setup.tilt;
    return setup.circle * Vec(std::cos(angle) * std::cos(tilt), std::sin(angle), std::cos(angle) * std::sin(tilt));
}

/// An obstacle that flies from outside across the inner part of the circle.
Threat obstacle(const SwarmSetup& setup, Random& random, unsigned number)
{
    Threat sphere;
    sphere.name = "obstacle_" + std::to_string(number + 1);
    sphere.radius = setup.body;
    const double from = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double distance = setup.circle + kClearStart + uniform(random, 0.0, setup.circle);
    sphere.position = distance * Vec(std::cos(from), std::sin(from), 0.0);
    const double to = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double aside = uniform(random, 0.0, 0.7 * setup.circle);
    const Vec aim = aside * Vec(std::cos(to), std::sin(to), 0.0);
    sphere.velocity = (aim - sphere.position).normalized() * uniform(random, kSlowest, kFastest) * setup.cruise;
    sphere.position.z() = centre_of(setup).z() + uniform(random, -1.0, 1.0);
    return sphere;
}

double cruise_of(const SwarmSetup& setup, unsigned index)
{
    return index % 2 == 0 ? setup.cruise : setup.slow * setup.cruise;
}

void small_and_slow(Scenario& s, double cruise, double acceleration)
{
    s.vehicle.cruise = cruise;
    s.vehicle.max_climb = s.vehicle.max_descent = cruise;
    s.vehicle.max_acceleration = s.vehicle.max_vertical_acceleration = acceleration;
}

}  // namespace

Scenario swarm_scenario(const SwarmSetup& setup, std::uint64_t seed, unsigned index)
{
    Random places(seed * 7919U + 3U);
    Random obstacles(seed * 104729U + 5U);
    const auto off_place = [&] {
        const double x = uniform(places, -setup.spread, setup.spread);
        const double y = uniform(places, -setup.spread, setup.spread);
        const double z = uniform(places, -setup.spread, setup.spread);
        return Vec(x, y, z);
    };
    Scenario s;
    s.name = "swarm_" + std::to_string(seed) + "_" + std::to_string(index + 1);
    s.title = s.name;
    s.seed = seed * 1000U + index;
    s.system = static_cast<std::uint8_t>(index + 1);
    s.stack = setup.both_stacks && index % 2 == 1 ? Stack::px4 : setup.stack;
    s.duration = setup.duration;
    s.to_goal = true;
    s.body_radius = setup.body;
    s.promise = setup.body;
    small_and_slow(s, cruise_of(setup, index), setup.acceleration);
    if (setup.as_recorded) {
        answer_as_recorded(s);
    }
    Vec off = off_place();
    for (unsigned i = 0; i < index; ++i) {
        off = off_place();  // draws of the vehicles before this one
    }
    const Vec centre = centre_of(setup);
    const Vec place = on_circle(setup, index);
    s.start_position = centre + place + off;
    s.mission = {s.start_position, centre - place};
    if (setup.back) {
        s.mission.push_back(centre + place);
    }
    s.reached = 0.5;
    for (unsigned i = 0; i < setup.obstacles; ++i) {
        s.threats.push_back(obstacle(setup, obstacles, i));
    }
    s.traffic.latency = setup.delay;
    s.traffic.dropout = setup.loss;
    return s;
}

app::Parameters swarm_parameters(const SwarmSetup& setup, unsigned index)
{
    const double half = 0.5 * setup.vertical;
    const double cruise = cruise_of(setup, index);
    std::map<std::string, double> wanted{
        {"VEH_CRUISE", cruise},
        {"VEH_CLIMB", cruise},
        {"VEH_DESCENT", cruise},
        {"VEH_ACC", setup.acceleration},
        {"VEH_ACC_Z", setup.acceleration},
        // The other vehicle's sphere and the own box add up to the separations.
        {"TRK_RADIUS", half},
        {"JNK_HALF_XY", setup.level - half},
        {"JNK_HALF_Z", half},
        // Covers the rounding of the wire and the differences between the autopilots' maps.
        {"TRK_SIGMA_P", 0.03},
        {"TRK_SIGMA_V", 0.03},
        // Plus half a tick until the report is processed.
        {"TRK_LATENCY", setup.delay + 0.01},
    };
    for (const auto& [name, value] : setup.parameters) {
        wanted[name] = value;
    }
    if (index % 2 != 0) {
        for (const auto& [name, value] : setup.others) {
            wanted[name] = value;
        }
    }
    app::Parameters parameters;
    std::array<float, app::kParamCount> values = parameters.values();
    for (const auto& [name, value] : wanted) {
        const std::size_t place = app::Parameters::find(name);
        if (place == app::kParamCount) {
            throw std::runtime_error(name + " is no parameter");
        }
        values[place] = static_cast<float>(value);
    }
    if (parameters.set_all(values) != app::ParamStatus::ok) {
        throw std::runtime_error("the co-processor refuses these parameters");
    }
    return parameters;
}

}  // namespace jink::sim
