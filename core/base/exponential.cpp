// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/exponential.hpp"

#include <bit>
#include <cstdint>
#include <initializer_list>

namespace jink {
namespace {

/// ln 2 in two parts: a whole number up to 2^15 times the first is exact (Cody and Waite).
constexpr float kLn2High = 0.693359375F;
constexpr float kLn2Low = -2.12194440e-4F;
constexpr float kPerLn2 = 1.44269504088896341F;

constexpr std::uint32_t kMantissaBits = 23;
constexpr std::uint32_t kMantissa = (1U << kMantissaBits) - 1U;
constexpr int kBias = 127;

float power_of_two(int exponent) noexcept
{
    return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + kBias) << kMantissaBits);
}

}  // namespace

float faded_share(float x) noexcept
{
    constexpr float kAll = 20.0F;  // e^-20 is less than half a unit in the last place of 1
    if (!(x < kAll)) {
        return x >= kAll ? 1.0F : x;
    }
    const float up_by_half = x * kPerLn2 + 0.5F;
    const auto halvings = static_cast<int>(up_by_half);
    const auto n = static_cast<float>(halvings);
    const float u = (n * kLn2High - x) + n * kLn2Low;  // e^-x is e^u / 2^n
    const float tail =
        ((((1.9875691500e-4F * u + 1.3981999507e-3F) * u + 8.3334519073e-3F) * u + 4.1665795894e-2F) * u +
         1.6666665459e-1F) *
            u +
        5.0000001201e-1F;
    const float left = power_of_two(-halvings);
    return (1.0F - left) - left * (u + u * u * tail);
}

float natural_log(float value) noexcept
{
    constexpr float kMinNormal = 1.17549435e-38F;
    constexpr float kSqrtHalf = 0.707106781186547524F;
    const bool is_subnormal = value < kMinNormal;
    const auto bits = std::bit_cast<std::uint32_t>(is_subnormal ? value * power_of_two(kMantissaBits) : value);
    int exponent =
        static_cast<int>(bits >> kMantissaBits) - (kBias - 1) - (is_subnormal ? static_cast<int>(kMantissaBits) : 0);
    // Within [0.5, 1): value is `fraction` times 2^exponent.
    const auto fraction =
        std::bit_cast<float>((bits & kMantissa) | (static_cast<std::uint32_t>(kBias - 1) << kMantissaBits));
    const bool is_low = fraction < kSqrtHalf;
    exponent -= is_low ? 1 : 0;
    const float u = is_low ? 2.0F * fraction - 1.0F : fraction - 1.0F;
    const float uu = u * u;
    float p = 7.0376836292e-2F;
    for (const float next : {-1.1514610310e-1F, 1.1676998740e-1F, -1.2420140846e-1F, 1.4249322787e-1F,
                             -1.6668057665e-1F, 2.0000714765e-1F, -2.4999993993e-1F, 3.3333331174e-1F}) {
        p = p * u + next;
    }
    const auto n = static_cast<float>(exponent);
    return (u + (u * uu * p + n * kLn2Low - 0.5F * uu)) + n * kLn2High;
}

}  // namespace jink
