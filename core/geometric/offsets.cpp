// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace jink::geometric::detail {
namespace {

/// Half width of Pinheiro's fan of offsets in radii of the main threat (Pinheiro eq. 3.6).
constexpr float kFan = 3.2F;
/// Offsets within rounding of the drop limit are kept.
constexpr float kKeep = 1.0F - 1e-5F;
/// Where the curve has less than this share of its offset, it is not asked to clear anything.
constexpr float kMinShare = 1.0F / 3.0F;

void source_offsets(float radius, const Settings& settings, Offsets& out) noexcept
{
    const float step = 2.0F * kFan * radius / static_cast<float>(settings.offsets);
    const float dropped = kKeep * (radius + settings.source_drop_margin);
    for (std::uint16_t i = 0; i <= settings.offsets; ++i) {
        // Counted from the middle, so that both sides are equal to the bit.
        const float offset = step * (static_cast<float>(i) - 0.5F * static_cast<float>(settings.offsets));
        if (std::abs(offset) >= dropped) {
            out.unchecked_push_back(offset);
        }
    }
}

/// Offset k of `count` on one side, 0 the innermost.
float clearing_offset(const Problem& problem, float smallest, float box_aside, std::size_t k,
                      std::size_t count) noexcept
{
    const float span = std::max(kFan * scale_radius(problem) - smallest, 2.0F * box_aside);
    const auto n = static_cast<float>(count);
    const auto i = static_cast<float>(k);
    const float share = problem.span_from > 0.0F ? (i + 1.0F) / n : i / std::max(n - 1.0F, 1.0F);
    return smallest + span * (problem.span_from + share * (problem.span_to - problem.span_from));
}

/// Extent of the main threat from the collision point in a direction [m].
float main_extent(const Problem& problem, const Vec3& direction) noexcept
{
    if (problem.main_shape != nullptr) {
        const Vec3 collision_point = problem.frame.origin + problem.distance * problem.frame.axes.col(0);
        return (geometry::support(*problem.main_shape, direction) - collision_point).dot(direction) +
               problem.main_clearance;
    }
    return problem.main_centre_offset.dot(direction) + problem.main_radius +
           problem.main_half_height * std::abs(direction.z());
}

}  // namespace

MainExtent extent_along(const Problem& problem) noexcept
{
    // A sphere falls away behind its top as the curve does; points of it say which falls first. Other solids: their
    // ends.
    if (problem.main_shape == nullptr) {
        return {problem.main_radius, problem.main_radius};
    }
    const Vec3 along = problem.frame.axes.col(0);
    return {std::max(main_extent(problem, -along), 0.0F), std::max(main_extent(problem, along), 0.0F)};
}

MainExtent with_sides(const Problem& problem, const Vec3& side, MainExtent extent) noexcept
{
    extent.left = main_extent(problem, side);
    extent.right = main_extent(problem, -side);
    return extent;
}

float smallest_clearing_offset(const Problem& problem, const Settings& settings, Family family,
                               const Vec3& half_extents, const Vec3& side, const MainExtent& extent,
                               float aside) noexcept
{
    const float box_aside = half_extents.dot(side.cwiseAbs());
    const float box_along = half_extents.dot(problem.frame.axes.col(0).cwiseAbs());
    float smallest = std::max(kMinOffset, aside + box_aside + kClearingSlack);
    // The chords of the curve lie inside of it, by y'' / 8 of a step at its top.
    const float step = curve_length_x(family, 1.0F) / static_cast<float>(settings.waypoints - 1);
    const float chord = 0.75F * step * step;
    const bool sphere = problem.main_shape == nullptr;
    for (const float part : {0.0F, 0.25F, 0.5F, 0.75F, 1.0F}) {
        const float drop = sphere ? problem.main_radius * (1.0F - std::sqrt(1.0F - part * part)) : 0.0F;
        const float u_before = (problem.distance - box_along - part * extent.before) / scale_of(problem);
        const float u_behind = (problem.distance + box_along + part * extent.behind) / scale_of(problem);
        const float share = std::min(unit_offset(family, std::max(u_before, 0.0F)),
                                     unit_offset(family, std::min(u_behind, curve_length_x(family, 1.0F))));
        smallest = std::max(smallest, (aside - drop + box_aside + kClearingSlack) / std::max(share - chord, kMinShare));
    }
    return smallest;
}

void offsets_of_plane(const Problem& problem, const Settings& settings, Family family, const Vec3& half_extents,
                      const Vec3& side, const MainExtent& extent, Offsets& out) noexcept
{
    out.clear();
    if (settings.offset_rule == OffsetRule::source) {
        source_offsets(problem.main_radius, settings, out);
        return;
    }
    const std::size_t per_side = settings.offsets / 2U;
    const float box_aside = half_extents.dot(side.cwiseAbs());
    const float left = smallest_clearing_offset(problem, settings, family, half_extents, side, extent, extent.left);
    const float right = smallest_clearing_offset(problem, settings, family, half_extents, -side, extent, extent.right);
    const float widest = kLargestRatio * scale_of(problem);
    for (std::size_t k = per_side; k > 0; --k) {
        if (const float offset = clearing_offset(problem, right, box_aside, k - 1, per_side); offset <= widest) {
            out.unchecked_push_back(-offset);
        }
    }
    for (std::size_t k = 0; k < per_side; ++k) {
        if (const float offset = clearing_offset(problem, left, box_aside, k, per_side); offset <= widest) {
            out.unchecked_push_back(offset);
        }
    }
}

}  // namespace jink::geometric::detail
