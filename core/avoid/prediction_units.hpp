// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/time.hpp"

// Private to this module.

namespace jink::avoid::detail {

/// Work units of a prediction over `span` in steps of `step`, each of `each`. Saturates above every budget, from 1e9
/// units on. O(1).
[[nodiscard]] inline std::uint32_t prediction_units(Seconds span, Seconds step, std::uint32_t each) noexcept
{
    constexpr float kBeyondMeasure = 1e9F;
    const float units = std::ceil(span / step) * static_cast<float>(each);
    return units < kBeyondMeasure ? static_cast<std::uint32_t>(units) : std::numeric_limits<std::uint32_t>::max();
}

}  // namespace jink::avoid::detail
