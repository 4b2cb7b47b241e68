// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jink::sim {
namespace {

/// Rays per sector of a scan.
constexpr int kRays = 5;

// Steps of an ADS-B position, height and velocity: 6 degrees in 2^17, 25 ft, 1 kt, 64 ft/min.
constexpr double kCell = 5.1;           // [m]
constexpr double kAltitudeStep = 7.62;  // [m]
constexpr double kSpeedStep = 0.5144;   // [m/s]
constexpr double kClimbStep = 0.3251;   // [m/s]

Vec rounded_to(const Vec& value, const Vec& step)
{
    return (value.array() / step.array()).round().matrix().cwiseProduct(step);
}

double normal(Random& random) { return static_cast<double>(random.normal()); }

Vec noise(Random& random, double sigma)
{
    const double x = normal(random);
    const double y = normal(random);
    const double z = normal(random);
    return Vec(x, y, z) * sigma;
}

/// Range at which a level ray at the own height enters a threat; negative without an intersection.
double ray_range(const Threat& threat, const Vec& centre, const Vec& from, const Vec& direction)
{
    const double above = std::max(0.0, std::abs(centre.z() - from.z()) - threat.half_height);
    const double radius2 = threat.radius * threat.radius - above * above;
    if (radius2 <= 0.0) {
        return -1.0;
    }
    const Eigen::Vector2d gap = (centre - from).head<2>();
    const double along = gap.dot(direction.head<2>());
    const double inside = radius2 - (gap.squaredNorm() - along * along);
    if (inside < 0.0 || along < 0.0) {
        return -1.0;
    }
    return std::max(0.0, along - std::sqrt(inside));
}

}  // namespace

TrafficReceiver::TrafficReceiver(const World& world) : world_(world)
{
    for (std::size_t i = 0; i < world.scenario().threats.size(); ++i) {
        channels_.push_back({Random(world.scenario().seed * 1000003U + i)});
    }
}

/// The error that stays, at this sighting.
Vec TrafficReceiver::drift_of(Channel& channel) const
{
    const TrafficSensor& sensor = world_.scenario().traffic;
    if (sensor.sigma_drift <= 0.0) {
        return Vec::Zero();
    }
    const double since = to_seconds(world_.now() - channel.drifted_at);
    const double kept = channel.drift ? std::exp(-since / sensor.drift_time) : 0.0;
    channel.drift = kept * channel.drift.value_or(Vec::Zero()) +
                    noise(channel.random, sensor.sigma_drift * std::sqrt(1.0 - kept * kept));
    channel.drifted_at = world_.now();
    return *channel.drift;
}

void TrafficReceiver::sight(std::size_t i, Channel& channel)
{
    const TrafficSensor& sensor = world_.scenario().traffic;
    const Threat& threat = world_.scenario().threats[i];
    const Vec position_noise = noise(channel.random, sensor.sigma_position);
    const Vec velocity_noise = noise(channel.random, sensor.sigma_velocity);
    const Vec drift = drift_of(channel);
    const double late = sensor.jitter * static_cast<double>(channel.random.uniform());
    const bool lost = static_cast<double>(channel.random.uniform()) < sensor.dropout;
    if (lost) {
        return;
    }
    Sighting seen{i, world_.now() + to_micros(sensor.latency + late),
                  world_.threat_position(i) + position_noise + drift, Vec::Zero()};
    if (threat.sensed_by == SensedBy::traffic) {
        seen.velocity = threat.velocity_at(world_.seconds()) + velocity_noise;
    }
    if (sensor.quantised) {
        seen.position = rounded_to(seen.position, Vec(kCell, kCell, kAltitudeStep));
        seen.velocity = rounded_to(seen.velocity, Vec(kSpeedStep, kSpeedStep, kClimbStep));
    }
    seen.turns = static_cast<std::size_t>(std::count_if(threat.turns.begin(), threat.turns.end(),
                                                        [&](const Turn& turn) { return turn.at <= world_.seconds(); }));
    channel.under_way.push_back(seen);
}

std::vector<Sighting> TrafficReceiver::poll()
{
    std::vector<Sighting> arrived;
    const Micros period = to_micros(1.0 / world_.scenario().traffic.rate);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        Channel& channel = channels_[i];
        const SensedBy by = world_.scenario().threats[i].sensed_by;
        if (by == SensedBy::scan || by == SensedBy::lidar || !world_.visible(i)) {
            continue;
        }
        channel.next = channel.next < 0 ? world_.appeared(i) + world_.scenario().traffic.phase : channel.next;
        if (world_.now() >= channel.next) {
            sight(i, channel);
            channel.next += period;
        }
        // Jitter may reverse the order of sightings: the queue is in order of arrival.
        auto& queue = channel.under_way;
        for (auto it = queue.begin(); it != queue.end();) {
            if (it->arrives <= world_.now()) {
                arrived.push_back(*it);
                it = queue.erase(it);
            } else {
                ++it;
            }
        }
    }
    std::stable_sort(arrived.begin(), arrived.end(),
                     [](const Sighting& a, const Sighting& b) { return a.arrives < b.arrives; });
    return arrived;
}

std::array<double, kScanSectors> scan(const World& world)
{
    std::array<double, kScanSectors> ranges{};
    const Scenario& scenario = world.scenario();
    const Truth& own = world.own();
    for (std::size_t sector = 0; sector < kScanSectors; ++sector) {
        double nearest = -1.0;
        for (int ray = 0; ray < kRays; ++ray) {
            const double within = (static_cast<double>(ray) + 0.5) / kRays - 0.5;
            const double clockwise = (static_cast<double>(sector) + within) * kScanIncrement * std::numbers::pi / 180.0;
            const Vec direction(std::cos(own.yaw - clockwise), std::sin(own.yaw - clockwise), 0.0);
            for (std::size_t i = 0; i < scenario.threats.size(); ++i) {
                if (scenario.threats[i].sensed_by != SensedBy::scan || !world.visible(i)) {
                    continue;
                }
                const double range = ray_range(scenario.threats[i], world.threat_position(i), own.position, direction);
                if (range >= 0.0 && range <= scenario.scan.range && (nearest < 0.0 || range < nearest)) {
                    nearest = range;
                }
            }
        }
        ranges[sector] = nearest;
    }
    return ranges;
}

}  // namespace jink::sim
