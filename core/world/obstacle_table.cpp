// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_table.hpp"

#include <algorithm>

namespace jink::world {
namespace {

float gap(const geometry::Shape& shape, const Vec3& own) noexcept
{
    return (geometry::nearest_point(shape, own) - own).norm();
}

}  // namespace

void ObstacleTable::drop_appended() noexcept { obstacles_.resize(expiry_.size()); }

bool ObstacleTable::append(const Obstacle& obstacle) noexcept
{
    return obstacles_.size() - expiry_.size() < kMaxMapObstacles && obstacles_.try_push_back(obstacle);
}

void ObstacleTable::erase(std::size_t at) noexcept
{
    for (std::size_t i = at; i + 1 < obstacles_.size(); ++i) {
        obstacles_[i] = obstacles_[i + 1];
        expiry_[i] = expiry_[i + 1];
    }
    obstacles_.pop_back();
    expiry_.pop_back();
}

void ObstacleTable::insert(const Obstacle& obstacle, TimePoint expires) noexcept
{
    std::size_t at = obstacles_.size();
    obstacles_.unchecked_push_back(obstacle);
    expiry_.unchecked_push_back(expires);
    for (; at > 0 && obstacles_[at - 1].id > obstacle.id; --at) {
        obstacles_[at] = obstacles_[at - 1];
        expiry_[at] = expiry_[at - 1];
    }
    obstacles_[at] = obstacle;
    expiry_[at] = expires;
}

ObstacleStatus ObstacleTable::place(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept
{
    if (!geometry::is_valid(obstacle.shape)) {
        return ObstacleStatus::invalid;
    }
    auto* const known =
        std::find_if(obstacles_.begin(), obstacles_.end(), [&](const Obstacle& o) { return o.id == obstacle.id; });
    if (known != obstacles_.end()) {
        *known = obstacle;
        expiry_[static_cast<std::size_t>(known - obstacles_.begin())] = expires;
        return ObstacleStatus::updated;
    }
    if (obstacles_.size() < own_places_) {
        insert(obstacle, expires);
        return ObstacleStatus::created;
    }
    const auto* const farthest =
        std::max_element(obstacles_.begin(), obstacles_.end(),
                         [&](const Obstacle& a, const Obstacle& b) { return gap(a.shape, own) < gap(b.shape, own); });
    if (!(gap(obstacle.shape, own) < gap(farthest->shape, own))) {  // of numbers too large: not a number
        return ObstacleStatus::full;
    }
    erase(static_cast<std::size_t>(farthest - obstacles_.begin()));
    insert(obstacle, expires);
    return ObstacleStatus::replaced;
}

ObstacleStatus ObstacleTable::update(const Obstacle& obstacle, TimePoint expires, const Vec3& own) noexcept
{
    drop_appended();
    const ObstacleStatus status = place(obstacle, expires, own);
    switch (status) {
    case ObstacleStatus::updated: ++diagnostics_.updated; break;
    case ObstacleStatus::created: ++diagnostics_.created; break;
    case ObstacleStatus::replaced: ++diagnostics_.replaced; break;
    case ObstacleStatus::invalid: ++diagnostics_.invalid; break;
    case ObstacleStatus::full: ++diagnostics_.full; break;
    }
    return status;
}

bool ObstacleTable::remove(ObstacleId id) noexcept
{
    drop_appended();
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (obstacles_[i].id == id) {
            erase(i);
            return true;
        }
    }
    return false;
}

void ObstacleTable::expire(TimePoint now) noexcept
{
    drop_appended();
    for (std::size_t i = 0; i < obstacles_.size();) {
        if (expiry_[i] < now) {
            erase(i);
            ++diagnostics_.expired;
        } else {
            ++i;
        }
    }
}

void ObstacleTable::clear() noexcept
{
    obstacles_.clear();
    expiry_.clear();
}

}  // namespace jink::world
