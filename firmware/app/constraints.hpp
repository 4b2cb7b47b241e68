// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "firmware/link/constraint.hpp"

namespace jink::app {

using link::Constraint;

struct ConstraintDiagnostics {
    std::uint32_t reported = 0;
    std::uint32_t refused = 0;  ///< not finite, no radius, upside down, beyond 100 km, stamped in the future
    std::uint32_t merged = 0;   ///< became part of another: there were more than kMaxCylinders
    std::uint32_t grown = 0;    ///< placings of a moving one that was reported long ago and has grown
};

/// Closed areas, valid until the next set is received: each set replaces the one before.
///
/// A moving one goes straight on from its stamp. If received longer ago than kFresh, it grows at its own speed to all
/// sides besides, so that it is held where it may be if it has since then stopped, sped up to twice its speed, or
/// turned by up to 60 degrees at the same speed. One that turns back leaves this growth: it has to be reported anew.
/// Nothing that stands grows old, and nothing is forgotten before its end.
///
/// More than kMaxCylinders: the two farthest of the vehicle become one standing one that holds both for kFresh; after
/// that it grows at twice the greatest speed of all that were received, so that it still does.
///
/// Memory: 72 bytes for each of kMaxCylinders, and 32 for its place at an instant.
class ConstraintTable {
public:
    /// A moving constraint should be sent anew at least this often [s].
    static constexpr Seconds kFresh = 60.0F;
    /// Growth is taken this far ahead, because a nominal path is checked into the future [s].
    static constexpr Seconds kAhead = 10.0F;
    /// A map's lengths are off by this share of the distance from the origin at most: PX4's sphere is 0.11 % smaller.
    static constexpr float kMapError = 1.5e-3F;

    /// Replaces everything. What is wrong is refused, by itself, and counted.
    /// @param own  the vehicle's place in the local frame [m], as far as it is known: what is far of it is merged first
    /// O(constraints * kMaxCylinders).
    void tell(std::span<const Constraint> constraints, const std::optional<link::GlobalPosition>& origin,
              const Vec3& own, TimePoint now) noexcept;

    /// Where everything is at `now`, in the local frame that begins at `origin`. O(kMaxCylinders).
    void place(const std::optional<link::GlobalPosition>& origin, TimePoint now) noexcept;

    /// As placed last. What could not be placed is not in it: lacks_origin().
    [[nodiscard]] std::span<const world::Cylinder> cylinders() const noexcept
    {
        return {placed_.data(), placed_.size()};
    }
    /// Something closed is known by its place on the globe alone, and the origin of the local frame is not.
    [[nodiscard]] bool lacks_origin() const noexcept { return lacks_origin_; }
    [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
    [[nodiscard]] const ConstraintDiagnostics& diagnostics() const noexcept { return diagnostics_; }
    /// Whether `tell` at `now` would keep this constraint. O(1).
    [[nodiscard]] static bool accepts(const Constraint& constraint, TimePoint now) noexcept;

private:
    struct Entry {
        Constraint constraint;
        float speed = 0.0F;  ///< at which it grows once it is old [m/s]
    };
    void merge(std::span<const Constraint> constraints, const std::optional<link::GlobalPosition>& origin,
               const Vec3& own, TimePoint now) noexcept;

    StaticVector<Entry, kMaxCylinders> entries_;
    StaticVector<world::Cylinder, kMaxCylinders> placed_;
    bool lacks_origin_ = false;
    ConstraintDiagnostics diagnostics_;
};

}  // namespace jink::app
