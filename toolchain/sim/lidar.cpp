// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

namespace jink::sim {
namespace {

namespace cloud = link::cloud;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kGravity = 9.80665;
constexpr double kNever = std::numeric_limits<double>::infinity();
/// Lead of the sensor's clock over the flight's [ms].
constexpr std::int64_t kClockAheadMs = 7000;
/// Least measurable range [m].
constexpr double kBlind = 0.1;

/// Part of a ray, by range [m]; empty when its end is below its begin.
struct Stretch {
    double begin = -kNever;
    double end = kNever;

    void cut(double from, double to) noexcept
    {
        begin = std::max(begin, from);
        end = std::min(end, to);
    }
    /// First range >= 0 in the part; negative: none.
    [[nodiscard]] double first() const noexcept { return begin > end || end < 0.0 ? -1.0 : std::max(0.0, begin); }
};

constexpr Stretch kNone{1.0, -1.0};

/// Between two planes across an axis, `half` from the middle.
Stretch between_planes(double gap, double along, double half) noexcept
{
    if (along == 0.0) {
        return std::abs(gap) <= half ? Stretch{} : kNone;
    }
    const double a = (gap - half) / along;
    const double b = (gap + half) / along;
    return {std::min(a, b), std::max(a, b)};
}

/// Within `radius` of a point, in N dimensions. `along` may be shorter than 1.
template <int N>
Stretch within(const Eigen::Matrix<double, N, 1>& gap, const Eigen::Matrix<double, N, 1>& along, double radius) noexcept
{
    const double a = along.squaredNorm();
    const double c = gap.squaredNorm() - radius * radius;
    if (a == 0.0) {
        return c <= 0.0 ? Stretch{} : kNone;
    }
    const double b = gap.dot(along);
    const double inside = b * b - a * c;
    if (inside < 0.0) {
        return kNone;
    }
    const double root = std::sqrt(inside);
    return {(b - root) / a, (b + root) / a};
}

double nearer(double a, double b) noexcept { return a < 0.0 || (b >= 0.0 && b < a) ? b : a; }

double range_to_upright(const Vec& gap, const Vec& along, double radius, double half_height) noexcept
{
    Stretch stretch = within<2>(gap.head<2>(), along.head<2>(), radius);
    const Stretch level = between_planes(gap.z(), along.z(), half_height);
    stretch.cut(level.begin, level.end);
    return stretch.first();
}

}  // namespace

double ray_range(const Threat& threat, const Vec& centre, const Vec& from, const Vec& direction) noexcept
{
    const Vec gap = centre - from;
    if (threat.form == Form::box) {
        Stretch stretch;
        for (const int axis : {0, 1, 2}) {
            const Stretch slab = between_planes(gap[axis], direction[axis], threat.half_extents[axis]);
            stretch.cut(slab.begin, slab.end);
        }
        return stretch.first();
    }
    if (threat.form == Form::cylinder) {
        return range_to_upright(gap, direction, threat.radius, threat.half_height);
    }
    if (threat.half_height == 0.0) {
        return within<3>(gap, direction, threat.radius).first();
    }
    const Vec up = Vec::UnitZ() * threat.half_height;
    const double caps = nearer(within<3>(gap + up, direction, threat.radius).first(),
                               within<3>(gap - up, direction, threat.radius).first());
    return nearer(range_to_upright(gap, direction, threat.radius, threat.half_height), caps);
}

Tilt tilt_of(const Truth& truth) noexcept
{
    const double c = std::cos(truth.yaw);
    const double s = std::sin(truth.yaw);
    const Vec& a = truth.acceleration;
    const double forward = c * a.x() + s * a.y();
    const double left = c * a.y() - s * a.x();
    const double up = std::max(0.1 * kGravity, a.z() + kGravity);
    return {std::atan2(-left, std::hypot(forward, up)), std::atan2(-forward, up)};
}

Eigen::Matrix3d platform_to_world(const Tilt& tilt, double yaw)
{
    using Axis = Eigen::AngleAxisd;
    return (Axis(yaw, Vec::UnitZ()) * Axis(-tilt.pitch, Vec::UnitY()) * Axis(tilt.roll, Vec::UnitX()))
        .toRotationMatrix();
}

std::vector<LidarRay> rays_of(const LidarSensor& sensor)
{
    // Slightly more than the quotient, so that a field of a whole number of pitches has all of them.
    constexpr double kRounding = 1e-9;
    const bool closes = sensor.level >= 360.0;
    const int columns = std::max(1, static_cast<int>(sensor.level / sensor.pitch + kRounding) + (closes ? 0 : 1));
    const int rows = std::max(1, static_cast<int>((sensor.up + sensor.down) / sensor.pitch + kRounding) + 1);
    const double pitch_level = closes ? 360.0 / columns : sensor.pitch;
    std::vector<LidarRay> rays;
    for (int row = 0; row < rows; ++row) {
        const double elevation = (-sensor.down + row * sensor.pitch) * kDegree;
        for (int column = 0; column < columns; ++column) {
            const double azimuth = (column - 0.5 * (columns - 1)) * pitch_level * kDegree;
            rays.push_back({azimuth, elevation,
                            Vec(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation))});
        }
    }
    return rays;
}

std::vector<double> true_ranges(const World& world, const LidarSensor& sensor, const std::vector<LidarRay>& rays,
                                std::vector<bool>* hit)
{
    const Scenario& scenario = world.scenario();
    const Vec& from = world.own().position;
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < scenario.threats.size(); ++i) {
        const Threat& threat = scenario.threats[i];
        if (threat.sensed_by == SensedBy::lidar && world.visible(i) &&
            surface_distance(threat, world.threat_position(i), from) <= sensor.range) {
            seen.push_back(i);
        }
    }
    const Eigen::Matrix3d turn = platform_to_world(tilt_of(world.own()), world.own().yaw);
    std::vector<double> ranges;
    ranges.reserve(rays.size());
    for (const LidarRay& ray : rays) {
        const Vec direction = turn * ray.direction;
        double nearest = -1.0;
        if (scenario.ground && direction.z() < 0.0) {
            nearest = std::max(0.0, (from.z() - *scenario.ground) / -direction.z());
        }
        std::optional<std::size_t> at;
        for (const std::size_t i : seen) {
            const double before = nearest;
            nearest = nearer(nearest, ray_range(scenario.threats[i], world.threat_position(i), from, direction));
            at = nearest != before ? i : at;
        }
        if (hit != nullptr && at && nearest <= sensor.range) {
            (*hit)[*at] = true;
        }
        ranges.push_back(nearest <= sensor.range ? nearest : -1.0);
    }
    return ranges;
}

Lidar::Lidar(const Scenario& scenario)
    : sensor_(*scenario.lidar), rays_(rays_of(sensor_)), reported_(scenario.threats.size(), -1.0),
      random_(scenario.seed * 1000003U + 999'983U)
{
}

void Lidar::step(const World& world)
{
    now_ = world.now();
    if (now_ >= next_) {
        measure(world);
        next_ += to_micros(1.0 / sensor_.rate);
    }
}

void Lidar::measure(const World& world)
{
    std::vector<bool> hit(reported_.size(), false);
    const std::vector<double> ranges = true_ranges(world, sensor_, rays_, &hit);
    for (std::size_t i = 0; i < hit.size(); ++i) {
        if (hit[i] && reported_[i] < 0.0) {
            reported_[i] = to_seconds(now_) + sensor_.latency;
        }
    }
    std::vector<cloud::RawPoint> points;
    points.reserve(rays_.size());
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        cloud::RawPoint point;
        point.azimuth =
            static_cast<std::int16_t>(std::lround(rays_[i].azimuth / static_cast<double>(cloud::kAngleUnit)));
        point.elevation =
            static_cast<std::int16_t>(std::lround(rays_[i].elevation / static_cast<double>(cloud::kAngleUnit)));
        point.range = cloud::kNothingRange;
        if (ranges[i] >= 0.0) {
            const double measured = ranges[i] + sensor_.sigma * static_cast<double>(random_.normal());
            point.range =
                measured < kBlind
                    ? cloud::kInvalidRange
                    : static_cast<std::uint16_t>(std::lround(measured / static_cast<double>(cloud::kRangeUnit)));
        }
        points.push_back(point);
    }
    under_way_.push_back({now_ + to_micros(sensor_.latency), frames_of(world, points)});
}

std::vector<std::byte> Lidar::frames_of(const World& world, const std::vector<cloud::RawPoint>& points)
{
    const Tilt tilt = tilt_of(world.own());
    const auto in_units = [](double angle, float unit) { return std::lround(angle / static_cast<double>(unit)); };
    cloud::Part part;
    part.scan = scan_++;
    part.parts = static_cast<std::uint16_t>((points.size() + cloud::kMaxPoints - 1) / cloud::kMaxPoints);
    part.max_range = static_cast<std::uint16_t>(in_units(sensor_.range, cloud::kRangeUnit));
    part.stamp_ms = static_cast<std::uint32_t>(now_ / 1000 + kClockAheadMs);
    part.roll = static_cast<std::int16_t>(in_units(tilt.roll, cloud::kAngleUnit));
    part.pitch = static_cast<std::int16_t>(in_units(tilt.pitch, cloud::kAngleUnit));
    part.ray_pitch_level = part.ray_pitch_vertical =
        static_cast<std::uint16_t>(in_units(sensor_.pitch * kDegree, cloud::kPitchUnit));
    part.scan_points = static_cast<std::uint32_t>(points.size());
    std::vector<std::byte> bytes(part.parts * cloud::kMaxFrame);
    std::size_t end = 0;
    for (; part.part < part.parts; ++part.part) {
        part.sequence = sequence_++;
        const std::size_t at = part.part * cloud::kMaxPoints;
        const std::span<const cloud::RawPoint> some(&points[at], std::min(cloud::kMaxPoints, points.size() - at));
        end += cloud::write_frame(part, some, std::span(bytes).subspan(end));
    }
    bytes.resize(end);
    return bytes;
}

std::size_t Lidar::read(std::span<std::byte> into) noexcept
{
    std::size_t n = 0;
    while (n < into.size() && !under_way_.empty() && under_way_.front().arrives <= now_) {
        const std::vector<std::byte>& bytes = under_way_.front().bytes;
        const std::size_t part = std::min(into.size() - n, bytes.size() - read_);
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(read_), part,
                    into.begin() + static_cast<std::ptrdiff_t>(n));
        n += part;
        read_ += part;
        if (read_ == bytes.size()) {
            under_way_.pop_front();
            read_ = 0;
        }
    }
    return n;
}

hal::PortHealth Lidar::health() const noexcept
{
    hal::PortHealth health;
    health.state = hal::PortState::open;
    return health;
}

}  // namespace jink::sim
