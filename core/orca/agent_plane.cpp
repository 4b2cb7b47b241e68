// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/agent_plane.hpp"

#include <algorithm>
#include <cmath>

namespace jink::orca {

namespace {

constexpr float kOnAxis = 1e-5F;      // [m/s] across the axis, below which a velocity has no side of its own
constexpr float kCoincident = 1e-6F;  // [m] between centres that have no direction

// A vector that is handed over in memory part by part and read as a whole waits for itself: twice the time of a
// half-space. So what makes one is one function.
#define JINK_INLINE [[gnu::always_inline]] inline

/// Stretches heights by `by`.
JINK_INLINE Vec3 stretched(const Vec3& v, float by) noexcept { return {v.x(), v.y(), v.z() * by}; }

JINK_INLINE Exit exit_of(const Vec3& position, const Vec3& velocity, const Vec3& lean, float radius,
                         float horizon) noexcept
{
    const float rate = 1.0F / horizon;
    const Vec3 from_sphere = velocity - position * rate;
    const float along = from_sphere.dot(position);
    const float length2 = from_sphere.squaredNorm();
    if (along < 0.0F && along * along > radius * radius * length2) {
        // The sphere at the horizon, on the side of the apex.
        const float length = std::sqrt(length2);
        return {from_sphere / length, radius * rate - length};
    }
    const float distance2 = position.squaredNorm();
    const float distance = std::sqrt(distance2);
    const float cosine_length = std::sqrt((distance - radius) * (distance + radius));  // no cancellation near contact
    const Vec3 leaning = velocity + lean;
    Vec3 across = leaning - position * (leaning.dot(position) / distance2);
    constexpr float kNearAxis = 1e-4F;  // of the speed squared: what is left of the difference is rounding in part
    if (across.squaredNorm() < kNearAxis * leaning.squaredNorm()) {
        across -= position * (across.dot(position) / distance2);
    }
    const float across_length = across.norm();
    const Vec3 sideways = across_length > kOnAxis ? Vec3(across / across_length) : side(position);
    const float scale = 1.0F / distance;
    const Vec3 normal = (cosine_length * scale) * sideways - (radius * scale * scale) * position;
    return {normal, -velocity.dot(normal)};
}

JINK_INLINE Exit apart(const Vec3& position, float distance, const Vec3& velocity, float speed, bool above) noexcept
{
    const Vec3 normal = distance < kCoincident ? Vec3(0.0F, 0.0F, above ? 1.0F : -1.0F) : Vec3(position / -distance);
    return {normal, speed - velocity.dot(normal)};
}

/// An exit in the stretched space as a half-space of the own velocities.
JINK_INLINE HalfSpace half_space(const Exit& exit, const Pair& pair, float stretch, Level level) noexcept
{
    const float share = exit.depth * (exit.depth > 0.0F ? pair.weights.react : pair.weights.slack);
    HalfSpace out;
    out.level = level;
    out.source = pair.source;
    // The relative velocity that is just let pass, v + u, has normal . (stretched v) + depth; the own half of it:
    const float offset = exit.normal.dot(stretched(pair.own_velocity, stretch)) + share;
    if (stretch == 1.0F) {
        out.normal = exit.normal;
        out.offset = offset;
    } else {
        const Vec3 back = stretched(exit.normal, stretch);
        const float length = back.norm();
        out.normal = back / length;
        out.offset = offset / length;
    }
    return out;
}

JINK_INLINE Exit warning_exit(const Vec3& position, float distance, const Vec3& velocity, const Pair& pair,
                              const PairSettings& settings) noexcept
{
    const float outer = pair.across;
    if (distance > outer) {
        return exit_of(position, velocity, stretched(pair.lean, pair.across / pair.upright), outer, settings.horizon);
    }
    const float inner = outer * settings.conflict_ratio;
    const float part = std::min((outer - distance) / (outer - inner), 1.0F);
    if (settings.ramp == Ramp::speed || distance < kCoincident) {
        return apart(position, distance, velocity, settings.ramp_speed * part, pair.above);
    }
    const Exit soon = original_exit(position, velocity, outer, settings.period);
    // The answer at the rim, where both formulas know only how fast the two close in.
    const Exit late = apart(position, distance, velocity, 0.0F, pair.above);
    const Vec3 change = (1.0F - part) * late.depth * late.normal + part * soon.depth * soon.normal;
    const Vec3 normal = ((1.0F - part) * late.normal + part * soon.normal).normalized();
    return {normal, change.dot(normal)};
}

JINK_INLINE Exit conflict_exit(const Vec3& position, float distance, const Vec3& velocity, const Pair& pair,
                               float inner, const PairSettings& settings) noexcept
{
    if (distance > inner) {
        return exit_of(position, velocity, stretched(pair.lean, pair.across / pair.upright), inner, settings.horizon);
    }
    const float speed = std::min(settings.recovery_speed, (inner - distance) / settings.recovery_time);
    return apart(position, distance, velocity, speed, pair.above);
}

/// Conflict::at_rest: of the gap, half in each `brake` time; of what is missing, half of the recovery.
JINK_INLINE HalfSpace rest_plane(const Vec3& position, float distance, const Pair& pair, float inner, float stretch,
                                 const PairSettings& settings) noexcept
{
    const float gap = distance - inner;
    const Exit out = apart(position, distance, Vec3::Zero(), 0.0F, pair.above);
    // Demanded of both together: a separating speed, negative while there is a gap.
    const float speed =
        gap > 0.0F ? -gap / settings.brake : std::min(settings.recovery_speed, -gap / settings.recovery_time);
    Pair still = pair;
    const bool alone = pair.weights.react > kShared.react;
    still.own_velocity = alone ? pair.other_velocity : Vec3::Zero();
    still.weights = alone ? Weights{1.0F, 1.0F} : kShared;
    return half_space({out.normal, speed}, still, stretch, Level::conflict);
}

}  // namespace

Exit nearest_exit(const Vec3& position, const Vec3& velocity, float radius, float horizon) noexcept
{
    return exit_of(position, velocity, Vec3::Zero(), radius, horizon);
}

Exit original_exit(const Vec3& position, const Vec3& velocity, float radius, float period) noexcept
{
    const Vec3 from_sphere = velocity - position / period;
    const float length = from_sphere.norm();
    return {from_sphere / length, radius / period - length};
}

Exit separating(const Vec3& position, float distance, const Vec3& velocity, float speed, bool above) noexcept
{
    return apart(position, distance, velocity, speed, above);
}

PairPlanes pair_planes(const Pair& pair, const PairSettings& settings) noexcept
{
    const float stretch = pair.across == pair.upright ? 1.0F : pair.across / pair.upright;
    const Vec3 position = stretched(pair.position, stretch);
    const Vec3 velocity = stretched(pair.own_velocity - pair.other_velocity, stretch);
    PairPlanes out;
    out.distance = position.norm();
    out.warning =
        half_space(warning_exit(position, out.distance, velocity, pair, settings), pair, stretch, Level::warning);
    const float inner = pair.across * settings.conflict_ratio;
    out.conflict = settings.conflict == Conflict::at_rest
                       ? rest_plane(position, out.distance, pair, inner, stretch, settings)
                       : half_space(conflict_exit(position, out.distance, velocity, pair, inner, settings), pair,
                                    stretch, Level::conflict);
    return out;
}

HalfSpace pair_plane(const Pair& pair, const PairSettings& settings) noexcept
{
    const float stretch = pair.across == pair.upright ? 1.0F : pair.across / pair.upright;
    const Vec3 position = stretched(pair.position, stretch);
    const Vec3 velocity = stretched(pair.own_velocity - pair.other_velocity, stretch);
    return half_space(warning_exit(position, position.norm(), velocity, pair, settings), pair, stretch, Level::warning);
}

float effective_horizon(float limit, float radius, float horizon, float own_speed, float other_speed,
                        float stretch) noexcept
{
    const float closing = (own_speed + other_speed) * std::max(stretch, 1.0F);
    if (closing * horizon <= limit - radius) {
        return horizon;
    }
    return std::max(limit - radius, 0.0F) / closing;
}

}  // namespace jink::orca
