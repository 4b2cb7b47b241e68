// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/dense_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace jink::path {
namespace {

/// Share of the chord error that is left to the rounding of what keeps to it.
constexpr float kUsedError = 0.95F;
/// Slower than this a speed is none, and changes of it do not count [m/s].
constexpr float kLeastSpeed = 0.01F;

float seconds_between(const Decimator::Sample& from, const Decimator::Sample& to) noexcept
{
    return 1e-3F * static_cast<float>(to.arrival_ms - from.arrival_ms);
}

/// Speed from one sample to the next [m/s], and how much of it may be rounding of their coordinates.
struct Speed {
    float value = 0.0F;
    float rounding = 0.0F;
};
Speed speed_between(const Decimator::Sample& from, const Decimator::Sample& to) noexcept
{
    const Seconds time = seconds_between(from, to);
    const float largest = std::max(from.position.cwiseAbs().maxCoeff(), to.position.cwiseAbs().maxCoeff());
    return {(to.position - from.position).norm() / time, 2.0F * std::numeric_limits<float>::epsilon() * largest / time};
}

}  // namespace

void Decimator::begin(const Sample& first) noexcept
{
    anchor_ = first;
    last_ = first;
    has_segment_ = false;
}

bool Decimator::add(const Sample& sample, Sample& kept) noexcept
{
    bool keep = false;
    if (!has_segment_) {
        start_segment(last_, sample);
    } else if (!fits(sample)) {
        kept = last_;
        keep = true;
        start_segment(last_, sample);
    }
    const Vec3 offset = sample.position - anchor_.position;
    distance_ = offset.norm();
    narrow(offset, distance_);
    last_ = sample;
    return keep;
}

void Decimator::start_segment(const Sample& from, const Sample& to) noexcept
{
    anchor_ = from;
    has_segment_ = true;
    has_cone_ = false;
    distance_ = 0.0F;
    speed_ = speed_between(from, to).value;
}

/// Whether one segment from the anchor to `sample` may stand for all samples before it.
bool Decimator::fits(const Sample& sample) const noexcept
{
    const Speed speed = speed_between(last_, sample);
    if (std::abs(speed.value - speed_) > kSpeedChange * speed_ + kLeastSpeed + 2.0F * speed.rounding) {
        return false;
    }
    const Vec3 offset = sample.position - anchor_.position;
    const float distance = offset.norm();
    // With distances that do not decrease, whatever lies along the direction lies before the segment's end.
    if (distance < distance_) {
        return false;
    }
    return !has_cone_ || std::atan2(axis_.cross(offset).norm(), axis_.dot(offset)) <= half_angle_;
}

/// Keeps, of the directions that are left, a cone of those that pass near enough to the anchor's `offset` as well.
void Decimator::narrow(const Vec3& offset, float distance) noexcept
{
    constexpr float kNear = kUsedError * kChordError;
    if (distance <= kNear) {
        return;  // within the error of the anchor itself
    }
    const Vec3 direction = offset / distance;
    const float about = std::asin(kNear / distance);
    if (!has_cone_) {
        axis_ = direction;
        half_angle_ = about;
        has_cone_ = true;
        return;
    }
    const Vec3 across = direction - axis_ * axis_.dot(direction);
    const float apart = std::atan2(across.norm(), axis_.dot(direction));
    if (apart + half_angle_ <= about) {
        return;  // the cone so far lies in the new one
    }
    if (apart + about <= half_angle_ || !(across.norm() > 0.0F)) {
        axis_ = direction;
        half_angle_ = std::min(about, half_angle_);
        return;
    }
    // The largest cone in both, its axis on the great circle through theirs.
    const float turn = 0.5F * (apart + half_angle_ - about);
    half_angle_ = std::max(0.0F, 0.5F * (half_angle_ + about - apart));
    axis_ = (axis_ * std::cos(turn) + across.normalized() * std::sin(turn)).normalized();
}

DenseStatus DensePath::begin(bool continues) noexcept
{
    if (continues && has_next_) {
        return DenseStatus::busy;
    }
    if (continues && !empty() && is_complete()) {
        return DenseStatus::gap;  // whoever flies it may be done
    }
    continues_ = continues && !empty();
    if (!continues_) {
        has_next_ = false;  // what is to be replaced needs no continuation, and its chunk is needed
    }
    loading_ = true;
    taken_ = 0;
    chunks_[other()].points.clear();
    return DenseStatus::ok;
}

DenseStatus DensePath::fail(DenseStatus why) noexcept
{
    loading_ = false;
    return why;
}

DenseStatus DensePath::keep(const Decimator::Sample& sample) noexcept
{
    auto& points = chunks_[other()].points;
    DensePoint point{sample.position, sample.arrival_ms, 0.0F};
    if (!points.empty()) {
        point.along = points.back().along + (sample.position - points.back().position).norm();
    }
    return points.try_push_back(point) ? DenseStatus::ok : fail(DenseStatus::too_long);
}

DenseStatus DensePath::add(const Vec3& position, std::uint32_t arrival_ms) noexcept
{
    if (!loading_) {
        return DenseStatus::no_path;
    }
    if (!is_finite(position) || position.cwiseAbs().maxCoeff() > kFarthest) {
        return fail(DenseStatus::not_finite);
    }
    const Decimator::Sample sample{position, arrival_ms};
    if (taken_++ == 0) {
        if (continues_ && (position - flown_points().back().position).norm() > kJoin) {
            return fail(DenseStatus::gap);
        }
        decimator_.begin(sample);
        return keep(sample);
    }
    if (arrival_ms <= decimator_.last().arrival_ms) {
        return fail(DenseStatus::time_not_later);
    }
    Decimator::Sample kept;
    return decimator_.add(sample, kept) ? keep(kept) : DenseStatus::ok;
}

DenseStatus DensePath::commit(bool last) noexcept
{
    if (!loading_) {
        return DenseStatus::no_path;
    }
    if (taken_ < 2) {
        return fail(DenseStatus::too_few);
    }
    if (const DenseStatus status = keep(decimator_.last()); status != DenseStatus::ok) {
        return status;
    }
    Chunk& chunk = chunks_[other()];
    if (!(chunk.points.back().along > 0.0F)) {
        return fail(DenseStatus::too_few);
    }
    chunk.last = last;
    loading_ = false;
    if (continues_) {
        has_next_ = true;
    } else {
        flown_ = other();
        ++generation_;
    }
    return DenseStatus::ok;
}

void DensePath::clear() noexcept
{
    for (Chunk& chunk : chunks_) {
        chunk.points.clear();
    }
    has_next_ = false;
    loading_ = false;
    ++generation_;
}

std::size_t DensePath::size() const noexcept
{
    const std::size_t own = flown_points().size();
    return has_next_ ? own + chunks_[other()].points.size() - 1 : own;
}

const DensePoint& DensePath::point(std::size_t i) const noexcept
{
    const std::size_t own = flown_points().size();
    return i < own ? flown_points()[i] : chunks_[other()].points[i - own + 1];
}

float DensePath::along(std::size_t i) const noexcept
{
    return i < flown_points().size() ? flown_points()[i].along : flown_points().back().along + point(i).along;
}

std::size_t DensePath::advance(std::size_t i) noexcept
{
    const std::size_t segments = flown_points().size() - 1;
    if (!has_next_ || i < segments) {
        return i;
    }
    chunks_[flown_].points.clear();
    flown_ = other();
    has_next_ = false;
    return i - segments;
}

}  // namespace jink::path
