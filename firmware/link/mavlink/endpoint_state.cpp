// SPDX-License-Identifier: BSD-3-Clause
// Own state, origin and home. Mission and leg: endpoint_mission.cpp.
#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/angle.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"

namespace jink::link::mavlink {
namespace {

constexpr std::uint8_t kFrameBodyNed = 8;
/// LOCAL_POSITION_NED is ignored while ODOMETRY, which holds more, is younger than this [s]. Well below OWN_AGE: it has
/// to take over before the own state counts as stale.
constexpr Seconds kOdometryFresh = 0.2F;
/// Own global and local position this close in time give an origin [s].
constexpr Seconds kPairAge = 0.2F;
/// Ranges in the body frame need a heading no older than this [s].
constexpr Seconds kYawFresh = 1.0F;
/// Angles on the wire lie within a full turn either way [rad].
constexpr float kLargestAngle = 2.0F * kPi;
/// An origin from own positions that differs by more replaces the known one [m].
constexpr float kOriginMoved = 5.0F;

bool plausible(const Vec3& position, const Vec3& velocity) noexcept
{
    return position.norm() <= kLargestPosition && velocity.norm() <= kLargestSpeed;
}

/// Standard deviation from the first three variances of an upper triangle of 6 x 6; 0 if not given.
float sigma_of(const std::array<float, 21>& covariance) noexcept
{
    const float largest = std::max({covariance[0], covariance[6], covariance[11]});
    return std::isfinite(covariance[0]) && std::isfinite(largest) && largest > 0.0F ? std::sqrt(largest) : 0.0F;
}

/// q scaled to length 1: the wire rounds, and `turn` would stretch the vector.
std::array<float, 4> normalised(const std::array<float, 4>& q) noexcept
{
    const float scale = 1.0F / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    return {scale * q[0], scale * q[1], scale * q[2], scale * q[3]};
}

/// v rotated by the unit quaternion q = (w, x, y, z).
Vec3 turn(const std::array<float, 4>& q, const Vec3& v) noexcept
{
    const Vec3 axis(q[1], q[2], q[3]);
    const Vec3 t = 2.0F * axis.cross(v);
    return v + q[0] * t + axis.cross(t);
}

// Euler angles of a unit quaternion from FRD to NED; z-y-x, as in ATTITUDE [rad].
float heading_of(const std::array<float, 4>& q) noexcept
{
    return direction_angle(2.0F * (q[0] * q[3] + q[1] * q[2]), 1.0F - 2.0F * (q[2] * q[2] + q[3] * q[3]));
}
float pitch_of(const std::array<float, 4>& q) noexcept
{
    const float sine = std::clamp(2.0F * (q[0] * q[2] - q[3] * q[1]), -1.0F, 1.0F);
    return direction_angle(sine, std::sqrt((1.0F - sine) * (1.0F + sine)));
}
float roll_of(const std::array<float, 4>& q) noexcept
{
    return direction_angle(2.0F * (q[0] * q[1] + q[2] * q[3]), 1.0F - 2.0F * (q[1] * q[1] + q[2] * q[2]));
}

bool is_unit(const std::array<float, 4>& q) noexcept
{
    const float norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return norm2 > 0.9F && norm2 < 1.1F;
}

}  // namespace

void Endpoint::deliver_own_state(Inbox& inbox, TimePoint stamp) noexcept
{
    own_.stamp = stamp;
    const bool reset = inbox.own_state.estimator_reset;
    inbox.own_state.state = own_;
    inbox.own_state.has_yaw = knows_yaw(stamp);
    inbox.own_state.estimator_reset = reset;
    inbox.has_own_state = true;
}

void Endpoint::on_local_position(const Context& c) noexcept
{
    LocalPositionNed m;
    static_cast<void>(decode(c.frame, m));
    const Vec3 position = swap_ned_enu({m.x, m.y, m.z});
    const Vec3 velocity = swap_ned_enu({m.vx, m.vy, m.vz});
    if (!is_finite(position) || !is_finite(velocity)) {
        ++diagnostics_.not_finite;
        return;
    }
    if (!plausible(position, velocity)) {
        ++diagnostics_.out_of_range;
        return;
    }
    TimePoint stamp;
    if (!stamp_of(clock_.extend(m.time_boot_ms, c.now.us), c.now, stamp)) {
        return;
    }
    if (has_odometry_ && c.now - last_odometry_ < kOdometryFresh) {
        ++diagnostics_.frames_ignored;
        return;
    }
    own_.position = position;
    own_.velocity = velocity;
    own_.sigma_position = own_.sigma_velocity = 0.0F;
    has_local_ = has_local_boot_ = true;
    local_boot_ms_ = m.time_boot_ms;
    local_heard_ = c.now;
    deliver_own_state(c.inbox, stamp);
}

void Endpoint::on_attitude(const Context& c) noexcept
{
    AttitudeQuaternion m;
    static_cast<void>(decode(c.frame, m));
    const std::array<float, 4> q{m.q1, m.q2, m.q3, m.q4};
    if (!std::all_of(q.begin(), q.end(), [](float x) { return std::isfinite(x); })) {
        ++diagnostics_.not_finite;
        return;
    }
    if (!is_unit(q)) {
        ++diagnostics_.out_of_range;
        return;
    }
    const std::array<float, 4> unit = normalised(q);
    note_attitude(roll_of(unit), pitch_of(unit), heading_of(unit), c.now);
}

void Endpoint::on_euler_attitude(const Context& c) noexcept
{
    Attitude m;
    static_cast<void>(decode(c.frame, m));
    if (!std::isfinite(m.yaw) || !std::isfinite(m.roll) || !std::isfinite(m.pitch)) {
        ++diagnostics_.not_finite;
        return;
    }
    if (std::abs(m.yaw) > kLargestAngle || std::abs(m.roll) > kLargestAngle || std::abs(m.pitch) > kLargestAngle) {
        ++diagnostics_.out_of_range;
        return;
    }
    note_attitude(m.roll, m.pitch, m.yaw, c.now);
}

void Endpoint::note_attitude(float roll, float pitch, float heading, TimePoint now) noexcept
{
    roll_ = roll;
    pitch_ = pitch;
    own_.yaw = swap_heading_yaw(heading);
    has_yaw_ = true;
    yaw_heard_ = now;
}

bool Endpoint::knows_yaw(TimePoint now) const noexcept { return has_yaw_ && now - yaw_heard_ <= kYawFresh; }

void Endpoint::on_odometry(const Context& c) noexcept
{
    Odometry m;
    static_cast<void>(decode(c.frame, m));
    const Vec3 ned(m.x, m.y, m.z);
    Vec3 velocity(m.vx, m.vy, m.vz);
    if (!is_finite(ned) || !is_finite(velocity) ||
        !std::all_of(m.q.begin(), m.q.end(), [](float x) { return std::isfinite(x); })) {
        ++diagnostics_.not_finite;
        return;
    }
    const bool in_body = m.child_frame_id == kFrameBodyFrd || m.child_frame_id == kFrameBodyNed;
    if (m.frame_id != kFrameLocalNed || (!in_body && m.child_frame_id != kFrameLocalNed) || !is_unit(m.q) ||
        !plausible(ned, velocity)) {
        ++diagnostics_.out_of_range;
        return;
    }
    // The stamp may be on the boot clock or since 1970. Only the first can be mapped; the other counts as just arrived.
    constexpr std::uint64_t kSince1970 = 1'000'000'000'000'000ULL;
    TimePoint stamp = c.now;
    if (m.time_usec < kSince1970 && !stamp_of(static_cast<std::int64_t>(m.time_usec), c.now, stamp)) {
        return;
    }
    const std::array<float, 4> q = normalised(m.q);
    velocity = in_body ? turn(q, velocity) : velocity;
    const bool reset = has_odometry_ && m.reset_counter != reset_counter_;
    reset_counter_ = m.reset_counter;
    has_odometry_ = true;
    last_odometry_ = c.now;
    own_.position = swap_ned_enu(ned);
    own_.velocity = swap_ned_enu(velocity);
    note_attitude(roll_of(q), pitch_of(q), heading_of(q), c.now);
    own_.sigma_position = sigma_of(m.pose_covariance);
    own_.sigma_velocity = sigma_of(m.velocity_covariance);
    has_local_ = true;
    has_local_boot_ = m.time_usec < kSince1970;
    local_boot_ms_ = static_cast<std::uint32_t>(m.time_usec / 1000);
    local_heard_ = c.now;
    // The local frame has jumped: the leg starts at the vehicle's position in the new frame.
    has_anchor_ = has_anchor_ && !reset;
    has_former_ = has_former_ && !reset;
    c.inbox.own_state.estimator_reset = c.inbox.own_state.estimator_reset || reset;
    deliver_own_state(c.inbox, stamp);
}

void Endpoint::set_origin(const std::optional<GlobalPosition>& origin, int rank, Inbox& inbox) noexcept
{
    if (!origin || !is_on_earth(*origin) || std::abs(origin->lat) > kHighestLatitude) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (rank < origin_rank_) {
        return;
    }
    if (origin_rank_ > 0 && *origin != origin_) {
        const Vec3 by = to_local(origin_, *origin);
        for (TrackReport& track : inbox.tracks) {
            track.position += by;
        }
    }
    origin_ = *origin;
    origin_rank_ = rank;
    place_home(inbox);
}

void Endpoint::place_home(Inbox& inbox) noexcept
{
    const Vec3 local = to_local(home_on_globe_, origin_);
    has_home_ = has_home_on_globe_ && origin_rank_ > 0 && local.norm() <= kLargestPosition;
    if (has_home_) {
        home_ = local;
        inbox.home = local;
        inbox.has_home = true;
    }
}

void Endpoint::on_global_position(const Context& c) noexcept
{
    GlobalPositionInt m;
    static_cast<void>(decode(c.frame, m));
    const GlobalPosition own{m.lat, m.lon, m.alt};
    // One clock stamps both; the difference of two 32-bit stamps is right across their wrap.
    const auto ahead_ms = static_cast<std::int32_t>(m.time_boot_ms - local_boot_ms_);
    const Seconds ahead = static_cast<float>(ahead_ms) * 1e-3F;
    const bool is_pair =
        has_local_ && has_local_boot_ && c.now - local_heard_ <= kPairAge && std::abs(ahead) <= kPairAge;
    if (origin_rank_ > 1 || !is_pair) {
        return;
    }
    if (!is_on_earth(own) || (m.lat == 0 && m.lon == 0)) {
        ++diagnostics_.out_of_range;
        return;
    }
    const Vec3 position = own_.position + own_.velocity * ahead;
    if (origin_rank_ == 0 || (to_local(own, origin_) - position).norm() > kOriginMoved) {
        set_origin(to_global(-position, own), 1, c.inbox);
    }
}

void Endpoint::on_origin(const Context& c) noexcept
{
    GpsGlobalOrigin m;
    static_cast<void>(decode(c.frame, m));
    set_origin(GlobalPosition{m.latitude, m.longitude, m.altitude}, 2, c.inbox);
}

void Endpoint::on_home(const Context& c) noexcept
{
    HomePosition m;
    static_cast<void>(decode(c.frame, m));
    const GlobalPosition home{m.latitude, m.longitude, m.altitude};
    if (!is_on_earth(home) || (m.latitude == 0 && m.longitude == 0)) {
        ++diagnostics_.out_of_range;
        return;
    }
    home_on_globe_ = home;
    has_home_on_globe_ = true;
    place_home(c.inbox);
    diagnostics_.out_of_range += origin_rank_ > 0 && !has_home_ ? 1U : 0U;
}

}  // namespace jink::link::mavlink
