// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "core/base/work_units.hpp"
#include "core/capacity.hpp"

namespace jink::avoid {

/// Methods that one order names at most; a supervisor has no more.
inline constexpr std::size_t kMaxMethods = 6;

/// Methods by MethodTraits::id, in the order in which they are asked. 0 ends the order. 6 bytes.
class MethodOrder {
public:
    constexpr MethodOrder() noexcept = default;
    /// An id that comes again counts once.
    template <std::same_as<std::uint8_t>... Ids>
    constexpr explicit MethodOrder(Ids... ids) noexcept
    {
        static_assert(sizeof...(Ids) <= kMaxMethods);
        (static_cast<void>(try_add(ids)), ...);
    }

    [[nodiscard]] constexpr std::size_t size() const noexcept
    {
        return static_cast<std::size_t>(std::find(ids_.begin(), ids_.end(), std::uint8_t{0}) - ids_.begin());
    }
    [[nodiscard]] constexpr bool empty() const noexcept { return ids_[0] == 0; }
    [[nodiscard]] constexpr std::span<const std::uint8_t> ids() const noexcept { return {ids_.data(), size()}; }
    [[nodiscard]] constexpr bool contains(std::uint8_t id) const noexcept
    {
        return id != 0 && std::find(ids_.begin(), ids_.end(), id) != ids_.end();
    }
    /// Adds a method at the end; false (and nothing changed) when full, for id 0, and for a method that is in it.
    [[nodiscard]] constexpr bool try_add(std::uint8_t id) noexcept
    {
        const std::size_t n = size();
        if (id == 0 || n == kMaxMethods || contains(id)) {
            return false;
        }
        ids_[n] = id;
        return true;
    }
    /// Those that are in `others` too, in this order.
    [[nodiscard]] constexpr MethodOrder within(const MethodOrder& others) const noexcept
    {
        MethodOrder left;
        std::size_t n = 0;
        for (const std::uint8_t id : ids_) {
            if (others.contains(id)) {
                left.ids_[n++] = id;
            }
        }
        return left;
    }
    friend constexpr bool operator==(const MethodOrder&, const MethodOrder&) noexcept = default;

private:
    std::array<std::uint8_t, kMaxMethods> ids_{};
};

/// Work units of one update. Its mandatory part (conflicts, the check of what is flown, the fallback) has all but those
/// of the slice; planning has the slice, and what the mandatory part does not need.
struct WorkPerUpdate {
    /// The largest piece of work that is paid for at once fits into a slice: the costs of a candidate with all threats
    /// moving, or the choice among a reach set's trajectories. Checked by tests/property/app/sliced_plan_test.cpp.
    static constexpr std::uint32_t kMinSlice =
        std::max<std::uint32_t>(1000, 2U * units::kCostPoint * static_cast<std::uint32_t>(kMaxPathPoints) +
                                          units::closeness_units(kMaxPathPoints, 2 * kMaxTracks));
    static constexpr std::uint32_t kMinMandatory = 1000;
    /// More than this with large capacities alone.
    static constexpr std::uint32_t kUsualSlice = 22000;
    static constexpr std::uint32_t kInitialSlice = std::max(kUsualSlice, kMinSlice);

    std::uint32_t all = 38000 + kInitialSlice;  ///< at least `slice` + kMinMandatory
    std::uint32_t slice = kInitialSlice;        ///< kMinSlice at least
    friend constexpr bool operator==(const WorkPerUpdate&, const WorkPerUpdate&) noexcept = default;
};
[[nodiscard]] constexpr bool is_valid(const WorkPerUpdate& work) noexcept
{
    return work.slice >= WorkPerUpdate::kMinSlice && work.all >= WorkPerUpdate::kMinMandatory &&
           work.all - WorkPerUpdate::kMinMandatory >= work.slice;
}
static_assert(is_valid(WorkPerUpdate{}));

/// Of the supervisor alone; what it shares with the methods is in world::FlightRules.
struct Settings {
    /// The methods that are asked, all of them: the answer that costs least is flown (objective.hpp), the first of
    /// those that cost the same. Empty: all of the supervisor's, in its own order. Ids of methods that the supervisor
    /// does not have are skipped.
    MethodOrder order;
    Seconds commit = 5.0F;            ///< a loss of separation nearer than this is planned around, 0.5..60 [s]
    Seconds prediction_step = 0.2F;   ///< of the predicted flight, 0.02..0.5 [s]
    Seconds fallback_horizon = 4.0F;  ///< over which fallbacks are compared, 1..20 [s]
    Seconds reserve = 0.75F;          ///< on top of the stopping time, before which nothing is forced, 0..5 [s]
    Seconds settle = 1.0F;            ///< the nominal path is trusted after it has been clear this long, 0..10 [s]
    float clear_extra = 0.5F;         ///< and clear by this much more than the margin, 0..10 [m]
    float on_leg = 1.0F;              ///< cross-track error at which the leg counts as rejoined, > 0 [m]
    Seconds blocked_patience = 2.0F;  ///< after standing in front of something this long, the vehicle backs off [s]
    float back_off_speed = 1.0F;      ///< backwards, 0: never [m/s]
    Seconds back_off_limit = 10.0F;   ///< per conflict, at most [s]
    /// Control is kept at least this long, on the nominal path once that is clear: a conflict that comes and goes makes
    /// one take-over, not several, 0..60 [s].
    Seconds least_control = 5.0F;
    /// A vehicle that static threats block, without getting anywhere, gives up control and asks for a hold after this
    /// much time, of which all but braking counts a quarter; 0: never [s].
    Seconds patience = 20.0F;
    std::uint32_t plan_budget = 23000;  ///< of one plan, whatever updates it takes [work units]
    // Of `plan_budget` kept back for each method that is asked after another one [work units].
    std::uint32_t kept_for_next = 8000;
    std::uint32_t kept_for_reactive = 3000;  ///< where that decides anew at every update
    /// And of what a method has, but half of it at most, for the check of its answer; none where it decides anew.
    std::uint32_t kept_for_check = 2500;
    WorkPerUpdate work;  ///< what bounds a step's time on every target
};
/// Whether every setting lies within its range. O(1).
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

}  // namespace jink::avoid
