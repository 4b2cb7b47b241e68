// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/trajectory_generator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/base/finite.hpp"

namespace jink::path {
namespace {

constexpr float kEuler = 2.71828182845904523536F;
/// Segments and distances shorter than this have no direction [m].
constexpr float kNoLength = 1e-6F;

/// Curvature of the circle through three points (Menger): 4 area / product of sides [1/m]; 0 where two coincide.
float menger(const Vec3& a, const Vec3& b, const Vec3& c) noexcept
{
    const float sides = (b - a).norm() * (c - b).norm() * (c - a).norm();
    const float area = 0.5F * (b - a).cross(c - a).norm();
    return sides > kNoLength * kNoLength * kNoLength ? 4.0F * area / sides : 0.0F;
}

/// Where the segment from `from`, which lies within the sphere, to `to`, which does not, leaves it.
Vec3 leaving_point(const Vec3& from, const Vec3& to, const Vec3& centre, float radius) noexcept
{
    const Vec3 way = to - from;
    const Vec3 offset = from - centre;
    const float a = way.squaredNorm();
    const float b = way.dot(offset);
    const float c = std::min(0.0F, offset.squaredNorm() - radius * radius);
    const float root = std::sqrt(std::max(0.0F, b * b - a * c));
    // The larger root, in the form that does not cancel.
    const float t = b > 0.0F ? -c / (b + root) : (root - b) / a;
    return from + std::clamp(t, 0.0F, 1.0F) * way;
}

}  // namespace

bool is_valid(const GeneratorSettings& s) noexcept
{
    return is_not_negative(s.base) && is_not_negative(s.per_speed) && is_not_negative(s.per_error) &&
           is_not_negative(s.per_curvature) && is_positive(s.least) && is_positive(s.most) && s.most >= s.least &&
           is_not_negative(s.delay) && is_not_negative(s.lag) && is_positive(s.position_gain) && is_positive(s.small) &&
           is_positive(s.acceptance) && is_not_negative(s.acceptance_time) && is_positive(s.lost) &&
           is_not_negative(s.lost_time) && s.search >= 1 && is_positive(s.search_ahead) &&
           is_not_negative(s.turn_radius);
}

float stable_look_ahead(float speed, Seconds delay, Seconds lag) noexcept
{
    // e V T_d is more than 2 V T_d / pi.
    return std::max(kEuler * speed * delay, 4.0F * speed * lag);
}

bool TrajectoryGenerator::start(const Task& task, TimePoint now) noexcept
{
    if (path_.empty() || !is_positive(task.cruise_speed) || !is_not_negative(task.time_limit)) {
        return false;
    }
    task_ = task;
    status_ = GeneratorStatus::tracking;
    progress_ = 0;
    generation_ = path_.generation();
    started_ = now;
    last_step_ = now;
    is_near_end_ = false;
    is_off_ = false;
    return true;
}

void TrajectoryGenerator::reject() noexcept
{
    if (status_ == GeneratorStatus::idle) {
        status_ = GeneratorStatus::rejected;
    }
}

void TrajectoryGenerator::stop() noexcept
{
    path_.clear();
    status_ = GeneratorStatus::idle;
    progress_ = 0;
}

GeneratorOutput TrajectoryGenerator::step(const vehicle::VehicleState& own, TimePoint now, bool blocked) noexcept
{
    GeneratorOutput output;
    const Seconds period = now - last_step_;
    last_step_ = now;
    output.status = status_;
    if (status_ == GeneratorStatus::idle || status_ == GeneratorStatus::rejected) {
        return output;
    }
    if (path_.generation() != generation_) {  // another path, which no task has started
        status_ = GeneratorStatus::idle;
        output.status = status_;
        return output;
    }
    const Nearest nearest = find_nearest(own.position);
    output.nearest = nearest.point;
    output.error = (own.position - nearest.point).norm();
    output.curvature = curvature_at(nearest);
    const std::size_t end = path_.size() - 1;
    const Vec3& goal = path_.point(end).position;
    const float along = path_.along(nearest.segment) +
                        nearest.share * (path_.along(nearest.segment + 1) - path_.along(nearest.segment));
    // A path that ends where it begins is not done at its start.
    output.left = std::max(path_.along(end) - along, (goal - own.position).norm());

    const float deceleration = 0.5F * limits_.max_acceleration;
    const float cruise = std::min(
        {task_.cruise_speed, std::sqrt(2.0F * deceleration * output.left), settings_.position_gain * output.left});
    output.look_ahead = look_ahead(own.velocity.norm(), cruise, output.error, output.curvature);
    output.carrot =
        output.error > output.look_ahead ? nearest.point : find_carrot(nearest, own.position, output.look_ahead);
    progress_ = path_.advance(nearest.segment);
    status_ = judge(output, now, blocked);
    output.status = status_;
    if (status_ != GeneratorStatus::timed_out) {
        output.velocity = velocity_to(output.carrot - own.position, cruise);
        turn(own, period, output);
    }
    return output;
}

TrajectoryGenerator::Nearest TrajectoryGenerator::find_nearest(const Vec3& position) const noexcept
{
    Nearest nearest;
    float least = std::numeric_limits<float>::infinity();
    const std::size_t end = std::min<std::size_t>(path_.size() - 1, progress_ + settings_.search);
    float farthest = std::numeric_limits<float>::infinity();
    for (std::size_t i = progress_; i < end && path_.along(i) <= farthest; ++i) {
        const Vec3& from = path_.point(i).position;
        const Vec3 way = path_.point(i + 1).position - from;
        const float length = way.squaredNorm();
        const float share = length > 0.0F ? std::clamp(way.dot(position - from) / length, 0.0F, 1.0F) : 0.0F;
        const Vec3 point = from + share * way;
        if (i == progress_) {
            farthest = path_.along(i) + share * std::sqrt(length) + settings_.search_ahead;
        }
        const float distance = (position - point).squaredNorm();
        if (distance < least) {
            least = distance;
            nearest = {i, share, point};
        }
    }
    return nearest;
}

/// Of the points about the vertex that the nearest point is nearer to.
float TrajectoryGenerator::curvature_at(const Nearest& nearest) const noexcept
{
    const std::size_t vertex = nearest.share < 0.5F ? nearest.segment : nearest.segment + 1;
    if (path_.size() < 3) {
        return 0.0F;
    }
    const std::size_t middle = std::clamp<std::size_t>(vertex, 1, path_.size() - 2);
    return menger(path_.point(middle - 1).position, path_.point(middle).position, path_.point(middle + 1).position);
}

float TrajectoryGenerator::look_ahead(float speed, float cruise, float error, float curvature) const noexcept
{
    const float wanted = (settings_.base + settings_.per_speed * speed - settings_.per_error * error) /
                         (1.0F + settings_.per_curvature * curvature * settings_.most);
    // A vehicle that is about to fly at `cruise` needs what that needs. Stability before the upper bound.
    const float least =
        std::max(settings_.least, stable_look_ahead(std::max(speed, cruise), settings_.delay, settings_.lag));
    return std::clamp(wanted, least, std::max(settings_.most, least));
}

/// Where the path, from the nearest point on, first leaves the sphere about the vehicle.
Vec3 TrajectoryGenerator::find_carrot(const Nearest& nearest, const Vec3& position, float look_ahead) const noexcept
{
    const float reach = look_ahead * look_ahead;
    const std::size_t end = std::min<std::size_t>(path_.size() - 1, nearest.segment + settings_.search);
    Vec3 from = nearest.point;
    for (std::size_t i = nearest.segment; i < end; ++i) {
        const Vec3& to = path_.point(i + 1).position;
        if ((to - position).squaredNorm() > reach) {
            return leaving_point(from, to, position, look_ahead);
        }
        from = to;
    }
    return from;
}

Vec3 TrajectoryGenerator::velocity_to(const Vec3& way, float speed) const noexcept
{
    const float level = way.head<2>().norm();
    Vec3 velocity;
    if (level < settings_.small) {
        velocity = settings_.position_gain * way;
        const float fast = velocity.head<2>().norm();
        velocity.head<2>() *= fast > speed ? speed / fast : 1.0F;
        velocity.z() = std::clamp(velocity.z(), -limits_.max_descent, limits_.max_climb);
        return velocity;
    }
    velocity = way * (speed / level);
    const float bound = velocity.z() > 0.0F ? limits_.max_climb : limits_.max_descent;
    const float climb = std::abs(velocity.z());
    return climb > bound ? Vec3(velocity * (bound / climb)) : velocity;
}

GeneratorStatus TrajectoryGenerator::judge(const GeneratorOutput& output, TimePoint now, bool blocked) noexcept
{
    const bool at_end = path_.is_complete() && output.left < settings_.acceptance;
    near_end_since_ = at_end && !is_near_end_ ? now : near_end_since_;
    is_near_end_ = at_end;
    const bool off = output.error > settings_.lost;
    off_since_ = off && !is_off_ ? now : off_since_;
    is_off_ = off;
    // These two stay until the next task.
    if (status_ == GeneratorStatus::done || (at_end && now - near_end_since_ >= settings_.acceptance_time)) {
        return GeneratorStatus::done;
    }
    if (status_ == GeneratorStatus::timed_out || (task_.time_limit > 0.0F && now - started_ > task_.time_limit)) {
        return GeneratorStatus::timed_out;
    }
    if (off && now - off_since_ >= settings_.lost_time) {
        return GeneratorStatus::path_lost;
    }
    return blocked ? GeneratorStatus::blocked : GeneratorStatus::tracking;
}

/// (V, dphi): the carrot in the vehicle's frame, and the turn limit of G-ORCA 5.3 where there is one.
void TrajectoryGenerator::turn(const vehicle::VehicleState& own, Seconds period, GeneratorOutput& output) const noexcept
{
    output.speed = output.velocity.head<2>().norm();
    const Vec3 way = output.carrot - own.position;
    const float c = std::cos(own.yaw);
    const float s = std::sin(own.yaw);
    const float x = c * way.x() + s * way.y();
    const float y = c * way.y() - s * way.x();
    output.heading_change = std::hypot(x, y) > kNoLength ? std::atan2(y, x) : 0.0F;
    if (settings_.turn_radius > 0.0F) {
        constexpr float kMostTurn = 0.5F * kPi - 0.01F;
        const float most = std::min(output.speed * period / settings_.turn_radius, kMostTurn);
        output.heading_change = std::clamp(output.heading_change, -most, most);
    }
}

}  // namespace jink::path
