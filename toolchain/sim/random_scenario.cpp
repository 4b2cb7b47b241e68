// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/random_scenario.hpp"

#include <cmath>
#include <numbers>

#include "toolchain/sim/scenario_file.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kHeight = 40.0;

Vec any_direction(Random& random)
{
    const double z = uniform(random, -1.0, 1.0);
    const double azimuth = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

Threat intruder(Random& random, const Scenario& scenario, std::size_t index, double fastest = 12.0)
{
    Threat threat;
    threat.name = "intruder_" + std::to_string(index + 1);
    threat.radius = uniform(random, 0.5, 2.0);
    const double meets_at = uniform(random, 10.0, 13.0);
    const double seen_before = uniform(random, 2.0, 8.0);
    const Vec at = scenario.start_position + scenario.start_velocity * meets_at +
                   any_direction(random) * uniform(random, 0.0, index == 0 ? 0.5 : 1.5);
    Vec direction = any_direction(random);
    direction.z() *= 0.5;  // aircraft climb at shallow angles
    const double speed = uniform(random, 0.0, fastest);
    // Slower intruders hover: they are static.
    constexpr double kHovers = 0.5;
    threat.velocity = speed < kHovers ? Vec(Vec::Zero()) : Vec(direction.normalized() * speed);
    threat.position = at - threat.velocity * meets_at;
    threat.appears_at = meets_at - seen_before;
    threat.sensed_by = SensedBy::traffic;
    return threat;
}

/// A gap-free ring of pillars around `centre`.
void add_ring(Scenario& s, const Vec& centre, double ring_radius)
{
    constexpr double kPillar = 1.0;
    const auto count = static_cast<int>(std::ceil(std::numbers::pi * ring_radius / kPillar));
    for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / count;
        Threat pillar;
        pillar.name = "pillar_" + std::to_string(i + 1);
        pillar.radius = kPillar;
        pillar.half_height = 8.0;
        pillar.position = centre + ring_radius * Vec(std::cos(angle), std::sin(angle), 0.0);
        pillar.sensed_by = SensedBy::scan;
        s.threats.push_back(pillar);
    }
}

/// Largest number and speed of intruders.
struct Traffic {
    std::size_t most = 1;
    double fastest = 0.0;  ///< [m/s]
};

Scenario drawn(Random& random, const std::string& kind, std::uint64_t seed, const Traffic& traffic)
{
    Scenario s;
    s.name = kind + std::to_string(seed);
    s.seed = seed;
    s.stack = random.below(2) == 0 ? Stack::ardupilot : Stack::px4;
    s.duration = 60.0;
    const double course = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double climb = random.below(3) == 0 ? uniform(random, -0.2, 0.3) : 0.0;
    s.mission = {Vec(0.0, 0.0, kHeight),
                 Vec(0.0, 0.0, kHeight) + 350.0 * Vec(std::cos(course), std::sin(course), climb).normalized()};
    s.start_position = s.mission[0];
    s.start_velocity = along(s.mission[1] - s.mission[0], s.vehicle.cruise, s.vehicle);
    s.floor = 2.7;
    const std::size_t count = 1 + random.below(traffic.most);
    for (std::size_t i = 0; i < count; ++i) {
        s.threats.push_back(intruder(random, s, i, traffic.fastest));
    }
    s.title = std::to_string(count) + (count == 1 ? " intruder" : " intruders") + " on conflicting courses, seed " +
              std::to_string(seed);
    s.traffic.sigma_position = 0.3;
    s.traffic.sigma_velocity = 0.2;
    s.traffic.latency = 0.1;
    s.traffic.jitter = 0.05;
    s.traffic.dropout = 0.05;
    s.expect.outcomes = {Outcome::clear, Outcome::avoided, Outcome::braked};
    default_radii(s);
    default_noise(s);
    return s;
}

}  // namespace

Scenario crowded_scenario(std::uint64_t seed)
{
    constexpr std::size_t kIntruders = 32;
    constexpr double kMeets = 11.5;  // [s], the middle of the intruders' times
    Random random(seed * 104729U + 29U);
    Scenario s = random_scenario(seed);
    s.name = "crowd_" + std::to_string(seed);
    s.title = "32 intruders at once in a ring of pillars, seed " + std::to_string(seed);
    s.duration = 25.0;
    s.threats.clear();
    for (std::size_t i = 0; i < kIntruders; ++i) {
        s.threats.push_back(intruder(random, s, i));
    }
    add_ring(s, s.start_position + s.start_velocity * kMeets, uniform(random, 8.0, 20.0));
    s.expect.outcomes = {Outcome::clear, Outcome::avoided, Outcome::braked, Outcome::breach, Outcome::collision};
    default_radii(s);
    default_noise(s);
    return s;
}

Scenario random_scenario(std::uint64_t seed)
{
    Random random(seed * 7919U + 17U);
    return drawn(random, "random_", seed, {3, 12.0});
}

Scenario open_encounter(std::uint64_t seed)
{
    Random random(seed * 15485863U + 101U);
    return drawn(random, "encounter_", seed, {8, 15.0});
}

}  // namespace jink::sim
