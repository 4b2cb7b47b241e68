// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud_cover.hpp"

#include <algorithm>
#include <cmath>

namespace jink::app {
namespace {

constexpr float kDegree = kPi / 180.0F;
constexpr float kColumnWidth = 2.0F * kPi / static_cast<float>(CloudImage::kColumns);
constexpr float kLowest = -45.0F * kDegree;
constexpr float kRowHeight = 90.0F * kDegree / static_cast<float>(CloudImage::kRows);
/// What is as deep as it is wide is an upright capsule, which costs less to check than a box: where its radius is more
/// than the least half extent by this at most [m], or this share of the distance.
constexpr float kRoundOff = 0.3F;
constexpr float kRoundShare = 0.04F;

constexpr std::size_t kMaxLines = std::max(CloudImage::kColumns, CloudImage::kRows);
enum CloudAxis : std::size_t { columns, rows };

/// The bins of a column or a row of a region, or several of them.
struct CloudLine {
    CloudMoments moments;
    double empty = 0.0;   ///< bins without points, and gaps between the ranges of neighbours in it and within a bin
    double breaks = 0.0;  ///< neighbours in this line and the one before it between whose ranges there is a gap

    /// Sum of squared distances between surface and cover [m2].
    [[nodiscard]] double cost() const noexcept
    {
        constexpr double kWidth = kColumnWidth;
        return moments.residual() + empty * kWidth * kWidth * moments.square_range();
    }
};

struct CloudLook {
    std::array<std::array<CloudLine, kMaxLines>, 2> lines{};  ///< of each axis, from the region's first on
    std::array<CloudMoments, CloudBin::kLayers> layers{};
    double both = 0.0;  ///< bins with something behind what is nearer
    float nearest = 1e9F;
};

/// Both have points in these layers, and none of one is close to any of the other.
[[nodiscard]] bool are_apart(const CloudBin& a, const CloudBin& b,
                             const std::array<bool, CloudBin::kLayers>& layers) noexcept
{
    bool any = false;
    for (std::size_t i = 0; i < CloudBin::kLayers; ++i) {
        for (std::size_t j = 0; j < CloudBin::kLayers; ++j) {
            if (layers[i] && layers[j] && a.layers[i].has_points() && b.layers[j].has_points()) {
                any = true;
                if (a.layers[i].is_close_to(b.layers[j])) {
                    return false;
                }
            }
        }
    }
    return any;
}

template <typename Visit>
void for_each_bin(const CloudRegion& region, const Visit& visit) noexcept
{
    for (std::size_t column = region.first[columns]; column <= region.last[columns]; ++column) {
        for (std::size_t row = region.first[rows]; row <= region.last[rows]; ++row) {
            visit(column, row, column * CloudImage::kRows + row);
        }
    }
}

[[nodiscard]] CloudLook look(const CloudImage& image, const CloudRegion& region) noexcept
{
    CloudLook looked;
    for_each_bin(region, [&](std::size_t column, std::size_t row, std::size_t at) {
        const CloudBin& bin = image.bins[at];
        const auto breaks = [&](bool has_other, std::size_t other) {
            return has_other && are_apart(bin, image.bins[other], region.layers) ? 1.0 : 0.0;
        };
        CloudMoments sum;
        for (std::size_t layer = 0; layer < CloudBin::kLayers; ++layer) {
            const CloudSurface& surface = bin.layers[layer];
            if (region.layers[layer] && surface.has_points()) {
                const CloudMoments moments = surface.moments();
                sum += moments;
                looked.layers[layer] += moments;
                looked.nearest = std::min(looked.nearest, surface.range().low);
            }
        }
        const bool has_both = region.layers[0] && region.layers[1] && bin.layers[1].has_points();
        looked.both += has_both ? 1.0 : 0.0;
        const double empty = bin.state == CloudBin::State::hit && !has_both ? 0.0 : 1.0;
        const double left = breaks(column > region.first[columns], at - CloudImage::kRows);
        const double below = breaks(row > region.first[rows], at - 1);
        CloudLine& in_column = looked.lines[columns][column - region.first[columns]];
        CloudLine& in_row = looked.lines[rows][row - region.first[rows]];
        in_column.moments += sum;
        in_row.moments += sum;
        in_column.empty += empty + below;
        in_row.empty += empty + left;
        in_column.breaks += left;
        in_row.breaks += below;
    });
    return looked;
}

/// Costs of the first lines up to each, empty lines at their ends left out. Without points: 0.
using Costs = std::array<double, kMaxLines>;
[[nodiscard]] Costs costs_up_to(const std::array<CloudLine, kMaxLines>& lines, std::size_t n, bool from_behind) noexcept
{
    Costs costs{};
    CloudLine sum;
    double empty = 0.0;  // since the last line with points
    double cost = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t at = from_behind ? n - 1 - i : i;
        const CloudLine& line = lines[at];
        if (i > 0) {
            sum.empty += lines[from_behind ? at + 1 : at].breaks;
        }
        empty += sum.moments.n > 0.0 || line.moments.n > 0.0 ? line.empty : 0.0;
        if (line.moments.n > 0.0) {
            sum.moments += line.moments;
            sum.empty += empty;
            empty = 0.0;
            cost = sum.cost();
        }
        costs[at] = cost;
    }
    return costs;
}

}  // namespace

std::size_t CloudImage::bin_of(const Vec3& direction) noexcept
{
    const float azimuth = std::atan2(direction.y(), direction.x()) + kPi;
    const float elevation = std::atan2(direction.z(), std::hypot(direction.x(), direction.y()));
    const auto column = std::min(kColumns - 1, static_cast<std::size_t>(std::max(0.0F, azimuth / kColumnWidth)));
    const auto row = std::min(kRows - 1, static_cast<std::size_t>(std::max(0.0F, (elevation - kLowest) / kRowHeight)));
    return column * kRows + row;
}

CloudCover::CloudCover(const CloudImage& image, float sure) noexcept : image_(image)
{
    CloudRegion all;
    all.last = {CloudImage::kColumns - 1, CloudImage::kRows - 1};
    add(all);
    while (!parts_.empty() && (!parts_.full() || drop_farthest(sure))) {
        auto* const best = std::max_element(parts_.begin(), parts_.end(),
                                            [](const CloudPart& a, const CloudPart& b) { return a.gain < b.gain; });
        if (best->gain < kWorth) {
            return;
        }
        const CloudPart part = *best;
        parts_.swap_erase(static_cast<std::size_t>(best - parts_.begin()));
        add(part.lower);
        add(part.upper);
    }
}

/// Of the parts that begin beyond `sure` the farthest goes. False where there is none.
bool CloudCover::drop_farthest(float sure) noexcept
{
    auto* const farthest = std::max_element(
        parts_.begin(), parts_.end(), [](const CloudPart& a, const CloudPart& b) { return a.nearest < b.nearest; });
    if (coarse() == 0 || !(farthest->nearest > sure)) {
        return false;
    }
    parts_.swap_erase(static_cast<std::size_t>(farthest - parts_.begin()));
    ++left_out_;
    return true;
}

/// Without points it is none.
void CloudCover::add(const CloudRegion& region) noexcept
{
    const CloudLook looked = look(image_, region);
    CloudMoments all = looked.layers[0];
    all += looked.layers[1];
    if (!(all.n > 0.0)) {
        return;
    }
    CloudPart part{region, region, region, std::max(looked.nearest, 0.1F), 0.0};
    double best = 0.0;
    const auto consider = [&](double gain, const CloudRegion& lower, const CloudRegion& upper) {
        if (gain > best) {
            best = gain;
            part.lower = lower;
            part.upper = upper;
        }
    };
    for (const std::size_t axis : {columns, rows}) {
        const std::size_t n = region.last[axis] - region.first[axis] + 1;
        const Costs below = costs_up_to(looked.lines[axis], n, false);
        const Costs above = costs_up_to(looked.lines[axis], n, true);
        for (std::size_t cut = 1; cut < n; ++cut) {
            CloudRegion lower = region;
            CloudRegion upper = region;
            lower.last[axis] = region.first[axis] + cut - 1;
            upper.first[axis] = region.first[axis] + cut;
            consider(below[n - 1] - below[cut - 1] - above[cut], lower, upper);
        }
    }
    if (looked.layers[0].n > 0.0 && looked.layers[1].n > 0.0) {
        CloudRegion lower = region;
        CloudRegion upper = region;
        lower.layers[1] = upper.layers[0] = false;
        const double whole = CloudLine{all, looked.both, 0.0}.cost();
        consider(whole - looked.layers[0].residual() - looked.layers[1].residual(), lower, upper);
    }
    const double nearest = part.nearest;
    part.gain = best / (nearest * nearest);
    parts_.unchecked_push_back(part);
}

std::size_t CloudCover::coarse() const noexcept
{
    return static_cast<std::size_t>(
        std::count_if(parts_.begin(), parts_.end(), [](const CloudPart& part) { return part.gain >= kWorth; }));
}

geometry::Shape CloudCover::box_of(const CloudRegion& region, float least_half) const noexcept
{
    const auto for_each_surface = [&](const auto& visit) {
        for_each_bin(region, [&](std::size_t, std::size_t, std::size_t at) {
            for (std::size_t layer = 0; layer < CloudBin::kLayers; ++layer) {
                if (region.layers[layer] && image_.bins[at].layers[layer].has_points()) {
                    visit(image_.bins[at].layers[layer]);
                }
            }
        });
    };
    CloudMoments moments;
    for_each_surface([&](const CloudSurface& surface) { moments += surface.moments(); });
    CloudBounds bounds(moments.direction());
    for_each_surface([&](const CloudSurface& surface) { bounds.add(surface); });
    const geometry::Shape box = bounds.box(least_half);
    const Vec3& half = box.half;
    const Vec3& middle = box.centre;
    const float round = half.head<2>().norm();
    if (round - half.head<2>().minCoeff() <= std::max(kRoundOff, kRoundShare * middle.norm())) {
        const Vec3 up(0.0F, 0.0F, half.z());
        return geometry::make_capsule(middle - up, middle + up, round);
    }
    return box;
}

StaticVector<geometry::Shape, kMaxCloudObstacles> CloudCover::boxes(float least_half) const noexcept
{
    StaticVector<geometry::Shape, kMaxCloudObstacles> boxes;
    for (const CloudPart& part : parts_) {
        boxes.unchecked_push_back(box_of(part.region, least_half));
    }
    return boxes;
}

}  // namespace jink::app
