// SPDX-License-Identifier: BSD-3-Clause
#include "tests/timing/orca_published.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace jink::orca {

namespace {

constexpr float kTiny = 1e-5F;
constexpr std::uint32_t kLeaf = 10;

float distance2_to_box(const Vec3& low, const Vec3& high, const Vec3& point)
{
    return (point.cwiseMax(low).cwiseMin(high) - point).squaredNorm();
}

}  // namespace

/// The incremental programs: in a sphere of `radius`, nearest to `target`, or farthest along it (`along`, a unit
/// vector).
struct PublishedProgram {
    using Plane = PublishedSwarm::Plane;
    float radius;
    Vec3 target;
    bool along;

    static float violation(const Plane& plane, const Vec3& at) { return plane.normal.dot(plane.point - at); }

    bool on_line(const std::vector<Plane>& planes, std::size_t before, const Vec3& point, const Vec3& direction,
                 Vec3& out) const
    {
        const float half = point.dot(direction);
        const float inside = half * half + radius * radius - point.squaredNorm();
        if (inside < 0.0F) {
            return false;
        }
        const float root = std::sqrt(inside);
        float low = -half - root;
        float high = -half + root;
        for (std::size_t i = 0; i < before; ++i) {
            const float behind = violation(planes[i], point);
            const float slope = direction.dot(planes[i].normal);
            if (slope * slope <= kTiny) {
                if (behind > 0.0F) {
                    return false;
                }
                continue;
            }
            const float at = behind / slope;
            low = slope >= 0.0F ? std::max(low, at) : low;
            high = slope < 0.0F ? std::min(high, at) : high;
            if (low > high) {
                return false;
            }
        }
        const float wanted =
            along ? (target.dot(direction) > 0.0F ? high : low) : std::clamp(direction.dot(target - point), low, high);
        out = point + wanted * direction;
        return true;
    }

    bool on_plane(const std::vector<Plane>& planes, std::size_t index, Vec3& out) const
    {
        const Plane& plane = planes[index];
        const float depth = plane.point.dot(plane.normal);
        if (depth * depth > radius * radius) {
            return false;
        }
        const float disc2 = radius * radius - depth * depth;
        const Vec3 centre = depth * plane.normal;
        if (along) {
            const Vec3 flat = target - target.dot(plane.normal) * plane.normal;
            const float length2 = flat.squaredNorm();
            out = length2 <= kTiny ? centre : Vec3(centre + std::sqrt(disc2 / length2) * flat);
        } else {
            out = target + violation(plane, target) * plane.normal;
            if (out.squaredNorm() > radius * radius) {
                const Vec3 flat = out - centre;
                out = centre + std::sqrt(disc2 / flat.squaredNorm()) * flat;
            }
        }
        for (std::size_t i = 0; i < index; ++i) {
            if (violation(planes[i], out) <= 0.0F) {
                continue;
            }
            const Vec3 cross = planes[i].normal.cross(plane.normal);
            if (cross.squaredNorm() <= kTiny) {
                return false;
            }
            const Vec3 direction = cross.normalized();
            const Vec3 level = direction.cross(plane.normal);
            const Vec3 point = plane.point + (planes[i].point - plane.point).dot(planes[i].normal) /
                                                 level.dot(planes[i].normal) * level;
            if (!on_line(planes, i, point, direction, out)) {
                return false;
            }
        }
        return true;
    }

    /// How many planes hold at `out`: all, or those before the one that cannot.
    std::size_t solve(const std::vector<Plane>& planes, Vec3& out) const
    {
        const float limit = along || target.squaredNorm() > radius * radius ? radius / target.norm() : 1.0F;
        out = target * limit;
        for (std::size_t i = 0; i < planes.size(); ++i) {
            if (violation(planes[i], out) > 0.0F) {
                const Vec3 before = out;
                if (!on_plane(planes, i, out)) {
                    out = before;
                    return i;
                }
            }
        }
        return planes.size();
    }

    /// Without a solution: the least worst violation, beginning with the plane that could not hold.
    static void relax(const std::vector<Plane>& planes, std::size_t begin, float radius, std::vector<Plane>& projected,
                      Vec3& out)
    {
        float worst = 0.0F;
        for (std::size_t i = begin; i < planes.size(); ++i) {
            if (violation(planes[i], out) <= worst) {
                continue;
            }
            projected.clear();
            for (std::size_t j = 0; j < i; ++j) {
                const Vec3 cross = planes[j].normal.cross(planes[i].normal);
                Plane equal;
                if (cross.squaredNorm() <= kTiny) {
                    if (planes[i].normal.dot(planes[j].normal) > 0.0F) {
                        continue;
                    }
                    equal.point = 0.5F * (planes[i].point + planes[j].point);
                } else {
                    const Vec3 level = cross.cross(planes[i].normal);
                    equal.point = planes[i].point + (planes[j].point - planes[i].point).dot(planes[j].normal) /
                                                        level.dot(planes[j].normal) * level;
                }
                equal.normal = (planes[j].normal - planes[i].normal).normalized();
                projected.push_back(equal);
            }
            const Vec3 before = out;
            if (PublishedProgram{radius, planes[i].normal, true}.solve(projected, out) < projected.size()) {
                out = before;
            }
            worst = violation(planes[i], out);
        }
    }
};

PublishedSwarm::PublishedSwarm(std::size_t count, const SwarmSettings& settings)
    : MovingPoints(count, settings.sphere), settings_(settings), next_(count), order_(count)
{
    std::iota(order_.begin(), order_.end(), 0U);
}

void PublishedSwarm::build()
{
    nodes_.assign(1, {.end = static_cast<std::uint32_t>(order_.size())});
    split(0);
}

void PublishedSwarm::split(std::uint32_t node)
{
    Node here = nodes_[node];
    here.low = here.high = positions_[order_[here.begin]];
    for (std::uint32_t i = here.begin + 1; i < here.end; ++i) {
        here.low = here.low.cwiseMin(positions_[order_[i]]);
        here.high = here.high.cwiseMax(positions_[order_[i]]);
    }
    if (here.end - here.begin > kLeaf) {
        int axis = 0;
        (here.high - here.low).maxCoeff(&axis);
        const float at = 0.5F * (here.low[axis] + here.high[axis]);
        auto* const first = order_.data() + here.begin;
        auto* const last = order_.data() + here.end;
        auto* middle = std::partition(first, last, [&](std::uint32_t i) { return positions_[i][axis] < at; });
        middle = middle == first ? first + 1 : middle;
        const auto cut = static_cast<std::uint32_t>(middle - order_.data());
        here.left = static_cast<std::uint32_t>(nodes_.size());
        here.right = here.left + 1;
        nodes_.push_back({.begin = here.begin, .end = cut});
        nodes_.push_back({.begin = cut, .end = here.end});
    }
    nodes_[node] = here;
    if (here.left != 0) {
        split(here.left);
        split(here.right);
    }
}

void PublishedSwarm::search(std::uint32_t node, std::size_t self, float& range2)
{
    const Node& here = nodes_[node];
    if (here.left == 0) {
        for (std::uint32_t i = here.begin; i < here.end; ++i) {
            const std::uint32_t other = order_[i];
            const float distance2 = (positions_[other] - positions_[self]).squaredNorm();
            if (other == self || distance2 >= range2) {
                continue;
            }
            if (found_.size() == settings_.most) {
                found_.pop_back();
            }
            const auto place =
                std::upper_bound(found_.begin(), found_.end(), distance2,
                                 [](float value, const Found& found) { return value < found.distance2; });
            found_.insert(place, {distance2, other});
            if (found_.size() == settings_.most) {
                range2 = found_.back().distance2;
            }
        }
        return;
    }
    const Node& left = nodes_[here.left];
    const Node& right = nodes_[here.right];
    const float to_left = distance2_to_box(left.low, left.high, positions_[self]);
    const float to_right = distance2_to_box(right.low, right.high, positions_[self]);
    const bool left_first = to_left < to_right;
    if (std::min(to_left, to_right) < range2) {
        search(left_first ? here.left : here.right, self, range2);
        if (std::max(to_left, to_right) < range2) {
            search(left_first ? here.right : here.left, self, range2);
        }
    }
}

/// Half-spaces by (7.13) and (7.32) to (7.35).
void PublishedSwarm::add_planes(std::size_t self)
{
    const float radius = 2.0F * settings_.radius;
    planes_.clear();
    for (const Found& found : found_) {
        const Vec3 position = positions_[found.index] - positions_[self];
        const Vec3 velocity = velocities_[self] - velocities_[found.index];
        Plane plane;
        Vec3 change;
        if (found.distance2 > radius * radius) {
            const Vec3 w = velocity - position / settings_.pair.horizon;
            const float behind = w.dot(position);
            const float w2 = w.squaredNorm();
            if (behind < 0.0F && behind * behind > radius * radius * w2) {
                const float length = std::sqrt(w2);
                plane.normal = w / length;
                change = (radius / settings_.pair.horizon - length) * plane.normal;
            } else {
                const float b = position.dot(velocity);
                const float c = velocity.squaredNorm() -
                                position.cross(velocity).squaredNorm() / (found.distance2 - radius * radius);
                const float t = (b + std::sqrt(b * b - found.distance2 * c)) / found.distance2;
                const Vec3 side = velocity - t * position;
                const float length = side.norm();
                plane.normal = side / length;
                change = (radius * t - length) * plane.normal;
            }
        } else {
            const Vec3 w = velocity - position / settings_.step;
            const float length = w.norm();
            plane.normal = w / length;
            change = (radius / settings_.step - length) * plane.normal;
        }
        plane.point = velocities_[self] + 0.5F * change;
        planes_.push_back(plane);
    }
}

Vec3 PublishedSwarm::decide(std::size_t self)
{
    found_.clear();
    float range2 = settings_.range * settings_.range;
    search(0, self, range2);
    add_planes(self);
    Vec3 out;
    const PublishedProgram program{settings_.max_speed, preferred(self, settings_.cruise), false};
    const std::size_t held = program.solve(planes_, out);
    if (held < planes_.size()) {
        PublishedProgram::relax(planes_, held, settings_.max_speed, projected_, out);
    }
    return out;
}

void PublishedSwarm::step()
{
    build();
    for (std::size_t i = 0; i < next_.size(); ++i) {
        next_[i] = decide(i);
    }
    move(next_, settings_.step);
}

}  // namespace jink::orca
