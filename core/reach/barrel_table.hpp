// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/reach/barrel.hpp"

// The constraints of one sort, hard or soft, that are looked at in one frame (Gomola eq. 6.110, 6.6.5).

namespace jink::reach {

/// The barrel may come within the range of the vehicle's grid, margin and all, in the next `horizon` seconds, from its
/// own time `since` on: level distance and heights. Never no when it does. O(1).
/// @param range  of the grid, to all sides [m]
/// @param since  now, less when the barrel was where it is [s]
[[nodiscard]] bool may_matter(const Barrel& barrel, const Vec3& vehicle, float range, float since,
                              float horizon) noexcept;

/// The smallest circle around two, grown by 1e-5 of it for rounding. O(1).
[[nodiscard]] Circle around(const Circle& a, const Circle& b) noexcept;

/// A barrel that stands and holds all that two others are in, from their times `from` until `to` [s]: bodies within
/// its body, margins within its margin, heights as the hull. O(1).
[[nodiscard]] Barrel merged(const Barrel& a, const Barrel& b, float from, float to) noexcept;

enum class AddStatus : std::uint8_t { added, constraint_merged };

/// All barrels count time alike. Memory: kMaxBarrels barrels.
class BarrelTable {
public:
    /// @param vehicle   [m], in the world: what is far of it gives way
    /// @param from, to  times in which the barrels are looked at [s]
    void begin(const Vec3& vehicle, float from, float to) noexcept;
    /// O(kMaxBarrels).
    AddStatus add(const Barrel& barrel) noexcept;

    [[nodiscard]] std::span<const Barrel> barrels() const noexcept { return {barrels_.data(), barrels_.size()}; }
    /// Barrels that became part of another since begin().
    [[nodiscard]] std::size_t merged() const noexcept { return merged_; }

private:
    [[nodiscard]] float distance_to(const Barrel& barrel) const noexcept;

    Vec3 vehicle_ = Vec3::Zero();
    float from_ = 0.0F;
    float to_ = 0.0F;
    StaticVector<Barrel, kMaxBarrels> barrels_;
    std::size_t merged_ = 0;
};

}  // namespace jink::reach
