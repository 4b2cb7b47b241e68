// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink {

/// Deterministic random numbers, the same on every target (SplitMix64: Steele, Lea & Flood 2014).
///
/// Not cryptographically secure. State 8 bytes, period 2^64, O(1) per number.
class Random {
public:
    explicit constexpr Random(std::uint64_t seed) noexcept : state_(seed) {}

    [[nodiscard]] constexpr std::uint64_t next() noexcept
    {
        state_ += 0x9E3779B97F4A7C15ULL;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
        z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
        return z ^ (z >> 31U);
    }

    /// Uniform in [0, 1), 24 bits.
    [[nodiscard]] constexpr float uniform() noexcept { return static_cast<float>(next() >> 40U) * 0x1p-24F; }
    /// Uniform in [low, high).
    [[nodiscard]] constexpr float uniform(float low, float high) noexcept { return low + (high - low) * uniform(); }
    /// Uniform integer in [0, n), n >= 1; bias below n / 2^64.
    [[nodiscard]] constexpr std::uint64_t below(std::uint64_t n) noexcept { return next() % n; }
    /// Sum of twelve uniforms less six: mean 0, variance 1, tails cut at 6. No libm, so equal on every target.
    [[nodiscard]] constexpr float normal() noexcept
    {
        float sum = -6.0F;
        for (int i = 0; i < 12; ++i) {
            sum += uniform();
        }
        return sum;
    }

private:
    std::uint64_t state_;
};

}  // namespace jink
