// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/base/static_vector.hpp"
#include "core/base/work_budget.hpp"
#include "core/reach/cell_spheres.hpp"
#include "core/reach/evaluation.hpp"
#include "core/reach/placed.hpp"
#include "core/world/separation.hpp"

// Threats near enough to a placed reach set to matter, and the nodes that conflict with them. Private to core/reach.

namespace jink::reach::detail {

/// Set of threats by number, as bits: in the order of the ThreatSet.
struct ThreatBits {
    static constexpr std::size_t kMax = kMaxTracks + kMaxObstacles + kMaxCylinders;
    static constexpr std::size_t kWords = (kMax + 31) / 32;

    void add(std::size_t i) noexcept { words[i / 32] |= std::uint32_t{1} << (i % 32); }

    std::array<std::uint32_t, kWords> words{};
};

/// One threat to the own box, from the start of the path on.
struct NearThreat {
    const geometry::Shape* shape = nullptr;  ///< of a solid other than a sphere; null for spheres, static or moving
    Vec3 half =
        Vec3::Zero();  ///< sphere: of the own box, taller for upright capsules. solid: its own, grown by the box
    Vec3 position = Vec3::Zero();  ///< centre [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    world::Growth growth;          ///< of the sphere, or of what a solid is grown by
    float shrunk = 0.0F;           ///< reduction by the escape rule, at time 0 [m]
    float body = 0.0F;  ///< sphere: what the own box adds to its radius, at most; of a tall one in the level plane [m]
    float far = 0.0F;   ///< sphere: farther apart than this halfway through a movement: apart all through it [m]
    float room = 0.0F;  ///< nearer than this is better avoided; of a cylinder level, its margin if that is more [m]
    bool is_tall = false;  ///< sphere: an upright capsule or a cylinder, whose heights are checked by `half` alone
    bool is_track = false;
    bool is_cylinder = false;  ///< flat-ended: the radius is level alone

    [[nodiscard]] Vec3 at(Seconds t) const noexcept { return position + velocity * t; }
};

/// Distance of a point from a solid that has been grown by the own box, below 0 inside. Exact for upright boxes; for
/// other shapes not above the true distance. O(1).
[[nodiscard]] float distance_to(const NearThreat& solid, const Vec3& point) noexcept;

/// A straight piece of a flight, from the start of the path on.
struct Piece {
    Vec3 from = Vec3::Zero();  ///< [m]
    Vec3 to = Vec3::Zero();
    Seconds start = 0.0F;
    Seconds end = 0.0F;
    float bulge = 0.0F;  ///< largest distance of the vehicle from the piece [m]
};

/// The threats near a placed reach set. Memory: 88 bytes a threat, a bit for each threat in a cell.
class NearThreats {
public:
    /// Collects the threats that the placed set may come near to.
    /// @param lead    time from Situation::now until the path begins [s]
    /// @param beyond  distance past the grid's border that is checked as well [m]
    /// O(tracks + obstacles + cylinders).
    [[nodiscard]] bool collect(const world::Situation& situation, const Placed& placed, Seconds lead, float beyond,
                               WorkBudget& budget) noexcept;

    /// Finds, for each cell in which a node ends, the threats that may come near to the movements to and from that cell
    /// at the times at which a node is there. False when the budget is too small. O(nodes + cells * threats).
    [[nodiscard]] bool mark(const Placed& placed, const CellSpheres& spheres, WorkBudget& budget) noexcept;

    /// Level of the movement that leads to `node`, by the near threats and the bounds of the airspace:
    /// obstacles, intruders, hard_constraints (a cylinder's body), soft_constraints (within the clearance buffer, or a
    /// cylinder's margin) or kFree. Conservative: the movement counts as its chord with its bulge around it, threats as
    /// large as at its end, and solids other than spheres as up to an eighth of a movement nearer than they are. A
    /// movement that conflicts with an intruder is checked no further. If the budget runs out: obstacles. O(near
    /// threats).
    [[nodiscard]] Level level(const Placed& placed, NodeIndex node, WorkBudget& budget) const noexcept;

    /// The same for any piece, against all near threats. O(threats).
    [[nodiscard]] Level level(const Piece& piece, WorkBudget& budget) const noexcept;

    [[nodiscard]] std::size_t size() const noexcept { return near_.size(); }

private:
    [[nodiscard]] Level against(const NearThreat& threat, const Piece& piece, WorkBudget& budget) const noexcept;
    [[nodiscard]] Level against_cylinder(const NearThreat& cylinder, const Piece& piece) const noexcept;
    [[nodiscard]] Level against(const ThreatBits& bits, const Piece& piece, WorkBudget& budget) const noexcept;
    struct Depths;
    struct LayerCells;
    void set_far(NearThreat& threat, Seconds last, const Placed& placed) const noexcept;
    [[nodiscard]] bool keep_near(const Piece& piece, ThreatBits& bits, WorkBudget& budget) const noexcept;
    void mark_layer(const Placed& placed, const LayerCells& cells, std::size_t threat) noexcept;
    [[nodiscard]] Level in_airspace(const Vec3& to, Seconds end) const noexcept;
    void add_point(const world::Threat& threat, const Vec3& own, const Placed& placed, Seconds lead,
                   float range) noexcept;
    void add_solid(const world::Threat& threat, const Vec3& own, const Placed& placed, float range) noexcept;
    void add_cylinder(const world::Threat& threat, const Vec3& own, const Placed& placed, Seconds lead,
                      float range) noexcept;
    void add_bound(const world::Threat& threat, const Vec3& own, const Placed& placed) noexcept;
    [[nodiscard]] float shrunk_by(float margin_at_start) const noexcept;
    [[nodiscard]] float shrunk_at(float shrunk, Seconds t) const noexcept;

    world::FlightRules rules_;  ///< of the situation
    StaticVector<NearThreat, ThreatBits::kMax> near_;
    std::array<ThreatBits, kMaxReachCells> of_cell_{};
    ThreatBits all_;
    float bulge_ = 0.0F;  ///< of a movement [m]
    /// Bounds of the airspace, for the centre of the own box; without bounds every position is inside.
    struct Inside {
        static constexpr float kUnbounded = std::numeric_limits<float>::infinity();
        float floor = -kUnbounded;
        float ceiling = kUnbounded;
        float keep_in = kUnbounded;
        Vec3 home = Vec3::Zero();
        float floor_shrunk = 0.0F;  ///< reduction by the escape rule, at time 0
        float ceiling_shrunk = 0.0F;
        float keep_in_shrunk = 0.0F;
    };
    Inside inside_;
};

}  // namespace jink::reach::detail
