// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/reach/cylinder.hpp"

// The constraints of one kind, hard or soft, that are checked in one frame (Gomola eq. 6.110, 6.6.5).

namespace jink::reach {

/// Whether the cylinder, with its margin, may come within the range of the vehicle's grid in the next `horizon`
/// seconds, from its own time `since` on: level distance and heights. Conservative: always true when the cylinder does.
/// O(1).
/// @param range  of the grid, to all sides [m]
/// @param since  now, less the time of the cylinder's position [s]
[[nodiscard]] bool may_matter(const Cylinder& cylinder, const Vec3& vehicle, float range, float since,
                              float horizon) noexcept;

/// The smallest circle around two, grown by 1e-5 of it for rounding. O(1).
[[nodiscard]] Circle around(const Circle& a, const Circle& b) noexcept;

/// A static cylinder that contains two others, from their times `from` until `to` [s]: bodies within its body, margins
/// within its margin, heights as the hull. O(1).
[[nodiscard]] Cylinder merged(const Cylinder& a, const Cylinder& b, float from, float to) noexcept;

enum class AddStatus : std::uint8_t { added, constraint_merged };

/// All cylinders use the same time. When the table is full, the two farthest cylinders are merged. Memory:
/// kMaxCylinders cylinders.
class CylinderTable {
public:
    /// @param vehicle   [m], in the world: cylinders far from it are merged first
    /// @param from, to  interval in which the cylinders are checked [s]
    void begin(const Vec3& vehicle, float from, float to) noexcept;
    /// O(kMaxCylinders).
    AddStatus add(const Cylinder& cylinder) noexcept;

    [[nodiscard]] std::span<const Cylinder> cylinders() const noexcept
    {
        return {cylinders_.data(), cylinders_.size()};
    }
    /// Cylinders merged into another since begin().
    [[nodiscard]] std::size_t merged() const noexcept { return merged_; }

private:
    [[nodiscard]] float distance_to(const Cylinder& cylinder) const noexcept;

    Vec3 vehicle_ = Vec3::Zero();
    float from_ = 0.0F;
    float to_ = 0.0F;
    StaticVector<Cylinder, kMaxCylinders> cylinders_;
    std::size_t merged_ = 0;
};

}  // namespace jink::reach
