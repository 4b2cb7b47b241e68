// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/range_return.hpp"

namespace jink::app {
namespace {

constexpr float kDegree = kPi / 180.0F;
constexpr float kColumnWidth = 2.0F * kPi / static_cast<float>(CloudObstacles::kColumns);
constexpr float kLowest = -45.0F * kDegree;
constexpr float kRowHeight = 90.0F * kDegree / static_cast<float>(CloudObstacles::kRows);
constexpr float kSteps = 255.0F;
constexpr float kCentimetres = 100.0F;
/// What single precision rounds, 1e-6 of kReach and more, and the wire's centimetre is rounded by at most [m].
constexpr float kRounding = 0.01F;

/// Both ends of a row [rad]; the outermost reach to the poles.
struct Rows {
    float low;
    float high;
};
[[nodiscard]] Rows row_ends(std::size_t row) noexcept
{
    const float low = kLowest + static_cast<float>(row) * kRowHeight;
    return {row == 0 ? -0.5F * kPi : low, row + 1 == CloudObstacles::kRows ? 0.5F * kPi : low + kRowHeight};
}

/// Share of a bin's width, as a number of steps from 0 to kSteps.
[[nodiscard]] float steps(float angle, float low, float high) noexcept
{
    return std::clamp((angle - low) / (high - low) * kSteps, 0.0F, kSteps);
}

[[nodiscard]] float angle_at(std::uint8_t step, float low, float high) noexcept
{
    return low + static_cast<float>(step) / kSteps * (high - low);
}

}  // namespace

/// Of a point, as the image has it.
struct CloudObstacles::Direction {
    std::size_t column;
    std::size_t row;
    float across;  ///< in steps of the bin
    float up;
};

float CloudObstacles::patch_depth(float nearest) noexcept { return std::max(kMinDepth, kDepthShare * nearest); }

CloudObstacles::Direction CloudObstacles::direction_of(const Vec3& point) noexcept
{
    const float azimuth = std::atan2(point.y(), point.x()) + kPi;
    const float elevation = std::atan2(point.z(), std::hypot(point.x(), point.y()));
    const auto column = std::min(kColumns - 1, static_cast<std::size_t>(std::max(0.0F, azimuth / kColumnWidth)));
    const auto row = std::min(kRows - 1, static_cast<std::size_t>(std::max(0.0F, (elevation - kLowest) / kRowHeight)));
    const float left = static_cast<float>(column) * kColumnWidth;
    const Rows ends = row_ends(row);
    return {column, row, steps(azimuth, left, left + kColumnWidth), steps(elevation, ends.low, ends.high)};
}

std::size_t CloudObstacles::bin_of(const Vec3& direction) noexcept
{
    const Direction d = direction_of(direction);
    return d.column * kRows + d.row;
}

std::uint32_t CloudObstacles::id_of(std::size_t index) const noexcept
{
    static_assert(kBins <= 512);
    return first_id_ + scan_.sensor * 512U + static_cast<std::uint32_t>(index);
}

void CloudObstacles::begin_scan(const link::CloudScan& scan) noexcept
{
    ++diagnostics_.scans;
    scan_ = scan;
    view_ = next_view_;
    const Seconds gap = scan.stamp - view_.stamp;
    // A scan older than the own state is placed by flying back; the link refuses those that are too old.
    view_.is_placed = view_.is_placed && gap <= view_.own_age;
    view_.position += view_.velocity * gap;
    cos_yaw_ = std::cos(view_.yaw);
    sin_yaw_ = std::sin(view_.yaw);
    diagnostics_.scans_unplaced += view_.is_placed ? 0U : 1U;
    bins_.fill({});
}

void CloudObstacles::add(link::Ray ray, const Vec3& point) noexcept
{
    if (ray == link::Ray::hit) {
        ++diagnostics_.hits;
        add_hit(point);
        return;
    }
    const bool nothing = ray == link::Ray::nothing;
    ++(nothing ? diagnostics_.nothing : diagnostics_.invalid);
    Bin& bin = bins_[bin_of(point)];
    if (!has_hit(bin) && bin.nearest != kSpoiled) {
        bin.nearest = nothing ? kEmpty : kSpoiled;
    }
}

void CloudObstacles::add_hit(const Vec3& point) noexcept
{
    const Direction direction = direction_of(point);
    Bin& bin = bins_[direction.column * kRows + direction.row];
    const float range = point.norm();
    const bool is_body = view_.is_placed && (point.cwiseAbs().array() <= view_.half_extents.array()).all();
    if (is_body || !(range <= kReach)) {
        ++(is_body ? diagnostics_.body : diagnostics_.beyond);
        bin.nearest = is_body && !has_hit(bin) ? kSpoiled : bin.nearest;
        return;
    }
    if (view_.is_placed && view_.has_floor && view_.position.z() + point.z() < view_.floor - kFloorSlack) {
        ++diagnostics_.below_floor;
        bin.nearest = bin.nearest == kUnseen ? kEmpty : bin.nearest;
        return;
    }
    keep(bin, direction, range);
}

void CloudObstacles::keep(Bin& bin, const Direction& direction, float range) noexcept
{
    const auto near = static_cast<std::uint16_t>(range * kCentimetres);
    const auto far = static_cast<std::uint16_t>(std::ceil(range * kCentimetres));
    const auto floor_of = [](float x) { return static_cast<std::uint8_t>(x); };
    const auto ceil_of = [](float x) { return static_cast<std::uint8_t>(std::ceil(x)); };
    const std::uint8_t left = floor_of(direction.across);
    const std::uint8_t right = ceil_of(direction.across);
    const std::uint8_t low = floor_of(direction.up);
    const std::uint8_t high = ceil_of(direction.up);
    if (!has_hit(bin)) {
        ++diagnostics_.kept;
        bin = {near, far, left, right, low, high};
        return;
    }
    const float nearest = static_cast<float>(bin.nearest) / kCentimetres;
    // One step more than the patch: the nearest is rounded down, and what lies just at its end must not be left out.
    if (range > nearest + patch_depth(nearest) + kRounding + kDepthShare * kRounding) {
        ++diagnostics_.behind;
        return;
    }
    ++diagnostics_.kept;
    bin.nearest = std::min(bin.nearest, near);
    bin.farthest = std::max(bin.farthest, far);
    bin.left = std::min(bin.left, left);
    bin.right = std::max(bin.right, right);
    bin.low = std::min(bin.low, low);
    bin.high = std::max(bin.high, high);
}

/// The sphere about the middle of the extent that reaches its corners. Nothing of it is farther: a distance grows with
/// the angle from the middle, which is greatest in a corner for bins of less than half a turn, and is convex in range.
geometry::Shape CloudObstacles::local_sphere(std::size_t index, const Bin& bin) noexcept
{
    const std::size_t columns_before = index / kRows;
    const float column = static_cast<float>(columns_before) * kColumnWidth - kPi;
    const Rows row = row_ends(index % kRows);
    const float left = angle_at(bin.left, column, column + kColumnWidth);
    const float right = angle_at(bin.right, column, column + kColumnWidth);
    const float low = angle_at(bin.low, row.low, row.high);
    const float high = angle_at(bin.high, row.low, row.high);
    const float near = static_cast<float>(bin.nearest) / kCentimetres;
    const float far = std::max(near, std::min(static_cast<float>(bin.farthest) / kCentimetres,
                                              near + patch_depth(near) + kRounding + kDepthShare * kRounding));
    const auto at = [](float azimuth, float elevation, float range) {
        const float level = range * std::cos(elevation);
        return Vec3(level * std::cos(azimuth), level * std::sin(azimuth), range * std::sin(elevation));
    };
    const Vec3 middle = at(0.5F * (left + right), 0.5F * (low + high), 0.5F * (near + far));
    float radius = 0.0F;
    for (const float elevation : {low, high}) {
        for (const float range : {near, far}) {
            radius = std::max(radius, (at(right, elevation, range) - middle).norm());
        }
    }
    return geometry::make_sphere(middle, std::max(radius + kRounding, kMinReturnRadius));
}

void CloudObstacles::give(std::size_t index) noexcept
{
    geometry::Shape sphere = local_sphere(index, bins_[index]);
    const Vec3 local = sphere.centre;
    sphere.centre = view_.position + Vec3(cos_yaw_ * local.x() - sin_yaw_ * local.y(),
                                          sin_yaw_ * local.x() + cos_yaw_ * local.y(), local.z());
    // Each refusal is counted in the table.
    static_cast<void>(table_->update({id_of(index), sphere}, scan_.stamp + view_.keep, view_.position));
    ++diagnostics_.obstacles;
}

void CloudObstacles::end_scan(std::uint32_t points_lost) noexcept
{
    diagnostics_.lost += points_lost;
    if (table_ == nullptr || !view_.is_placed) {
        return;
    }
    // First the obstacles that go, so that there is space for those that come.
    for (std::size_t i = 0; points_lost == 0 && i < kBins; ++i) {
        if (bins_[i].nearest == kEmpty) {
            static_cast<void>(table_->remove(id_of(i)));
        }
    }
    for (std::size_t given = 0; given < kMaxCloudObstacles; ++given) {
        auto* const nearest = std::min_element(bins_.begin(), bins_.end(),
                                               [](const Bin& a, const Bin& b) { return a.nearest < b.nearest; });
        if (!has_hit(*nearest)) {
            return;
        }
        give(static_cast<std::size_t>(nearest - bins_.begin()));
        nearest->nearest = kUnseen;
    }
    for (std::size_t i = 0; i < kBins; ++i) {
        if (has_hit(bins_[i])) {
            ++diagnostics_.no_room;
            static_cast<void>(table_->remove(id_of(i)));
        }
    }
}

}  // namespace jink::app
