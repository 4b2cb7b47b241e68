// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/exact_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace jink::host {
namespace {

constexpr double kGravity = 9.81;

double cubic(double u) { return u * u * (3.0 - 2.0 * u); }

double quintic(double u) { return u * u * u * (10.0 + u * (-15.0 + 6.0 * u)); }

double mirrored(double u) { return u > 1.0 ? 2.0 - u : u; }

double gradient(const std::vector<double>& f, std::size_t i)
{
    const std::size_t last = f.size() - 1;
    return i == 0 ? f[1] - f[0] : i == last ? f[last] - f[last - 1] : 0.5 * (f[i + 1] - f[i - 1]);
}

}  // namespace

std::span<const CurveFamily> curve_families()
{
    static const std::array<CurveFamily, 3> families{{{"simple", 1.5, [](double u) { return cubic(u); }},
                                                      {"symmetric", 2.0, [](double u) { return cubic(mirrored(u)); }},
                                                      {"smooth", 2.0, [](double u) { return quintic(mirrored(u)); }}}};
    return families;
}

ExactCurve::ExactCurve(const CurveFamily& family, std::size_t waypoints)
    : step_(family.length / static_cast<double>(waypoints - 1))
{
    for (std::size_t i = 0; i < waypoints; ++i) {
        offset_.push_back(family.offset(step_ * static_cast<double>(i)));
    }
    for (std::size_t i = 0; i + 1 < waypoints; ++i) {
        slope_.push_back((offset_[i + 1] - offset_[i]) / step_);
    }
}

double ExactCurve::chord(std::size_t i, double ratio) const
{
    return step_ * std::sqrt(1.0 + ratio * slope_[i] * ratio * slope_[i]);
}

double ExactCurve::length(double ratio) const
{
    double sum = 0.0;
    for (std::size_t i = 0; i < chords(); ++i) {
        sum += chord(i, ratio);
    }
    return sum;
}

double ExactCurve::bend(double ratio) const
{
    std::vector<double> first(offset_.size());
    for (std::size_t i = 0; i < offset_.size(); ++i) {
        first[i] = gradient(offset_, i) * ratio / step_;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < offset_.size(); ++i) {
        const double second = gradient(first, i) / step_;
        const double stretch = 1.0 + first[i] * first[i];
        const bool end = i == 0 || i + 1 == offset_.size();
        sum += (end ? 0.5 : 1.0) * second * second / (stretch * stretch * stretch) * step_;
    }
    return sum;
}

double ExactCurve::turn(double ratio) const
{
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < chords(); ++i) {
        const double here = ratio * slope_[i];
        const double next = ratio * slope_[i + 1];
        const double x = 1.0 / std::sqrt(1.0 + next * next) - 1.0 / std::sqrt(1.0 + here * here);
        const double y = next / std::sqrt(1.0 + next * next) - here / std::sqrt(1.0 + here * here);
        sum += chord(i, ratio) * (x * x + y * y);
    }
    return sum;
}

double ExactCurve::chord_time(std::size_t i, const ExactQuery& query) const
{
    const double ratio = query.offset / query.distance;
    const double rise = query.along_z + ratio * slope_[i] * query.side_z;
    const double length = std::sqrt(1.0 + ratio * slope_[i] * ratio * slope_[i]);
    return query.distance * step_ * std::max({length / query.speed, rise / query.max_climb, -rise / query.max_descent});
}

double ExactCurve::time(const ExactQuery& query) const
{
    double sum = 0.0;
    for (std::size_t i = 0; i < chords(); ++i) {
        sum += chord_time(i, query);
    }
    return sum;
}

std::vector<double> ExactCurve::times(const ExactQuery& query) const
{
    std::vector<double> at{0.0};
    for (std::size_t i = 0; i < chords(); ++i) {
        at.push_back(at.back() + chord_time(i, query));
    }
    return at;
}

double ExactCurve::energy(const ExactQuery& query) const
{
    const double ratio = query.offset / query.distance;
    const auto velocity = [&](std::size_t i) {  // in the curve's own plane
        const double per_time = query.distance * step_ / chord_time(i, query);
        return std::array<double, 2>{per_time, per_time * ratio * slope_[i]};
    };
    double sum = 0.0;
    std::array<double, 2> here = velocity(0);
    for (std::size_t i = 0; i < chords(); ++i) {
        const std::array<double, 2> next = i + 1 < chords() ? velocity(i + 1) : here;
        const double rise = query.distance * step_ * (query.along_z + ratio * slope_[i] * query.side_z);
        const double kinetic = 0.5 * (next[0] * next[0] + next[1] * next[1] - here[0] * here[0] - here[1] * here[1]);
        const double x = here[0] + next[0];
        const double y = here[1] + next[1];
        sum += query.mass * std::abs(kinetic + kGravity * rise) +
               query.drag * query.distance * chord(i, ratio) * (x * x + y * y);
        here = next;
    }
    return sum;
}

double exact_bend(const CurveFamily& family, double ratio)
{
    // Differences within each half only: at the apex the second derivative of some families jumps.
    constexpr std::size_t kParts = 4000;
    constexpr double kDelta = 1e-4;
    double sum = 0.0;
    for (std::size_t i = 0; i < kParts; ++i) {  // mid-points stay within their half: both halves are a whole number of
                                                // parts long
        const double u = family.length * (static_cast<double>(i) + 0.5) / static_cast<double>(kParts);
        const double low = family.offset(u - kDelta);
        const double high = family.offset(u + kDelta);
        const double first = ratio * (high - low) / (2.0 * kDelta);
        const double second = ratio * (high - 2.0 * family.offset(u) + low) / (kDelta * kDelta);
        const double stretch = 1.0 + first * first;
        sum += second * second / (stretch * stretch * stretch) * family.length / static_cast<double>(kParts);
    }
    return sum;
}

double drag_of(const vehicle::Airframe& airframe)
{
    return 0.25 * static_cast<double>(airframe.drag_coefficient) * static_cast<double>(airframe.air_density) *
           static_cast<double>(airframe.effective_area);
}

ExactQuery query_for(const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe)
{
    ExactQuery query;
    query.speed = static_cast<double>(limits.cruise_speed);
    query.max_climb = static_cast<double>(limits.max_climb);
    query.max_descent = static_cast<double>(limits.max_descent);
    query.mass = static_cast<double>(airframe.mass);
    query.drag = drag_of(airframe);
    return query;
}

}  // namespace jink::host
