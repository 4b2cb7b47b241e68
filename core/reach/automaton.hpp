// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "core/reach/predictor.hpp"

// The movement automaton: orders that are planned, the one under way, and those that were flown (Gomola 6.2.1 to
// 6.2.3).

namespace jink::reach {

/// Movements that were flown and are remembered, for telemetry: twice the longest path. The oldest give way.
inline constexpr std::size_t kMaxExecuted = 32;
static_assert(kMaxExecuted >= 1 && kMaxExecuted <= 1024);

enum class PushStatus : std::uint8_t {
    taken,
    full,       ///< no room; the plan is as it was
    too_short,  ///< less than the least duration, not finite, or no movement
};

enum class StepStatus : std::uint8_t {
    running,
    /// Nothing is planned. Past the plan's end nobody knows here where the vehicle is: no order begins until `begin`
    /// says.
    ran_dry,
    /// The next order cannot be flown from here: its speed is too far from the one before. Else as ran_dry.
    refused,
    went_back,   ///< now lies before the step before; nothing was done
    not_usable,  ///< settings
};

/// A movement that was flown to its end.
struct Executed {
    Order order;
    TimePoint begin;
};

/// Orders are flown back-to-back. What is planned may change at any time; what is under way is never cut. The movement
/// that began at time a and ends at b is under way in (a, b]: at b itself it is the one, not the next.
///
/// Memory: one leg, kMaxPlanned orders, kMaxExecuted entries: about 1 KiB.
class MovementAutomaton {
public:
    /// @param segments  outlives this
    MovementAutomaton(const AutomatonSettings& settings, const Segments& segments) noexcept
        : settings_(settings), segments_(&segments)
    {
    }

    /// Puts the vehicle where it is. What is under way and planned is forgotten; the log is kept.
    void begin(const FlightState& at, TimePoint now) noexcept;

    /// Plans one order more. O(movements).
    [[nodiscard]] PushStatus push(const Order& order) noexcept;
    /// Puts these in place of what is planned: all of them, or none. O(orders movements).
    [[nodiscard]] PushStatus replan(std::span<const Order> orders) noexcept;

    /// Goes on to the order that is under way at `now`. O(planned).
    [[nodiscard]] StepStatus step(TimePoint now) noexcept;

    /// What is under way and what is planned, time 0 when the one under way began. O(planned).
    PredictStatus trajectory(Trajectory& out) const noexcept;
    /// State at `now`: false before the movement under way began and after the plan's end. O(planned).
    [[nodiscard]] bool project(TimePoint now, FlightState& out) const noexcept;

    [[nodiscard]] bool is_running() const noexcept { return is_running_; }
    /// Of what is under way; only while it is.
    [[nodiscard]] const Leg& running() const noexcept { return leg_; }
    [[nodiscard]] TimePoint running_since() const noexcept { return since_; }
    [[nodiscard]] std::span<const Order> planned() const noexcept { return {planned_.data(), planned_.size()}; }

    /// Movements that were flown and are remembered; the oldest is number 0.
    [[nodiscard]] std::size_t executed() const noexcept { return logged_ < kMaxExecuted ? logged_ : kMaxExecuted; }
    [[nodiscard]] const Executed& executed(std::size_t i) const noexcept
    {
        return log_[(logged_ - executed() + i) % kMaxExecuted];
    }
    /// That were flown and are not remembered any more.
    [[nodiscard]] std::size_t overwritten() const noexcept { return logged_ - executed(); }
    /// Orders that push and replan have refused.
    [[nodiscard]] std::size_t refused() const noexcept { return refused_; }
    /// Movements begun in a state outside the envelope.
    [[nodiscard]] std::size_t outside() const noexcept { return outside_; }

private:
    [[nodiscard]] PushStatus judge(const Order& order) const noexcept;
    [[nodiscard]] bool begin_next() noexcept;
    void finish() noexcept;

    AutomatonSettings settings_;
    const Segments* segments_;
    FlightState state_;  ///< where the leg under way begins, or where everything has ended
    Exit exit_;
    TimePoint since_;
    TimePoint last_step_;
    bool is_running_ = false;
    bool is_placed_ = false;  ///< begin was called, and the plan has not run dry since
    Leg leg_;
    StaticVector<Order, kMaxPlanned> planned_;
    std::array<Executed, kMaxExecuted> log_{};
    std::size_t logged_ = 0;
    std::size_t refused_ = 0;
    std::size_t outside_ = 0;
};

}  // namespace jink::reach
