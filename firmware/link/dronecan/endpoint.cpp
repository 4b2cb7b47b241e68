// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/dronecan/endpoint.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "firmware/link/track_ids.hpp"

namespace jink::link::dronecan {
namespace {

/// Heights that an int32 of millimetres holds, even as a difference of two [m].
constexpr float kLargestHeight = 1e6F;
/// Ranges in the body frame need an attitude no older than this [s].
constexpr Seconds kAttitudeFresh = 1.0F;
/// Of several nodes with the same data one is followed; after this silence another one replaces it [s].
constexpr Seconds kSourceSilence = 1.0F;
/// Stamps this far ahead of arrival still count as now [s].
constexpr Seconds kFutureSlack = 0.05F;
/// Assumed beam width of a sensor that does not give its own: half angle [rad].
constexpr float kDefaultHalfAngle = 0.1F;
constexpr float kMinFieldOfView = 1e-3F;
constexpr float kDegree = kPi / 180.0F;
/// Noise of a velocity with unknown vertical component, as on the MAVLink side [m/s].
constexpr float kUnknownClimb = 5.0F;
constexpr std::uint32_t kProximityBeams = 1U << 8U;  ///< separates their keys from the range finders' ids

template <class Range>
[[nodiscard]] bool all_finite(const Range& values) noexcept
{
    return std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); });
}

/// Standard deviation from the largest of three variances: 0 if a variance is missing or invalid.
[[nodiscard]] float sigma_of(const StaticVector<float, 36>& covariance, std::size_t first) noexcept
{
    // One number for all, six on the diagonal, the upper triangle, or the full matrix.
    constexpr std::array<std::size_t, 6> kTriangle{0, 6, 11, 15, 18, 20};
    float largest = 0.0F;
    for (std::size_t i = first; i < first + 3; ++i) {
        const std::size_t at = covariance.size() == 1    ? 0
                               : covariance.size() == 6  ? i
                               : covariance.size() == 21 ? kTriangle[i]
                               : covariance.size() == 36 ? 7 * i
                                                         : covariance.size();
        if (at >= covariance.size() || !std::isfinite(covariance[at]) || covariance[at] < 0.0F) {
            return 0.0F;
        }
        largest = std::max(largest, covariance[at]);
    }
    return std::sqrt(largest);
}

/// v rotated by the unit quaternion q = (x, y, z, w).
[[nodiscard]] Vec3 turn(const std::array<float, 4>& q, const Vec3& v) noexcept
{
    const Vec3 axis(q[0], q[1], q[2]);
    const Vec3 t = 2.0F * axis.cross(v);
    return v + q[3] * t + axis.cross(t);
}

/// Direction of a beam along the nose, rotated by pitch (up) and yaw (right) [rad]; body frame, FRD.
[[nodiscard]] Vec3 beam_of_angles(float pitch, float yaw) noexcept
{
    return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), -std::sin(pitch)};
}

}  // namespace

const Transfer* Endpoint::receive(const Frame& frame, TimePoint now, Inbox& inbox) noexcept
{
    ++diagnostics_.frames_in;
    const Transfer* const transfer = node_.receive(frame, now);
    if (transfer == nullptr) {
        return nullptr;
    }
    const Context c{*transfer, now, inbox};
    switch (transfer->type.id) {
    case Fix2::kType.id: on_fix(c); return nullptr;
    case AhrsSolution::kType.id: on_attitude(c); return nullptr;
    case TrafficReport::kType.id: on_traffic(c); return nullptr;
    case RangeMeasurement::kType.id: on_measurement(c); return nullptr;
    case Proximity::kType.id: on_proximity(c); return nullptr;
    default: return transfer;
    }
}

bool Endpoint::stamp_of(std::uint64_t wire, const Context& c, TimePoint& stamp) noexcept
{
    stamp = c.transfer.stamp;
    const std::optional<TimePoint> said = node_.time().to_local(wire, c.now);
    if (!options_.believe_stamps || wire == 0 || !said) {
        return true;
    }
    if (*said > c.now + kFutureSlack || c.now - *said > options_.max_stamp_age) {
        ++diagnostics_.stale_stamp;
        return false;
    }
    stamp = std::min(*said, c.now);
    return true;
}

bool Endpoint::follow(Source& source, const Context& c, bool& changed) noexcept
{
    const std::uint8_t node = c.transfer.source;
    if (source.node != kAnonymous && source.node != node && c.now - source.heard <= kSourceSilence) {
        ++diagnostics_.frames_ignored;
        return false;
    }
    changed = source.node != kAnonymous && source.node != node;
    source = {node, c.now};
    return true;
}

void Endpoint::on_fix(const Context& c) noexcept
{
    Fix2 m;
    if (!node_.decode(c.transfer, m)) {
        return;
    }
    if (!all_finite(m.velocity)) {
        ++diagnostics_.not_finite;
        return;
    }
    constexpr std::int64_t kTenth = 10;  // 1e-8 degrees to 1e-7: a centimetre
    constexpr std::int64_t kLargest = 18'000'000'000;
    const bool in_range = std::abs(m.latitude) <= kLargest / 2 && std::abs(m.longitude) <= kLargest;
    mavlink::GlobalPosition where;
    if (in_range) {
        where = {static_cast<std::int32_t>(m.latitude / kTenth), static_cast<std::int32_t>(m.longitude / kTenth),
                 m.height_msl};
    }
    const Vec3 velocity = mavlink::swap_ned_enu({m.velocity[0], m.velocity[1], m.velocity[2]});
    if (m.status != Fix2::Status::fix_3d || !in_range || std::abs(where.lat) > mavlink::kHighestLatitude ||
        velocity.norm() > kLargestSpeed) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (!options_.has_origin && !options_.first_fix_is_origin) {
        ++diagnostics_.no_origin;
        return;
    }
    TimePoint stamp;
    if (!stamp_of(m.stamp, c, stamp)) {
        return;
    }
    const Vec3 position = options_.has_origin ? mavlink::to_local(where, options_.origin) : Vec3(Vec3::Zero());
    if (position.norm() > kLargestPosition) {
        ++diagnostics_.out_of_range;
        return;
    }
    bool changed = false;
    if (!follow(fix_from_, c, changed)) {
        return;
    }
    if (!options_.has_origin) {  // this fix itself becomes the origin
        options_.origin = where;
        options_.has_origin = true;
    }
    own_.stamp = stamp;
    own_.position = position;
    own_.velocity = velocity;
    own_.sigma_position = sigma_of(m.covariance, 0);
    own_.sigma_velocity = sigma_of(m.covariance, 3);
    c.inbox.bus_state.state = own_;
    c.inbox.bus_state.has_yaw = has_attitude_ && c.now - attitude_heard_ <= kAttitudeFresh;
    c.inbox.bus_state.estimator_reset = c.inbox.bus_state.estimator_reset || changed;
    c.inbox.has_bus_state = true;
}

void Endpoint::on_attitude(const Context& c) noexcept
{
    AhrsSolution m;
    if (!node_.decode(c.transfer, m)) {
        return;
    }
    std::array<float, 4> q = m.orientation;
    if (!all_finite(q)) {
        ++diagnostics_.not_finite;
        return;
    }
    const float norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(norm2 > 0.9F && norm2 < 1.1F)) {
        ++diagnostics_.out_of_range;
        return;
    }
    TimePoint stamp;
    if (!stamp_of(m.stamp, c, stamp)) {
        return;
    }
    bool changed = false;
    if (!follow(attitude_from_, c, changed)) {
        return;
    }
    for (float& x : q) {
        x /= std::sqrt(norm2);
    }
    attitude_ = q;
    has_attitude_ = true;
    attitude_heard_ = stamp;
    const Vec3 nose = turn(q, Vec3::UnitX());
    own_.yaw = mavlink::swap_heading_yaw(std::atan2(nose.y(), nose.x()));
}

void Endpoint::on_traffic(const Context& c) noexcept
{
    TrafficReport m;
    if (!node_.decode(c.transfer, m)) {
        return;
    }
    const bool moves = m.velocity_valid && m.traffic_type != TrafficReport::kPointObstacle;
    if (!std::isfinite(m.altitude) || (moves && !all_finite(m.velocity))) {
        ++diagnostics_.not_finite;
        return;
    }
    if (!m.position_valid || std::abs(m.altitude) > kLargestHeight ||
        !mavlink::is_on_earth({m.latitude, m.longitude, 0})) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (!options_.has_origin) {
        ++diagnostics_.no_origin;
        return;
    }
    TrackReport report;
    report.id = track_of_address(m.icao);
    report.stamp = c.transfer.stamp - static_cast<Seconds>(m.tslc);
    const auto height = static_cast<std::int32_t>(std::lround(m.altitude * 1e3F));
    report.position = mavlink::to_local({m.latitude, m.longitude, height}, options_.origin);
    if (m.altitude_type != TrafficReport::kGeometricAltitude) {
        ++diagnostics_.pressure_heights;
        report.height = HeightSource::pressure;
    }
    report.at_rest = m.traffic_type == TrafficReport::kPointObstacle;
    report.unmanned = m.traffic_type == TrafficReport::kUnmanned;
    report.has_velocity = report.at_rest || moves;
    if (moves) {
        report.velocity = mavlink::swap_ned_enu({m.velocity[0], m.velocity[1], m.velocity[2]});
        report.velocity.z() = m.vertical_velocity_valid ? report.velocity.z() : 0.0F;
        report.sigma_velocity = m.vertical_velocity_valid ? 0.0F : kUnknownClimb;
    }
    if (!c.inbox.tracks.try_push_back(report)) {
        ++diagnostics_.inbox_full;
    }
}

void Endpoint::on_measurement(const Context& c) noexcept
{
    RangeMeasurement m;
    if (!node_.decode(c.transfer, m)) {
        return;
    }
    using Reading = RangeMeasurement::Reading;
    const bool known = m.reading == Reading::valid || m.reading == Reading::too_close || m.reading == Reading::too_far;
    if (!m.orientation_defined || !known || (m.reading == Reading::valid && m.range < 0.0F)) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (!std::isfinite(m.field_of_view) || (m.reading == Reading::valid && !std::isfinite(m.range))) {
        ++diagnostics_.not_finite;
        return;
    }
    const float said = std::isfinite(m.range) && m.range > 0.0F ? m.range : 0.0F;
    RangeReading reading;
    if (!stamp_of(m.stamp, c, reading.stamp)) {
        return;
    }
    reading.range = m.reading == Reading::too_far ? RangeScan::kNothing : said;
    reading.max_range = said;
    reading.half_angle =
        m.field_of_view >= kMinFieldOfView ? std::min(0.5F * m.field_of_view, 0.5F * kPi) : kDefaultHalfAngle;
    constexpr float kStep = kPi / 15.0F;  // CoarseOrientation.ANGLE_MULTIPLIER = 4.7746: 15 steps are half a turn
    const Vec3 body = beam_of_angles(static_cast<float>(m.roll_pitch_yaw[1]) * kStep,
                                     static_cast<float>(m.roll_pitch_yaw[2]) * kStep);
    constexpr int kHalf = 16;  // of five bits
    const auto beam = static_cast<std::uint32_t>((m.roll_pitch_yaw[1] + kHalf) * 64 + m.roll_pitch_yaw[2] + kHalf);
    place(c, reading, body, static_cast<std::uint32_t>(m.sensor) << 12U | beam);
}

void Endpoint::on_proximity(const Context& c) noexcept
{
    Proximity m;
    if (!node_.decode(c.transfer, m)) {
        return;
    }
    if (!std::isfinite(m.yaw) || !std::isfinite(m.pitch) || !std::isfinite(m.distance)) {
        ++diagnostics_.not_finite;
        return;
    }
    if (m.reading != Proximity::Reading::good || m.distance < 0.0F || std::abs(m.yaw) > 360.0F ||
        std::abs(m.pitch) > 90.0F) {
        ++diagnostics_.out_of_range;
        return;
    }
    RangeReading reading;
    reading.stamp = c.transfer.stamp;
    reading.range = m.distance;
    reading.max_range = m.distance;
    reading.half_angle = kDefaultHalfAngle;
    const Vec3 body = beam_of_angles(m.pitch * kDegree, m.yaw * kDegree);
    // Steps of 15 degrees in both angles.
    constexpr float kSteps = 12.0F / kPi;
    const auto yaw = static_cast<std::uint32_t>(std::lround(std::atan2(body.y(), body.x()) * kSteps) + 12) % 24U;
    const auto pitch =
        static_cast<std::uint32_t>(std::lround(std::asin(std::clamp(-body.z(), -1.0F, 1.0F)) * kSteps) + 6);
    place(c, reading, body, (m.sensor | kProximityBeams) << 12U | pitch << 6U | yaw);
}

void Endpoint::place(const Context& c, RangeReading& reading, const Vec3& body, std::uint32_t beam) noexcept
{
    if (!has_attitude_ || c.now - attitude_heard_ > kAttitudeFresh) {
        ++diagnostics_.no_origin;
        return;
    }
    // Two nodes may use the same sensor id.
    const std::uint32_t key = static_cast<std::uint32_t>(c.transfer.source) << 24U | beam;
    reading.sensor = static_cast<std::uint8_t>(kFirstBeam + beams_.of(key, c.now));
    diagnostics_.sensors_evicted = beams_.evicted();
    reading.direction = mavlink::swap_ned_enu(turn(attitude_, body));
    if (!c.inbox.readings.try_push_back(reading)) {
        ++diagnostics_.inbox_full;
    }
}

}  // namespace jink::link::dronecan
