// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometric/extent.hpp"
#include "core/geometry/shape.hpp"

namespace jink::geometric::detail {

/// Planes that may part a solid from the own box on a straight way: a box's faces; the ends of a round solid and the
/// plane square to the way from its axis to the middle; for a hull the one square to the way from its centre there. A
/// look that takes no search and that never parts what touches: it leaves 1e-5 of all lengths for rounding.
class Planes {
public:
    /// `centre`: of the solid, in the coordinates of what it is asked about [m].
    Planes(const geometry::Shape& solid, const Vec3& centre) noexcept : solid_(solid), centre_(centre)
    {
        solid_.centre = Vec3::Zero();
        bound_ = geometry::bounding_radius(solid_);
        for (int k = first_face(); k < 3; ++k) {
            extents_[static_cast<std::size_t>(k)] =
                geometry::support(solid_, solid_.axes.col(k)).dot(solid_.axes.col(k));
        }
    }

    /// The box (half extents [m]) on its way from `a` to `b` stays farther than `clearance` [m] from the solid. Some of
    /// what is so is not seen. O(1); O(vertices) for a hull.
    [[nodiscard]] bool part(const Vec3& a, const Vec3& b, const Vec3& half, float clearance) const noexcept
    {
        const Vec3 from = a - centre_;
        const Vec3 to = b - centre_;
        const float slack =
            kExtentRounding * (1.0F + from.cwiseAbs().sum() + to.cwiseAbs().sum() + half.sum() + bound_);
        const float room = clearance * kUnit + slack;
        for (int k = first_face(); k < 3; ++k) {
            const Vec3 axis = solid_.axes.col(k);
            if (beyond(axis, from, to) > extents_[static_cast<std::size_t>(k)] + half.dot(axis.cwiseAbs()) + room) {
                return true;
            }
        }
        if (solid_.kind == geometry::ShapeKind::box) {
            return false;
        }
        Vec3 out = 0.5F * (from + to);
        if (first_face() < 3) {
            out -= out.dot(solid_.axes.col(2)) * solid_.axes.col(2);
        }
        const float length = out.norm();
        if (!(length > kExtentRounding * bound_)) {
            return false;
        }
        out /= length;
        return std::min(out.dot(from), out.dot(to)) >
               geometry::support(solid_, out).dot(out) + half.dot(out.cwiseAbs()) + room;
    }

    /// The same of all of a view, by the planes that are known beforehand. O(points).
    [[nodiscard]] bool part(const View& view, const Vec3& half, float clearance) const noexcept
    {
        const float reach =
            view.extent.low.cwiseAbs().sum() + view.extent.high.cwiseAbs().sum() + 2.0F * centre_.cwiseAbs().sum();
        const float room = clearance * kUnit + kExtentRounding * (1.0F + reach + half.sum() + bound_);
        for (int k = first_face(); k < 3; ++k) {
            const Vec3 axis = solid_.axes.col(k);
            const float edge = extents_[static_cast<std::size_t>(k)] + half.dot(axis.cwiseAbs()) + room;
            const float middle = axis.dot(centre_);
            const Vec3 out = axis.dot(view.position(0)) < middle ? Vec3(-axis) : axis;
            const float least = out.dot(centre_) + edge;
            std::size_t i = 0;
            while (i <= view.last() && out.dot(view.position(i)) > least) {
                ++i;
            }
            if (i > view.last()) {
                return true;
            }
        }
        return false;
    }

    /// The box (half extents [m]) at `point` surely comes within `clearance` [m]: seen by the sphere in it, and of a
    /// box by the corner that is deepest beyond its nearest face. Cheaper than a search. Never of a hull.
    [[nodiscard]] bool touch(const Vec3& point, const Vec3& half, float clearance) const noexcept
    {
        using Kind = geometry::ShapeKind;
        const Vec3 from = point - centre_;
        const Vec3 local = solid_.axes.transpose() * from;
        const Vec3 along = local.cwiseAbs();
        const float slack = kExtentRounding * (1.0F + from.cwiseAbs().sum() + bound_);
        const float inner = half.minCoeff() + clearance - slack;
        switch (solid_.kind) {
        case Kind::box: {
            const Vec3 off = along - solid_.half;
            return off.cwiseMax(0.0F).norm() < inner || holds_corner(local, off, half, slack);
        }
        case Kind::capsule:
        case Kind::cylinder: {
            const float ends = solid_.kind == Kind::capsule ? 0.0F : solid_.radius;
            const float aside = std::max(length_of(along.x(), along.y()) - ends, 0.0F);
            const float beyond_end = std::max(along.z() - solid_.half.z(), 0.0F);
            return length_of(aside, beyond_end) < inner + solid_.radius - ends;
        }
        case Kind::sphere: return from.norm() < inner + solid_.radius;
        case Kind::hull: break;
        }
        return false;
    }

private:
    static constexpr float kUnit = 1.001F;  ///< axes of a valid shape may be that long

    /// Of the own box about `local`, the corner that is deepest beyond the face which it is farthest out of.
    [[nodiscard]] bool holds_corner(const Vec3& local, const Vec3& off, const Vec3& half, float slack) const noexcept
    {
        Eigen::Index face = 0;
        static_cast<void>(off.maxCoeff(&face));
        const Vec3 inwards = local[face] > 0.0F ? Vec3(-solid_.axes.col(face)) : Vec3(solid_.axes.col(face));
        const Vec3 corner(std::copysign(half.x(), inwards.x()), std::copysign(half.y(), inwards.y()),
                          std::copysign(half.z(), inwards.z()));
        return ((local + solid_.axes.transpose() * corner).cwiseAbs() - solid_.half).maxCoeff() < -slack;
    }
    [[nodiscard]] static float length_of(float x, float y) noexcept { return std::sqrt(x * x + y * y); }
    /// Of the axes that are tried as they are: all of a box, the last one of what is round about it, none of a hull.
    [[nodiscard]] int first_face() const noexcept
    {
        using Kind = geometry::ShapeKind;
        return solid_.kind == Kind::box ? 0 : solid_.kind == Kind::capsule || solid_.kind == Kind::cylinder ? 2 : 3;
    }
    /// How far both ends lie out along an axis, on the same side of the centre; 0 otherwise.
    [[nodiscard]] static float beyond(const Vec3& axis, const Vec3& from, const Vec3& to) noexcept
    {
        const float x = axis.dot(from);
        const float y = axis.dot(to);
        return (x > 0.0F) == (y > 0.0F) ? std::min(std::abs(x), std::abs(y)) : 0.0F;
    }

    geometry::Shape solid_;  ///< about its centre
    Vec3 centre_;
    float bound_ = 0.0F;
    std::array<float, 3> extents_{};
};

}  // namespace jink::geometric::detail
