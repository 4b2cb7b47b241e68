// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/angle.hpp"

#include <cmath>
#include <limits>

#include "core/base/vec3.hpp"

namespace jink {
namespace {

/// pi / 2 in three parts: a whole number up to 2^10 times the first two is exact (Cody and Waite).
constexpr float kQuarter1 = 1.5703125F;
constexpr float kQuarter2 = 4.837512969970703125e-4F;
constexpr float kQuarter3 = 7.54978995489188216e-8F;
constexpr float kPerQuarter = 0.636619772367581343F;
constexpr float kTanEighth = 0.414213562373095049F;  ///< tan(pi / 8)

}  // namespace

SineCosine sine_cosine(float angle) noexcept
{
    if (!(std::abs(angle) <= kMaxAngle)) {
        constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
        return {kNone, kNone};
    }
    const auto quarters = static_cast<int>(angle * kPerQuarter + std::copysign(0.5F, angle));
    const auto n = static_cast<float>(quarters);
    const float u = ((angle - n * kQuarter1) - n * kQuarter2) - n * kQuarter3;
    const float uu = u * u;
    const float sine = u + u * uu * ((-1.9515295891e-4F * uu + 8.3321608736e-3F) * uu - 1.6666654611e-1F);
    const float cosine = 1.0F - 0.5F * uu +
                         uu * uu * ((2.443315711809948e-5F * uu - 1.388731625493765e-3F) * uu + 4.166664568298827e-2F);
    const auto turned = static_cast<unsigned>(quarters) % 4U;
    const float s = turned % 2U == 0U ? sine : cosine;
    const float c = turned % 2U == 0U ? cosine : sine;
    return {turned < 2U ? s : -s, turned == 0U || turned == 3U ? c : -c};
}

float direction_angle(float y, float x) noexcept
{
    const float along = std::abs(x);
    const float across = std::abs(y);
    const bool is_steep = across > along;
    const float low = is_steep ? along : across;
    const float high = is_steep ? across : along;
    if (high == 0.0F) {
        return 0.0F;
    }
    const bool is_wide = low > kTanEighth * high;
    const float t = is_wide ? (low - high) / (low + high) : low / high;
    const float tt = t * t;
    const float near =
        t + t * tt * (((8.05374449538e-2F * tt - 1.38776856032e-1F) * tt + 1.99777106478e-1F) * tt - 3.33329491539e-1F);
    const float acute = is_wide ? 0.25F * kPi + near : near;
    const float first = is_steep ? 0.5F * kPi - acute : acute;
    const float half = x < 0.0F ? kPi - first : first;
    return y < 0.0F ? -half : half;
}

}  // namespace jink
