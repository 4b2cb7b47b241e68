// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "core/path/follower.hpp"
#include "core/vehicle/motion.hpp"

// A planner's candidate flight, part by part, coarser than the final check's (prediction.hpp). Several flights advanced
// in turn, one part each, take little longer than a single flight: their roots and divisions do not wait for each
// other. Private to core/path and core/geometric.

namespace jink::path::detail {

/// A remainder of the path shorter than this share of a step is merged with the step before it. Otherwise two points
/// could be so near that the velocity between them is rounding.
inline constexpr float kMinStep = 1e-3F;

/// The grid of times of a flight over `length` in steps of `dt` > 0, the last step shortened, `most` steps at most.
/// Times are multiples of dt, not sums: 60 steps of 0.1 s end at 6 s.
struct Steps {
    Seconds length;
    Seconds dt;
    std::size_t count;

    Steps(Seconds over, Seconds step, std::size_t most) noexcept : length(over), dt(step), count(0)
    {
        // The first guess is off by one at most, by rounding.
        const float guess = std::min(std::floor(length / dt), static_cast<float>(most));
        count = guess > 1.0F ? static_cast<std::size_t>(guess) - 1 : 0;
        while (count < most && left_after(count) > kMinStep * dt) {
            ++count;
        }
    }
    /// End of step `step`, counted from 1.
    [[nodiscard]] Seconds end_of(std::size_t step) const noexcept { return step < count ? time(step) : end(); }

private:
    [[nodiscard]] Seconds time(std::size_t step) const noexcept { return static_cast<float>(step) * dt; }
    [[nodiscard]] Seconds left_after(std::size_t steps) const noexcept { return length - time(steps); }
    /// Less than `length` if `most` steps do not cover it.
    [[nodiscard]] Seconds end() const noexcept { return left_after(count) > kMinStep * dt ? time(count) : length; }
};

/// The first point of `path`, from `next` on, that lies after `t`; the last point if none does.
[[nodiscard]] inline std::size_t next_after(const TimedPath& path, std::size_t next, Seconds t) noexcept
{
    while (next + 1 < path.points.size() && path.points[next].time <= t) {
        ++next;
    }
    return next;
}

/// `follow`, but with the path's velocity at `ahead` instead of one loop lag after `t`. `next` and `next_ahead` are the
/// points after `t` and `ahead` (next_after, 1 at least).
[[nodiscard]] Vec3 command(const TimedPath& path, Seconds t, std::size_t next, Seconds ahead, std::size_t next_ahead,
                           const Vec3& position, const vehicle::VehicleLimits& limits,
                           const FollowerGains& gains) noexcept;

/// Step lengths of a predicted flight; they may be coarser once the vehicle has found the path.
struct Fineness {
    Seconds settled = std::numeric_limits<Seconds>::infinity();  ///< parts of at most kFollowerPeriod until then
    Seconds afterwards = kFollowerPeriod;                        ///< longest part, for steps that begin later
};

/// The vehicle model follows `path` from `state`, assumed to be at path time `start`, in steps of `dt` > 0, to the end
/// of the path or until kMaxPathPoints. The last step is shortened to end with the path. Each step is flown in parts of
/// kFollowerPeriod at most. `path`, `limits` and `gains` outlive this. 160 bytes.
class Flight {
public:
    Flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start, Seconds dt,
           const vehicle::VehicleLimits& limits, const FollowerGains& gains, const Fineness& fineness = {}) noexcept
        : path_(path), limits_(limits), gains_(gains), start_(start), settled_(fineness.settled),
          steps_(path.duration() - start, dt, kMaxPathPoints - 1), parts_(parts_of(dt, kFollowerPeriod)),
          later_parts_(parts_of(dt, fineness.afterwards)), position_(state.position), velocity_(state.velocity)
    {
        part_ = part();
    }

    [[nodiscard]] std::size_t steps() const noexcept { return steps_.count; }
    [[nodiscard]] std::size_t flown() const noexcept { return flown_; }
    [[nodiscard]] bool ended() const noexcept { return flown_ == steps_.count; }
    /// Parts of the next step.
    [[nodiscard]] int parts() const noexcept { return parts_; }
    /// Parts of all steps.
    [[nodiscard]] std::size_t all_parts() const noexcept
    {
        std::size_t early = 0;
        while (early < steps_.count && !(early > 0 && steps_.end_of(early) >= settled_)) {
            ++early;
        }
        return early * static_cast<std::size_t>(parts_) +
               (steps_.count - early) * static_cast<std::size_t>(later_parts_);
    }
    [[nodiscard]] const Vec3& position() const noexcept { return position_; }
    /// Time of `position` since the start.
    [[nodiscard]] Seconds time() const noexcept { return from_; }

    /// Flies part `i` of the next step: all parts in turn, then `end_step`. Not after the end. O(1), amortised.
    void fly(int i, vehicle::detail::Fading& fading) noexcept
    {
        const Seconds t = start_ + from_ + static_cast<float>(i) * part_;
        // A command held for longer than the follower's period would lag on average.
        const Seconds lead = part_ > kFollowerPeriod ? 0.5F * (part_ - kFollowerPeriod) : 0.0F;
        const Seconds ahead = t + limits_.velocity_lag + lead;
        next_ = next_after(path_, next_, t);
        ahead_ = next_after(path_, ahead_, ahead);
        vehicle::detail::move(position_, velocity_, command(path_, t, next_, ahead, ahead_, position_, limits_, gains_),
                              limits_, part_, fading);
    }
    void end_step() noexcept
    {
        ++flown_;
        from_ = steps_.end_of(flown_);
        parts_ = from_ >= settled_ ? later_parts_ : parts_;
        part_ = part();
    }

private:
    [[nodiscard]] static int parts_of(Seconds step, Seconds longest) noexcept
    {
        return std::max(1, static_cast<int>(std::ceil(step / longest - 1e-3F)));
    }
    /// The same to the bit for all whole steps, so that the cache of vehicle::detail::Fading applies.
    [[nodiscard]] Seconds part() const noexcept
    {
        const Seconds step = flown_ + 1 < steps_.count ? steps_.dt : steps_.end_of(flown_ + 1) - from_;
        return step / static_cast<float>(parts_);
    }

    const TimedPath& path_;
    const vehicle::VehicleLimits& limits_;
    const FollowerGains& gains_;
    Seconds start_;
    Seconds settled_;
    Steps steps_;
    int parts_;
    int later_parts_;
    Vec3 position_;
    Vec3 velocity_;
    std::size_t flown_ = 0;
    Seconds from_ = 0.0F;
    Seconds part_ = 0.0F;
    std::size_t next_ = 1;
    std::size_t ahead_ = 1;
};

}  // namespace jink::path::detail
