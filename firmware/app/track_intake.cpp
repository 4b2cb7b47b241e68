// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/track_intake.hpp"

namespace jink::app {
namespace {

/// Velocity noise of traffic at rest [m/s].
constexpr float kRestSigma = 0.02F;

/// Whether the traffic does its half of the avoidance. Traffic at rest, and traffic that reports that it will not,
/// does none.
bool is_cooperative(const link::TrackReport& report, const Configuration& c) noexcept
{
    if (report.at_rest || report.helpless) {
        return false;
    }
    switch (report.source) {
    case world::TrackSource::datalink: return c.coop_systems;
    case world::TrackSource::utm: return c.coop_utm;
    case world::TrackSource::adsb: return c.coop_all || (c.coop_unmanned && report.unmanned);
    case world::TrackSource::own_sensor: break;
    }
    return false;
}

/// Uncertainty of a height, all that counts as possible of it [m].
float half_height_of(const link::TrackReport& report, const Configuration& c) noexcept
{
    switch (report.height) {
    case link::HeightSource::pressure: return c.rules.k_sigma * c.sigma_baro;
    case link::HeightSource::compared: return report.height_spread + c.rules.k_sigma * c.sigma_compared;
    case link::HeightSource::geometric: break;
    }
    return report.height_spread;
}

}  // namespace

world::TrackMeasurement measurement_of(const link::TrackReport& report, const Configuration& c) noexcept
{
    world::TrackMeasurement m;
    m.id = report.id;
    m.stamp = report.stamp - c.track_latency;
    m.position = report.position;
    m.source = report.source;
    m.cooperative = is_cooperative(report, c);
    m.manned = report.source == world::TrackSource::adsb && !report.unmanned && !report.at_rest;
    m.sigma_position = report.sigma_position > 0.0F ? report.sigma_position : c.track_sigma_position;
    m.half_height = half_height_of(report, c);
    if (report.at_rest) {
        m.has_velocity = true;
        m.sigma_velocity = kRestSigma;
        m.radius = report.radius > 0.0F ? report.radius : c.point_radius;
    } else {
        m.velocity = report.velocity;
        m.has_velocity = report.has_velocity;
        m.sigma_velocity = report.sigma_velocity > 0.0F ? report.sigma_velocity : c.track_sigma_velocity;
        m.radius = report.radius > 0.0F ? report.radius : c.track_radius;
        m.max_acceleration = c.track_acceleration;
    }
    return m;
}

}  // namespace jink::app
