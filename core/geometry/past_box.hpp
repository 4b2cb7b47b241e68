// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

// Private to core/geometry: shared by the closed forms of sweep.hpp.
//
// The squared distance of a straight-moving point from a box is convex and piecewise quadratic in time. Its pieces end
// where a coordinate crosses a face plane: six instants at most. All eight instants of interest (the six crossings and
// both ends) are evaluated at once, unsorted. The piece that holds the wanted instant lies between the latest instant
// before it and the earliest instant after it.

namespace jink::geometry::detail {

/// The two ends of an interval and the six instants at which a coordinate crosses a face plane, in no order.
using Instants = Eigen::Array<float, 8, 1>;

/// Speed below which a component counts as zero: its square would underflow, and the motion within any horizon is nil.
inline constexpr float kAtRest = 1e-18F;

/// A point moving straight past the box |x_i| <= half_i.
class PastBox {
public:
    /// The box is symmetric, so each axis is mirrored such that the point moves in its positive direction.
    PastBox(const Vec3& half, const Vec3& position, const Vec3& velocity) noexcept : half_(half)
    {
        for (int i = 0; i < 3; ++i) {
            const float speed = std::abs(velocity[i]);
            position_[i] = velocity[i] < 0.0F ? -position[i] : position[i];
            velocity_[i] = speed < kAtRest ? 0.0F : speed;
        }
    }

    [[nodiscard]] const Vec3& half() const noexcept { return half_; }
    [[nodiscard]] const Vec3& position() const noexcept { return position_; }
    [[nodiscard]] const Vec3& velocity() const noexcept { return velocity_; }

    /// The same motion with `t` as the origin of time.
    [[nodiscard]] PastBox from(Seconds t) const noexcept
    {
        PastBox later = *this;
        later.position_ += velocity_ * t;
        return later;
    }

    /// From the nearest point of the box to the moving point.
    [[nodiscard]] Vec3 excess(Seconds t) const noexcept
    {
        const Vec3 x = position_ + velocity_ * t;
        return x - x.cwiseMax(-half_).cwiseMin(half_);
    }
    [[nodiscard]] float distance_squared(Seconds t) const noexcept { return excess(t).squaredNorm(); }
    /// Half the slope of the squared distance.
    [[nodiscard]] float slope(Seconds t) const noexcept { return excess(t).dot(velocity_); }
    /// Half the second derivative on the piece that holds `t`: the squared speed in the axes that lie outside their
    /// slab.
    [[nodiscard]] float curvature(Seconds t) const noexcept
    {
        const Vec3 x = position_ + velocity_ * t;
        float sum = 0.0F;
        for (int i = 0; i < 3; ++i) {
            sum += std::abs(x[i]) > half_[i] ? velocity_[i] * velocity_[i] : 0.0F;
        }
        return sum;
    }

    /// Both ends of [0, length] and the crossings; crossings outside the interval are moved to an end.
    [[nodiscard]] Instants instants(Seconds length) const noexcept
    {
        Instants t;
        t[6] = 0.0F;
        t[7] = length;
        for (int i = 0; i < 3; ++i) {
            const float pace = velocity_[i] > 0.0F ? 1.0F / velocity_[i] : 0.0F;
            t[i] = std::clamp((-half_[i] - position_[i]) * pace, 0.0F, length);
            t[i + 3] = std::clamp((half_[i] - position_[i]) * pace, 0.0F, length);
        }
        return t;
    }
    [[nodiscard]] Instants slopes(const Instants& t) const noexcept
    {
        return velocity_[0] * excess(0, t) + velocity_[1] * excess(1, t) + velocity_[2] * excess(2, t);
    }
    [[nodiscard]] Instants distances_squared(const Instants& t) const noexcept
    {
        return excess(0, t).square() + excess(1, t).square() + excess(2, t).square();
    }

    /// First instant of the least distance in [0, length], given the instants of that interval.
    [[nodiscard]] Seconds closest(const Instants& t) const noexcept
    {
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        const Instants slope_at = slopes(t);
        const float falling = (slope_at < 0.0F).select(t, -kInfinity).maxCoeff();
        if (falling < 0.0F) {
            return 0.0F;
        }
        const float rising = (slope_at >= 0.0F).select(t, kInfinity).minCoeff();
        const float next = rising > falling ? std::min(rising, t[7]) : falling;
        const float bend = curvature(falling + 0.5F * (next - falling));
        return bend > 0.0F ? std::min(falling - slope(falling) / bend, next) : falling;
    }

private:
    [[nodiscard]] Instants excess(int axis, const Instants& t) const noexcept
    {
        const Instants x = position_[axis] + velocity_[axis] * t;
        return x - x.max(-half_[axis]).min(half_[axis]);
    }

    Vec3 half_;
    Vec3 position_;
    Vec3 velocity_;
};

}  // namespace jink::geometry::detail
