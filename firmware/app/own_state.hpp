// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>

#include "firmware/app/diagnostics.hpp"
#include "firmware/app/outbox.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/link/messages.hpp"

namespace jink::app {

/// What a new own state invalidates.
enum class Jump : std::uint8_t {
    none,
    source,    ///< own state comes from elsewhere: the place jumps by what the two differ
    estimate,  ///< the autopilot's estimator was reset: what was placed relative to the own place no longer holds;
               ///< traffic does, which reports its place on the globe, and the frame's origin stands
    frame,     ///< the local frame has jumped: no place known before holds
};

/// Own state, and whose. The autopilot's is what set-points refer to; the bus's stands in where the autopilot's is
/// missing or stale, and never beside it. O(1).
class OwnState {
public:
    explicit OwnState(Diagnostics& counts) noexcept : counts_(counts) {}

    [[nodiscard]] Jump take_autopilot(const link::OwnStateReport& report, TimePoint now) noexcept;
    /// A fix of the bus. While the autopilot's own state is fresh, the two are compared: a disagreement is said and
    /// counted, and changes nothing, because nobody knows which of them (or the origin between them) is wrong.
    /// @param max_age  of the autopilot's [s]
    [[nodiscard]] Jump take_bus(const link::OwnStateReport& report, Seconds max_age, float k_sigma, TimePoint now,
                                Outbox& outbox) noexcept;
    /// The autopilot has restarted.
    void forget() noexcept
    {
        source_ = OwnSource::none;
        autopilot_stamp_.reset();
        reset_refused_ = false;
    }
    /// The bus's frame has changed.
    void forget_bus() noexcept { source_ = source_ == OwnSource::bus ? OwnSource::none : source_; }

    [[nodiscard]] bool is_known() const noexcept { return source_ != OwnSource::none; }
    [[nodiscard]] bool is_fresh(TimePoint now, Seconds max_age) const noexcept
    {
        return is_known() && now - state_.stamp <= max_age;
    }
    [[nodiscard]] OwnSource source() const noexcept { return source_; }
    [[nodiscard]] bool is_yaw_known() const noexcept { return is_yaw_known_; }
    /// As measured last, also when it is no longer known.
    [[nodiscard]] const vehicle::VehicleState& measured() const noexcept { return state_; }
    /// The same carried forward to `now`, by `max_age` at most.
    [[nodiscard]] vehicle::VehicleState at(TimePoint now, Seconds max_age) const noexcept
    {
        vehicle::VehicleState own = state_;
        own.position += own.velocity * std::clamp(now - own.stamp, 0.0F, max_age);
        own.stamp = now;
        return own;
    }
    /// The place at `time`, up to `max_age` [s] before or after the newest report.
    [[nodiscard]] Vec3 place_at(TimePoint time, Seconds max_age) const noexcept;
    /// Of the autopilot's newest own state.
    [[nodiscard]] const std::optional<TimePoint>& autopilot_stamp() const noexcept { return autopilot_stamp_; }

private:
    [[nodiscard]] Jump use(const link::OwnStateReport& report, OwnSource source) noexcept;
    void compare(const vehicle::VehicleState& fix, Seconds max_age, float k_sigma, Outbox& outbox) noexcept;

    Diagnostics& counts_;
    vehicle::VehicleState state_;
    bool is_yaw_known_ = false;
    OwnSource source_ = OwnSource::none;
    std::optional<TimePoint> autopilot_stamp_;
    TimePoint bus_stamp_;
    bool reset_refused_ = false;      ///< the autopilot's report that said so was refused: the next one jumps
    bool bus_reset_refused_ = false;  ///< the bus's
    bool places_differ_ = false;
};

}  // namespace jink::app
