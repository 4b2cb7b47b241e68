// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/reach_picture.hpp"

#include <algorithm>
#include <cmath>

namespace jink::app {

ReachPicture::ReachPicture(const reach::VehicleSets& sets) noexcept : sets_(sets)
{
    const auto widest = std::max_element(sets.segments.begin(), sets.segments.end(),
                                         [](const reach::SegmentSets& a, const reach::SegmentSets& b) {
                                             return a.emergency->grid.vertical() < b.emergency->grid.vertical();
                                         });
    static_cast<void>(picture_.configure(widest->emergency->grid));
}

const world::CostToGo& ReachPicture::way_of(const world::Situation& situation, bool plan_runs) noexcept
{
    if (!plan_runs) {
        way_.show();
    }
    if (way_.is_idle()) {
        way_.begin(situation);
    }
    return way_;
}

void ReachPicture::advance(WorkBudget& budget) noexcept
{
    static_assert(BackgroundService<world::CostToGoField>);
    static_cast<void>(way_.advance(budget));
}

void ReachPicture::begin_scan(const link::CloudScan& scan) noexcept
{
    const float speed = view_.velocity.norm();
    const float least_speed = sets_.speeds.front() * sets_.cruise_speed;
    reach::ScanStart start;
    start.stamp = scan.stamp;
    start.position = view_.position + view_.velocity * (scan.stamp - view_.stamp);
    start.nose = view_.yaw;
    start.unit = std::max(speed, least_speed) * sets_.period;
    start.horizontal_pitch = scan.ray_pitch_level;
    start.vertical_pitch = scan.ray_pitch_vertical;
    ++scans_;
    const Seconds apart = scan.stamp - view_.stamp;
    const bool is_placed = view_.is_placed && std::abs(apart) <= view_.own_age;
    // A pitch of 0 is refused: without it nobody knows what is not seen.
    start.horizontal_pitch = is_placed ? start.horizontal_pitch : 0.0F;
    unused_ += picture_.begin(start) ? 0U : 1U;
}

void ReachPicture::add(link::Ray ray, const Vec3& point) noexcept
{
    if (ray == link::Ray::hit) {
        picture_.add(point);
    } else if (ray == link::Ray::nothing) {
        picture_.add_nothing(point);
    }
}

/// What is lost is not distinguished from what was not fired: it is missing where it should be.
void ReachPicture::end_scan(std::uint32_t /*points_lost*/) noexcept { picture_.end(); }

}  // namespace jink::app
