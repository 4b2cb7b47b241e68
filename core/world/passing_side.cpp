// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/passing_side.hpp"

#include <cmath>

namespace jink::world {
namespace {

/// Parts of the unit vector: the level one is the larger, so right and down outweighs left and up.
constexpr float kLevelPart = 0.8F;
constexpr float kUprightPart = 0.6F;
/// Centres nearer than this have no direction [m].
constexpr float kCoincident = 1e-3F;

}  // namespace

Vec3 side(const Vec3& offset) noexcept
{
    const float level2 = offset.x() * offset.x() + offset.y() * offset.y();
    const float height2 = offset.z() * offset.z();
    constexpr float kUpright2 = 1e-6F;  // of the length squared, below which it points straight up or down
    if (level2 < kUpright2 * (level2 + height2)) {
        // offset x (1, 0, 0)
        return Vec3(0.0F, offset.z(), -offset.y()) / std::sqrt(height2 + offset.y() * offset.y());
    }
    return Vec3(offset.y(), -offset.x(), 0.0F) / std::sqrt(level2);  // offset x (0, 0, 1)
}

Vec3 passing_side(const Situation& s, const Threat& threat) noexcept
{
    if (threat.ref.kind != ThreatKind::track || !threat.reciprocal) {
        return Vec3::Zero();
    }
    const Vec3 offset = threat.position - s.own.position;
    if (!(offset.squaredNorm() > kCoincident * kCoincident)) {
        return Vec3::Zero();
    }
    const Vec3 right = side(offset);
    if (s.own_id == 0 || threat.track == nullptr || threat.track->source != TrackSource::datalink) {
        // NOLINTNEXTLINE(performance-no-automatic-move): numbers alone, which are copied either way
        return right;
    }
    const float up = climbs(s.own_id, threat.track->id) ? kUprightPart : -kUprightPart;
    return kLevelPart * right + up * Vec3::UnitZ();
}

}  // namespace jink::world
