// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/world/world.hpp"

namespace jink::world {

enum class ObstacleStatus : std::uint8_t {
    updated,
    created,
    replaced,  ///< table full: the obstacle farthest from the vehicle gave way
    invalid,   ///< not finite, negative sizes, axes not orthonormal
    full,      ///< table full and this one is the farthest
};

struct ObstacleDiagnostics {
    std::uint32_t updated = 0, created = 0, replaced = 0, invalid = 0, full = 0;
    std::uint32_t expired = 0;
};

/// Obstacles at rest: surveyed ones that stay, sensed ones that expire, and behind them those of a map, which are
/// appended anew in every update. Memory: kMaxObstacles * 112 bytes or less.
class ObstacleTable {
public:
    /// From now on kMaxMapObstacles places are for `append` alone. Before the first obstacle is known.
    void keep_places_for_map() noexcept { own_places_ = kMaxObstacles - kMaxMapObstacles; }
    /// Adds or renews one; `expires` far away for surveyed ones. `own`: for what gives way. O(kMaxObstacles).
    ObstacleStatus update(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept;
    /// Forgets one; false when it is not known. O(kMaxObstacles).
    bool remove(ObstacleId id) noexcept;
    void expire(TimePoint now) noexcept;
    void clear() noexcept;
    /// Adds an obstacle of a map behind all others, until the next call of a member above. False when kMaxMapObstacles
    /// are appended, or all places are taken. O(1).
    [[nodiscard]] bool append(const Obstacle& obstacle) noexcept;

    /// In order of id, then those that were appended. Valid until the next call of a non-const member.
    [[nodiscard]] std::span<const Obstacle> obstacles() const noexcept
    {
        return {obstacles_.data(), obstacles_.size()};
    }
    /// Those that were not appended.
    [[nodiscard]] std::span<const Obstacle> own() const noexcept { return {obstacles_.data(), expiry_.size()}; }
    [[nodiscard]] const ObstacleDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    [[nodiscard]] ObstacleStatus place(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept;
    void drop_appended() noexcept;
    void erase(std::size_t at) noexcept;
    void insert(const Obstacle& obstacle, TimePoint expires) noexcept;

    StaticVector<Obstacle, kMaxObstacles> obstacles_;  // sorted by id, then those appended
    StaticVector<TimePoint, kMaxObstacles> expiry_;    // beside it, not of those appended
    std::size_t own_places_ = kMaxObstacles;
    ObstacleDiagnostics diagnostics_;
};

}  // namespace jink::world
