// SPDX-License-Identifier: BSD-3-Clause
// Single points in space: OBSTACLE_DISTANCE_3D.
#include <cmath>

#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"

namespace jink::link::mavlink {
namespace {

/// Points of one scan follow one another within this time, as in ArduPilot [s].
constexpr Seconds kPointPause = 0.05F;
/// Scans that begin in one step. The end of a scan is costly, and senders may stamp each point or take turns.
constexpr std::uint8_t kMaxScansPerStep = 4;
/// A roll of 90 degrees a second moves a point at 20 m by 9 m in this time: older attitudes are not used [s].
constexpr Seconds kTiltFresh = 0.3F;
/// Largest age of the own position that makes points of the local frame relative; extrapolated from its stamp [s].
constexpr Seconds kPlaceFresh = 0.5F;

}  // namespace

void Endpoint::on_point(const Context& c) noexcept
{
    ObstacleDistance3d m;
    static_cast<void>(decode(c.frame, m));
    if (!is_finite({m.x, m.y, m.z}) || !std::isfinite(m.min_distance) || !std::isfinite(m.max_distance)) {
        ++diagnostics_.not_finite;
        return;
    }
    if ((m.frame != kFrameBodyFrd && m.frame != kFrameLocalNed) || m.max_distance <= 0.0F || m.min_distance < 0.0F ||
        m.min_distance > m.max_distance) {
        ++diagnostics_.out_of_range;
        return;
    }
    Vec3 point;
    if (!make_level(m, c.now, point)) {
        ++diagnostics_.no_origin;
        return;
    }
    const float distance = point.norm();
    if (!(distance > 0.0F) || !std::isfinite(distance)) {  // no direction in which it could lie
        ++diagnostics_.out_of_range;
        return;
    }
    follow_scan(m, c.now);
    if (distance > m.max_distance) {
        if (m.max_distance >= scan_max_range_) {
            points_to_->add(Ray::nothing, point / distance);
        }
    } else {
        points_to_->add(Ray::hit, point * (std::max(distance, m.min_distance) / distance));
    }
}

/// @param point  relative to the vehicle, in CloudSink's level frame [m]
/// False if attitude or own position are too old.
bool Endpoint::make_level(const ObstacleDistance3d& m, TimePoint now, Vec3& point) noexcept
{
    const Vec3 reported(m.x, m.y, m.z);
    if (m.frame == kFrameBodyFrd) {
        point = level_of_frd(roll_, pitch_) * reported;
        return has_yaw_ && now - yaw_heard_ <= kTiltFresh;
    }
    // Extrapolates the own position: the vehicle has moved since the stamp.
    const Vec3 own = own_.position + own_.velocity * (now - own_.stamp);
    const Vec3 offset = swap_ned_enu(reported) - own;
    const float c = std::cos(own_.yaw);
    const float s = std::sin(own_.yaw);
    point = Vec3(c * offset.x() + s * offset.y(), c * offset.y() - s * offset.x(), offset.z());
    return knows_yaw(now) && has_local_ && now - local_heard_ <= kPlaceFresh;
}

/// Opens the scan to which a point belongs, unless that scan is open already. Within a step (one `now`) a change of the
/// stamp continues the scan that began in it, and so does a change of the sensor after kMaxScansPerStep scans.
void Endpoint::follow_scan(const ObstacleDistance3d& m, TimePoint now) noexcept
{
    scans_in_step_ = now == last_point_ ? scans_in_step_ : std::uint8_t{0};
    const bool is_other = m.sensor_type != scan_sensor_;
    const bool may_begin = scans_in_step_ < (is_other ? kMaxScansPerStep : 1);
    if (is_scan_open_ && may_begin && (is_other || m.time_boot_ms != scan_boot_ms_)) {
        points_to_->end_scan(0);
        is_scan_open_ = false;
    }
    if (!is_scan_open_) {
        CloudScan scan;
        scan.stamp = now;  // the stamp is on the sender's clock, which may be that of any component
        scan.sensor = m.sensor_type;
        scan.max_range = m.max_distance;
        points_to_->begin_scan(scan);
        is_scan_open_ = true;
        ++scans_in_step_;
        scan_sensor_ = m.sensor_type;
        scan_max_range_ = m.max_distance;
    }
    scan_boot_ms_ = m.time_boot_ms;
    last_point_ = now;
}

void Endpoint::end_pausing_scan(TimePoint now) noexcept
{
    if (is_scan_open_ && now - last_point_ > kPointPause) {
        points_to_->end_scan(0);
        is_scan_open_ = false;
    }
}

}  // namespace jink::link::mavlink
