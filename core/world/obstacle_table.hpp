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

/// Obstacles at rest: surveyed ones that stay, and sensed ones that expire. Memory: kMaxObstacles * 112 bytes or less.
class ObstacleTable {
public:
    /// Adds or renews one; `expires` far away for surveyed ones. `own`: for what gives way. O(kMaxObstacles).
    ObstacleStatus update(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept;
    /// Forgets one; false when it is not known. O(kMaxObstacles).
    bool remove(ObstacleId id) noexcept;
    void expire(TimePoint now) noexcept;
    void clear() noexcept;

    /// In order of id. Valid until the next call of a non-const member.
    [[nodiscard]] std::span<const Obstacle> obstacles() const noexcept
    {
        return {obstacles_.data(), obstacles_.size()};
    }
    [[nodiscard]] const ObstacleDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    [[nodiscard]] ObstacleStatus place(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept;
    void erase(std::size_t at) noexcept;
    void insert(const Obstacle& obstacle, TimePoint expires) noexcept;

    StaticVector<Obstacle, kMaxObstacles> obstacles_;  // sorted by id
    StaticVector<TimePoint, kMaxObstacles> expiry_;    // beside it
    ObstacleDiagnostics diagnostics_;
};

}  // namespace jink::world
