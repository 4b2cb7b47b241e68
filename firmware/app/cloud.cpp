// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/app/range_return.hpp"

namespace jink::app {

using State = CloudBin::State;

void CloudObstacles::begin_scan(const link::CloudScan& scan) noexcept
{
    ++diagnostics_.scans;
    scan_ = scan;
    view_ = next_view_;
    const Seconds gap = scan.stamp - view_.stamp;
    // A scan older than the own state is placed by flying back; the link refuses those that are too old.
    view_.is_placed = view_.is_placed && gap <= view_.own_age;
    view_.position += view_.velocity * gap;
    const float cosine = std::cos(view_.yaw);
    const float sine = std::sin(view_.yaw);
    turn_.topLeftCorner<2, 2>() << cosine, -sine, sine, cosine;
    diagnostics_.scans_unplaced += view_.is_placed ? 0U : 1U;
    image_.bins.fill({});
}

void CloudObstacles::add(link::Ray ray, const Vec3& point) noexcept
{
    if (ray == link::Ray::hit) {
        ++diagnostics_.hits;
        add_hit(point);
        return;
    }
    const bool nothing = ray == link::Ray::nothing;
    ++(nothing ? diagnostics_.nothing : diagnostics_.invalid);
    State& state = image_.bins[CloudImage::bin_of(point)].state;
    if (state != State::hit && state != State::spoiled) {
        state = nothing ? State::empty : State::spoiled;
    }
}

void CloudObstacles::add_hit(const Vec3& point) noexcept
{
    const bool is_body = view_.is_placed && (point.cwiseAbs().array() <= view_.half_extents.array()).all();
    const bool is_near = point.norm() <= kReach;  // false for what is no number
    CloudBin& bin = image_.bins[CloudImage::bin_of(point)];
    if (is_body || !is_near) {
        ++(is_body ? diagnostics_.body : diagnostics_.beyond);
        bin.state = is_body && bin.state != State::hit ? State::spoiled : bin.state;
        return;
    }
    // Below the floor nothing bounds the flight: what lies at the vehicle's height or above may be in its way.
    const bool is_below = point.z() < 0.0F && view_.position.z() + point.z() < view_.floor - kFloorSlack;
    if (view_.is_placed && view_.has_floor && is_below) {
        ++diagnostics_.below_floor;
        bin.state = bin.state == State::unseen ? State::empty : bin.state;
        return;
    }
    ++diagnostics_.kept;
    CloudSurface surface;
    surface.add(point);
    bin.add(surface);
}

geometry::Shape CloudObstacles::to_world(const geometry::Shape& local) const noexcept
{
    geometry::Shape world = local;
    world.centre = view_.position + turn_ * local.centre;
    if (world.kind == geometry::ShapeKind::box) {
        world.axes = turn_ * local.axes;  // a capsule is upright
    }
    return world;
}

geometry::Shape CloudObstacles::to_local(const geometry::Shape& world) const noexcept
{
    geometry::Shape local = world;
    local.centre = turn_.transpose() * (world.centre - view_.position);
    local.axes = turn_.transpose() * world.axes;
    return local;
}

/// Keeps what was known before and lies where this scan does not see, notes what it hit, and adds the former to it.
void CloudObstacles::remember(bool all_came) noexcept
{
    const auto is_hidden = [&](const Remembered& old) {
        const State state = image_.bins[CloudImage::bin_of(to_local(old.box).centre)].state;
        return state == State::unseen || state == State::spoiled || (state == State::empty && !all_came);
    };
    // Within the own box the rays that hit it count as hits of the own body: it is there until it is seen elsewhere.
    const auto is_at_the_body = [&](const Remembered& old) {
        const Vec3 local = to_local(old.box).centre;
        const Vec3 off = (local.cwiseAbs() - view_.half_extents).cwiseMax(0.0F);
        return image_.bins[CloudImage::bin_of(local)].state == State::spoiled &&
               off.norm() <= old.box.half.norm() + kBodyReach;
    };
    std::size_t kept = 0;
    for (Remembered& old : memory_) {
        const bool is_own = old.sensor == scan_.sensor;
        if (is_own && is_at_the_body(old)) {
            old.expires = scan_.stamp + view_.keep;
        }
        if (old.expires >= scan_.stamp && (!is_own || is_hidden(old))) {
            memory_[kept++] = old;
        }
    }
    memory_.resize(kept);
    for (const CloudBin& bin : image_.bins) {
        for (const CloudSurface& surface : bin.layers) {
            if (surface.has_points()) {
                static_cast<void>(
                    memory_.try_push_back({to_world(surface.box()), scan_.stamp + view_.keep, scan_.sensor}));
            }
        }
    }
    for (std::size_t i = 0; i < kept; ++i) {
        const Remembered& old = memory_[i];
        if (old.sensor == scan_.sensor) {
            const geometry::Shape local = to_local(old.box);
            CloudSurface surface;
            surface.add(local);
            image_.bins[CloudImage::bin_of(local.centre)].add(surface);
            ++diagnostics_.remembered;
        }
    }
}

float CloudObstacles::sure_range(const CloudView& view) noexcept
{
    return kSureLeast + kSureStops * 0.5F * view.velocity.squaredNorm() / view.deceleration;
}

void CloudObstacles::give() noexcept
{
    const CloudCover cover(image_, sure_range(view_));
    const std::uint32_t first = first_id_ + scan_.sensor * 512U;
    const auto boxes = cover.boxes(kMinReturnRadius);
    // First those that go, so that there is space for those that come.
    for (std::size_t i = boxes.size(); i < kMaxCloudObstacles; ++i) {
        static_cast<void>(table_->remove(first + static_cast<std::uint32_t>(i)));
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        // Each refusal is counted in the table.
        static_cast<void>(table_->update({first + static_cast<std::uint32_t>(i), to_world(boxes[i])},
                                         scan_.stamp + view_.keep, view_.position));
    }
    diagnostics_.obstacles += static_cast<std::uint32_t>(boxes.size());
    diagnostics_.left_out += static_cast<std::uint32_t>(cover.left_out());
    diagnostics_.coarse += static_cast<std::uint32_t>(cover.coarse());
}

void CloudObstacles::end_scan(std::uint32_t points_lost) noexcept
{
    diagnostics_.lost += points_lost;
    if (table_ == nullptr || !view_.is_placed) {
        return;
    }
    remember(points_lost == 0);
    give();
}

}  // namespace jink::app
