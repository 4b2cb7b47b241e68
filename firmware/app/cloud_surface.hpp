// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/vec3.hpp"
#include "core/geometry/shape.hpp"

namespace jink::app {

/// Number and sums of points and of their products.
struct CloudMoments {
    double n = 0.0;
    double x = 0.0, y = 0.0, z = 0.0;
    double xx = 0.0, xy = 0.0, yy = 0.0, zz = 0.0;

    CloudMoments& operator+=(const CloudMoments& other) noexcept;
    /// Direction of the greatest level extent, counter-clockwise from x, 0 to pi [rad].
    [[nodiscard]] float direction() const noexcept;
    /// Sum of squared distances from the best upright or the level plane, whichever is closer [m2].
    [[nodiscard]] double residual() const noexcept;
    /// Sums of the products of the level offsets from the mean [m2].
    struct Spread {
        double xx, xy, yy;
    };
    [[nodiscard]] Spread spread() const noexcept;
    /// Mean squared distance from the origin [m2].
    [[nodiscard]] double square_range() const noexcept;
};

/// From `low` to `high`; empty at first.
struct Interval {
    float low = 1e9F;
    float high = -1e9F;

    void add(float from, float to) noexcept;
};

/// Points that one direction's rays hit, close to each other in range: their extent along kAxes level directions and in
/// height, and their means. Frame: the sensor's, x along the nose, y left, z up [m].
class CloudSurface {
public:
    /// Level directions, evenly spread over half a turn.
    static constexpr std::size_t kAxes = 16;

    /// Least depth of a surface [m], and its share of the range: a plane seen at up to 60 degrees from its normal lies
    /// within 0.3 times the range across a bin of 10 degrees.
    static constexpr float kMinDepth = 1.0F;
    static constexpr float kDepthShare = 0.3F;
    /// What is no farther apart in range counts as one surface [m].
    [[nodiscard]] static float patch_depth(float nearest) noexcept;

    [[nodiscard]] bool has_points() const noexcept { return n_ > 0.0F; }
    /// O(kAxes).
    void add(const Vec3& point) noexcept;
    /// All of an upright box, as one point with the box's spread. O(kAxes).
    void add(const geometry::Shape& box) noexcept;
    /// All that another one holds. O(kAxes).
    void add(const CloudSurface& other) noexcept;
    /// Of the ranges added [m].
    [[nodiscard]] const Interval& range() const noexcept { return range_; }
    [[nodiscard]] const Interval& height() const noexcept { return height_; }
    /// As if all points were one.
    [[nodiscard]] CloudMoments moments() const noexcept;
    /// What lies between the ranges of both [m]; 0 where they overlap.
    [[nodiscard]] float gap_to(const CloudSurface& other) const noexcept;
    /// They may be one: what lies between them is no more than patch_depth().
    [[nodiscard]] bool is_close_to(const CloudSurface& other) const noexcept;
    /// Bounds of the extent along the level direction at `angle`, 0 to pi [rad]: exact along the axes, and between them
    /// wider by at most a tenth of the extent across. O(1).
    [[nodiscard]] Interval along(float angle) const noexcept;
    /// Upright box that holds it, along the direction of its greatest extent. O(1).
    [[nodiscard]] geometry::Shape box() const noexcept;

private:
    void add_means(float n, const std::array<float, 7>& means) noexcept;

    std::array<Interval, kAxes> level_;
    Interval height_;
    Interval range_;
    float n_ = 0.0F;
    /// Of x, y, z, xx, xy, yy and zz. Means and not sums: single precision keeps them for any number of points.
    std::array<float, 7> means_{};
};

/// Upright box about surfaces, its sides along a given level direction and across it.
class CloudBounds {
public:
    /// @param direction  0 to pi [rad]
    explicit CloudBounds(float direction) noexcept : direction_(direction) {}
    /// O(1).
    void add(const CloudSurface& surface) noexcept;
    /// At least one surface was added. Wider by what single precision rounds, 1 cm; no half extent is below
    /// `least_half` [m].
    [[nodiscard]] geometry::Shape box(float least_half) const noexcept;

private:
    float direction_;
    Interval along_;
    Interval across_;  ///< along the direction a quarter turn to the left
    Interval height_;
};

/// What is known of a direction.
struct CloudBin {
    enum class State : std::uint8_t {
        unseen,   ///< no ray came back to tell
        empty,    ///< rays found nothing, or only what lies below the floor
        spoiled,  ///< hidden by the own body, or of rays that are not valid
        hit,
    };
    static constexpr std::size_t kLayers = 2;

    State state = State::unseen;
    std::array<CloudSurface, kLayers> layers{};  ///< what is nearer, and what is seen past it

    /// A hit, or what is known from before. It joins the surface to which it is close, or is one of its own; of three
    /// the two become one between which least lies for their range. O(kAxes).
    void add(const CloudSurface& added) noexcept;
};

}  // namespace jink::app
