// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/threat_set.hpp"

#include <algorithm>

#include "core/world/obstacle_distance.hpp"

namespace jink::world {
namespace {

Threat at_rest(ThreatKind kind, std::size_t index, ThreatForm form, const Vec3& position, float grown) noexcept
{
    Threat threat;
    threat.ref = {kind, static_cast<std::uint16_t>(index)};
    threat.form = form;
    threat.position = position;
    threat.growth.radius = grown;
    return threat;
}

Threat threat_of(const Situation& situation, const Track& track, std::size_t index) noexcept
{
    Threat threat =
        track_threat(index, {track.position, track.velocity}, growth_of(situation, track), track.half_height);
    threat.growth_begins = std::max(track.stamp - situation.now, 0.0F);
    threat.grows = !(track.sigma_velocity <= 0.0F && track.max_acceleration <= 0.0F);  // non-finite ones too
    threat.reciprocal = track.cooperative;
    if (threat.reciprocal) {
        const Doubt doubt = doubt_of(situation, track);
        threat.doubted = doubt.velocity > 0.0F;
        threat.grows = threat.grows || threat.doubted;
        threat.doubt = doubt.velocity;
        threat.doubt_ends = doubt.ends;
    }
    threat.track = &track;
    return threat;
}

/// Of a kind in the order of a set.
int place_of(ThreatKind kind) noexcept
{
    switch (kind) {
    case ThreatKind::floor: return 1;
    case ThreatKind::ceiling: return 2;
    case ThreatKind::keep_in: return 3;
    case ThreatKind::track: return 4;
    case ThreatKind::cylinder: return 5;
    case ThreatKind::obstacle: return 6;
    case ThreatKind::none: break;
    }
    return 0;
}

}  // namespace

Threat track_threat(std::size_t index, const geometry::Motion& motion, const Growth& growth, float half_height) noexcept
{
    Threat threat = at_rest(ThreatKind::track, index, ThreatForm::point, motion.position, 0.0F);
    threat.velocity = motion.velocity;
    threat.half_height = half_height;
    threat.growth = growth;
    threat.grows = !(growth.rate <= 0.0F && growth.acceleration <= 0.0F);
    return threat;
}

Threat obstacle_threat(std::size_t index, const geometry::Shape& shape, float uncertainty) noexcept
{
    Threat threat = at_rest(ThreatKind::obstacle, index, ThreatForm::point, shape.centre, uncertainty);
    Vec3 half = Vec3::Zero();
    float radius = 0.0F;
    threat.solid = &shape;
    if (as_sphere(shape, Vec3::Zero(), half, radius)) {
        threat.half_height = half.z();
        threat.growth.radius = radius + uncertainty;
    } else {
        threat.form = ThreatForm::solid;
    }
    return threat;
}

Threat solid_threat(std::size_t index, const geometry::Shape& shape, const Vec3& velocity,
                    const Growth& growth) noexcept
{
    Threat threat = track_threat(index, {shape.centre, velocity}, growth);
    threat.ref.kind = ThreatKind::obstacle;
    threat.form = ThreatForm::solid;
    threat.solid = &shape;
    return threat;
}

Threat cylinder_threat(std::size_t index, const Cylinder& cylinder, float uncertainty) noexcept
{
    const Vec3 centre(cylinder.circle.centre.x(), cylinder.circle.centre.y(), 0.0F);
    Threat threat = at_rest(ThreatKind::cylinder, index, ThreatForm::cylinder, centre, uncertainty);
    threat.velocity = {cylinder.velocity.x(), cylinder.velocity.y(), 0.0F};
    threat.cylinder = &cylinder;
    return threat;
}

StaticVector<Threat, 3> bounds_of(const Airspace& air, float uncertainty) noexcept
{
    StaticVector<Threat, 3> bounds;
    if (air.has_floor) {
        bounds.unchecked_push_back(
            at_rest(ThreatKind::floor, 0, ThreatForm::floor, air.floor * Vec3::UnitZ(), uncertainty));
    }
    if (air.has_ceiling) {
        bounds.unchecked_push_back(
            at_rest(ThreatKind::ceiling, 0, ThreatForm::ceiling, air.ceiling * Vec3::UnitZ(), uncertainty));
    }
    if (air.has_keep_in) {
        Threat threat = at_rest(ThreatKind::keep_in, 0, ThreatForm::keep_in, air.home, uncertainty);
        threat.level_radius = air.keep_in_radius;
        bounds.unchecked_push_back(threat);
    }
    return bounds;
}

std::span<const Threat> of_kind(std::span<const Threat> threats, ThreatKind kind) noexcept
{
    const auto begin =
        std::partition_point(threats.begin(), threats.end(), [place = place_of(kind)](const Threat& threat) {
            return place_of(threat.ref.kind) < place;
        });
    const auto end = std::partition_point(begin, threats.end(), [place = place_of(kind)](const Threat& threat) {
        return place_of(threat.ref.kind) <= place;
    });
    return {begin, end};
}

bool ThreatSet::collect(const Situation& s, const Surroundings& around) noexcept
{
    const Airspace& air = around.airspace;
    threats_.clear();
    collected_ = around.tracks.size() <= kMaxTracks && around.obstacles.size() <= kMaxObstacles &&
                 air.cylinders.size() <= kMaxCylinders;
    if (!collected_) {
        return false;
    }
    const float uncertainty = own_uncertainty(s);
    for (const Threat& bound : bounds_of(air, uncertainty)) {
        threats_.unchecked_push_back(bound);
    }
    for (std::size_t i = 0; i < around.tracks.size(); ++i) {
        threats_.unchecked_push_back(threat_of(s, around.tracks[i], i));
    }
    for (std::size_t i = 0; i < air.cylinders.size(); ++i) {
        threats_.unchecked_push_back(cylinder_threat(i, air.cylinders[i], uncertainty));
    }
    for (std::size_t i = 0; i < around.obstacles.size(); ++i) {
        const Obstacle& obstacle = around.obstacles[i];
        Threat threat = obstacle_threat(i, obstacle.shape, uncertainty + obstacle.uncertainty);
        threat.slack = obstacle.uncertainty;
        threats_.unchecked_push_back(threat);
    }
    return true;
}

}  // namespace jink::world
