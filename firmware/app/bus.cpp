// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor does with a sensor bus: one frame of reference for both, whose own state counts, what the bus
// is told.
#include <algorithm>

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/near_field.hpp"
#include "firmware/link/geoid.hpp"
#include "firmware/link/mavlink/geodesy.hpp"

namespace jink::app {
namespace {

/// Own state may be stamped this far ahead of our clock before it is refused [s].
constexpr Seconds kFutureSlack = 0.05F;
/// Receivers of ArduPilot forget a Proximity after 0.5 s [s].
constexpr Seconds kNearPeriod = 0.2F;
/// A fix and an estimate farther apart than this, with what both say of their error on top, cannot both be right: a
/// receiver without corrections is within 10 m, twice that for height [m].
constexpr float kPlacesAgree = 30.0F;

}  // namespace

void Coprocessor::say(link::Severity severity, std::string_view text) noexcept
{
    link_.send_text(severity, text);
    if (bus_ != nullptr) {
        bus_->send_text(severity, text);
    }
}

void Coprocessor::read_bus(TimePoint now) noexcept
{
    if (bus_ != nullptr) {
        bus_->receive(now, inbox_);
        bus_was_up_ = bus_was_up_ || !bus_->is_lost();
    }
}

/// What is known by its place in a frame that is no more.
void Coprocessor::forget_places() noexcept
{
    supervisor_.reset();
    nominal_.reset();
    tracks_.clear();
    obstacles_.clear();
    has_ground_ = false;
}

/// Tracks are held in the local frame and were told by their place on the globe: where the origin between the two turns
/// out to lie elsewhere, they do too, and until their next report they would be looked for in the wrong place. Dropped,
/// they would be in none; so they are moved. What the inbox holds, the link has placed or moved already.
void Coprocessor::follow_origin() noexcept
{
    const std::optional<link::GlobalPosition> origin = link_.origin();
    if (placed_by_ && origin && *placed_by_ != *origin) {
        ++diagnostics_.origin_changes;
        const Vec3 by = link::mavlink::to_local(*placed_by_, *origin);
        if (by.norm() <= link::mavlink::kMapReach) {
            tracks_.move(by);
        } else {
            diagnostics_.tracks_not_moved += static_cast<std::uint32_t>(tracks_.size());
            tracks_.clear();
        }
    }
    placed_by_ = origin ? origin : placed_by_;
}

/// One frame for both: the autopilot's as soon as there is one. A place in another is worse than none. Geometric
/// heights of the bus hold both readings, as those of the link do.
///
/// @param bus_tracks  how many of the inbox's tracks came from the bus: they are the first
void Coprocessor::settle_frame(std::size_t bus_tracks) noexcept
{
    if (bus_ == nullptr || !(has_autopilot_ || inbox_.has_autopilot)) {
        return;
    }
    for (std::size_t i = 0; i < bus_tracks; ++i) {
        if (inbox_.tracks[i].height == link::HeightSource::geometric) {
            link::hold_both_readings(inbox_.tracks[i], link_.undulation());
        }
    }
    const bool rebooted = inbox_.has_autopilot && inbox_.autopilot.rebooted;
    const std::optional<link::GlobalPosition> origin = link_.origin();
    if (follows_origin_ && origin == origin_ && !rebooted) {
        return;
    }
    // What the bus told in this very step was placed before.
    diagnostics_.bus_reports_dropped += static_cast<std::uint32_t>(bus_tracks) + (inbox_.has_bus_state ? 1U : 0U);
    const auto first = inbox_.tracks.begin();
    std::copy(first + static_cast<std::ptrdiff_t>(bus_tracks), inbox_.tracks.end(), first);
    inbox_.tracks.resize(inbox_.tracks.size() - bus_tracks);
    inbox_.has_bus_state = false;
    if (own_source_ == OwnSource::bus) {
        has_own_ = false;
        own_source_ = OwnSource::none;
    }
    if (!follows_origin_) {
        forget_places();
        ++diagnostics_.frame_changes;
    }
    bus_->follow_origin(origin);
    follows_origin_ = true;
    origin_ = origin;
}

void Coprocessor::use_own(const link::OwnStateReport& report, OwnSource source) noexcept
{
    if (has_own_ && own_source_ != source) {
        supervisor_.reset();  // the place jumps by what the two differ
        nominal_.reset();
    }
    own_ = report.state;
    own_yaw_known_ = report.has_yaw;
    own_source_ = source;
    has_own_ = true;
}

/// The autopilot's own state is what set-points refer to: the bus's stands in for it where it is missing, and never
/// beside it.
void Coprocessor::take_bus_state(TimePoint now) noexcept
{
    if (!inbox_.has_bus_state) {
        return;
    }
    const vehicle::VehicleState& heard = inbox_.bus_state.state;
    if (heard.stamp > now + kFutureSlack || heard.stamp < bus_own_) {
        ++diagnostics_.bus_states_refused;
        return;
    }
    bus_own_ = heard.stamp;
    if (has_autopilot_own_ && now - autopilot_own_ <= parameters_.configuration().own_age) {
        ++diagnostics_.bus_states_beside;
        compare_places(heard);
        return;
    }
    if (has_own_ && own_source_ == OwnSource::bus && inbox_.bus_state.estimator_reset) {
        ++diagnostics_.estimator_resets;
        forget_places();
    }
    use_own(inbox_.bus_state, OwnSource::bus);
    ++diagnostics_.bus_states;
}

/// Where both are told of, they have to agree, or one of them (or the origin between them) is wrong. Which one cannot
/// be told, and traffic placed by a good origin is not given up for a bad receiver: so it is said and counted.
void Coprocessor::compare_places(const vehicle::VehicleState& fix) noexcept
{
    const vehicle::VehicleState own = own_at(fix.stamp);
    const float k = parameters_.configuration().k_sigma;
    const bool differ = (own.position - fix.position).norm() >
                        kPlacesAgree + k * (own.sigma_position + fix.sigma_position) + fix.velocity.norm();
    if (differ && !places_differ_) {
        ++diagnostics_.places_disagree;
        say(link::Severity::critical, "jink: CAN and autopilot differ on own place");
    }
    places_differ_ = differ;
}

void Coprocessor::tell_bus(TimePoint now, const StepReport& report) noexcept
{
    if (bus_ == nullptr) {
        return;
    }
    const bool alone =
        report.own_source == OwnSource::bus && !has_autopilot_ && parameters_.configuration().mode != ActMode::off;
    if (alone && !told_alone_) {
        say(link::Severity::warning, "jink: no autopilot heard, advising only");
    }
    told_alone_ = alone;
    bus_->service(now, {report.state, alone, report.faults});
    tell_near(now, report);
}

void Coprocessor::tell_near(TimePoint now, const StepReport& report) noexcept
{
    const Configuration& c = parameters_.configuration();
    if (passive_ || !c.tell_near || !own_yaw_known_ || report.own_source == OwnSource::none ||
        now - last_near_ < kNearPeriod) {
        return;
    }
    last_near_ = now;
    for (const link::NearObject& object :
         find_near(own_at(now), tracks_.snapshot(now), obstacles_.obstacles(), c.k_sigma)) {
        diagnostics_.near_told += bus_->send_near(object) ? 1U : 0U;
    }
}

}  // namespace jink::app
