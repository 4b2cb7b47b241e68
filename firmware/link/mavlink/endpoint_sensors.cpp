// SPDX-License-Identifier: BSD-3-Clause
// Range sensors, and requests of other systems.
#include <algorithm>
#include <cmath>

#include "firmware/link/mavlink/constraint_message.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint16_t kUnknownDistance = 65535;
constexpr float kCentimetre = 0.01F;
constexpr float kDegree = kPi / 180.0F;
/// Assumed beam width of a range finder that does not give its own: half angle [rad].
constexpr float kDefaultHalfAngle = 0.1F;
/// Ids of the readings of ArduPilot's proximity library: eight level sectors, and one upwards.
constexpr std::uint8_t kFirstProximityId = 10;
constexpr std::uint8_t kLastProximityId = 19;
/// A sector of that library: half angle [rad].
constexpr float kProximityHalfAngle = kPi / 8.0F;
/// Types of sensors that one component may have scans of; MAVLink names five.
constexpr std::uint16_t kSensorTypes = 64;
static_assert(256 * kSensorTypes == RangeScan::kMaxScanSensors);
/// A field of view below this counts as not given [rad].
constexpr float kMinFieldOfView = 1e-3F;

}  // namespace

void Endpoint::dispatch_sensors(const Context& c) noexcept
{
    const bool same_system = c.frame.header.system_id == system_;
    switch (c.frame.message_id) {
    case AdsbVehicle::kInfo.id:
        // Other vehicles' autopilots relay the traffic that they receive, and that includes us.
        if (same_system || c.frame.header.component_id != kAutopilotComponent) {
            diagnostics_.traffic_relayed += same_system ? 0U : 1U;
            on_adsb(c);
            return;
        }
        break;
    case UtmGlobalPosition::kInfo.id:
        if (c.frame.header.system_id != 0) {
            on_utm(c);
            return;
        }
        break;
    case GlobalPositionInt::kInfo.id:
        if (!same_system && c.frame.header.component_id == kAutopilotComponent && c.frame.header.system_id != 0) {
            on_neighbour(c);
            return;
        }
        break;
    case ObstacleDistance::kInfo.id:
        if (same_system) {
            on_obstacle_distance(c);
            return;
        }
        break;
    case DistanceSensor::kInfo.id:
        if (same_system) {
            on_distance_sensor(c);
            return;
        }
        break;
    case ObstacleDistance3d::kInfo.id:
        if (same_system && points_to_ != nullptr) {
            on_point(c);
            return;
        }
        break;
    default: dispatch_requests(c); return;
    }
    ++diagnostics_.frames_ignored;
}

void Endpoint::on_obstacle_distance(const Context& c) noexcept
{
    ObstacleDistance m;
    static_cast<void>(decode(c.frame, m));
    if (!std::isfinite(m.increment_f) || !std::isfinite(m.angle_offset)) {
        ++diagnostics_.not_finite;
        return;
    }
    const float increment = m.increment_f != 0.0F ? m.increment_f : static_cast<float>(m.increment);
    const bool known_frame = m.frame == kFrameGlobal || m.frame == kFrameLocalNed || m.frame == kFrameBodyFrd;
    // Sectors below a degree would leave most of the circle unseen; sectors above 180 degrees give no direction.
    if (!known_frame || std::abs(increment) < 0.5F || std::abs(increment) > 180.0F ||
        std::abs(m.angle_offset) > 360.0F || m.max_distance == 0 || m.min_distance > m.max_distance ||
        m.sensor_type >= kSensorTypes) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (m.frame == kFrameBodyFrd && !knows_yaw(c.now)) {
        ++diagnostics_.no_origin;
        return;
    }
    auto& scans = c.inbox.scans;
    const auto sensor = static_cast<std::uint16_t>(c.frame.header.component_id * kSensorTypes + m.sensor_type);
    const auto same = std::find_if(scans.begin(), scans.end(), [&](const RangeScan& s) { return s.sensor == sensor; });
    const bool is_new = same == scans.end();
    if (!is_new || scans.size() == scans.capacity()) {  // the newer of a sensor replaces its former
        ++diagnostics_.inbox_full;
    }
    if (is_new && !scans.try_push_back({})) {
        return;
    }
    RangeScan& scan = is_new ? scans.back() : *same;
    scan.stamp = c.now;
    scan.sensor = sensor;
    scan.min_range = static_cast<float>(m.min_distance) * kCentimetre;
    scan.max_range = static_cast<float>(m.max_distance) * kCentimetre;
    scan.increment = -increment * kDegree;
    const float forward = m.frame == kFrameBodyFrd ? own_.yaw : 0.5F * kPi;
    scan.yaw_first = forward - m.angle_offset * kDegree;
    scan.ranges.clear();
    const auto sectors =
        std::min<std::size_t>(kMaxScanSectors, static_cast<std::size_t>(std::ceil(360.0F / std::abs(increment))));
    for (std::size_t i = 0; i < sectors; ++i) {
        const std::uint16_t d = m.distances[i];
        const float range = d == kUnknownDistance ? RangeScan::kUnknown
                            : d > m.max_distance  ? RangeScan::kNothing
                                                  : static_cast<float>(std::max(d, m.min_distance)) * kCentimetre;
        scan.ranges.unchecked_push_back(range);
    }
}

void Endpoint::on_distance_sensor(const Context& c) noexcept
{
    DistanceSensor m;
    static_cast<void>(decode(c.frame, m));
    constexpr std::uint8_t kUp = 24;
    constexpr std::uint8_t kDown = 25;
    constexpr std::uint8_t kInvalidSignal = 1;
    const bool level = m.orientation <= 7;
    // That library sends max_distance for a clear sector.
    const bool proximity = from_autopilot(c.frame) && autopilot_.stack == AutopilotStack::ardupilot &&
                           m.id >= kFirstProximityId && m.id <= kLastProximityId;
    if (!std::isfinite(m.horizontal_fov) || !std::isfinite(m.vertical_fov)) {
        ++diagnostics_.not_finite;
        return;
    }
    if ((!level && m.orientation != kUp && m.orientation != kDown) || m.max_distance == 0 ||
        m.min_distance > m.max_distance || m.signal_quality == kInvalidSignal) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (level && !knows_yaw(c.now)) {
        ++diagnostics_.no_origin;
        return;
    }
    RangeReading reading;
    reading.stamp = c.now;
    // Two components may use the same id, and one of them for sensors that look different ways.
    const std::uint32_t looks = level ? 0 : m.orientation;
    reading.sensor =
        range_sensors_.of(std::uint32_t{c.frame.header.component_id} << 16U | std::uint32_t{m.id} << 8U | looks, c.now);
    reading.max_range = static_cast<float>(m.max_distance) * kCentimetre;
    reading.range = m.current_distance > m.max_distance || (proximity && m.current_distance == m.max_distance)
                        ? RangeScan::kNothing
                        : static_cast<float>(std::max(m.current_distance, m.min_distance)) * kCentimetre;
    // For level beams the vertical width is irrelevant; straight up or down, the wider of both counts.
    const float fov = level ? m.horizontal_fov : std::max(m.horizontal_fov, m.vertical_fov);
    const float unsaid = proximity && level ? kProximityHalfAngle : kDefaultHalfAngle;
    reading.half_angle = fov >= kMinFieldOfView ? std::min(0.5F * fov, 0.5F * kPi) : unsaid;
    if (level) {
        const float yaw = own_.yaw - static_cast<float>(m.orientation) * 45.0F * kDegree;
        reading.direction = Vec3(std::cos(yaw), std::sin(yaw), 0.0F);
    } else {
        reading.direction = m.orientation == kUp ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
    }
    if (!c.inbox.readings.try_push_back(reading)) {
        ++diagnostics_.inbox_full;
    }
}

void Endpoint::dispatch_requests(const Context& c) noexcept
{
    switch (c.frame.message_id) {
    case CommandLong::kInfo.id: on_command(c); break;
    case ParamRequestRead::kInfo.id:
    case ParamRequestList::kInfo.id:
    case ParamSet::kInfo.id: on_param(c); break;
    case Tunnel::kInfo.id: on_tunnel(c); break;
    case SetupSigning::kInfo.id: on_setup_signing(c); break;
    case LoggingAck::kInfo.id: on_log_ack(c); break;
    default: ++diagnostics_.frames_ignored;
    }
}

/// Reports the pilot's sticks if they are known.
void Endpoint::on_sticks(const Context& c) noexcept
{
    SticksReport report;
    RcChannels radio;
    ManualControl joystick;
    if (decode(c.frame, radio)) {
        constexpr float kLowest = 800.0F, kHighest = 2200.0F, kCentre = 1500.0F, kHalfTravel = 500.0F;
        constexpr std::uint16_t kThrottleLost = 1000;
        const std::array<std::uint16_t, 4> raw{radio.chan1_raw, radio.chan2_raw, radio.chan3_raw, radio.chan4_raw};
        bool known = radio.chancount >= raw.size() && raw[2] >= kThrottleLost;
        for (std::size_t i = 0; i < raw.size(); ++i) {
            const auto width = static_cast<float>(raw[i]);
            known = known && width >= kLowest && width <= kHighest;
            report.sticks[i] = (width - kCentre) / kHalfTravel;
        }
        c.inbox.has_sticks = c.inbox.has_sticks || known;
        c.inbox.sticks = known ? report : c.inbox.sticks;
    } else if (decode(c.frame, joystick)) {
        constexpr float kFull = 1000.0F;
        const std::array<std::int16_t, 4> raw{joystick.x, joystick.y, joystick.z, joystick.r};
        bool known = true;
        for (std::size_t i = 0; i < raw.size(); ++i) {
            report.sticks[i] = static_cast<float>(raw[i]) / kFull;
            known = known && report.sticks[i] >= -1.0F && report.sticks[i] <= 1.0F;
        }
        report.from_radio = false;
        c.inbox.has_sticks = c.inbox.has_sticks || known;
        c.inbox.sticks = known ? report : c.inbox.sticks;
    }
}

void Endpoint::on_command(const Context& c) noexcept
{
    CommandLong m;
    static_cast<void>(decode(c.frame, m));
    if (!for_us(m.target_system, m.target_component)) {
        ++diagnostics_.frames_ignored;
        return;
    }
    const CommandRequest request{m.command,
                                 {m.param1, m.param2, m.param3, m.param4, m.param5, m.param6, m.param7},
                                 c.frame.header.system_id,
                                 c.frame.header.component_id};
    if (!c.inbox.commands.try_push_back(request)) {
        ++diagnostics_.inbox_full;
    }
}

void Endpoint::on_log_ack(const Context& c) noexcept
{
    LoggingAck m;
    static_cast<void>(decode(c.frame, m));
    if (!for_us(m.target_system, m.target_component)) {
        ++diagnostics_.frames_ignored;
        return;
    }
    if (!c.inbox.log_acks.try_push_back({m.sequence, c.frame.header.system_id, c.frame.header.component_id})) {
        ++diagnostics_.inbox_full;
    }
}

void Endpoint::on_tunnel(const Context& c) noexcept
{
    Tunnel m;
    static_cast<void>(decode(c.frame, m));
    if (!for_us(m.target_system, m.target_component) || m.payload_type != kConstraintPayload ||
        is_constraint_answer(m)) {
        ++diagnostics_.frames_ignored;
        return;
    }
    ConstraintPart part;
    const bool readable = read_constraint(m, c.now, part);
    part.from_system = c.frame.header.system_id;
    part.from_component = c.frame.header.component_id;
    if (!readable) {
        ++diagnostics_.out_of_range;
        acknowledge(part, ConstraintResult::malformed);
    } else if (!c.inbox.constraints.try_push_back(part)) {
        ++diagnostics_.inbox_full;  // no answer: the sender repeats an unanswered request
    }
}

void Endpoint::on_param(const Context& c) noexcept
{
    ParamRequest request;
    bool ours = false;
    ParamRequestList list;
    ParamRequestRead read;
    ParamSet set;
    if (decode(c.frame, list)) {
        // A list may be requested from every component at once.
        ours = for_us(list.target_system, list.target_component) ||
               (list.target_system == system_ && list.target_component == 0);
        request.kind = ParamRequestKind::list;
    } else if (decode(c.frame, read)) {
        ours = for_us(read.target_system, read.target_component);
        request.kind = read.param_index < 0 ? ParamRequestKind::read_by_name : ParamRequestKind::read_by_index;
        request.index = read.param_index;
        request.name = read.param_id;
    } else if (decode(c.frame, set)) {
        ours = for_us(set.target_system, set.target_component);
        request.kind = ParamRequestKind::set;
        request.name = set.param_id;
        // Another type may mean that the bits are those of an integer, so the value is unusable.
        request.value_finite = std::isfinite(set.param_value) && set.param_type == kReal32;
        request.value = request.value_finite ? set.param_value : 0.0F;
    }
    if (!ours) {
        ++diagnostics_.frames_ignored;
    } else if (!c.inbox.params.try_push_back(request)) {
        ++diagnostics_.inbox_full;
    }
}

}  // namespace jink::link::mavlink
