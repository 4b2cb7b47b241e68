// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

// What is done to the preferred velocity before it is made safe: an exactly symmetric encounter is a fixed point of
// reciprocal avoidance, in which everybody brakes for ever (G-ORCA 10; Alejo shows deadlocks of 10 s and has no
// rule). Deterministic, and antisymmetric: each of two vehicles decides for the other side without a word between them.

namespace jink::orca {

/// Another vehicle as the bias sees it.
struct BiasNeighbour {
    std::uint32_t id = 0;        ///< differs from the own one, which is the smaller one deciding who climbs
    Vec3 offset = Vec3::Zero();  ///< from the own position to its position [m], finite
    Vec3 side = Vec3::Zero();    ///< unit vector across `offset` to which the own vehicle passes: for the other one,
                                 ///< whose offset is -offset, the opposite one (G-ORCA 3.5)
};

struct BiasSettings {
    float near = 4.0F;           ///< neighbours farther away bias nothing [m], > 0
    float sideways = 0.05F;      ///< share of the preferred speed (H-bias); 0: none
    float vertical = 0.2F;       ///< share once stalled for long (V-bias); 0: none
    float stalled_below = 0.3F;  ///< flying at less than this share of the preferred speed is stalling
    Seconds stall = 1.0F;        ///< stalled this long the vertical bias begins, and is whole a second later
    Seconds blocked = 5.0F;      ///< and this long the vehicle is blocked
};

struct Biased {
    Vec3 preferred = Vec3::Zero();  ///< [m/s]
    bool blocked = false;           ///< no progress for long: a plan from above is needed (BLOCKED)
};

/// Breaks symmetry and watches progress. Memory: 28 bytes.
class Bias {
public:
    explicit Bias(const BiasSettings& settings = {}) noexcept : settings_(settings) {}
    /// What was timed stays.
    void configure(const BiasSettings& settings) noexcept { settings_ = settings; }

    /// Once per tick.
    ///
    /// H-bias: the nearest neighbour ahead (offset . preferred > 0) within settings.near adds settings.sideways of the
    /// preferred speed along its `side`. V-bias: once stalled for longer than settings.stall the same neighbour adds up
    /// to settings.vertical of it upwards, where the own id is the smaller one, or downwards. Without such a neighbour
    /// nothing is added, but the stall is timed: a wall may block as well.
    ///
    /// Stalled time counts up while `velocity` is slower than settings.stalled_below of `preferred`, down otherwise; it
    /// ends at twice settings.blocked, so that being blocked for an hour is over as soon as for ten seconds.
    /// @param own        id
    /// @param preferred  without avoidance [m/s]
    /// @param velocity   own one [m/s]
    /// @param period     since the last call [s], > 0
    /// O(neighbours).
    [[nodiscard]] Biased apply(std::uint32_t own, const Vec3& preferred, const Vec3& velocity,
                               std::span<const BiasNeighbour> neighbours, Seconds period) noexcept;

    [[nodiscard]] Seconds stalled() const noexcept { return stalled_; }
    /// On a new task.
    void reset() noexcept { stalled_ = 0.0F; }

private:
    BiasSettings settings_;
    Seconds stalled_ = 0.0F;
};

/// By how much the preferred velocity is scaled while conflict regions overlap (G-ORCA 9.2, D14): the vehicle that
/// cannot take its half because of an obstacle gets time. Never scale the solution: an escape must not be slowed.
class SlowDown {
public:
    static constexpr float kMin = 0.2F;   ///< it goes on, and so ends
    static constexpr float kRate = 1.0F;  ///< change of the factor [1/s]

    /// @param nearest  least scaled distance over required one, rho / R_c, of all neighbours; 1 or more where no
    ///                 conflict regions overlap, infinite where there is nobody
    /// @param period   since the last call [s], > 0
    /// @return the factor g in [kMin, 1]: clamp(nearest, kMin, 1), approached at kRate. O(1).
    [[nodiscard]] float update(float nearest, Seconds period) noexcept;
    [[nodiscard]] float factor() const noexcept { return factor_; }
    void reset() noexcept { factor_ = 1.0F; }

private:
    float factor_ = 1.0F;
};

}  // namespace jink::orca
