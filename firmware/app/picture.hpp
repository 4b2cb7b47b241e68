// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/world/obstacle_table.hpp"
#include "core/world/track_table.hpp"
#include "firmware/app/constraint_upload.hpp"
#include "firmware/app/constraints.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/known_map.hpp"
#include "firmware/app/own_state.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/link/link.hpp"

namespace jink::app {

class Clouds;
class ReachPicture;

/// What is known around the vehicle, in the local frame: tracks, obstacles, closed areas, a map, ground and home.
///
/// Tracks are known by their place on the globe: where the frame's origin turns out to lie elsewhere, they are moved.
class Picture {
public:
    Picture(const world::TrackTableSettings& tracks, Diagnostics& counts) noexcept : counts_(counts), tracks_(tracks) {}

    /// Point clouds become obstacles from now on. They outlive this.
    void use_clouds(Clouds& clouds, link::Link& link) noexcept;
    /// One more consumer of the scans; no effect before use_clouds(). It outlives this.
    void forward_clouds_to(link::CloudSink& sink) noexcept;
    /// The scans show the reach sets what is seen. After use_clouds(); it outlives this.
    void show_scans_in(ReachPicture& picture) noexcept;
    /// Its pieces become obstacles from now on. Good (geometry::check), before the first step; it outlives this.
    void use_map(const geometry::MeshMap& map) noexcept { map_.use(map, obstacles_); }
    void configure(const world::TrackTableSettings& tracks) noexcept { tracks_.configure(tracks); }
    void set_constraints(std::span<const Constraint> constraints, const std::optional<link::GlobalPosition>& origin,
                         const Vec3& own, TimePoint now) noexcept
    {
        constraints_.tell(constraints, origin, own, now);
    }

    /// The own place has jumped within the frame: what was measured from it no longer holds.
    void forget_measured() noexcept;
    /// The frame in which places were known is gone.
    void forget_places() noexcept;
    /// The autopilot has restarted: its home before lies anywhere in the new frame.
    void forget_home() noexcept { home_ = Vec3::Zero(); }
    void follow_origin(const std::optional<link::GlobalPosition>& origin) noexcept;

    // In each step, in this order.
    void take_home(const link::Inbox& inbox) noexcept;
    void take_tracks(const link::Inbox& inbox, const OwnState& own, const Configuration& c, TimePoint now) noexcept;
    void take_ranges(const link::Inbox& inbox, const OwnState& own, const Configuration& c, TimePoint now) noexcept;
    /// @param has_autopilot  there is a home that bounds refer to
    void take_clouds(const OwnState& own, bool has_autopilot, const Configuration& c, TimePoint now) noexcept;
    void take_constraints(const link::Inbox& inbox, const OwnState& own, link::Link& link, TimePoint now) noexcept;
    void place_constraints(const std::optional<link::GlobalPosition>& origin, TimePoint now) noexcept
    {
        constraints_.place(origin, now);
    }
    /// The pieces of the map about the vehicle follow the obstacles that are sensed, until the next step.
    /// @param has_autopilot  the map is placed in its frame: without one there is no map
    void place_map(const std::optional<link::GlobalPosition>& origin, const OwnState& own, bool has_autopilot,
                   const Configuration& c, TimePoint now) noexcept;

    /// Valid until the next call.
    [[nodiscard]] std::span<const world::Track> tracks(TimePoint now) noexcept { return tracks_.snapshot(now); }
    [[nodiscard]] std::span<const world::Obstacle> obstacles() const noexcept { return obstacles_.obstacles(); }
    /// Those that are not of the map.
    [[nodiscard]] std::span<const world::Obstacle> sensed() const noexcept { return obstacles_.own(); }
    /// Bounds and closed areas. Without an autopilot the ground seen is the only bound: there is no home.
    [[nodiscard]] world::Airspace airspace(bool has_autopilot, const Configuration& c, TimePoint now) const noexcept;
    /// Home in the local frame [m]; its origin until it was received.
    [[nodiscard]] const Vec3& home() const noexcept { return home_; }

    [[nodiscard]] const world::TrackTable& track_table() const noexcept { return tracks_; }
    [[nodiscard]] const world::ObstacleTable& obstacle_table() const noexcept { return obstacles_; }
    [[nodiscard]] const ConstraintTable& constraints() const noexcept { return constraints_; }
    [[nodiscard]] const KnownMap& known_map() const noexcept { return map_; }
    [[nodiscard]] const ConstraintUpload& constraint_upload() const noexcept { return constraint_upload_; }

private:
    /// Seen by a sensor that looks down.
    struct Ground {
        float height = 0.0F;  ///< [m]
        TimePoint expires;
        std::uint8_t sensor = 0;
    };

    void take_ground(const link::RangeReading& reading, const Vec3& place, const Configuration& c) noexcept;

    Diagnostics& counts_;
    world::TrackTable tracks_;
    world::ObstacleTable obstacles_;
    ConstraintTable constraints_;
    KnownMap map_;
    ConstraintUpload constraint_upload_;
    std::optional<link::GlobalPosition> placed_by_;  ///< the origin that places the tracks
    Vec3 home_ = Vec3::Zero();
    std::optional<Ground> ground_;
    Clouds* clouds_ = nullptr;
    ReachPicture* scans_shown_ = nullptr;
};

}  // namespace jink::app
