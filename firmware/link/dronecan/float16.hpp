// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

namespace jink::link::dronecan {

/// Greatest finite half-precision value.
inline constexpr float kMaxFloat16 = 65504.0F;

/// IEEE 754 binary16 nearest to `value`, ties to even; beyond 65520 infinity, NaN to NaN (the top of its payload kept).
[[nodiscard]] constexpr std::uint16_t to_float16(float value) noexcept
{
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits >> 16U & 0x8000U;
    const std::uint32_t magnitude = bits & 0x7FFFFFFFU;
    if (magnitude > 0x7F800000U) {
        return static_cast<std::uint16_t>(sign | 0x7E00U | (magnitude >> 13U & 0x1FFU));
    }
    if (magnitude >= 0x477FF000U) {  // 65520: halfway to the power of two that does not fit
        return static_cast<std::uint16_t>(sign | 0x7C00U);
    }
    // `whole`: the result without the bits below its last bit; `rest` against `half` decides the rounding.
    std::uint32_t whole = 0;
    std::uint32_t rest = 0;
    std::uint32_t half = 0;
    if (magnitude >= 0x38800000U) {  // normal: 2^-14 and more
        const std::uint32_t rebased = magnitude - 0x38000000U;
        whole = rebased >> 13U;
        rest = rebased & 0x1FFFU;
        half = 0x1000U;
    } else if (magnitude >= 0x33000000U) {  // subnormal: multiples of 2^-24, from half of one on
        const std::uint32_t shift = 126U - (magnitude >> 23U);
        const std::uint32_t mantissa = (magnitude & 0x7FFFFFU) | 0x800000U;
        whole = mantissa >> shift;
        rest = mantissa & ((1U << shift) - 1U);
        half = 1U << (shift - 1U);
    }
    whole += rest > half || (rest == half && half != 0 && (whole & 1U) != 0) ? 1U : 0U;
    return static_cast<std::uint16_t>(sign | whole);
}

/// The exact value.
[[nodiscard]] constexpr float from_float16(std::uint16_t half) noexcept
{
    const std::uint32_t sign = (half & 0x8000U) * 0x10000U;
    const std::uint32_t exponent = half >> 10U & 31U;
    const std::uint32_t fraction = half & 0x3FFU;
    if (exponent == 0) {
        const float magnitude = static_cast<float>(fraction) * 0x1p-24F;
        return sign != 0 ? -magnitude : magnitude;
    }
    const std::uint32_t rebased = exponent == 31 ? 255U : exponent + 112U;
    return std::bit_cast<float>(sign | rebased << 23U | fraction << 13U);
}

}  // namespace jink::link::dronecan
