// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/optimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"
#include "core/orca/meet.hpp"

namespace jink::orca {

namespace {

constexpr float kTiny = 1e-12F;    // of a length squared that has no direction
constexpr float kEndless = 1e18F;  // [m/s]

/// Disc: what a plane leaves of a ball.
struct Disc {
    Vec3 centre = Vec3::Zero();
    float radius = 0.0F;
};

/// The point of a ball (or, with everything in one plane, of a disc) nearest to the goal or farthest along it.
Vec3 onto(const Vec3& centre, float radius, const Goal& goal) noexcept
{
    const Vec3 way = goal.farthest ? goal.point : Vec3(goal.point - centre);
    const float length2 = way.squaredNorm();
    if (!goal.farthest && length2 <= radius * radius) {
        return goal.point;
    }
    return length2 > kTiny ? Vec3(centre + way * (radius / std::sqrt(length2))) : centre;
}

/// How far from the first centre, on the way to the second, the spheres cut; and the radius of the cut, or negative.
struct Cut {
    float along;
    float radius2;
};
Cut cut(float distance, float radius_1, float radius_2) noexcept
{
    const float along = 0.5F * (distance + (radius_1 - radius_2) * (radius_1 + radius_2) / distance);
    return {along, (radius_1 - along) * (radius_1 + along)};
}

/// Some unit vector across `axis`.
Vec3 any_across(const Vec3& axis) noexcept
{
    return (std::fabs(axis.x()) < 0.6F ? axis.cross(Vec3::UnitX()) : axis.cross(Vec3::UnitY())).normalized();
}

/// Where the spheres of two balls cut, towards the goal.
bool optimum_on_circle(const Ball& one, const Ball& other, const Goal& goal, float tolerance, Vec3& x) noexcept
{
    const Vec3 between = other.centre - one.centre;
    const float distance = between.norm();
    if (distance <= tolerance) {
        return false;
    }
    const Vec3 axis = between / distance;
    const Cut at = cut(distance, one.radius, other.radius);
    if (at.radius2 < -2.0F * one.radius * tolerance) {
        return false;
    }
    const Vec3 centre = one.centre + at.along * axis;
    const Vec3 way = goal.farthest ? goal.point : Vec3(goal.point - centre);
    const Vec3 level = way - way.dot(axis) * axis;
    const float length2 = level.squaredNorm();
    const Vec3 direction = length2 > kTiny ? Vec3(level / std::sqrt(length2)) : any_across(axis);
    x = centre + std::sqrt(std::max(at.radius2, 0.0F)) * direction;
    return true;
}

/// What of `ball` lies in the plane; false where nothing does.
bool disc_of(const Ball& ball, const Row& plane, float tolerance, Disc& disc) noexcept
{
    const float height = -plane.violation(ball.centre);
    if (std::fabs(height) > ball.radius + tolerance) {
        return false;
    }
    disc.centre = ball.centre - height * plane.normal;
    disc.radius = std::sqrt(std::max((ball.radius - height) * (ball.radius + height), 0.0F));
    return true;
}

/// The better one of the two points of a plane where two circles cut.
bool optimum_on_corners(const Disc& one, const Disc& other, const Vec3& normal, const Goal& goal, float tolerance,
                        Vec3& x) noexcept
{
    const Vec3 between = other.centre - one.centre;
    const float distance = between.norm();
    if (distance <= tolerance) {
        return false;
    }
    const Vec3 axis = between / distance;
    const Cut at = cut(distance, one.radius, other.radius);
    if (at.radius2 < -2.0F * one.radius * tolerance - tolerance * tolerance) {
        return false;
    }
    const Vec3 middle = one.centre + at.along * axis;
    const Vec3 half = std::sqrt(std::max(at.radius2, 0.0F)) * normal.cross(axis);
    const Vec3 way = goal.farthest ? goal.point : Vec3(goal.point - middle);
    x = half.dot(way) >= 0.0F ? Vec3(middle + half) : Vec3(middle - half);
    return true;
}

bool optimum_on_two_discs(const Disc& one, const Disc& other, const Row& plane, const Goal& goal, float tolerance,
                          Vec3& x) noexcept
{
    const auto in = [tolerance](const Disc& disc, const Vec3& p) {
        return within({disc.centre, disc.radius}, p, tolerance);
    };
    if (goal.farthest && goal.point.squaredNorm() <= kTiny) {
        // Every point is as good: the middle of what both leave of the line through their centres.
        const Vec3 between = other.centre - one.centre;
        const float distance = between.norm();
        const float from = std::max(-one.radius, distance - other.radius);
        const float to = std::min(one.radius, distance + other.radius);
        if (from > to + 2.0F * tolerance) {
            return false;
        }
        x = distance > tolerance ? Vec3(one.centre + between * (0.5F * (from + to) / distance)) : one.centre;
        return true;
    }
    const Vec3 first = onto(one.centre, one.radius, goal);
    if (in(other, first)) {
        x = first;
        return true;
    }
    const Vec3 second = onto(other.centre, other.radius, goal);
    if (in(one, second)) {
        x = second;
        return true;
    }
    return optimum_on_corners(one, other, plane.normal, goal, tolerance, x);
}

/// On a plane, within the balls.
bool optimum_on_disc(const Row& plane, Balls balls, const Goal& goal, float tolerance, Vec3& x) noexcept
{
    Disc one;
    if (!disc_of(balls[0], plane, tolerance, one)) {
        return false;
    }
    const float off = goal.farthest ? -goal.point.dot(plane.normal) : plane.violation(goal.point);
    Goal level{goal.point + off * plane.normal, goal.farthest};
    if (goal.farthest) {
        // Nearly along the normal, what is left is rounding in part, and becomes long: once more.
        level.point -= level.point.dot(plane.normal) * plane.normal;
        if (level.point.squaredNorm() <= kTiny) {
            level.point = Vec3::Zero();
        }
    }
    if (balls.size() == 1) {
        x = onto(one.centre, one.radius, level);
        return true;
    }
    Disc other;
    return disc_of(balls[1], plane, tolerance, other) && optimum_on_two_discs(one, other, plane, level, tolerance, x);
}

/// A piece of a line: its ends, and how steeply what ends it there is left beyond.
struct Piece {
    float low = -kEndless;
    float high = kEndless;
    float low_slope = 1.0F;
    float high_slope = 1.0F;
    std::uint16_t low_row = kNone;
    std::uint16_t high_row = kNone;

    static constexpr std::uint16_t kNone = 0xFFFF;

    /// Brings ends that passed each other by no more than rounding back together.
    [[nodiscard]] bool close_up(float tolerance) noexcept
    {
        if (low <= high) {
            return true;
        }
        // Between both ends the larger violation is least where both are equal.
        const float sum = low_slope + high_slope;
        const float middle = (low * low_slope + high * high_slope) / sum;
        if ((low - middle) * low_slope > 2.0F * tolerance) {
            return false;
        }
        low = high = middle;
        return true;
    }
};

/// What the balls leave of the line from + t * along.
bool piece_in_balls(Balls balls, const Vec3& from, const Vec3& along, float tolerance, Piece& piece) noexcept
{
    for (const Ball& ball : balls) {
        const Vec3 away = from - ball.centre;
        const float middle = -away.dot(along);
        // Of the point of the line nearest to the centre: no difference of squares.
        const float nearest = (away + middle * along).norm();
        if (nearest > ball.radius + tolerance) {
            return false;
        }
        const float half = std::sqrt(std::max((ball.radius - nearest) * (ball.radius + nearest), 0.0F));
        piece.low = std::max(piece.low, middle - half);
        piece.high = std::min(piece.high, middle + half);
    }
    return piece.close_up(tolerance);
}

/// Cuts the piece of the line off where rows[j] ends it.
void cut_by(const Row& row, std::size_t j, const Vec3& from, const Vec3& along, Piece& piece) noexcept
{
    const float slope = along.dot(row.normal);
    const float missing = row.violation(from);
    const float t = missing / slope;
    if (slope > 0.0F) {
        if (t > piece.low) {
            piece.low = t;
            piece.low_slope = slope;
            piece.low_row = static_cast<std::uint16_t>(j);
        }
    } else if (t < piece.high) {
        piece.high = t;
        piece.high_slope = -slope;
        piece.high_row = static_cast<std::uint16_t>(j);
    }
}

/// On the line, within rows[0 .. before) and the balls. `end` is the row that holds the optimum, or Piece::kNone.
bool optimum_on_line(std::span<const Row> rows, std::size_t before, const Vec3& from, const Vec3& along, Balls balls,
                     const Goal& goal, float tolerance, Vec3& x, std::uint16_t& end) noexcept
{
    Piece piece;
    if (!piece_in_balls(balls, from, along, tolerance, piece)) {
        return false;
    }
    for (std::size_t j = 0; j < before; ++j) {
        const float slope = along.dot(rows[j].normal);
        if (std::fabs(slope) <= kSameDirection) {
            // Along the line nothing changes by more than rounding.
            if (rows[j].violation(from) > 2.0F * tolerance) {
                return false;
            }
            continue;
        }
        cut_by(rows[j], j, from, along, piece);
        if (piece.low > piece.high && !piece.close_up(tolerance)) {
            return false;
        }
    }
    const float wanted =
        goal.farthest ? (goal.point.dot(along) > 0.0F ? piece.high : piece.low) : along.dot(goal.point - from);
    const float t = std::clamp(wanted, piece.low, piece.high);
    end = t == piece.low ? piece.low_row : t == piece.high ? piece.high_row : Piece::kNone;
    x = from + t * along;
    return true;
}

}  // namespace

bool optimum_in_balls(Balls balls, const Goal& goal, Tolerance tolerance, Vec3& x) noexcept
{
    x = onto(balls[0].centre, balls[0].radius, goal);
    if (balls.size() == 1 || within(balls[1], x, tolerance.outside)) {
        return true;
    }
    const Vec3 second = onto(balls[1].centre, balls[1].radius, goal);
    if (within(balls[0], second, tolerance.outside)) {
        x = second;
        return true;
    }
    return optimum_on_circle(balls[0], balls[1], goal, tolerance.outside, x);
}

Found optimum_on_plane(std::span<const Row> rows, std::size_t on, std::size_t before, Balls balls, const Goal& goal,
                       Tolerance tolerance, WorkBudget& budget, Vec3& x, Basis& basis) noexcept
{
    if (!budget.spend(units::kOrcaPlane + units::orca_rows(before))) {
        return Found::exhausted;
    }
    Vec3 best;
    if (!optimum_on_disc(rows[on], balls, goal, tolerance.outside, best)) {
        return Found::nothing;
    }
    Basis held{{static_cast<std::uint16_t>(on)}, 1};
    for (std::size_t j = 0; j < before; ++j) {
        if (rows[j].violation(best) <= tolerance.outside) {
            continue;
        }
        if (!budget.spend(units::kOrcaLine + units::orca_rows(j))) {
            return Found::exhausted;
        }
        Vec3 from;
        Vec3 along;
        std::uint16_t end = Piece::kNone;
        if (!line_of(rows[on], rows[j], best, from, along) ||
            !optimum_on_line(rows, j, from, along, balls, goal, tolerance.outside, best, end)) {
            return Found::nothing;
        }
        if (end != Piece::kNone) {
            settle(rows[on], rows[j], rows[end], balls, tolerance.outside, best);
        }
        held = {{static_cast<std::uint16_t>(on), static_cast<std::uint16_t>(j), end},
                static_cast<std::uint8_t>(end == Piece::kNone ? 2 : 3)};
    }
    x = best;
    basis = held;
    return Found::optimum;
}

Optimum optimum(std::span<const Row> rows, Balls balls, const Goal& goal, Tolerance tolerance,
                WorkBudget& budget) noexcept
{
    Optimum out;
    if (!budget.spend(units::kOrcaPlane + units::orca_rows(rows.size()))) {
        out.found = Found::exhausted;
        return out;
    }
    if (!optimum_in_balls(balls, goal, tolerance, out.x)) {
        return out;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        out.satisfied = i;
        if (rows[i].violation(out.x) <= tolerance.outside) {
            continue;
        }
        out.found = optimum_on_plane(rows, i, i, balls, goal, tolerance, budget, out.x, out.basis);
        if (out.found != Found::optimum) {
            return out;
        }
    }
    out.found = Found::optimum;
    out.satisfied = rows.size();
    return out;
}

}  // namespace jink::orca
