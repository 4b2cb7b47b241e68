// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/range_obstacles.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/range_return.hpp"

namespace jink::app {
namespace {

/// Sine of the elevation: what is steeper downwards is the ground; what is steeper upwards, a ceiling; what is flatter,
/// level.
constexpr float kDownwards = -0.7F;
constexpr float kUpwards = 0.98F;
constexpr float kLevel = 0.02F;

constexpr std::uint32_t kScanIds = 0x01000000;
constexpr std::uint32_t kReadingIds = 0x02000000;
/// Ids of one sensor, and of one direction of a single reading.
constexpr std::uint32_t kIdsOfScan = 1024;
constexpr std::uint32_t kIdsOfDirection = 32;
static_assert(kMaxReturnParts <= kIdsOfDirection);
/// Directions that single readings tell apart, at most.
constexpr std::uint32_t kMaxDirections = 128;
/// Narrowest sector that a link reports [rad].
constexpr float kNarrowestSector = 0.5F * kPi / 180.0F;
static_assert(kScanIds + link::RangeScan::kMaxScanSensors * kIdsOfScan <= kReadingIds);
static_assert(2.0F * kPi / kNarrowestSector < static_cast<float>(kIdsOfScan));

/// Directions `width` [rad] apart, numbered around the horizon of the world, not of the vehicle: what a sensor saw
/// stays where it was seen when the sensor turns away, until it expires.
class Directions {
public:
    Directions(float width, std::uint32_t least, std::uint32_t most) noexcept
        : width_(width), count_(std::clamp(static_cast<std::uint32_t>(std::lround(2.0F * kPi / width)), least, most))
    {
    }
    /// Of the direction `step` further counter-clockwise than the one nearest to `yaw` [rad].
    [[nodiscard]] std::uint32_t number(float yaw, std::int64_t step = 0) const noexcept
    {
        const std::int64_t n = count_;
        return static_cast<std::uint32_t>(((std::lround(yaw / width_) + step) % n + n) % n);
    }

private:
    float width_;
    std::uint32_t count_;
};

/// A beam of a level sensor.
struct LevelBeam {
    std::uint32_t first_id;  ///< of its parts
    float yaw;               ///< of its middle [rad]
    float range;             ///< [m]
    float half_angle;        ///< [rad]
};

/// In as many parts as the beam's width asks for.
void place_level(const LevelBeam& beam, const Vec3& own, float half_height, TimePoint expires,
                 world::ObstacleTable& table) noexcept
{
    const std::size_t parts = return_parts(beam.half_angle);
    const float part = beam.half_angle / static_cast<float>(parts);
    for (std::size_t k = 0; k < parts; ++k) {
        const float aside = static_cast<float>(2 * k + 1) * part - beam.half_angle;
        const geometry::Shape body = level_return(own, beam.yaw + aside, beam.range, part, half_height);
        static_cast<void>(table.update({beam.first_id + static_cast<std::uint32_t>(k), body}, expires, own));
    }
}

void remove(std::uint32_t first_id, std::size_t n, world::ObstacleTable& table) noexcept
{
    for (std::size_t k = 0; k < n; ++k) {
        static_cast<void>(table.remove(first_id + static_cast<std::uint32_t>(k)));
    }
}

/// A beam that is not quite vertical sees a ceiling as low as its lowest edge, and as far aside.
geometry::Shape overhead_return(const link::RangeReading& reading, const Vec3& own, float half_height) noexcept
{
    const float edge = std::acos(std::min(reading.direction.z(), 1.0F)) + reading.half_angle;
    const float height = reading.range * std::cos(edge);
    const float aside = std::max(half_height, reading.range * std::sin(edge));
    return ceiling_return(own, height, 0.0F, aside);
}

}  // namespace

void place_scan(const link::RangeScan& scan, const Vec3& own, const Configuration& c,
                world::ObstacleTable& table) noexcept
{
    const TimePoint expires = scan.stamp + c.scan_keep;
    const float width = std::max(std::abs(scan.increment), kNarrowestSector);
    const float half_angle = std::min(0.5F * width, 0.5F * kPi);
    const std::size_t parts = return_parts(half_angle);
    const auto sectors = static_cast<std::uint32_t>(scan.ranges.size());
    const Directions directions(width, std::max<std::uint32_t>(sectors, 1), kIdsOfScan);
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const auto step = static_cast<std::int64_t>(i) * (scan.increment < 0.0F ? -1 : 1);
        const std::uint32_t first = kScanIds + scan.sensor * kIdsOfScan +
                                    directions.number(scan.yaw_first, step) * static_cast<std::uint32_t>(parts);
        const float range = scan.ranges[i];
        if (range == link::RangeScan::kNothing) {
            remove(first, parts, table);
        } else if (range >= 0.0F) {
            const float yaw = scan.yaw_first + scan.increment * static_cast<float>(i);
            place_level({first, yaw, range, half_angle}, own, c.scan_height, expires, table);
        }
    }
}

bool sees_ground(const link::RangeReading& reading) noexcept { return reading.direction.z() < kDownwards; }

bool place_reading(const link::RangeReading& reading, const Vec3& own, const Configuration& c,
                   world::ObstacleTable& table) noexcept
{
    const TimePoint expires = reading.stamp + c.scan_keep;
    const float yaw = std::atan2(reading.direction.y(), reading.direction.x());
    const Directions directions(2.0F * std::max(reading.half_angle, kNarrowestSector), 1, kMaxDirections);
    const std::uint32_t first =
        kReadingIds + (reading.sensor * kMaxDirections + directions.number(yaw)) * kIdsOfDirection;
    const float steepness = reading.direction.z();
    if (reading.range == link::RangeScan::kNothing) {
        remove(first, kMaxReturnParts, table);
    } else if (std::abs(steepness) <= kLevel) {
        place_level({first, yaw, reading.range, std::min(reading.half_angle, 0.5F * kPi)}, own, c.scan_height, expires,
                    table);
    } else if (reading.half_angle > kWidestSteep) {
        return false;
    } else {
        const geometry::Shape body = steepness > kUpwards
                                         ? overhead_return(reading, own, c.scan_height)
                                         : slanted_return(own, reading.direction, reading.range, reading.half_angle);
        static_cast<void>(table.update({first, body}, expires, own));
    }
    return true;
}

}  // namespace jink::app
