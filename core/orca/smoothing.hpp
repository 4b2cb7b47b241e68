// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::orca {

/// Low-pass of velocity commands: the mean of the last N, linearly weighted, the newest heaviest (Alejo 8.3 with its
/// weights put in, G-ORCA 12):
///     2 / (N (N + 1)) * (1 v_oldest + 2 v + ... + N v_newest)
/// As long as there are fewer, the mean of those with their own weights.
///
/// Steady commands pass unchanged, and a slew limit that the commands keep the mean keeps too: it is a convex mean of
/// slews. What it does NOT keep are half-spaces: the filtered command has to be brought back into them (the programs
/// do that), and a slow change comes delay() later, which belongs into the delay that gains are checked against.
///
/// Two running sums, made anew of all N every kExact commands so that rounding does not add up: the weighted sum adds
/// up the other one's error, so in float it grows faster than the number of commands. Within 1e-4 m/s of the exact mean
/// for speeds up to 20 m/s (property tests); every 1024, as the specification proposes for N = 10, it would be 1e-3,
/// and 0.025 m/s for short filters. Memory: 12 bytes for each of kMax, 56 more. O(1) a command, O(N) every kExact.
class CommandFilter {
public:
    /// Longest filter: 0.8 s at 40 Hz, three times what was flown.
    static constexpr std::size_t kMax = 32;
    /// In flight (Alejo table 8.3).
    static constexpr std::size_t kFlown = 10;
    /// Commands between two exact sums: on average no more work than a command itself.
    static constexpr std::size_t kExact = 32;

    /// @param length  N in [1, kMax]; what lies outside is taken as the nearer end, length() tells
    explicit CommandFilter(std::size_t length = kFlown) noexcept;

    /// @param command  [m/s], finite
    /// @return the mean with it [m/s]
    [[nodiscard]] Vec3 add(const Vec3& command) noexcept;
    /// After a pause: older commands say nothing about what is flown now.
    void clear() noexcept;

    [[nodiscard]] std::size_t length() const noexcept { return length_; }
    /// How late a slow change comes with commands every `period` [s].
    [[nodiscard]] Seconds delay(Seconds period) const noexcept
    {
        return static_cast<float>(length_ - 1) / 3.0F * period;
    }

private:
    void sum_up() noexcept;

    std::array<Vec3, kMax> commands_;
    std::size_t length_;
    std::size_t count_ = 0;   ///< of commands there are, length_ at most
    std::size_t oldest_ = 0;  ///< its place once there are length_
    std::size_t since_exact_ = 0;
    Vec3 sum_ = Vec3::Zero();       ///< of the commands
    Vec3 weighted_ = Vec3::Zero();  ///< and with their weights, 1 for the oldest
};

}  // namespace jink::orca
