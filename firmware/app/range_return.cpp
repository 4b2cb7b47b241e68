// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/range_return.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::app {
namespace {

/// Radius in half widths of the beam at the range. The smallest disc over an arc has 1 and bulges towards the sensor by
/// half the arc's width; larger ones bulge less and reach farther aside. For a scan the gaps between obstacles count.
constexpr float kLevelRadius = 1.25F;
constexpr float kSlantedRadius = 2.0F;

struct Disc {
    float distance;  ///< of its centre, along the beam [m]
    float radius;    ///< [m]
};

/// Disc (or sphere) through the ends of the arc at `range`, its middle inside.
Disc over_arc(float range, float half_angle, float widths) noexcept
{
    const SineCosine half = sine_cosine(half_angle);
    const float half_width = range * half.sine;
    const float radius = std::max(kMinReturnRadius, widths * half_width);
    return {range * half.cosine + std::sqrt(radius * radius - half_width * half_width), radius};
}

}  // namespace

std::size_t return_parts(float half_angle) noexcept
{
    const auto parts = static_cast<std::size_t>(std::ceil(2.0F * half_angle / kWidestPart - 1e-3F));
    return std::clamp<std::size_t>(parts, 1, kMaxReturnParts);
}

geometry::Shape level_return(const Vec3& origin, float yaw, float range, float half_angle, float half_height) noexcept
{
    const Disc disc = over_arc(range, half_angle, kLevelRadius);
    const SineCosine ahead = sine_cosine(yaw);
    const Vec3 centre = origin + disc.distance * Vec3(ahead.cosine, ahead.sine, 0.0F);
    const Vec3 tall = half_height * Vec3::UnitZ();
    return geometry::make_capsule(centre - tall, centre + tall, disc.radius);
}

geometry::Shape slanted_return(const Vec3& origin, const Vec3& direction, float range, float half_angle) noexcept
{
    const Disc sphere = over_arc(range, half_angle, kSlantedRadius);
    return geometry::make_sphere(origin + sphere.distance * direction, sphere.radius);
}

geometry::Shape ceiling_return(const Vec3& origin, float range, float half_angle, float half_width) noexcept
{
    const SineCosine edge = sine_cosine(half_angle);
    const float half = std::max(half_width, range * edge.sine);
    const Vec3 centre = origin + Vec3(0.0F, 0.0F, range * edge.cosine + half);
    return geometry::make_box(centre, Vec3(half, half, half));
}

}  // namespace jink::app
