// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor does with what it hears: the inbox into own state, tracks, obstacles, parameters.
#include <algorithm>
#include <cmath>

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/echo.hpp"

namespace jink::app {
namespace {

/// Own state may be stamped this far ahead of our clock before it is refused [s].
constexpr Seconds kFutureSlack = 0.05F;
/// Velocity noise given to what stands still [m/s].
constexpr float kRestSigma = 0.02F;
/// Sine of the elevation: what is steeper downwards is the ground; what is steeper upwards, a ceiling; what is flatter,
/// level.
constexpr float kDownwards = -0.7F;
constexpr float kUpwards = 0.98F;
constexpr float kLevel = 0.02F;

constexpr std::uint32_t kScanIds = 0x01000000;
constexpr std::uint32_t kReadingIds = 0x02000000;

/// Whether what is heard takes its share in avoiding us. Who says that he will not, and what stands, does not.
bool is_cooperative(const link::TrackReport& report, const Configuration& c) noexcept
{
    if (report.at_rest || report.helpless) {
        return false;
    }
    switch (report.source) {
    case world::TrackSource::datalink: return c.coop_systems;
    case world::TrackSource::utm: return c.coop_utm;
    case world::TrackSource::adsb: return c.coop_all || (c.coop_unmanned && report.unmanned);
    case world::TrackSource::own_sensor: break;
    }
    return false;
}

/// Uncertainty of a height, all that counts as possible of it [m].
float half_height_of(const link::TrackReport& report, const Configuration& c) noexcept
{
    switch (report.height) {
    case link::HeightSource::pressure: return c.k_sigma * c.sigma_baro;
    case link::HeightSource::compared: return report.height_spread + c.k_sigma * c.sigma_compared;
    case link::HeightSource::geometric: break;
    }
    return report.height_spread;
}

}  // namespace

void Coprocessor::take_own_state(TimePoint now) noexcept
{
    if (!inbox_.has_own_state) {
        return;
    }
    const vehicle::VehicleState& heard = inbox_.own_state.state;
    if (heard.stamp > now + kFutureSlack || (has_autopilot_own_ && heard.stamp < autopilot_own_)) {
        ++diagnostics_.own_state_refused;
        return;
    }
    if (inbox_.own_state.estimator_reset && has_own_) {
        // The local frame has jumped: paths and places in it mean nothing any more.
        ++diagnostics_.estimator_resets;
        forget_places();
    }
    use_own(inbox_.own_state, OwnSource::autopilot);
    autopilot_own_ = heard.stamp;
    has_autopilot_own_ = true;
    ++diagnostics_.own_states;
}

void Coprocessor::take_autopilot(TimePoint now) noexcept
{
    static_cast<void>(now);
    new_autopilot_report_ = inbox_.has_autopilot;
    earlier_reports_ = inbox_.earlier_autopilot;
    if (!inbox_.has_autopilot) {
        return;
    }
    autopilot_ = inbox_.autopilot;
    has_autopilot_ = true;
    if (autopilot_.rebooted) {
        ++diagnostics_.autopilot_reboots;
        say(link::Severity::warning,
            takeover_.in_control() ? "jink: autopilot restarted, control dropped" : "jink: autopilot restarted");
        takeover_.drop(false);
        forget_places();
        has_own_ = has_autopilot_own_ = has_leg_ = false;
        home_ = Vec3::Zero();  // that of the frame before lies anywhere in the new one
    }
}

void Coprocessor::take_tracks(TimePoint now) noexcept
{
    const Configuration& c = parameters_.configuration();
    for (const link::TrackReport& report : inbox_.tracks) {
        const bool transponder = report.source == world::TrackSource::adsb;
        if (transponder && c.own_address != 0 && report.id == c.own_address) {
            ++diagnostics_.own_heard;
            continue;
        }
        world::TrackMeasurement m;
        m.id = report.id;
        m.stamp = report.stamp - c.track_latency;
        m.position = report.position;
        m.source = report.source;
        m.cooperative = is_cooperative(report, c);
        m.sigma_position = report.sigma_position > 0.0F ? report.sigma_position : c.track_sigma_position;
        m.half_height = half_height_of(report, c);
        if (report.at_rest) {
            m.has_velocity = true;
            m.sigma_velocity = kRestSigma;
            m.radius = report.radius > 0.0F ? report.radius : c.point_radius;
        } else {
            m.velocity = report.velocity;
            m.has_velocity = report.has_velocity;
            m.sigma_velocity = report.sigma_velocity > 0.0F ? report.sigma_velocity : c.track_sigma_velocity;
            m.radius = report.radius > 0.0F ? report.radius : c.track_radius;
            m.max_acceleration = c.track_acceleration;
        }
        ++diagnostics_.tracks_in;
        static_cast<void>(tracks_.update(m, own_, now));  // each refusal is counted there
    }
    tracks_.expire(now);
}

/// Each refusal is counted in the table.
void Coprocessor::place(std::uint32_t id, const geometry::Shape& shape, TimePoint expires) noexcept
{
    static_cast<void>(obstacles_.update({id, shape}, expires, own_.position));
}

/// A level beam about `yaw`, in as many parts as its width asks for, under the ids from `first` on.
void Coprocessor::place_level(std::uint32_t first, float yaw, float range, float half_angle, TimePoint expires) noexcept
{
    const std::size_t parts = echo_parts(half_angle);
    const float part = half_angle / static_cast<float>(parts);
    for (std::size_t k = 0; k < parts; ++k) {
        const float aside = static_cast<float>(2 * k + 1) * part - half_angle;
        place(first + static_cast<std::uint32_t>(k),
              level_echo(own_.position, yaw + aside, range, part, parameters_.configuration().scan_height), expires);
    }
}

void Coprocessor::remove_obstacles(std::uint32_t first, std::size_t n) noexcept
{
    for (std::size_t k = 0; k < n; ++k) {
        static_cast<void>(obstacles_.remove(first + static_cast<std::uint32_t>(k)));
    }
}

void Coprocessor::take_scan(TimePoint now) noexcept
{
    obstacles_.expire(now);
    if (!inbox_.has_scan || !has_own_) {
        return;
    }
    ++diagnostics_.scans;
    const link::RangeScan& scan = inbox_.scan;
    const TimePoint expires = scan.stamp + parameters_.configuration().scan_keep;
    const float half_angle = std::min(0.5F * std::abs(scan.increment), 0.5F * kPi);
    const std::size_t parts = echo_parts(half_angle);
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        // 72 narrow sectors, or fewer wide ones in parts: at most 72 ids either way.
        const std::uint32_t first = kScanIds + scan.sensor * 256U + static_cast<std::uint32_t>(i * parts);
        const float range = scan.ranges[i];
        if (range == link::RangeScan::kNothing) {
            remove_obstacles(first, parts);
        } else if (range >= 0.0F) {
            place_level(first, scan.yaw_first + scan.increment * static_cast<float>(i), range, half_angle, expires);
        }
    }
}

/// A beam that is not quite vertical sees a ceiling as low as its lowest edge, and as far aside.
geometry::Shape Coprocessor::overhead_echo(const link::RangeReading& reading) const noexcept
{
    const float edge = std::acos(std::min(reading.direction.z(), 1.0F)) + reading.half_angle;
    const float height = reading.range * std::cos(edge);
    const float aside = std::max(parameters_.configuration().scan_height, reading.range * std::sin(edge));
    return ceiling_echo(own_.position, height, 0.0F, aside);
}

void Coprocessor::take_reading(const link::RangeReading& reading) noexcept
{
    const TimePoint expires = reading.stamp + parameters_.configuration().scan_keep;
    const std::uint32_t first = kReadingIds + reading.sensor * 32U;
    static_assert(kMaxEchoParts <= 32);
    const bool nothing = reading.range == link::RangeScan::kNothing;
    const float steepness = reading.direction.z();
    if (steepness < kDownwards) {
        has_ground_ = !nothing;
        ground_ = own_.position.z() + steepness * reading.range;
        ground_expires_ = expires;
    } else if (nothing) {
        remove_obstacles(first, kMaxEchoParts);
    } else if (std::abs(steepness) <= kLevel) {
        const float yaw = std::atan2(reading.direction.y(), reading.direction.x());
        place_level(first, yaw, reading.range, std::min(reading.half_angle, 0.5F * kPi), expires);
    } else if (reading.half_angle > kWidestSteep) {
        ++diagnostics_.readings_refused;
    } else if (steepness > kUpwards) {
        place(first, overhead_echo(reading), expires);
    } else {
        place(first, slanted_echo(own_.position, reading.direction, reading.range, reading.half_angle), expires);
    }
}

void Coprocessor::take_readings() noexcept
{
    for (const link::RangeReading& reading : inbox_.readings) {
        if (!has_own_) {
            return;
        }
        ++diagnostics_.readings;
        take_reading(reading);
    }
}

void Coprocessor::take_params() noexcept
{
    const auto& table = param_table();
    const auto answer = [&](std::size_t index) {
        link::ParamName name{};
        std::copy(table[index].name.begin(), table[index].name.end(), name.begin());
        link_.send_param(name, parameters_.values()[index], static_cast<std::uint16_t>(index),
                         static_cast<std::uint16_t>(kParamCount));
    };
    for (const link::ParamRequest& request : inbox_.params) {
        if (request.kind == link::ParamRequestKind::list) {
            param_listing_ = true;
            param_cursor_ = 0;
            continue;
        }
        const std::size_t index = request.kind == link::ParamRequestKind::read_by_index
                                      ? (request.index >= 0 ? static_cast<std::size_t>(request.index) : kParamCount)
                                      : Parameters::find({request.name.data(), request.name.size()});
        if (index >= kParamCount) {
            ++diagnostics_.params_unknown;
            continue;
        }
        if (request.kind == link::ParamRequestKind::set) {
            const bool taken =
                request.value_finite && parameters_.set(static_cast<Param>(index), request.value) == ParamStatus::ok;
            ++(taken ? diagnostics_.params_set : diagnostics_.params_refused);
        }
        answer(index);  // a refused set is answered with the value that stands
    }
    apply_configuration();
    // A list goes out a few at a time, so that it never fills the transmit buffer.
    constexpr std::uint16_t kPerStep = 3;
    for (std::uint16_t i = 0; param_listing_ && i < kPerStep; ++i) {
        answer(param_cursor_++);
        param_listing_ = param_cursor_ < kParamCount;
    }
}

void Coprocessor::take_commands() noexcept
{
    constexpr std::uint16_t kRequestMessage = 512;
    constexpr float kHeartbeat = 0.0F;
    for (const link::CommandRequest& request : inbox_.commands) {
        ++diagnostics_.commands;
        link::CommandResult result = link::CommandResult::unsupported;
        if (request.command == kRequestMessage) {
            const bool known = request.params[0] == kHeartbeat;
            result = known ? link::CommandResult::accepted : link::CommandResult::denied;
            heartbeat_sent_ = heartbeat_sent_ && !known;
        }
        diagnostics_.commands_refused += result == link::CommandResult::accepted ? 0U : 1U;
        link_.acknowledge(request, result);
    }
}

void Coprocessor::take_constraints(TimePoint now) noexcept
{
    for (const link::ConstraintPart& part : inbox_.constraints) {
        const link::ConstraintResult result = constraint_upload_.take(part, now);
        if (constraint_upload_.is_new()) {
            set_constraints(constraint_upload_.set(), now);
            constraint_upload_.mark_in_force();
        }
        link_.acknowledge(part, result);
    }
}

void Coprocessor::take_inbox(TimePoint now) noexcept
{
    take_autopilot(now);
    take_own_state(now);
    take_bus_state(now);
    if (inbox_.has_home) {
        home_ = inbox_.home;
    }
    if (inbox_.leg_lost) {
        // Better the own motion than a leg that is flown no more.
        diagnostics_.legs_dropped += has_leg_ ? 1U : 0U;
        has_leg_ = false;
    }
    if (inbox_.has_leg) {
        leg_ = inbox_.leg.leg;
        has_leg_ = true;
    }
    mode_denied_ = std::any_of(inbox_.mode_answers.begin(), inbox_.mode_answers.end(),
                               [](const link::ModeAnswer& a) { return !a.accepted; });
    mode_accepted_ = std::any_of(inbox_.mode_answers.begin(), inbox_.mode_answers.end(),
                                 [](const link::ModeAnswer& a) { return a.accepted; });
    sticks_moved_ = stick_watch_.update(inbox_.has_sticks ? &inbox_.sticks : nullptr, takeover_.streaming(),
                                        parameters_.configuration().sticks);
    take_tracks(now);
    take_scan(now);
    take_readings();
    take_clouds(now);
    take_params();
    take_commands();
    take_constraints(now);
    inbox_.clear();
}

}  // namespace jink::app
