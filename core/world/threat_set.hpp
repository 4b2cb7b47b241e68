// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// What is around the vehicle, as its tables hold it.
struct Surroundings {
    std::span<const Track> tracks{};  ///< at Situation::now
    std::span<const Obstacle> obstacles{};
    const Airspace& airspace;
};

/// Everything that must be kept clear of, collected once per update. Conflict prediction, separation, methods and
/// fallback iterate over it; a new kind of threat enters here.
///
/// Order: floor, ceiling, keep-in; tracks; cylinders; obstacles; each in the order of the Surroundings.
/// Memory: kMaxThreats times sizeof(Threat).
class ThreatSet {
public:
    /// Floor, ceiling, keep-in, and whatever the tables hold.
    static constexpr std::size_t kMaxThreats = 3 + kMaxTracks + kMaxCylinders + kMaxObstacles;

    /// Takes in what is around the vehicle of a situation, whose own threats do not count; the tables outlive this.
    /// False when there is more than the capacities allow: then there is no set (all() says so). O(tracks + cylinders +
    /// obstacles).
    [[nodiscard]] bool collect(const Situation& situation, const Surroundings& around) noexcept;

    /// A span without data (null) before `collect` and after one that failed: Situation::threats counts that as contact
    /// everywhere.
    [[nodiscard]] std::span<const Threat> all() const noexcept
    {
        return collected_ ? std::span<const Threat>(threats_.data(), threats_.size()) : std::span<const Threat>();
    }

private:
    StaticVector<Threat, kMaxThreats> threats_;
    bool collected_ = false;
};

/// A sphere or an upright capsule that moves; a track's place in its table is `index`.
[[nodiscard]] Threat track_threat(std::size_t index, const geometry::Motion& motion, const Growth& growth,
                                  float half_height = 0.0F) noexcept;
/// An obstacle at rest that grows by `uncertainty` [m]. The shape outlives the threat.
[[nodiscard]] Threat obstacle_threat(std::size_t index, const geometry::Shape& shape, float uncertainty) noexcept;
/// A convex solid, where it is at time 0, that moves without turning. The shape outlives the threat.
[[nodiscard]] Threat solid_threat(std::size_t index, const geometry::Shape& shape, const Vec3& velocity,
                                  const Growth& growth) noexcept;
/// An upright cylinder that grows by `uncertainty` [m]. `cylinder` outlives the threat.
[[nodiscard]] Threat cylinder_threat(std::size_t index, const Cylinder& cylinder, float uncertainty) noexcept;
/// Floor, ceiling and keep-in cylinder of an airspace, those that it has.
[[nodiscard]] StaticVector<Threat, 3> bounds_of(const Airspace& airspace, float uncertainty) noexcept;

/// Those of one kind, of threats in a set's order. O(log threats).
[[nodiscard]] std::span<const Threat> of_kind(std::span<const Threat> threats, ThreatKind kind) noexcept;

}  // namespace jink::world
