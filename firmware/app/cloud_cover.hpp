// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/geometry/shape.hpp"
#include "firmware/app/cloud_surface.hpp"

namespace jink::app {

/// Obstacles that one scan gives to the world, at most. Half the table, beside a level scan of 72 sectors that keeps
/// two thirds of its own.
inline constexpr std::size_t kMaxCloudObstacles = 48;

/// Image of directions about the sensor: kColumns azimuths by kRows elevations between -45 and 45 degrees, the
/// outermost rows reaching to the poles.
struct CloudImage {
    static constexpr std::size_t kColumns = 36;
    static constexpr std::size_t kRows = 9;
    static constexpr std::size_t kBins = kColumns * kRows;

    /// Column by column, each from below.
    std::array<CloudBin, kBins> bins{};

    /// Bin of a direction of any length, not zero. O(1).
    [[nodiscard]] static std::size_t bin_of(const Vec3& direction) noexcept;
};

/// Rectangle of bins, both ends included, and which of their layers.
struct CloudRegion {
    std::array<std::size_t, 2> first{};  ///< column, row
    std::array<std::size_t, 2> last{};
    std::array<bool, CloudBin::kLayers> layers{true, true};
};

/// A part of what was hit, and the best way to part it further.
struct CloudPart {
    CloudRegion region;
    CloudRegion lower, upper;  ///< the halves of its best cut
    float nearest = 0.0F;      ///< [m]
    /// What the cut saves of the sum over bins of the squared distance between surface and cover, by the square of
    /// `nearest`; 0 without a cut.
    double gain = 0.0;
};

/// Few upright boxes that hold every point of an image, closer where they are nearer.
///
/// The image is cut in two, again and again, where it pays most, until no cut is worth kWorth. A cut pays by what an
/// upright or a level plane does not explain of the points, and by the empty bins that lie between them. So a wall or
/// the ground is one box, and two pillars are two. Where there are more parts than kMaxCloudObstacles, the farthest is
/// left out that begins beyond `sure` [m]; where all begin within, they share boxes: coarser, but nothing is left out.
///
/// O(kBins * log(kBins)) on average, O(kBins * kMaxCloudObstacles) at most.
class CloudCover {
public:
    /// Least gain of a cut: a bin's width at the distance of the nearest point is 0.17, one empty bin counts 0.03.
    static constexpr double kWorth = 0.005;

    CloudCover(const CloudImage& image, float sure) noexcept;

    /// In the sensor's frame; no half extent is below `least_half` [m].
    [[nodiscard]] StaticVector<geometry::Shape, kMaxCloudObstacles> boxes(float least_half) const noexcept;
    [[nodiscard]] std::size_t size() const noexcept { return parts_.size(); }
    /// Boxes that would have been cut further had there been more.
    [[nodiscard]] std::size_t coarse() const noexcept;
    /// Parts that were left out.
    [[nodiscard]] std::size_t left_out() const noexcept { return left_out_; }

private:
    [[nodiscard]] bool drop_farthest(float sure) noexcept;
    void add(const CloudRegion& region) noexcept;
    [[nodiscard]] geometry::Shape box_of(const CloudRegion& region, float least_half) const noexcept;

    const CloudImage& image_;
    StaticVector<CloudPart, kMaxCloudObstacles> parts_;
    std::size_t left_out_ = 0;
};

}  // namespace jink::app
