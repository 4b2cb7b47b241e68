// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/intruder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "tests/reference/reach/fusion.hpp"

namespace jink::reach {
namespace {

constexpr float kForEver = std::numeric_limits<float>::infinity();
/// Rounding error of an intruder's line, relative to its distance.
constexpr float kFarSlack = 1e-6F;

using Times = StaticVector<float, kMaxCrossings>;

void add(Times& times, float t) noexcept
{
    if (t > 0.0F && std::isfinite(t)) {
        times.unchecked_push_back(t);
    }
}

/// Both roots of a t^2 + 2 b t + c = 0, in the form without differences of like numbers.
void add_roots(Times& times, float a, float b, float c) noexcept
{
    const float discriminant = b * b - a * c;
    if (!(discriminant >= 0.0F)) {
        return;
    }
    const float q = -(b + std::copysign(std::sqrt(discriminant), b));
    add(times, q / a);
    add(times, c / q);
}

float square(float x) noexcept { return x * x; }

/// Times at which a line may change cells.
void find_crossings(const Grid<float>& grid, const Vec3& x, const Vec3& v, Times& times) noexcept
{
    for (std::size_t layer = 0; layer <= grid.layers(); ++layer) {
        const float radius = layer < grid.layers() ? grid.layer_start(layer) : grid.distance();
        add_roots(times, v.squaredNorm(), x.dot(v), x.squaredNorm() - square(radius));
    }
    for (std::size_t column = 0; column <= grid.columns(); ++column) {
        const float h = grid.column_start(column);
        add(times, -(x.x() * std::sin(h) - x.y() * std::cos(h)) / (v.x() * std::sin(h) - v.y() * std::cos(h)));
    }
    for (std::size_t row = 0; row <= grid.rows(); ++row) {
        const float slope = square(std::tan(grid.row_start(row)));
        add_roots(times, v.z() * v.z() - slope * (square(v.x()) + square(v.y())),
                  x.z() * v.z() - slope * (x.x() * v.x() + x.y() * v.y()),
                  x.z() * x.z() - slope * (square(x.x()) + square(x.y())));
    }
}

/// In-plane axes of the cone: to the intruder's left, and up.
struct Axes {
    Vec3 along;
    Vec3 left;
    Vec3 up;

    explicit Axes(const Vec3& velocity) noexcept : along(velocity.normalized())
    {
        constexpr float kUpright = 1e-3F;
        const Vec3 across = Vec3::UnitZ().cross(along);
        const float size = across.norm();
        left = size < kUpright ? Vec3(Vec3::UnitX()) : Vec3(across / size);
        up = along.cross(left);
    }
};

}  // namespace

CellSphere sphere_of(const Grid<float>& grid, const CellPlace& place) noexcept
{
    CellSphere sphere;
    sphere.centre = grid.centre(place);
    // The farthest point of a cell from any point in it is a corner, or on the middle of an outer edge at most as far:
    // the arcs between corners bulge outwards, which the middle of each outer edge takes in.
    const std::array distances{grid.layer_start(place.layer), grid.layer_end(place.layer)};
    const std::array horizontals{grid.column_start(place.column), grid.column_start(place.column + 1U)};
    const std::array verticals{grid.row_start(place.row), grid.row_start(place.row + 1U)};
    for (const float distance : distances) {
        for (const float horizontal : {horizontals[0], (horizontals[0] + horizontals[1]) / 2.0F, horizontals[1]}) {
            for (const float vertical : {verticals[0], (verticals[0] + verticals[1]) / 2.0F, verticals[1]}) {
                const Vec3 point = from_polar(Polar<float>{distance, horizontal, vertical});
                sphere.radius = std::max(sphere.radius, (point - sphere.centre).norm());
            }
        }
    }
    return sphere;
}

void cross(const Grid<float>& grid, const Vec3& position, const Vec3& velocity, CrossedCells& out) noexcept
{
    out.clear();
    if (!(velocity.squaredNorm() > 0.0F)) {
        return;
    }
    Times times;
    times.unchecked_push_back(0.0F);
    find_crossings(grid, position, velocity, times);
    std::sort(times.begin(), times.end());
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        if (!(times[i + 1] > times[i])) {
            continue;
        }
        const Located at = grid.locate(Vec3(position + 0.5F * (times[i] + times[i + 1]) * velocity));
        if (at.status != LocateStatus::inside) {
            continue;
        }
        const CellIndex cell = grid.index(at.place);
        if (!out.empty() && out.back().cell == cell && out.back().stay.to == times[i]) {
            out.back().stay.to = times[i + 1];
        } else {
            out.unchecked_push_back({cell, {times[i], times[i + 1]}});
        }
    }
}

std::optional<Stay> body_in(const CellSphere& cell, const Intruder& intruder) noexcept
{
    const float reach = intruder.radius + cell.radius;
    const Vec3 from = intruder.position - cell.centre;
    const float a = intruder.velocity.squaredNorm();
    if (a < square(kStandsBelow) && from.norm() <= reach) {
        return Stay{0.0F, kForEver};
    }
    // The distance from the line by the cross product: a difference of squares loses a body that comes from afar.
    const float apart = from.cross(intruder.velocity).squaredNorm();
    const float discriminant = a * square(reach + kFarSlack * from.norm()) - apart;
    if (!(discriminant >= 0.0F) || !(a > 0.0F)) {
        return std::nullopt;
    }
    const float b = from.dot(intruder.velocity);
    const float root = std::sqrt(discriminant);
    const float last = (-b + root) / a;
    return last < 0.0F ? std::nullopt : std::optional(Stay{std::max(0.0F, (-b - root) / a), last});
}

std::optional<Stay> spread_in(const CellSphere& cell, const Intruder& intruder) noexcept
{
    const float speed = intruder.velocity.norm();
    if (speed < kStandsBelow) {
        // A slow intruder may stay in contact for ever; its possible motion is still a cone.
        const std::optional<Stay> stands = body_in(cell, intruder);
        if (stands || !(speed > 0.0F)) {
            return stands;
        }
    }
    const float reach = intruder.radius + cell.radius;
    const Axes axes(intruder.velocity);
    const Vec3 to = cell.centre - intruder.position;
    const float ahead = to.dot(axes.along) + reach;
    if (ahead < 0.0F) {
        return std::nullopt;
    }
    const float a = std::tan(std::min(intruder.horizontal, kMaxSpread)) * ahead;
    const float b = std::tan(std::min(intruder.vertical, kMaxSpread)) * ahead;
    const float left = std::abs(to.dot(axes.left));
    const float up = std::abs(to.dot(axes.up));
    if (left > a + reach || up > b + reach) {
        return std::nullopt;
    }
    const float least = std::min(a, b);
    if (least > 0.0F) {
        const float scale = 1.0F + reach / least;
        if (square(left / (a * scale)) + square(up / (b * scale)) > 1.0F) {
            return std::nullopt;
        }
    }
    const float distance = to.norm();
    return reach_times(std::max(0.0F, distance - reach), distance + reach, speed, intruder.speed_share);
}

float time_rate(const Stay& vehicle, const Stay& intruder) noexcept
{
    const float overlap = std::min(intruder.to, vehicle.to) - std::max(intruder.from, vehicle.from);
    if (!(overlap >= 0.0F)) {
        return 0.0F;
    }
    const float length = vehicle.to - vehicle.from;
    return length > 0.0F ? std::clamp(overlap / length, 2.0F * kThreshold, 1.0F) : 1.0F;
}

float padding(float step, float radius, float speed, float clock) noexcept
{
    return speed > 0.0F ? (0.5F * step + radius) / speed + clock : kForEver;
}

Stay padded(const Stay& stay, float by) noexcept { return {std::max(0.0F, stay.from - by), stay.to + by}; }

Stay reach_times(float nearest, float farthest, float speed, float share) noexcept
{
    if (!(speed > 0.0F)) {
        return {0.0F, kForEver};
    }
    const float slow = speed * (1.0F - share);
    return {nearest / (speed * (1.0F + share)), slow > 0.0F ? farthest / slow : kForEver};
}

Intruder moved(const Intruder& intruder, float later) noexcept
{
    Intruder there = intruder;
    there.position += later * intruder.velocity;
    return there;
}

CombinedModel::CombinedModel(const Grid<float>& grid, const Intruder& intruder, const Models& models,
                             float clock) noexcept
    : intruder_(intruder), models_(models), clock_(clock)
{
    if (!(models.line || models.body || models.spread)) {
        models_ = {true, true, true, false};
        status_ = ModelStatus::bad_intruder_model;
    }
    if (!models_.line) {
        return;
    }
    cross(grid, intruder.position, intruder.velocity, crossed_);
    const Located at = grid.locate(intruder.position);
    if (intruder.velocity.norm() < kStandsBelow && at.status == LocateStatus::inside) {
        // The capacity suffices: between kMaxCrossings times there is one stay less.
        crossed_.unchecked_push_back({grid.index(at.place), {0.0F, kForEver}});
    }
}

Meeting CombinedModel::in(CellIndex cell, const CellSphere& sphere, const std::optional<Stay>& vehicle) const noexcept
{
    Meeting meeting;
    const auto add = [&](const std::optional<Stay>& touched, float by) {
        if (!touched) {
            return;
        }
        const Stay stay = padded(*touched, by);
        const float timed = vehicle ? time_rate(*vehicle, stay) : 0.0F;
        meeting.rate = std::max(meeting.rate, models_.timed ? timed : 1.0F);
        meeting.stay =
            meeting.stay ? Stay{std::min(meeting.stay->from, stay.from), std::max(meeting.stay->to, stay.to)} : stay;
    };
    // The line's times are of the body's centre; the other models' times have the radius in them.
    const float speed = intruder_.velocity.norm();
    for (const CellStay& crossed : crossed_) {
        if (crossed.cell == cell) {
            add(crossed.stay, padding(0.0F, intruder_.radius, speed, clock_));
        }
    }
    if (models_.body) {
        add(body_in(sphere, intruder_), clock_);
    }
    if (models_.spread) {
        add(spread_in(sphere, intruder_), clock_);
    }
    return meeting;
}

}  // namespace jink::reach
