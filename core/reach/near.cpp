// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/near.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/work_units.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::reach::detail {
namespace {

constexpr float kUnbounded = std::numeric_limits<float>::infinity();
/// A movement is checked against a solid in this many pieces.
constexpr int kSolidPieces = 4;

/// Distance from a box or a flat-ended cylinder, given the distances beyond its faces; below 0 inside, by the nearest
/// face.
template <class Beyond>
float signed_distance(const Beyond& beyond) noexcept
{
    const float deepest = beyond.maxCoeff();
    return deepest > 0.0F ? beyond.cwiseMax(0.0F).norm() : deepest;
}

/// Half extents, in the solid's axes, of a box about the solid grown by the own box; for round solids x is the radius.
void grow_by_box(NearThreat& solid, const Vec3& own) noexcept
{
    const geometry::Shape& shape = *solid.shape;
    const Vec3 own_in = shape.axes.cwiseAbs().transpose() * own;
    switch (shape.kind) {
    case geometry::ShapeKind::capsule: solid.half = {shape.radius + own.norm(), 0.0F, shape.half.z()}; return;
    case geometry::ShapeKind::cylinder:
        // Upright, the corners of the own box are its farthest points sideways.
        solid.half = {shape.radius + std::min(own.norm(), std::hypot(own_in.x(), own_in.y())), 0.0F,
                      shape.half.z() + own_in.z()};
        return;
    case geometry::ShapeKind::hull: {
        Vec3 low = Vec3::Constant(kUnbounded);
        Vec3 high = Vec3::Constant(-kUnbounded);
        for (const Point3& vertex : shape.vertices) {
            low = low.cwiseMin(vertex.vec());
            high = high.cwiseMax(vertex.vec());
        }
        solid.position = shape.centre + shape.axes * (0.5F * (low + high));
        solid.half = 0.5F * (high - low) + own_in;
        return;
    }
    default: solid.half = shape.half + own_in; return;
    }
}

}  // namespace

float distance_to(const NearThreat& solid, const Vec3& point) noexcept
{
    const Vec3 in = solid.shape->axes.transpose() * (point - solid.position);
    switch (solid.shape->kind) {
    case geometry::ShapeKind::capsule:
        return std::hypot(std::max(std::abs(in.z()) - solid.half.z(), 0.0F), std::hypot(in.x(), in.y())) -
               solid.half.x();
    case geometry::ShapeKind::cylinder:
        return signed_distance(
            Eigen::Vector2f(std::hypot(in.x(), in.y()) - solid.half.x(), std::abs(in.z()) - solid.half.z()));
    default: return signed_distance(Vec3(in.cwiseAbs() - solid.half));
    }
}

float NearThreats::shrunk_by(float margin_at_start) const noexcept
{
    return margin_at_start < 0.0F ? rules_.escape.slack - margin_at_start : 0.0F;
}

float NearThreats::shrunk_at(float shrunk, Seconds t) const noexcept
{
    return shrunk > 0.0F ? std::max(0.0F, shrunk - rules_.escape.speed * t) : 0.0F;
}

void NearThreats::set_far(NearThreat& threat, Seconds last, const Placed& placed) const noexcept
{
    const float half_way = 0.5F * (placed.unit + placed.period * threat.velocity.norm());
    threat.far = threat.growth.at(last) + threat.body + threat.room + bulge_ + half_way;
}

void NearThreats::add_point(const world::Threat& threat, const Vec3& own, const Placed& placed, Seconds lead,
                            float range) noexcept
{
    NearThreat near;
    near.half = threat.box_against(own);
    near.is_tall = threat.half_height > 0.0F;
    near.is_track = threat.ref.kind == world::ThreatKind::track;
    near.body = near.is_tall ? std::hypot(own.x(), own.y()) : own.norm();
    near.position = threat.position_at(lead);
    near.velocity = threat.velocity;
    near.growth = threat.growth_from(lead);
    near.room = rules_.clearance;
    const Seconds last = near.is_track ? placed.period * static_cast<float>(kMaxDepth) : 0.0F;
    const float margin = geometry::box_distance(near.half, near.position - placed.origin) - near.growth.at(0.0F);
    const float apart = geometry::point_segment_distance(placed.origin, near.position, near.at(last));
    if (near.is_track ? apart > range + near.growth.at(last) + near.half.norm() : margin > range) {
        return;
    }
    near.shrunk = shrunk_by(margin);
    set_far(near, last, placed);
    near_.unchecked_push_back(near);
}

void NearThreats::add_solid(const world::Threat& threat, const Vec3& own, const Placed& placed, float range) noexcept
{
    NearThreat near;
    near.shape = threat.solid;
    near.position = threat.position;
    near.room = rules_.clearance;
    grow_by_box(near, own);
    near.growth = threat.growth;
    const float margin = distance_to(near, placed.origin) - near.growth.radius;
    if (margin > range) {
        return;
    }
    near.shrunk = shrunk_by(margin);
    near_.unchecked_push_back(near);
}

void NearThreats::add_bound(const world::Threat& threat, const Vec3& own, const Placed& placed) noexcept
{
    const float extra = threat.growth.radius;
    const Vec3& at = placed.origin;
    switch (threat.form) {
    case world::ThreatForm::floor:
        inside_.floor = threat.position.z() + own.z() + extra;
        inside_.floor_shrunk = shrunk_by(at.z() - inside_.floor);
        break;
    case world::ThreatForm::ceiling:
        inside_.ceiling = threat.position.z() - own.z() - extra;
        inside_.ceiling_shrunk = shrunk_by(inside_.ceiling - at.z());
        break;
    default:
        inside_.home = threat.position;
        inside_.keep_in = threat.level_radius - std::hypot(own.x(), own.y()) - extra;
        inside_.keep_in_shrunk = shrunk_by(inside_.keep_in - (at - inside_.home).head<2>().norm());
        break;
    }
}

bool NearThreats::collect(const world::Situation& situation, const Placed& placed, Seconds lead, float beyond,
                          WorkBudget& budget) noexcept
{
    rules_ = situation.rules;
    bulge_ = placed.bulge();
    near_.clear();
    inside_ = {};
    const Vec3& own = situation.limits.half_extents;
    const float range = placed.unit * placed.set->grid.distance() + bulge_ + beyond + rules_.clearance;
    for (const world::Threat& threat : situation.threats) {
        const std::size_t vertices = threat.form == world::ThreatForm::solid ? threat.solid->vertices.size() : 0;
        if (!budget.spend(units::kReachThreat + units::hull_units(vertices))) {
            return false;
        }
        switch (threat.form) {
        case world::ThreatForm::point: add_point(threat, own, placed, lead, range); break;
        case world::ThreatForm::solid: add_solid(threat, own, placed, range); break;
        case world::ThreatForm::cylinder: add_cylinder(threat, own, placed, lead, range); break;
        default: add_bound(threat, own, placed); break;
        }
    }
    all_ = {};
    for (std::size_t i = 0; i < near_.size(); ++i) {
        all_.add(i);
    }
    return true;
}

Level NearThreats::against(const NearThreat& threat, const Piece& piece, WorkBudget& budget) const noexcept
{
    constexpr Level kObstacle = static_cast<Level>(AvoidanceRun::obstacles);
    constexpr Level kIntruder = static_cast<Level>(AvoidanceRun::intruders);
    constexpr Level kNoRoom = static_cast<Level>(AvoidanceRun::soft_constraints);
    const float radius = threat.growth.at(piece.end) - shrunk_at(threat.shrunk, piece.end) + piece.bulge;
    const Vec3& from = piece.from;
    const Vec3& to = piece.to;
    if (threat.is_cylinder) {
        return against_cylinder(threat, piece);
    }
    if (threat.shape != nullptr) {
        // Triangle inequality: no point between two points is nearer than half of (sum of both distances less their
        // separation).
        const float length = (to - from).norm() / static_cast<float>(kSolidPieces);
        float before = distance_to(threat, from);
        float least = kUnbounded;
        for (int i = 1; i <= kSolidPieces; ++i) {
            const float share = static_cast<float>(i) / static_cast<float>(kSolidPieces);
            const float after = distance_to(threat, Vec3(from + share * (to - from)));
            least = std::min(least, 0.5F * (before + after - length));
            before = after;
        }
        // The other way round what is not a number would be free.
        return !(least > radius) ? kObstacle : !(least > radius + rules_.clearance) ? kNoRoom : kFree;
    }
    if (radius + rules_.clearance < 0.0F) {
        return kFree;
    }
    const Vec3 first = threat.at(piece.start) - from;
    const Vec3 last = threat.at(piece.end) - to;
    if (geometry::quick_reject(threat.half, first, last, radius + rules_.clearance) == geometry::QuickReject::apart) {
        return kFree;
    }
    if (!(radius >= 0.0F)) {  // NaN blocks
        return radius < 0.0F ? kNoRoom : threat.is_track ? kIntruder : kObstacle;
    }
    const geometry::QuickReject quick_reject = geometry::quick_reject(threat.half, first, last, radius);
    // Without a budget for the exact test it counts as a contact.
    if (quick_reject == geometry::QuickReject::touches ||
        (quick_reject == geometry::QuickReject::unclear &&
         (!budget.spend(units::kReachContact) ||
          geometry::contact_interval(threat.half, {}, {first, last - first}, radius, 1.0F)))) {
        return threat.is_track ? kIntruder : kObstacle;
    }
    return kNoRoom;
}

Level NearThreats::in_airspace(const Vec3& to, Seconds end) const noexcept
{
    const bool inside =
        to.z() >= inside_.floor - shrunk_at(inside_.floor_shrunk, end) &&
        to.z() <= inside_.ceiling + shrunk_at(inside_.ceiling_shrunk, end) &&
        (to - inside_.home).head<2>().norm() <= inside_.keep_in + shrunk_at(inside_.keep_in_shrunk, end);
    return inside ? kFree : static_cast<Level>(AvoidanceRun::obstacles);
}

Level NearThreats::against(const ThreatBits& bits, const Piece& piece, WorkBudget& budget) const noexcept
{
    constexpr Level kBlocked = static_cast<Level>(AvoidanceRun::obstacles);
    constexpr Level kMet = static_cast<Level>(AvoidanceRun::intruders);
    Level level = in_airspace(piece.to, piece.end);
    for (std::size_t word = 0; word < ThreatBits::kWords; ++word) {
        for (std::uint32_t left = bits.words[word]; left != 0 && level > kMet; left &= left - 1) {
            const std::size_t i = word * 32 + static_cast<std::size_t>(std::countr_zero(left));
            const bool is_solid = near_[i].shape != nullptr || near_[i].is_cylinder;
            if (!budget.spend(is_solid ? units::kReachSolid : units::kReachCheck)) {
                return kBlocked;
            }
            level = std::min(level, against(near_[i], piece, budget));
        }
    }
    return level;
}

Level NearThreats::level(const Piece& piece, WorkBudget& budget) const noexcept
{
    return budget.spend(units::kReachNode) ? against(all_, piece, budget) : static_cast<Level>(AvoidanceRun::obstacles);
}

Level NearThreats::level(const Placed& placed, NodeIndex node, WorkBudget& budget) const noexcept
{
    const ReachSet& set = *placed.set;
    if (!budget.spend(units::kReachNode)) {
        return static_cast<Level>(AvoidanceRun::obstacles);
    }
    const NodeIndex parent = set.parent[node];
    const Seconds end = placed.time(node);
    const Vec3 to = placed.node(node);
    // At the root every threat may be near; the root has nine children at most.
    ThreatBits bits = parent == 0 ? all_ : of_cell_[set.end[parent]];
    std::uint32_t any = 0;
    for (std::size_t word = 0; word < ThreatBits::kWords; ++word) {
        bits.words[word] |= of_cell_[set.end[node]].words[word];
        any |= bits.words[word];
    }
    if (any == 0) {
        return in_airspace(to, end);
    }
    const Piece piece{placed.node(parent), to, end - placed.period, end, bulge_};
    return keep_near(piece, bits, budget) ? against(bits, piece, budget) : static_cast<Level>(AvoidanceRun::obstacles);
}

/// Removes the threats that a quick reject from the middle of the piece proves to be far. False when the budget is too
/// small.
bool NearThreats::keep_near(const Piece& piece, ThreatBits& bits, WorkBudget& budget) const noexcept
{
    const Vec3 middle = 0.5F * (piece.from + piece.to);
    const Seconds halfway = 0.5F * (piece.start + piece.end);
    std::uint32_t looks = 0;
    for (std::size_t word = 0; word < ThreatBits::kWords; ++word) {
        for (std::uint32_t left = bits.words[word]; left != 0; left &= left - 1) {
            const int bit = std::countr_zero(left);
            const NearThreat& threat = near_[word * 32 + static_cast<std::size_t>(bit)];
            ++looks;
            if (threat.shape != nullptr) {
                continue;
            }
            Vec3 apart = threat.at(halfway) - middle;
            apart.z() = threat.is_tall ? std::max(std::abs(apart.z()) - threat.half.z(), 0.0F) : apart.z();
            if (apart.squaredNorm() > threat.far * threat.far) {
                bits.words[word] &= ~(std::uint32_t{1} << static_cast<unsigned>(bit));
            }
        }
    }
    return budget.spend((looks + 2) / 3 * units::kReachQuickRejects);
}

}  // namespace jink::reach::detail
