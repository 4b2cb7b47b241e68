// SPDX-License-Identifier: BSD-3-Clause
// What the co-processor does with point clouds: it says where it is, and they become obstacles.
#include "firmware/app/clouds.hpp"

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/reach_picture.hpp"

namespace jink::app {

/// How the own vehicle lies for the clouds that come from now on.
void Coprocessor::take_clouds(TimePoint now) noexcept
{
    if (clouds_ == nullptr) {
        return;
    }
    const Configuration& c = parameters_.configuration();
    const world::Airspace air = airspace(now);
    const CloudView view{
        has_own_ && own_yaw_known_, own_.stamp,    own_.position, own_.velocity, own_.yaw, c.own_age, c.scan_keep,
        c.limits.half_extents,      air.has_floor, air.floor};
    if (reach_picture_ != nullptr) {
        reach_picture_->look_from(view);
        reach_picture_->picture().block_unseen(c.blocks_unseen);
    }
    clouds_->serve(now, view);
}

void Coprocessor::let_reach_sets_see(ReachPicture& picture) noexcept
{
    reach_picture_ = &picture;
    reach_.look_at(&picture.picture());
    forward_clouds_to(picture);
    static_cast<void>(supervisor_.configure(supervisor_settings()));
}

void Coprocessor::use_clouds(Clouds& clouds) noexcept
{
    clouds_ = &clouds;
    clouds.give_to(obstacles_);
    link_.report_points_to(clouds.link_points());
}

void Coprocessor::forward_clouds_to(link::CloudSink& sink) noexcept
{
    if (clouds_ != nullptr) {
        clouds_->forward_to(sink);
    }
}

}  // namespace jink::app
