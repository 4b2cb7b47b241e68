// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reference/reach/segments.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/finite.hpp"

namespace jink::reach {
namespace {

float value_of(const Condition& condition, Impact impact) noexcept
{
    switch (impact) {
    case Impact::speed: return condition.speed;
    case Impact::pitch: return condition.pitch;
    case Impact::altitude: return condition.altitude;
    case Impact::payload: return condition.payload;
    }
    return NAN;
}

bool in_order(float lower, float upper, std::span<const float> separators) noexcept
{
    float before = lower;
    for (const float separator : separators) {
        if (!(separator > before && separator < upper)) {
            return false;
        }
        before = separator;
    }
    return true;
}

}  // namespace

SegmentStatus Segments::split(Impact impact, float lower, float upper, std::span<const float> separators) noexcept
{
    if (!(std::isfinite(lower) && std::isfinite(upper) && upper > lower)) {
        return SegmentStatus::bad_bounds;
    }
    if (separators.size() >= kMaxIntervals) {
        return SegmentStatus::too_many_intervals;
    }
    if (!in_order(lower, upper, separators)) {
        return SegmentStatus::bad_separators;
    }
    if (std::ranges::any_of(splits_, [&](const Split& split) { return split.impact == impact; })) {
        return SegmentStatus::named_twice;
    }
    const std::size_t count = count_ * (separators.size() + 1);
    if (count > kMaxSegments) {
        return SegmentStatus::too_many_segments;
    }
    Split split{impact, lower, upper, {}};
    for (const float separator : separators) {
        split.separators.unchecked_push_back(separator);
    }
    splits_.unchecked_push_back(split);  // each impact once, so the capacity suffices
    count_ = count;
    limits_.fill({});
    return SegmentStatus::good;
}

SegmentStatus Segments::set(std::size_t segment, const SegmentLimits& limits) noexcept
{
    if (segment >= count_) {
        return SegmentStatus::no_such_segment;
    }
    if (!is_not_negative(limits.pitch) || !is_not_negative(limits.yaw) || !(limits.speed_change >= 0.0F)) {
        return SegmentStatus::bad_limits;
    }
    limits_[segment] = limits;
    return SegmentStatus::good;
}

SegmentAt Segments::at(const Condition& condition) const noexcept
{
    std::size_t index = 0;
    bool outside = false;
    for (const Split& split : splits_) {
        const float value = value_of(condition, split.impact);
        outside = outside || !(value >= split.lower && value <= split.upper);
        std::size_t interval = 0;
        for (const float separator : split.separators) {
            interval += value >= separator ? 1U : 0U;
        }
        index = index * (split.separators.size() + 1) + interval;
    }
    return {static_cast<std::uint8_t>(index), outside};
}

}  // namespace jink::reach
