// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor says of a conflict.
#include <cmath>

#include "firmware/app/coprocessor.hpp"

namespace jink::app {
namespace {

/// Ids of warnings of closed areas, beside those of scans (0x01000000) and readings (0x02000000), and of tracks
/// (firmware/link/track_ids.hpp).
constexpr std::uint32_t kBarrelIds = 0x04000000;

}  // namespace

void Coprocessor::warn_of_conflict(TimePoint now, const StepReport& report) noexcept
{
    const avoid::Guidance& g = report.guidance;
    const world::Conflict& c = *g.conflict;
    const Vec3 miss = c.threat_at_closest - c.own_at_closest;
    const bool is_track = c.threat.kind == world::ThreatKind::track;
    const bool is_barrel = c.threat.kind == world::ThreatKind::barrel;
    link::CollisionWarning warning;
    warning.id = is_track    ? tracks_.id_in_snapshot(c.threat.index)
                 : is_barrel ? kBarrelIds + c.threat.index
                             : obstacles_.obstacles()[c.threat.index].id;
    warning.time_to_closest = c.time_to_closest;
    warning.horizontal_miss = miss.head<2>().norm();
    warning.vertical_miss = std::abs(miss.z());
    warning.action = link::CollisionAction::report;
    if (takeover_.in_control()) {
        const world::Manoeuvre* flying = supervisor_.flying();
        const bool vertical = flying != nullptr && std::abs(flying->side.z()) > 0.7F;
        warning.action = g.kind == world::ManoeuvreKind::brake ? link::CollisionAction::hover
                         : vertical                            ? link::CollisionAction::ascend_or_descend
                                                               : link::CollisionAction::move_horizontally;
    }
    const bool near =
        c.time_to_loss <= vehicle::stopping_time(own_.velocity.norm(), parameters_.configuration().limits) + 1.0F;
    warning.level = near ? link::ThreatLevel::high : link::ThreatLevel::low;
    link_.send_collision(warning);
    last_collision_ = now;
    if (!told_conflict_) {
        Text text;
        text << (is_track    ? "jink: conflict, traffic in "
                 : is_barrel ? "jink: conflict, closed area in "
                             : "jink: conflict, obstacle in ")
             << c.time_to_loss << " s";
        say(link::Severity::warning, text.view());
    }
}

}  // namespace jink::app
