// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/exponential.hpp"
#include "core/cost/cost.hpp"

namespace jink::cost {
namespace {

/// (ln value - low) / (high - low), clipped; 0 for value 0, 1 for infinity (Pinheiro eq. 4.30 to 4.32).
float log_scale(float value, float low, float high) noexcept
{
    if (!(value > 0.0F)) {
        return 0.0F;
    }
    if (std::isinf(value)) {
        return 1.0F;
    }
    return std::clamp((natural_log(value) - low) / (high - low), 0.0F, 1.0F);
}

float min_max(float value, float low, float high) noexcept
{
    return std::clamp((value - low) / (high - low), 0.0F, 1.0F);
}

}  // namespace

bool is_valid(const Weights& weights) noexcept
{
    constexpr float kRounding = 1e-4F;
    const float sum = weights.smoothness + weights.time + weights.closeness + weights.passing + weights.beyond;
    return std::abs(sum - 1.0F) <= kRounding && weights.smoothness >= 0.0F && weights.closeness >= 0.0F &&
           weights.closeness <= 0.7F + kRounding && weights.time >= 0.1F - kRounding && weights.passing >= 0.0F &&
           weights.beyond >= 0.0F;
}

bool is_valid(const Caps& caps) noexcept
{
    return std::isfinite(caps.time_low) && std::isfinite(caps.time_high) && std::isfinite(caps.energy_low) &&
           std::isfinite(caps.energy_high) && caps.time_low >= 0.0F && caps.energy_low >= 0.0F &&
           caps.time_low < kTimeHeadroom * caps.time_high && caps.energy_low < caps.energy_high;
}

NormalisedTerms normalise(const Terms& terms, const Caps& caps) noexcept
{
    return {.time = min_max(terms.time, caps.time_low, kTimeHeadroom * caps.time_high),
            .smoothness = log_scale(terms.smoothness, -3.0F, 2.5F),
            .smoothness_penalised = log_scale(terms.smoothness_penalised, -3.0F, 3.0F),
            .closeness = log_scale(terms.closeness, -3.0F, 0.001F),
            .energy = min_max(terms.energy, caps.energy_low, caps.energy_high),
            .passing = std::clamp(terms.passing, 0.0F, 1.0F),
            .beyond = min_max(terms.beyond, 0.0F, kTimeHeadroom * caps.time_high)};
}

float total(const NormalisedTerms& terms, const Weights& weights) noexcept
{
    const float source = weights.smoothness * terms.smoothness_penalised + weights.time * terms.time +
                         weights.closeness * terms.closeness;
    return source + weights.passing * terms.passing + weights.beyond * terms.beyond;
}

}  // namespace jink::cost
