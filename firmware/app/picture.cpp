// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/picture.hpp"

#include <algorithm>

#include "firmware/app/clouds.hpp"
#include "firmware/app/range_obstacles.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/app/track_intake.hpp"
#include "firmware/link/mavlink/geodesy.hpp"

namespace jink::app {

void Picture::use_clouds(Clouds& clouds, link::Link& link) noexcept
{
    clouds_ = &clouds;
    clouds.give_to(obstacles_);
    link.report_points_to(clouds.link_points());
}

void Picture::forward_clouds_to(link::CloudSink& sink) noexcept
{
    if (clouds_ != nullptr) {
        clouds_->forward_to(sink);
    }
}

void Picture::show_scans_in(ReachPicture& picture) noexcept
{
    scans_shown_ = &picture;
    forward_clouds_to(picture);
}

void Picture::forget_measured() noexcept
{
    obstacles_.clear();
    ground_.reset();
}

void Picture::forget_places() noexcept
{
    tracks_.clear();
    forget_measured();
}

/// Tracks that were dropped instead of moved would be missing until their next report. The link has placed or moved
/// what the inbox holds already.
void Picture::follow_origin(const std::optional<link::GlobalPosition>& origin) noexcept
{
    if (placed_by_ && origin && *placed_by_ != *origin) {
        ++counts_.origin_changes;
        const Vec3 by = link::mavlink::to_local(*placed_by_, *origin);
        if (by.norm() <= link::mavlink::kMapReach) {
            tracks_.move(by);
        } else {
            counts_.tracks_not_moved += static_cast<std::uint32_t>(tracks_.size());
            tracks_.clear();
        }
    }
    placed_by_ = origin ? origin : placed_by_;
}

void Picture::take_home(const link::Inbox& inbox) noexcept
{
    if (inbox.has_home) {
        home_ = inbox.home;
    }
}

void Picture::take_tracks(const link::Inbox& inbox, const OwnState& own, const Configuration& c, TimePoint now) noexcept
{
    for (const link::TrackReport& report : inbox.tracks) {
        if (is_own_transponder(report, c)) {
            ++counts_.own_heard;
            continue;
        }
        ++counts_.tracks_in;
        // Each refusal is counted in the table.
        static_cast<void>(tracks_.update(measurement_of(report, c), own.measured(), now));
    }
    tracks_.expire(now);
}

void Picture::take_ranges(const link::Inbox& inbox, const OwnState& own, const Configuration& c, TimePoint now) noexcept
{
    obstacles_.expire(now);
    if (!own.is_known()) {
        return;
    }
    // Where the vehicle was when the sensor saw it.
    const auto seen_from = [&](TimePoint arrival) { return own.place_at(arrival - c.scan_latency, c.own_age); };
    for (const link::RangeScan& scan : inbox.scans) {
        ++counts_.scans;
        place_scan(scan, seen_from(scan.stamp), c, obstacles_);
    }
    for (const link::RangeReading& reading : inbox.readings) {
        ++counts_.readings;
        const Vec3 place = seen_from(reading.stamp);
        if (!sees_ground(reading)) {
            counts_.readings_refused += place_reading(reading, place, c, obstacles_) ? 0U : 1U;
        } else {
            take_ground(reading, place, c);
        }
    }
}

/// Of several sensors the highest ground counts, while it is new; one that sees nothing knows nothing of what is beyond
/// its reach.
void Picture::take_ground(const link::RangeReading& reading, const Vec3& place, const Configuration& c) noexcept
{
    const bool sees = reading.range != link::RangeScan::kNothing;
    const float height = place.z() + reading.direction.z() * (sees ? reading.range : reading.max_range);
    const bool other = ground_ && ground_->sensor != reading.sensor && reading.stamp <= ground_->expires;
    if (other && (sees ? height < ground_->height : height >= ground_->height)) {
        return;
    }
    ground_.reset();
    if (sees) {
        ground_ = {height, reading.stamp + c.scan_keep, reading.sensor};
    }
}

void Picture::take_clouds(const OwnState& own, bool has_autopilot, const Configuration& c, TimePoint now) noexcept
{
    if (clouds_ == nullptr) {
        return;
    }
    const world::Airspace air = airspace(has_autopilot, c, now);
    const vehicle::VehicleState& state = own.measured();
    const CloudView view{own.is_known() && own.is_yaw_known(),
                         state.stamp,
                         state.position,
                         state.velocity,
                         state.yaw,
                         c.own_age,
                         c.scan_keep,
                         c.limits.half_extents,
                         air.has_floor,
                         air.floor,
                         c.limits.max_acceleration};
    if (scans_shown_ != nullptr) {
        scans_shown_->look_from(view);
        scans_shown_->picture().block_unseen(c.blocks_unseen);
    }
    clouds_->serve(now, view);
}

void Picture::take_constraints(const link::Inbox& inbox, const OwnState& own, link::Link& link, TimePoint now) noexcept
{
    for (const link::ConstraintPart& part : inbox.constraints) {
        const link::ConstraintResult result = constraint_upload_.take(part, now);
        if (constraint_upload_.is_new()) {
            set_constraints(constraint_upload_.set(), link.origin(), own.measured().position, now);
            constraint_upload_.mark_in_force();
        }
        link.acknowledge(part, result);
    }
}

void Picture::place_map(const std::optional<link::GlobalPosition>& origin, const OwnState& own, bool has_autopilot,
                        const Configuration& c, TimePoint now) noexcept
{
    if (!has_autopilot || !own.is_known()) {
        map_.leave_out();
        return;
    }
    map_.append_to(obstacles_, origin, own.at(now, c.own_age), c);
    counts_.map_coarse += map_.is_coarse() ? 1U : 0U;
}

world::Airspace Picture::airspace(bool has_autopilot, const Configuration& c, TimePoint now) const noexcept
{
    world::Airspace air;
    const bool sees_ground = c.floor_on && ground_ && now <= ground_->expires;
    air.has_floor = c.floor_on && (has_autopilot || sees_ground);
    air.has_ceiling = c.ceiling_on && has_autopilot;
    air.has_keep_in = c.keep_in_on && has_autopilot;
    air.floor = home_.z() + c.floor;
    air.ceiling = home_.z() + c.ceiling;
    air.home = home_;
    air.keep_in_radius = c.keep_in;
    if (sees_ground) {
        const float ground = ground_->height + std::max(c.floor, 0.0F);
        air.floor = has_autopilot ? std::max(air.floor, ground) : ground;
    }
    // Closed areas are placed in the autopilot's frame: in a bus's own frame there are none.
    air.cylinders = has_autopilot ? constraints_.cylinders() : std::span<const world::Cylinder>();
    return air;
}

}  // namespace jink::app
