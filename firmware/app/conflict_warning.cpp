// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/conflict_warning.hpp"

#include <array>
#include <cmath>

#include "firmware/app/method_orders.hpp"

namespace jink::app {
namespace {

/// Ids of warnings of closed areas, beside those of scans (0x01000000) and readings (0x02000000), and of tracks
/// (firmware/link/track_ids.hpp).
constexpr std::uint32_t kCylinderIds = 0x04000000;

}  // namespace

link::CollisionWarning warning_of(const avoid::Guidance& guidance, const Picture& picture,
                                  const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                  bool in_control, const world::Manoeuvre* flying) noexcept
{
    const world::Conflict& c = *guidance.conflict;
    const Vec3 miss = c.threat_at_closest - c.own_at_closest;
    const bool is_track = c.threat.kind == world::ThreatKind::track;
    const bool is_cylinder = c.threat.kind == world::ThreatKind::cylinder;
    link::CollisionWarning warning;
    warning.id = is_track      ? picture.track_table().id_in_snapshot(c.threat.index)
                 : is_cylinder ? kCylinderIds + c.threat.index
                               : picture.obstacles()[c.threat.index].id;
    warning.time_to_closest = c.time_to_closest;
    warning.horizontal_miss = miss.head<2>().norm();
    warning.vertical_miss = std::abs(miss.z());
    warning.action = link::CollisionAction::report;
    if (in_control) {
        const bool vertical = flying != nullptr && std::abs(flying->side.z()) > 0.7F;
        warning.action = guidance.kind == world::ManoeuvreKind::brake ? link::CollisionAction::hover
                         : vertical                                   ? link::CollisionAction::ascend_or_descend
                                                                      : link::CollisionAction::move_horizontally;
    }
    const bool near = c.time_to_loss <= vehicle::stopping_time(own.velocity.norm(), limits) + 1.0F ||
                      guidance.alert >= world::Alert::medium;
    warning.level = near ? link::ThreatLevel::high : link::ThreatLevel::low;
    return warning;
}

Text text_of(const avoid::Guidance& guidance) noexcept
{
    const world::Conflict& conflict = *guidance.conflict;
    const bool is_track = conflict.threat.kind == world::ThreatKind::track;
    const bool is_cylinder = conflict.threat.kind == world::ThreatKind::cylinder;
    Text text;
    text << (guidance.by == avoid::kGivesWay ? "jink: giving way, aircraft too near in "
             : is_track                      ? "jink: conflict, traffic in "
             : is_cylinder                   ? "jink: conflict, closed area in "
                                             : "jink: conflict, obstacle in ")
         << conflict.time_to_loss << " s";
    return text;
}

Text text_of_alert(world::Alert alert) noexcept
{
    constexpr std::array<std::string_view, 4> kMeaning{"well clear will be lost", "near mid-air ahead",
                                                       "well clear is lost", "near mid-air"};
    const auto level = static_cast<std::uint32_t>(alert);
    Text text;
    text << "jink: aircraft " << level << "/4, " << kMeaning[level - 1];
    return text;
}

Text text_of_choice(const avoid::Guidance& guidance) noexcept
{
    Text text;
    text << "jink: by " << method_name(guidance.by);
    if (guidance.answers > 1) {
        text << ", best of " << static_cast<std::uint32_t>(guidance.answers) << ", costs " << guidance.cost << " s";
    }
    return text;
}

}  // namespace jink::app
