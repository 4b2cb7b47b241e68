// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/reach/grid.hpp"

// The cells that an intruder enters, and when (Gomola 6.6.1 to 6.6.4). All in the grid's frame and unit of length;
// times count from the entry into the grid. The grid is static while the vehicle flies through it, so velocities are
// absolute.

namespace jink::reach {

/// An intruder in the form of the models.
struct Intruder {
    Vec3 position = Vec3::Zero();  ///< at time 0
    Vec3 velocity = Vec3::Zero();
    float radius = 0.0F;       ///< of its body, plus the required clearance
    float horizontal = 0.0F;   ///< largest turn to either side [rad], 0 to kMaxSpread
    float vertical = 0.0F;     ///< largest turn up or down [rad]
    float speed_share = 0.1F;  ///< relative error of its speed, below 1
};
/// Greatest spread: 75 degrees; beyond, the tangent is of no use.
inline constexpr float kMaxSpread = 1.3089969F;
/// Intruders below this speed [grid's unit/s] may be static or may continue: cells that they overlap now stay occupied
/// for ever.
inline constexpr float kStandsBelow = 0.1F;

/// Time interval in a cell [s], first to last.
struct Stay {
    float from = 0.0F;
    float to = 0.0F;
};
struct CellStay {
    CellIndex cell = kNoCell;
    Stay stay;
};

/// Bounding sphere of a cell: about the middle of its ranges, through its farthest corner or edge.
struct CellSphere {
    Vec3 centre = Vec3::Zero();
    float radius = 0.0F;
};
/// O(1).
[[nodiscard]] CellSphere sphere_of(const Grid<float>& grid, const CellPlace& place) noexcept;

/// Cells on a straight line, in the order of flight: for small intruders.
inline constexpr std::size_t kMaxCrossings = 2 * (kMaxLayers + 1) + (kMaxColumns + 1) + 2 * (kMaxRows + 1) + 1;
using CrossedCells = StaticVector<CellStay, kMaxCrossings>;
/// Exact: intersections of the line with the spheres, planes and cones between cells. A velocity of zero gives none.
/// Near a cell's corner, where the line is in the cell for less than rounding resolves, the result may be a neighbour.
/// O(n log n) for n = 2 (layers + rows + 2) + columns + 2.
void cross(const Grid<float>& grid, const Vec3& position, const Vec3& velocity, CrossedCells& out) noexcept;

/// When the body, flying straight, may overlap the cell. Conservative: uses the cell's sphere. O(1).
[[nodiscard]] std::optional<Stay> body_in(const CellSphere& cell, const Intruder& intruder) noexcept;

/// When the body may overlap the cell if the intruder deviates from its line within its spread: an elliptic cone.
/// Conservative: uses the cell's sphere. O(1).
[[nodiscard]] std::optional<Stay> spread_in(const CellSphere& cell, const Intruder& intruder) noexcept;

/// Share of the vehicle's stay in a cell during which the intruder is there too (Gomola eq. 6.119): 0 to 1. Stays with
/// a single common instant count as 2e-7, above the threshold of a threat, so that an intruder present for an instant
/// is not lost. O(1).
[[nodiscard]] float time_rate(const Stay& vehicle, const Stay& intruder) noexcept;

/// Padding of a model's stay before and after [s], so that an intruder present for an instant is not lost: half the
/// sampling step plus its radius, over its speed, plus its clock error. Infinite at speed 0.
/// @param step  between samples of its path [grid's unit]; 0 for exact paths
/// @param radius  that the model leaves out of its times [grid's unit]
/// @param clock   [s]: one decision frame of the intruder
/// O(1).
[[nodiscard]] float padding(float step, float radius, float speed, float clock) noexcept;
[[nodiscard]] Stay padded(const Stay& stay, float by) noexcept;

/// When an intruder may be between two distances from its present position, with a relative speed error up to `share`
/// (Gomola eq. 6.121, 6.148, 6.149). A static intruder, or an unknown speed, gives all times. O(1).
[[nodiscard]] Stay reach_times(float nearest, float farthest, float speed, float share) noexcept;

/// The intruder `later` seconds ahead. O(1).
[[nodiscard]] Intruder moved(const Intruder& intruder, float later) noexcept;

/// Models applied to an intruder (Gomola eq. 6.150, 6.151). Claimed separation: body, with the separation as its
/// radius; possible deviation: spread; small intruders in known straight flight: line.
struct Models {
    bool line = false;
    bool body = false;
    bool spread = false;
    bool timed = false;  ///< cells that the vehicle is in at other times are not rated
};
enum class ModelStatus : std::uint8_t { good, bad_intruder_model };

/// Effect of an intruder on a cell.
struct Meeting {
    float rate = 0.0F;         ///< 0 to 1
    std::optional<Stay> stay;  ///< hull of the models' times, padded; none: no overlap
};

/// One intruder by the selected models. If none is selected, by all models, untimed (`bad_intruder_model`).
///
/// Memory: the cells of its line, about 1 KiB.
class CombinedModel {
public:
    /// @param clock  as of `padding`
    /// @param grid   outlives this
    /// O(n log n) as `cross`.
    CombinedModel(const Grid<float>& grid, const Intruder& intruder, const Models& models, float clock) noexcept;

    [[nodiscard]] ModelStatus status() const noexcept { return status_; }
    /// The greatest of the models' rates: 1 where a model overlaps the cell, and when timed, 1 times the share of
    /// `vehicle` in that model's own times. Timed without a vehicle in the cell: 0.
    /// @param vehicle  its stay in the cell; none: never in the cell O(kMaxCrossings).
    [[nodiscard]] Meeting in(CellIndex cell, const CellSphere& sphere,
                             const std::optional<Stay>& vehicle) const noexcept;

private:
    Intruder intruder_;
    Models models_;
    float clock_;
    ModelStatus status_ = ModelStatus::good;
    CrossedCells crossed_;
};

}  // namespace jink::reach
