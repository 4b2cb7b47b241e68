// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/waypoints_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/cost/cost.hpp"
#include "toolchain/host/exact_curve.hpp"

namespace jink::host {
namespace {

constexpr std::array<double, 8> kRatios{0.16, 0.32, 0.48, 0.64, 0.8, 0.96, 1.12, 1.28};
constexpr std::array<double, 3> kElevations{-30.0, 0.0, 30.0};
constexpr std::array<double, 4> kStudyPlanes{0.0, 45.0, 90.0, 135.0};

struct Point {
    double x = 0.0, y = 0.0, z = 0.0;
};

double sine(double degrees) { return std::sin(degrees * std::numbers::pi / 180.0); }
double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

/// Costs of a curve as flown with one number of waypoints.
struct Costs {
    double time = 0.0, smoothness = 0.0, energy = 0.0, closeness = 0.0, total = 0.0;
};

struct Shape {
    double ratio = 0.0, elevation = 0.0, plane = 0.0;
};

/// The leg lies in the xz plane; planes turn about it from y.
Point point_of(const ExactCurve& curve, std::size_t i, const Shape& shape, double distance)
{
    const double along = distance * curve.step() * static_cast<double>(i);
    const double aside = distance * shape.ratio * curve.offset()[i];
    const double up = aside * sine(shape.plane);
    return {along * cosine(shape.elevation) - up * sine(shape.elevation), aside * cosine(shape.plane),
            along * sine(shape.elevation) + up * cosine(shape.elevation)};
}

/// Eq. 4.11 for a threat that crosses the leg's far end at half the cruise speed, with a radius of a fifth of the
/// distance.
double closeness(const ExactCurve& curve, const ExactQuery& query, const Shape& shape)
{
    const double distance = query.distance;
    const std::vector<double> times = curve.times(query);
    double sum = 0.0;
    double least = 1e300;
    for (std::size_t i = 0; i < times.size(); ++i) {
        const Point p = point_of(curve, i, shape, distance);
        const double flown = 0.5 * query.speed * times[i];
        const double dx = p.x - 1.4 * distance;
        const double dy = p.y - (2.2 * distance - flown);
        const double dz = p.z - 0.6 * distance;
        const double apart = std::sqrt(dx * dx + dy * dy + dz * dz) - 0.2 * distance;
        sum += apart;
        least = std::min(least, apart);
    }
    return 1.0 / (0.5 * sum / static_cast<double>(times.size()) + 0.5 * least);
}

Costs costs_of(const ExactCurve& curve, const files::Vehicle& vehicle, const Shape& shape)
{
    ExactQuery query = query_for(vehicle.limits, vehicle.airframe);
    query.distance = static_cast<double>(study_distance(vehicle.limits));
    query.offset = shape.ratio * query.distance;
    query.along_z = sine(shape.elevation);
    query.side_z = cosine(shape.elevation) * sine(shape.plane);
    Costs out;
    out.time = curve.time(query);
    out.smoothness = curve.bend(shape.ratio) / query.distance;
    out.energy = curve.energy(query);
    out.closeness = closeness(curve, query, shape);
    const double rotated =
        out.smoothness * (1.0 + std::sqrt(query.along_z * query.along_z + query.side_z * query.side_z));
    cost::Terms terms;
    terms.time = static_cast<float>(out.time);
    terms.smoothness = static_cast<float>(out.smoothness);
    terms.smoothness_penalised = static_cast<float>(rotated);
    terms.closeness = static_cast<float>(out.closeness);
    out.total = static_cast<double>(cost::total(cost::normalise(terms, vehicle.caps), {}));
    return out;
}

void raise(double& largest, double found, double exact) { largest = std::max(largest, std::abs(found / exact - 1.0)); }

/// Distance of a point from a chord.
double apart(const Point& p, const Point& from, const Point& to)
{
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double t = std::clamp(((p.x - from.x) * dx + (p.y - from.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    return std::hypot(p.x - from.x - t * dx, p.y - from.y - t * dy);
}

}  // namespace

float study_distance(const vehicle::VehicleLimits& limits)
{
    return 2.0F * limits.cruise_speed * std::max(1.0F, limits.cruise_speed / limits.max_acceleration);
}

double chord_distance(std::size_t family, std::size_t waypoints, double ratio)
{
    constexpr std::size_t kBetween = 40;
    const CurveFamily& shape = curve_families()[family];
    const ExactCurve curve(shape, waypoints);
    double largest = 0.0;
    for (std::size_t i = 0; i < curve.chords(); ++i) {
        const double u = curve.step() * static_cast<double>(i);
        const Point from{u, ratio * curve.offset()[i], 0.0};
        const Point to{u + curve.step(), ratio * curve.offset()[i + 1], 0.0};
        for (std::size_t k = 1; k < kBetween; ++k) {
            const double at = u + curve.step() * static_cast<double>(k) / static_cast<double>(kBetween);
            largest = std::max(largest, apart({at, ratio * shape.offset(at), 0.0}, from, to));
        }
    }
    return largest;
}

WaypointErrors waypoint_errors(const files::Vehicle& vehicle, std::size_t waypoints)
{
    WaypointErrors out;
    out.waypoints = waypoints;
    std::vector<double> lowest(kElevations.size(), 1.0);
    std::vector<double> highest(kElevations.size(), -1.0);
    for (std::size_t family = 0; family < curve_families().size(); ++family) {
        const ExactCurve curve(curve_families()[family], waypoints);
        const ExactCurve fine(curve_families()[family], kReferenceWaypoints);
        out.inside = std::max(out.inside, chord_distance(family, waypoints, kRatios.back()));
        out.typical = std::max(out.typical, chord_distance(family, waypoints, 0.4));
        for (std::size_t e = 0; e < kElevations.size(); ++e) {
            for (const double plane : kStudyPlanes) {
                for (const double size : kRatios) {
                    for (const double ratio : {size, -size}) {
                        const Shape shape{ratio, kElevations[e], plane};
                        const Costs found = costs_of(curve, vehicle, shape);
                        const Costs exact = costs_of(fine, vehicle, shape);
                        raise(out.time, found.time, exact.time);
                        raise(out.smoothness, found.smoothness, exact.smoothness);
                        raise(out.energy, found.energy, exact.energy);
                        raise(out.closeness, found.closeness, exact.closeness);
                        const double off = found.total - exact.total;
                        out.cost = std::max(out.cost, std::abs(off));
                        lowest[e] = std::min(lowest[e], off);
                        highest[e] = std::max(highest[e], off);
                    }
                }
            }
        }
    }
    for (std::size_t e = 0; e < kElevations.size(); ++e) {
        out.order = std::max(out.order, highest[e] - lowest[e]);
    }
    return out;
}

}  // namespace jink::host
