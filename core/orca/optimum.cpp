// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/optimum.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"
#include "core/orca/meet.hpp"

namespace jink::orca {

using std::fabs;
using std::sqrt;

namespace {

/// Of a length squared that has no direction.
template <class Real>
constexpr float kTiny = std::is_same_v<Real, float> ? 1e-12F : 1e-22F;
constexpr float kEndless = 1e18F;  // [m/s]
constexpr std::uint16_t kNoRow = 0xFFFF;

/// Disc: what a plane leaves of a sphere.
template <class Real>
struct Disc {
    Vec3Of<Real> centre = Vec3Of<Real>::Zero();
    Real radius = 0.0F;
};

template <class Real>
Disc<Real> whole_of(const Sphere& sphere) noexcept
{
    return {sphere.centre.template cast<Real>(), sphere.radius};
}

/// The point of a sphere (or, with everything in one plane, of a disc) nearest to the goal or farthest along it.
template <class Real>
Vec3Of<Real> onto(const Vec3Of<Real>& centre, Real radius, const GoalOf<Real>& goal) noexcept
{
    const Vec3Of<Real> way = goal.farthest ? goal.point : Vec3Of<Real>(goal.point - centre);
    const Real length2 = way.squaredNorm();
    if (!goal.farthest && length2 <= radius * radius) {
        return goal.point;
    }
    return length2 > kTiny<Real> ? Vec3Of<Real>(centre + way * (radius / sqrt(length2))) : centre;
}

/// How far from the first centre, on the way to the second, the spheres cut; and the radius of the cut, or negative.
template <class Real>
struct Cut {
    Real along;
    Real radius2;
};
template <class Real>
Cut<Real> cut(Real distance, Real radius_1, Real radius_2) noexcept
{
    const Real along = Real(0.5F) * (distance + (radius_1 - radius_2) * (radius_1 + radius_2) / distance);
    return {along, (radius_1 - along) * (radius_1 + along)};
}

/// Some unit vector across `axis`.
template <class Real>
Vec3Of<Real> any_across(const Vec3Of<Real>& axis) noexcept
{
    const bool is_x = fabs(axis.x()) < 0.6F;
    return axis.cross(is_x ? Vec3Of<Real>(Vec3Of<Real>::UnitX()) : Vec3Of<Real>(Vec3Of<Real>::UnitY())).normalized();
}

/// Where the spheres of two spheres cut, towards the goal.
template <class Real>
bool optimum_on_circle(const Disc<Real>& one, const Disc<Real>& other, const GoalOf<Real>& goal, float tolerance,
                       Vec3Of<Real>& x) noexcept
{
    const Vec3Of<Real> between = other.centre - one.centre;
    const Real distance = between.norm();
    if (distance <= tolerance) {
        return false;
    }
    const Vec3Of<Real> axis = between / distance;
    const Cut<Real> at = cut(distance, one.radius, other.radius);
    if (at.radius2 < Real(-2.0F * tolerance) * one.radius) {
        return false;
    }
    const Vec3Of<Real> centre = one.centre + at.along * axis;
    const Vec3Of<Real> way = goal.farthest ? goal.point : Vec3Of<Real>(goal.point - centre);
    const Vec3Of<Real> level = way - way.dot(axis) * axis;
    const Real length2 = level.squaredNorm();
    const Vec3Of<Real> direction = length2 > kTiny<Real> ? Vec3Of<Real>(level / sqrt(length2)) : any_across(axis);
    x = centre + sqrt(std::max(at.radius2, Real(0.0F))) * direction;
    return true;
}

/// What of `sphere` lies in the plane; false where nothing does.
template <class Real>
bool disc_of(const Disc<Real>& sphere, const RowOf<Real>& plane, float tolerance, Disc<Real>& disc) noexcept
{
    const Real height = -plane.violation(sphere.centre);
    if (fabs(height) > sphere.radius + tolerance) {
        return false;
    }
    disc.centre = sphere.centre - height * plane.normal;
    disc.radius = sqrt(std::max((sphere.radius - height) * (sphere.radius + height), Real(0.0F)));
    return true;
}

/// The better one of the two points of a plane where two circles cut.
template <class Real>
bool optimum_on_corners(const Disc<Real>& one, const Disc<Real>& other, const Vec3Of<Real>& normal,
                        const GoalOf<Real>& goal, float tolerance, Vec3Of<Real>& x) noexcept
{
    const Vec3Of<Real> between = other.centre - one.centre;
    const Real distance = between.norm();
    if (distance <= tolerance) {
        return false;
    }
    const Vec3Of<Real> axis = between / distance;
    const Cut<Real> at = cut(distance, one.radius, other.radius);
    if (at.radius2 < Real(-2.0F * tolerance) * one.radius - tolerance * tolerance) {
        return false;
    }
    const Vec3Of<Real> middle = one.centre + at.along * axis;
    const Vec3Of<Real> half = sqrt(std::max(at.radius2, Real(0.0F))) * normal.cross(axis);
    const Vec3Of<Real> way = goal.farthest ? goal.point : Vec3Of<Real>(goal.point - middle);
    x = half.dot(way) >= 0.0F ? Vec3Of<Real>(middle + half) : Vec3Of<Real>(middle - half);
    return true;
}

template <class Real>
bool optimum_on_two_discs(const Disc<Real>& one, const Disc<Real>& other, const RowOf<Real>& plane,
                          const GoalOf<Real>& goal, float tolerance, Vec3Of<Real>& x) noexcept
{
    const auto in = [tolerance](const Disc<Real>& disc, const Vec3Of<Real>& p) {
        const Real reach = disc.radius + tolerance;
        return (p - disc.centre).squaredNorm() <= reach * reach;
    };
    if (goal.farthest && goal.point.squaredNorm() <= kTiny<Real>) {
        // Every point is as good: the middle of what both leave of the line through their centres.
        const Vec3Of<Real> between = other.centre - one.centre;
        const Real distance = between.norm();
        const Real from = std::max(-one.radius, distance - other.radius);
        const Real to = std::min(one.radius, distance + other.radius);
        if (from > to + Real(2.0F * tolerance)) {
            return false;
        }
        x = distance > tolerance ? Vec3Of<Real>(one.centre + between * (Real(0.5F) * (from + to) / distance))
                                 : one.centre;
        return true;
    }
    const Vec3Of<Real> first = onto(one.centre, one.radius, goal);
    if (in(other, first)) {
        x = first;
        return true;
    }
    const Vec3Of<Real> second = onto(other.centre, other.radius, goal);
    if (in(one, second)) {
        x = second;
        return true;
    }
    return optimum_on_corners(one, other, plane.normal, goal, tolerance, x);
}

/// On a plane, within the spheres.
template <class Real>
bool optimum_on_disc(const RowOf<Real>& plane, Spheres spheres, const GoalOf<Real>& goal, float tolerance,
                     Vec3Of<Real>& x) noexcept
{
    Disc<Real> one;
    if (!disc_of(whole_of<Real>(spheres[0]), plane, tolerance, one)) {
        return false;
    }
    const Real off = goal.farthest ? -goal.point.dot(plane.normal) : plane.violation(goal.point);
    GoalOf<Real> level{goal.point + off * plane.normal, goal.farthest};
    if (goal.farthest) {
        // Nearly along the normal, what is left is rounding in part, and becomes long: once more.
        level.point -= level.point.dot(plane.normal) * plane.normal;
        if (level.point.squaredNorm() <= kTiny<Real>) {
            level.point = Vec3Of<Real>::Zero();
        }
    }
    if (spheres.size() == 1) {
        x = onto(one.centre, one.radius, level);
        return true;
    }
    Disc<Real> other;
    return disc_of(whole_of<Real>(spheres[1]), plane, tolerance, other) &&
           optimum_on_two_discs(one, other, plane, level, tolerance, x);
}

/// A piece of a line: its ends, and how steeply what ends it there is left beyond.
template <class Real>
struct Piece {
    Real low = -kEndless;
    Real high = kEndless;
    Real low_slope = 1.0F;
    Real high_slope = 1.0F;
    std::uint16_t low_row = kNoRow;
    std::uint16_t high_row = kNoRow;

    /// Brings ends that passed each other by no more than rounding back together.
    [[nodiscard]] bool close_up(float tolerance) noexcept
    {
        if (low <= high) {
            return true;
        }
        // Between both ends the larger violation is least where both are equal.
        const Real sum = low_slope + high_slope;
        const Real middle = (low * low_slope + high * high_slope) / sum;
        if ((low - middle) * low_slope > Real(2.0F * tolerance)) {
            return false;
        }
        low = high = middle;
        return true;
    }
};

/// What the spheres leave of the line from + t * along.
template <class Real>
bool piece_in_spheres(Spheres spheres, const Vec3Of<Real>& from, const Vec3Of<Real>& along, float tolerance,
                      Piece<Real>& piece) noexcept
{
    for (const Sphere& given : spheres) {
        const auto sphere = whole_of<Real>(given);
        const Vec3Of<Real> away = from - sphere.centre;
        const Real middle = -away.dot(along);
        // Of the point of the line nearest to the centre: no difference of squares.
        const Real nearest = (away + middle * along).norm();
        if (nearest > sphere.radius + tolerance) {
            return false;
        }
        const Real half = sqrt(std::max((sphere.radius - nearest) * (sphere.radius + nearest), Real(0.0F)));
        piece.low = std::max(piece.low, middle - half);
        piece.high = std::min(piece.high, middle + half);
    }
    return piece.close_up(tolerance);
}

/// Cuts the piece of the line off where rows[j] ends it.
template <class Real>
void cut_by(const RowOf<Real>& row, std::size_t j, const Vec3Of<Real>& from, const Vec3Of<Real>& along,
            Piece<Real>& piece) noexcept
{
    const Real slope = along.dot(row.normal);
    const Real missing = row.violation(from);
    const Real t = missing / slope;
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

/// On the line, within rows[0 .. before) and the spheres. `end` is the row that holds the optimum, or kNoRow.
template <class Real>
bool optimum_on_line(std::span<const RowOf<Real>> rows, std::size_t before, const Vec3Of<Real>& from,
                     const Vec3Of<Real>& along, Spheres spheres, const GoalOf<Real>& goal, float tolerance,
                     Vec3Of<Real>& x, std::uint16_t& end) noexcept
{
    Piece<Real> piece;
    if (!piece_in_spheres(spheres, from, along, tolerance, piece)) {
        return false;
    }
    for (std::size_t j = 0; j < before; ++j) {
        const Real slope = along.dot(rows[j].normal);
        if (fabs(slope) <= kSameDirection<Real>) {
            // Along the line nothing changes by more than rounding.
            if (rows[j].violation(from) > Real(2.0F * tolerance)) {
                return false;
            }
            continue;
        }
        cut_by(rows[j], j, from, along, piece);
        if (piece.low > piece.high && !piece.close_up(tolerance)) {
            return false;
        }
    }
    const Real wanted =
        goal.farthest ? (goal.point.dot(along) > 0.0F ? piece.high : piece.low) : along.dot(goal.point - from);
    const Real t = std::clamp(wanted, piece.low, piece.high);
    end = t == piece.low ? piece.low_row : t == piece.high ? piece.high_row : kNoRow;
    x = from + t * along;
    return true;
}

}  // namespace

template <class Real>
bool optimum_in_spheres(Spheres spheres, const GoalOf<Real>& goal, Tolerance<Real> tolerance, Vec3Of<Real>& x) noexcept
{
    const auto one = whole_of<Real>(spheres[0]);
    x = onto(one.centre, one.radius, goal);
    if (spheres.size() == 1 || within(spheres[1], x, tolerance.outside)) {
        return true;
    }
    const auto other = whole_of<Real>(spheres[1]);
    const Vec3Of<Real> second = onto(other.centre, other.radius, goal);
    if (within(spheres[0], second, tolerance.outside)) {
        x = second;
        return true;
    }
    return optimum_on_circle(one, other, goal, tolerance.outside, x);
}

template <class Real>
Found optimum_on_plane(std::span<const RowOf<Real>> rows, std::size_t on, std::size_t before, Spheres spheres,
                       const GoalOf<Real>& goal, Tolerance<Real> tolerance, WorkBudget& budget, Vec3Of<Real>& x,
                       Basis& basis) noexcept
{
    if (!budget.spend(cost<Real>(units::kOrcaPlane + units::orca_rows(before)))) {
        return Found::exhausted;
    }
    Vec3Of<Real> best;
    if (!optimum_on_disc(rows[on], spheres, goal, tolerance.outside, best)) {
        return Found::nothing;
    }
    Basis held{{static_cast<std::uint16_t>(on)}, 1};
    for (std::size_t j = 0; j < before; ++j) {
        if (rows[j].violation(best) <= tolerance.outside) {
            continue;
        }
        if (!budget.spend(cost<Real>(units::kOrcaLine + units::orca_rows(j)))) {
            return Found::exhausted;
        }
        Vec3Of<Real> from;
        Vec3Of<Real> along;
        std::uint16_t end = kNoRow;
        if (!line_of(rows[on], rows[j], best, from, along) ||
            !optimum_on_line(rows, j, from, along, spheres, goal, tolerance.outside, best, end)) {
            return Found::nothing;
        }
        held = {{static_cast<std::uint16_t>(on), static_cast<std::uint16_t>(j), end},
                static_cast<std::uint8_t>(end == kNoRow ? 2 : 3)};
    }
    x = best;
    basis = held;
    return Found::optimum;
}

template <class Real>
Optimum<Real> optimum(std::span<const RowOf<Real>> rows, Spheres spheres, const GoalOf<Real>& goal,
                      Tolerance<Real> tolerance, WorkBudget& budget) noexcept
{
    Optimum<Real> out;
    if (!budget.spend(cost<Real>(units::kOrcaPlane + units::orca_rows(rows.size())))) {
        out.found = Found::exhausted;
        return out;
    }
    if (!optimum_in_spheres(spheres, goal, tolerance, out.x)) {
        return out;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        out.satisfied = i;
        if (rows[i].violation(out.x) <= tolerance.outside) {
            continue;
        }
        out.found = optimum_on_plane(rows, i, i, spheres, goal, tolerance, budget, out.x, out.basis);
        if (out.found != Found::optimum) {
            return out;
        }
    }
    out.found = Found::optimum;
    out.satisfied = rows.size();
    return out;
}

template bool optimum_in_spheres(Spheres, const GoalOf<float>&, Tolerance<float>, Vec3Of<float>&) noexcept;
template bool optimum_in_spheres(Spheres, const GoalOf<DoubleFloat>&, Tolerance<DoubleFloat>,
                                 Vec3Of<DoubleFloat>&) noexcept;
template Found optimum_on_plane(std::span<const RowOf<float>>, std::size_t, std::size_t, Spheres, const GoalOf<float>&,
                                Tolerance<float>, WorkBudget&, Vec3Of<float>&, Basis&) noexcept;
template Found optimum_on_plane(std::span<const RowOf<DoubleFloat>>, std::size_t, std::size_t, Spheres,
                                const GoalOf<DoubleFloat>&, Tolerance<DoubleFloat>, WorkBudget&, Vec3Of<DoubleFloat>&,
                                Basis&) noexcept;
template Optimum<float> optimum(std::span<const RowOf<float>>, Spheres, const GoalOf<float>&, Tolerance<float>,
                                WorkBudget&) noexcept;
template Optimum<DoubleFloat> optimum(std::span<const RowOf<DoubleFloat>>, Spheres, const GoalOf<DoubleFloat>&,
                                      Tolerance<DoubleFloat>, WorkBudget&) noexcept;

}  // namespace jink::orca
