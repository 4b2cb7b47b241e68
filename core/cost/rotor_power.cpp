// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "core/cost/cost.hpp"

namespace jink::cost {
namespace {

/// Real over ideal induced power (Pinheiro 4.1.6).
constexpr float kInduced = 1.15F;

/// Induced velocity over that of hover, in descent where momentum theory does not hold (Pinheiro eq. 4.23), q = V /
/// v_h.
float empirical_descent(float q) noexcept
{
    return kInduced + q * (-1.125F + q * (-1.372F + q * (-1.718F + q * -0.655F)));
}

/// Values that do not depend on the climb rate.
struct Rotor {
    float weight;   ///< [N]
    float hover;    ///< induced velocity in hover v_h [m/s]
    float profile;  ///< P_0 [W]

    explicit Rotor(const vehicle::Airframe& airframe) noexcept
    {
        const float disk = airframe.rotors * kPi * airframe.rotor_radius * airframe.rotor_radius;
        const float solidity = airframe.blades * airframe.chord / (kPi * airframe.rotor_radius);
        const float tip = airframe.tip_speed;
        weight = airframe.mass * kGravity;
        hover = std::sqrt(weight / (2.0F * airframe.air_density * disk));
        profile = airframe.air_density * disk * tip * tip * tip * solidity * airframe.blade_drag_coefficient / 8.0F;
    }

    [[nodiscard]] float power(float climb_rate) const noexcept
    {
        const float q = climb_rate / hover;
        float induced = 0.0F;  // over v_h, k_i included
        if (q >= 0.0F) {
            induced = 0.5F * kInduced * (std::sqrt(q * q + 4.0F) - q);
        } else if (q > -2.0F) {
            induced = empirical_descent(q);
        } else {
            induced = -0.5F * kInduced * (q + std::sqrt(q * q - 4.0F));
        }
        return weight * hover * (q + induced) + profile;
    }
};

}  // namespace

float rotor_power(float climb_rate, const vehicle::Airframe& airframe) noexcept
{
    return Rotor(airframe).power(climb_rate);
}

float hover_power(const path::TimedPath& path, const vehicle::Airframe& airframe) noexcept
{
    const Rotor rotor(airframe);
    float work = 0.0F;
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
        work += rotor.power(path.points[i].velocity.z()) * (path.points[i + 1].time - path.points[i].time);
    }
    const Seconds duration = path.points.back().time - path.points.front().time;
    return duration > 0.0F ? work / duration : rotor.power(path.points.front().velocity.z());
}

}  // namespace jink::cost
