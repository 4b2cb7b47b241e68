// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/motion_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::app {
namespace {

constexpr Seconds kSpacing = 0.09F;  ///< of samples: kSamples of them span the window
constexpr Seconds kGap = 0.5F;       ///< own state that was missing for longer begins anew [s]
/// Speeds within the window closer together than this are one steady speed [m/s].
constexpr float kSteady = 0.5F;

/// Of the level parts, counter-clockwise from `a` to `b`, within half a turn either way [rad].
float level_angle(const Vec3& a, const Vec3& b) noexcept
{
    return direction_angle(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
}

}  // namespace

void MotionEstimate::clear() noexcept
{
    samples_.clear();
    turn_rate_ = steady_speed_ = 0.0F;
}

void MotionEstimate::add(const vehicle::VehicleState& measured) noexcept
{
    const Seconds since = samples_.empty() ? kSpacing : measured.stamp - samples_.back().at;
    if (since < kSpacing) {
        if (since < 0.0F) {
            samples_.clear();  // the clock was set back
        }
        return;
    }
    if (since > kGap) {
        samples_.clear();
    }
    if (samples_.full()) {
        std::move(samples_.begin() + 1, samples_.end(), samples_.begin());
        samples_.pop_back();
    }
    const Vec3& before = samples_.empty() ? measured.velocity : samples_.back().velocity;
    samples_.unchecked_push_back({measured.stamp, level_angle(before, measured.velocity), measured.velocity});
    estimate();
}

void MotionEstimate::estimate() noexcept
{
    turn_rate_ = steady_speed_ = 0.0F;
    const TimePoint last = samples_.back().at;
    float n = 0.0F, t_sum = 0.0F, h_sum = 0.0F, tt = 0.0F, th = 0.0F, oldest = 0.0F, speeds = 0.0F;
    float h = 0.0F;  // heading, less the newest one
    float slowest = samples_.back().velocity.norm();
    float fastest = slowest;
    bool moves = true;
    for (std::size_t i = samples_.size(); i > 0; --i) {
        const Sample& s = samples_[i - 1];
        const Seconds t = s.at - last;
        if (t < -kWindow - 0.5F * kSpacing) {
            break;
        }
        n += 1.0F;
        t_sum += t;
        h_sum += h;
        tt += t * t;
        th += t * h;
        h -= s.turned;
        oldest = std::min(oldest, t);
        const float speed = s.velocity.norm();
        speeds += speed;
        slowest = std::min(slowest, speed);
        fastest = std::max(fastest, speed);
        moves = moves && s.velocity.head<2>().squaredNorm() > kMoving * kMoving;
    }
    const float spread = n * tt - t_sum * t_sum;
    if (oldest > -0.8F * kWindow || !(spread > 0.0F)) {
        return;
    }
    const float rate = (n * th - t_sum * h_sum) / spread;
    turn_rate_ = moves && std::abs(rate) >= kMinTurn ? rate : 0.0F;
    steady_speed_ = slowest > kMoving && fastest - slowest < kSteady ? speeds / n : 0.0F;
}

}  // namespace jink::app
