// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/map_obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/finite.hpp"

namespace jink::reach {
namespace {

/// Relative tolerance of comparisons, so that rounding never makes a cell clear.
constexpr float kTouchSlack = 1e-5F;

Vec3 half_of(const MapObstacle& obstacle) noexcept
{
    switch (obstacle.shape) {
    case MapShape::sphere: return Vec3::Zero();
    case MapShape::line: return 0.5F * Vec3(obstacle.length, 0.0F, 0.0F);
    case MapShape::plane: return 0.5F * Vec3(obstacle.length, obstacle.width, 0.0F);
    case MapShape::cuboid: return 0.5F * Vec3(obstacle.length, obstacle.width, obstacle.depth);
    }
    return Vec3::Zero();
}

float rounding_of(const MapObstacle& obstacle) noexcept
{
    return obstacle.shape == MapShape::sphere ? obstacle.radius : 0.0F;
}

/// A range of numbers.
struct Between {
    float low = INFINITY;
    float high = -INFINITY;

    void add(float x) noexcept
    {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    [[nodiscard]] float middle() const noexcept { return 0.5F * (low + high); }
    [[nodiscard]] float half() const noexcept { return 0.5F * (high - low); }
};

/// Of amplitude sin(x - shift) for x from `from` to `to`, all within (-pi, pi) of the shift.
Between sine_bounds(float amplitude, float shift, float from, float to) noexcept
{
    Between bounds;
    bounds.add(amplitude * std::sin(from - shift));
    bounds.add(amplitude * std::sin(to - shift));
    for (const float peak : {-0.5F * kPi, 0.5F * kPi}) {
        if (from - shift <= peak && to - shift >= peak) {
            bounds.add(amplitude * std::sin(peak));
        }
    }
    return bounds;
}

/// Extent of a box from its centre along a unit vector.
float half_extent(const Mat3& axes, const Vec3& half, const Vec3& direction) noexcept
{
    return (axes.transpose() * direction).cwiseAbs().dot(half);
}

/// True if some axis separates the two by more than `gap`.
bool are_apart(const CellBox& cell, const MapBody& body, float gap) noexcept
{
    const Vec3 between = body.centre - cell.centre;
    const auto tells = [&](const Vec3& axis) {
        const float apart = std::abs(between.dot(axis)) - half_extent(cell.axes, cell.half, axis) -
                            half_extent(body.axes, body.half, axis);
        return apart > gap + kTouchSlack * (1.0F + between.norm());
    };
    for (Eigen::Index i = 0; i < 3; ++i) {
        if (tells(cell.axes.col(i)) || tells(body.axes.col(i))) {
            return true;
        }
        for (Eigen::Index j = 0; j < 3; ++j) {
            const Vec3 across = cell.axes.col(i).cross(body.axes.col(j));
            const float size = across.norm();
            // For nearly parallel edges the axes above suffice.
            if (size > 1e-3F && tells(across / size)) {
                return true;
            }
        }
    }
    return false;
}

/// The body and `gap` about it lie beyond one of the walls of the cell's layer or column.
bool is_beyond_walls(const Grid<float>& grid, const CellPlace& place, const MapBody& body, float gap) noexcept
{
    const float slack = kTouchSlack * (1.0F + body.centre.norm());
    // In the box's own axes: its nearest and farthest points from the vehicle.
    const Vec3 from = (body.axes.transpose() * body.centre).cwiseAbs();
    const float nearest = (from - body.half).cwiseMax(0.0F).norm() - gap;
    const float farthest = (from + body.half).norm() + gap;
    if (nearest > grid.layer_end(place.layer) + slack || farthest < grid.layer_start(place.layer) - slack) {
        return true;
    }
    const float right = grid.column_start(place.column);
    const float left = grid.column_start(place.column + 1U);
    if (left - right >= kPi) {
        return false;  // not between two planes
    }
    const Vec3 past_left(-std::sin(left), std::cos(left), 0.0F);
    const Vec3 past_right(std::sin(right), -std::cos(right), 0.0F);
    const auto past = [&](const Vec3& outwards) {
        return body.centre.dot(outwards) - half_extent(body.axes, body.half, outwards) > gap + slack;
    };
    return past(past_left) || past(past_right);
}

/// Points on one axis of a box: from its middle, `spacing` apart, as many as are within `half`.
std::size_t points_on(float half, float spacing) noexcept
{
    constexpr float kMax = 1e6F;
    return 2U * static_cast<std::size_t>(std::min(half / spacing + kTouchSlack, kMax)) + 1U;
}

/// The lattice about a body that holds its margin too, coarse enough.
struct Lattice {
    std::array<std::size_t, 3> count{};
    float spacing = 0.0F;
};
Lattice lattice_of(const Vec3& half, float spacing) noexcept
{
    Lattice lattice;
    lattice.spacing = spacing;
    constexpr int kMaxSteps = 256;  // 1.1^256 is more than any two lengths are apart
    for (int step = 0; step < kMaxSteps; ++step) {
        float points = 1.0F;
        for (Eigen::Index i = 0; i < 3; ++i) {
            std::size_t& count = lattice.count[static_cast<std::size_t>(i)];
            count = points_on(half[i], lattice.spacing);
            points *= static_cast<float>(count);
        }
        if (points <= static_cast<float>(kMaxCloudPoints)) {
            return lattice;
        }
        lattice.spacing *= 1.1F;
    }
    return {{1, 1, 1}, lattice.spacing};
}

/// Calls visit(point in the body's axes, whether it is of the body) for all points of the body and its margin.
template <class Visit>
void visit_cloud(const MapBody& body, const Lattice& lattice, const Visit& visit) noexcept
{
    const auto along = [&](std::size_t i, std::size_t axis) {
        return lattice.spacing * (static_cast<float>(i) - 0.5F * static_cast<float>(lattice.count[axis] - 1U));
    };
    for (std::size_t i = 0; i < lattice.count[0]; ++i) {
        for (std::size_t j = 0; j < lattice.count[1]; ++j) {
            for (std::size_t k = 0; k < lattice.count[2]; ++k) {
                const Vec3 local(along(i, 0), along(j, 1), along(k, 2));
                const float outside = (local.cwiseAbs() - body.half).cwiseMax(0.0F).norm();
                if (outside <= body.rounding + body.margin) {
                    visit(local, outside <= body.rounding);
                }
            }
        }
    }
}

/// Volume of a box and all that is within `about` of it (Steiner's formula).
float volume_of(const Vec3& half, float about) noexcept
{
    const float a = half.x();
    const float b = half.y();
    const float c = half.z();
    return 8.0F * (a * b * c + (a * b + b * c + c * a) * about) +
           kPi * about * about * (2.0F * (a + b + c) + 4.0F / 3.0F * about);
}

/// Of one point of a cloud. A body without volume, a line or a plane, is one wherever it is.
float point_rate(float volume, std::size_t points, float threshold) noexcept
{
    return threshold > 0.0F && volume > 0.0F && points > 0 ? volume / (threshold * static_cast<float>(points)) : 1.0F;
}

}  // namespace

MapStatus check(const MapObstacle& o) noexcept
{
    if (!is_finite(o.position) || !std::isfinite(o.roll + o.pitch + o.yaw)) {
        return MapStatus::not_a_number;
    }
    if (!is_positive(o.margin)) {
        return MapStatus::bad_margin;
    }
    const bool good = o.shape == MapShape::sphere
                          ? is_not_negative(o.radius)
                          : is_positive(o.length) && (o.shape == MapShape::line || is_positive(o.width)) &&
                                (o.shape != MapShape::cuboid || is_positive(o.depth));
    return good ? MapStatus::good : MapStatus::bad_size;
}

bool is_near(const MapObstacle& obstacle, const Vec3& vehicle, float range) noexcept
{
    const float total = obstacle.margin + rounding_of(obstacle) + half_of(obstacle).norm();
    return (obstacle.position - vehicle).norm() - total <= range;
}

MapBody in_grid(const MapObstacle& obstacle, const GridPose& pose) noexcept
{
    using Turned = Eigen::AngleAxisf;
    const Mat3 to_grid = Turned(-pose.yaw, Vec3::UnitZ()).toRotationMatrix();
    const Mat3 local = (Turned(obstacle.yaw, Vec3::UnitZ()) * Turned(obstacle.pitch, Vec3::UnitY()) *
                        Turned(obstacle.roll, Vec3::UnitX()))
                           .toRotationMatrix();
    MapBody body;
    body.centre = to_grid * (obstacle.position - pose.position) / pose.unit;
    body.axes = to_grid * local;
    body.half = half_of(obstacle) / pose.unit;
    body.rounding = rounding_of(obstacle) / pose.unit;
    body.margin = obstacle.margin / pose.unit;
    return body;
}

CellBox box_of(const Grid<float>& grid, const CellPlace& place) noexcept
{
    const float inner = grid.layer_start(place.layer);
    const float outer = grid.layer_end(place.layer);
    const float low = grid.row_start(place.row);
    const float high = grid.row_start(place.row + 1U);
    const float azimuth = 0.5F * (grid.column_start(place.column) + grid.column_start(place.column + 1U));
    const float elevation = 0.5F * (low + high);
    const float aside = grid.column_start(place.column + 1U) - azimuth;

    // Along the middle direction, aside and up, of a direction in the cell: its azimuth differs from the middle one by
    // 0 to `aside` on either side, and each is linear in the cosine of the difference, so both ends are checked.
    Between along;
    Between up;
    for (const float turned : {0.0F, aside}) {
        const float c = std::cos(turned);
        const float a = std::cos(elevation);
        const float b = std::sin(elevation);
        // sin(e) b + cos(e) a c, and sin(e) a - cos(e) b c.
        const Between ahead = sine_bounds(std::hypot(b, a * c), std::atan2(-a * c, b), low, high);
        const Between above = sine_bounds(std::hypot(a, b * c), std::atan2(b * c, a), low, high);
        along.add(ahead.low);
        along.add(ahead.high);
        up.add(above.low);
        up.add(above.high);
    }
    const bool level = low <= 0.0F && high >= 0.0F;
    const float level_share = level ? 1.0F : std::max(std::cos(low), std::cos(high));
    const float left = outer * level_share * (aside < 0.5F * kPi ? std::sin(aside) : 1.0F);
    const auto scaled = [&](const Between& b) {
        return Between{std::min(b.low * inner, b.low * outer), std::max(b.high * inner, b.high * outer)};
    };
    CellBox box;
    box.axes.col(0) = from_polar(Polar<float>{1.0F, azimuth, elevation});
    box.axes.col(1) = Vec3(-std::sin(azimuth), std::cos(azimuth), 0.0F);
    box.axes.col(2) = box.axes.col(0).cross(box.axes.col(1));
    const Between x = scaled(along);
    const Between z = scaled(up);
    box.centre = x.middle() * box.axes.col(0) + z.middle() * box.axes.col(2);
    box.half = Vec3(x.half(), left, z.half()) + Vec3::Constant(kTouchSlack * outer);
    return box;
}

Closure closure_of(const Grid<float>& grid, const CellPlace& place, const CellBox& box, const MapBody& body) noexcept
{
    const auto is_clear = [&](float gap) {
        return is_beyond_walls(grid, place, body, gap) || are_apart(box, body, gap);
    };
    if (is_clear(body.rounding + body.margin)) {
        return Closure::none;
    }
    return is_clear(body.rounding) ? Closure::soft : Closure::hard;
}

void add_map_obstacle(CellRating& cell, Closure closure) noexcept
{
    if (closure == Closure::hard) {
        cell.add_map(1.0F);
    } else if (closure == Closure::soft) {
        cell.add_map_margin(1.0F);
    }
}

CloudReport rate_by_cloud(const Grid<float>& grid, const MapBody& body, const CloudRule& rule, std::span<float> bodies,
                          std::span<float> margins) noexcept
{
    std::ranges::fill(bodies, 0.0F);
    std::ranges::fill(margins, 0.0F);
    const float about = body.rounding + body.margin;
    const Lattice lattice = lattice_of(body.half + Vec3::Constant(about), rule.spacing);
    std::size_t of_body = 0;
    std::size_t of_margin = 0;
    visit_cloud(body, lattice, [&](const Vec3&, bool is_body) { ++(is_body ? of_body : of_margin); });
    const float volume = volume_of(body.half, body.rounding);
    const float body_rate = point_rate(volume, of_body, rule.threshold);
    const float margin_rate = point_rate(volume_of(body.half, about) - volume, of_margin, rule.threshold);
    visit_cloud(body, lattice, [&](const Vec3& local, bool is_body) {
        const Located at = grid.locate(Vec3(body.centre + body.axes * local));
        if (at.status == LocateStatus::inside) {
            float& sum = (is_body ? bodies : margins)[grid.index(at.place)];
            sum = std::min(sum + (is_body ? body_rate : margin_rate), 1.0F);
        }
    });
    return {of_body + of_margin, lattice.spacing, lattice.spacing > rule.spacing};
}

}  // namespace jink::reach
