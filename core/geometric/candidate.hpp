// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/cost/cost.hpp"
#include "core/path/timed_path.hpp"
#include "core/world/separation.hpp"

// Candidate curves around the main threat (geometric planner, section 2; Pinheiro 3.1 after Chen, Zhao & Yin 2020).

namespace jink::geometric {

/// simple, symmetric: Pinheiro's. smooth: the quintic of least jerk, out and back (T. Flash, N. Hogan, J. Neurosci. 5
/// (1985), 1688-1703): it leaves the leg and meets it again along it and without curvature, so that acceleration has no
/// jump anywhere. plateau: the same, but out within kPlateauRise of D and as far from the leg until as much before its
/// end: climb (or step aside) first, then pass. wait: stays on the leg, slows down or stands until something has
/// passed.
enum class Family : std::uint8_t { simple, symmetric, smooth, plateau, wait };
inline constexpr std::array kFamilies{Family::simple, Family::symmetric, Family::smooth, Family::plateau, Family::wait};
/// Those that leave the leg.
inline constexpr std::array kCurves{Family::simple, Family::symmetric, Family::smooth, Family::plateau};
[[nodiscard]] std::string_view to_string(Family family) noexcept;

enum class CandidateStatus : std::uint8_t {
    available,  ///< clear, not the cheapest
    chosen,
    hits_static,    ///< touches a static threat or an obstacle, on its curve or as it would be flown
    hits_moving,    ///< touches a moving threat, likewise
    hits_airspace,  ///< leaves floor, ceiling or keep-in, or enters a cylinder
    not_flyable,    ///< asks for more acceleration than the vehicle has, or comes back to the leg too steeply
    not_evaluated,  ///< the work budget ran out before its turn, or it can be no cheaper than the chosen one
};

/// Right-handed frame of the manoeuvre: x along the leg, y horizontal, z = x cross y; columns of `axes`.
struct PathFrame {
    Vec3 origin = Vec3::Zero();
    Mat3 axes = Mat3::Identity();
};
/// Frame at `origin` with x towards `direction` (length > 0); y = world z cross x, and world north for a vertical leg.
[[nodiscard]] PathFrame make_path_frame(const Vec3& origin, const Vec3& direction) noexcept;
/// The same with y towards `across`, which is not along `direction`; what it has along it does not count.
[[nodiscard]] PathFrame make_path_frame(const Vec3& origin, const Vec3& direction, const Vec3& across) noexcept;

/// One candidate: family, plane and offset say everything of a curve but the scale D.
struct CandidateShape {
    Family family = Family::simple;
    float plane = 0.0F;    ///< theta [rad], rotation about the leg
    float offset = 0.0F;   ///< w [m], signed
    float share = 0.0F;    ///< wait: of the leg's speed, until then
    Seconds until = 0.0F;  ///< wait [s]
};

/// Length of a curve along the leg, over the threat's distance D (Pinheiro eq. 3.7 and 3.1.2).
inline constexpr float kSimpleLength = 1.5F;
inline constexpr float kSymmetricLength = 2.0F;  ///< of smooth and plateau too
inline constexpr float kPlateauRise = 0.4F;

/// Curve of a family for D = 1, w = 1: 3u^2 - 2u^3, for symmetric mirrored about u = 1; 10v^3 - 15v^4 + 6v^5 so
/// mirrored for smooth, v = u, and plateau, v = u / kPlateauRise up to 1; 0 for wait. O(1).
[[nodiscard]] float unit_offset(Family family, float u) noexcept;
/// Offset y [m] of the curve at abscissa s in [0, length_x] for a threat at distance D: w unit_offset(s / D).
[[nodiscard]] float curve_offset(const CandidateShape& shape, float distance, float s) noexcept;
/// 1.5 D or 2 D; of wait 1.5 D.
[[nodiscard]] float curve_length_x(Family family, float distance) noexcept;

/// What became of one candidate. Checked in the order of the causes: not_flyable, bounds, static threats, obstacles,
/// moving threats, cylinders; so the status does not depend on the order of the threats.
struct Candidate {
    CandidateShape shape;
    CandidateStatus status = CandidateStatus::not_evaluated;
    float sin_alpha = 0.0F;     ///< sine of the angle between its plane and the ground, >= 0
    float duration = 0.0F;      ///< [s]
    world::ThreatRef hit;       ///< what it touches, where status says so
    cost::Terms terms;          ///< valid when available or chosen; on 0 to 1: cost::normalise with the settings' caps
    float total = 0.0F;         ///< [0, 1]
    float flip_penalty = 0.0F;  ///< added to the total when candidates are compared; 0 on the side being flown
};

}  // namespace jink::geometric
