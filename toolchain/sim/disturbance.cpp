// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/disturbance.hpp"

#include <algorithm>
#include <cmath>

namespace jink::sim {
namespace {

constexpr double kFeet = 0.3048;  // [m]
/// Heights for which the low-altitude model holds [ft].
constexpr double kLowest = 10.0;
constexpr double kHighest = 1000.0;
constexpr double kMinSpeed = 1.0;  // [m/s]

double gauss(Random& random) { return static_cast<double>(random.normal()); }

}  // namespace

OwnEstimate::OwnEstimate(const OwnSensor& sensor, std::uint64_t seed) : sensor_(sensor), random_(seed * 48271U + 3U)
{
    const double x = gauss(random_);
    const double y = gauss(random_);
    bias_ = Vec(sensor.bias * x, sensor.bias * y, sensor.bias_vertical * gauss(random_));
}

void OwnEstimate::step(const Truth& truth)
{
    if (sensor_.bias > 0.0 || sensor_.bias_vertical > 0.0) {
        const double keep = std::exp(-to_seconds(kStep) / sensor_.bias_time);
        const double fresh = std::sqrt(1.0 - keep * keep);
        const double x = gauss(random_);
        const double y = gauss(random_);
        const Vec noise(sensor_.bias * x, sensor_.bias * y, sensor_.bias_vertical * gauss(random_));
        bias_ = keep * bias_ + fresh * noise;
    }
    past_.push_back(truth);
    const auto steps = static_cast<std::size_t>(to_micros(sensor_.latency) / kStep);
    while (past_.size() > steps + 1) {
        past_.pop_front();
    }
    reported_ = past_.front();
    reported_.position += bias_;
}

Gusts::Gusts(const Wind& wind, std::uint64_t seed) : wind_(wind), random_(seed * 69621U + 7U) {}

void Gusts::Second::step(double noise, double tau, double sigma, double dt)
{
    const double acceleration = (noise - x - 2.0 * tau * rate) / (tau * tau);
    x += dt * rate;
    rate += dt * acceleration;
    y = sigma * std::sqrt(tau) * (x + std::sqrt(3.0) * tau * rate);
}

void Gusts::step(double height, double airspeed)
{
    if (is_calm()) {
        return;
    }
    const double dt = to_seconds(kStep);
    const double h = std::clamp(height / kFeet, kLowest, kHighest);
    const double shape = 0.177 + 0.000823 * h;
    const double level_scale = h / std::pow(shape, 1.2) * kFeet;
    const double vertical_scale = h * kFeet;
    const double vertical_sigma = 0.1 * wind_.at_20_ft;
    const double level_sigma = vertical_sigma / std::pow(shape, 0.4);
    const double speed = std::max(kMinSpeed, airspeed);
    const double keep = std::exp(-speed * dt / level_scale);
    const double white = 1.0 / std::sqrt(dt);
    along_ = keep * along_ + std::sqrt(1.0 - keep * keep) * level_sigma * gauss(random_);
    across_.step(white * gauss(random_), level_scale / speed, level_sigma, dt);
    up_.step(white * gauss(random_), vertical_scale / speed, vertical_sigma, dt);
}

Vec Gusts::velocity(double course) const
{
    const double c = std::cos(course);
    const double s = std::sin(course);
    return {c * along_ - s * across_.y, s * along_ + c * across_.y, up_.y};
}

}  // namespace jink::sim
