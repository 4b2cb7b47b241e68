// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/near_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace jink::app {
namespace {

class Nearest {
public:
    explicit Nearest(float yaw) noexcept : yaw_(yaw) { best_.fill({0.0F, 0.0F, kNearReach}); }

    /// @param offset    from the vehicle, world frame: towards the thing, of any length
    /// @param distance  to its surface [m]; below 0 inside
    void add(const Vec3& offset, float distance) noexcept
    {
        const float level = std::hypot(offset.x(), offset.y());
        const float turn = std::remainder(yaw_ - std::atan2(offset.y(), offset.x()), 2.0F * kPi);
        constexpr float kPerTurn = static_cast<float>(kNearSectors) / (2.0F * kPi);
        const auto sector =
            static_cast<std::size_t>(std::lround(turn * kPerTurn) + static_cast<long>(kNearSectors)) % kNearSectors;
        if (distance < best_[sector].distance) {
            best_[sector] = {turn, std::atan2(offset.z(), level), std::max(distance, kNearLeast)};
        }
    }

    [[nodiscard]] NearObjects found() const noexcept
    {
        NearObjects objects;
        for (const link::NearObject& object : best_) {
            if (object.distance < kNearReach) {
                objects.unchecked_push_back(object);
            }
        }
        return objects;
    }

private:
    float yaw_;
    std::array<link::NearObject, kNearSectors> best_{};
};

}  // namespace

NearObjects find_near(const vehicle::VehicleState& own, std::span<const world::Track> tracks,
                      std::span<const world::Obstacle> obstacles, float k_sigma) noexcept
{
    Nearest nearest(own.yaw);
    for (const world::Track& track : tracks) {
        const Vec3 offset = world::nearest_in_height(track, track.position, own.position.z()) - own.position;
        nearest.add(offset, offset.norm() - track.radius - k_sigma * track.sigma_position);
    }
    for (const world::Obstacle& obstacle : obstacles) {
        const Vec3 offset = geometry::nearest_point(obstacle.shape, own.position) - own.position;
        const float distance = offset.norm();
        nearest.add(distance > 0.0F ? offset : Vec3(obstacle.shape.centre - own.position), distance);
    }
    return nearest.found();
}

}  // namespace jink::app
