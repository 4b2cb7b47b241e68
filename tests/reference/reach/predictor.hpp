// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "tests/reference/reach/segments.hpp"

// Trajectories of orders of the movement automaton, in exact form and as samples for a tracking controller (Gomola
// 6.2.1, 6.2.3, 6.2.7).
//
// Frame: z up, yaw counter-clockwise from x, pitch > 0 nose down; the grid's or the world's, as for the start. The
// integrator's part: a controller that keeps the vehicle in a tube about the samples, whose radius goes into the safety
// margin.

namespace jink::reach {

/// One order of the navigator to the autopilot.
struct Order {
    Movement movement = Movement::straight;
    float duration = 1.0F;  ///< [s]
    float speed = 1.0F;     ///< constant [m/s], >= 0; straight at 0 means to stay
};

/// Transition time before a change of the order takes effect [s], flown straight; Gomola uses 0 for all (Gomola 6.2.5).
/// Two simultaneous changes take the longer time; a change from one side to the other takes two.
struct TransitionTimes {
    float turn = 0.0F;   ///< between straight flight and a turn
    float pitch = 0.0F;  ///< between level flight and a climb or descent
    float speed = 0.0F;  ///< from any speed to another; the old one is kept until then
};

struct AutomatonSettings {
    float period = 1.0F;         ///< of a movement that turns by one whole step [s], > 0
    float least_holding = 1.0F;  ///< least time that an order is flown after its transitions [s]
    TransitionTimes transitions;
    float payload = 0.0F;  ///< [kg]
};
/// Numbers are finite and not negative, the period is positive.
[[nodiscard]] bool is_usable(const AutomatonSettings& settings) noexcept;

/// Least duration of an order: to hold it, and the longest changes that may come before and after (Gomola eq. 6.7; the
/// maximum of the sum). O(movements).
[[nodiscard]] float least_duration(const AutomatonSettings& settings, const Order& order) noexcept;

/// True for a valid movement and speed, and a positive duration of at least the least duration, within 1e-6.
[[nodiscard]] bool can_be_flown(const AutomatonSettings& settings, const Order& order) noexcept;

/// State of a flying vehicle.
struct FlightState {
    Pose<float> pose;    ///< [m], [rad]
    float speed = 1.0F;  ///< [m/s]
};
/// End of the last order; sets the transitions of the next order.
struct Exit {
    Movement movement = Movement::straight;
    float speed = 1.0F;  ///< [m/s]
};

/// An order as flown: transitions, the order, and the transition back to straight flight (Gomola eq. 6.6).
struct Leg {
    Order order;
    float begin = 0.0F;  ///< in the trajectory [s]
    float entry = 0.0F;  ///< changes before [s]: straight, at the speed before
    float leave = 0.0F;  ///< transition after [s], if nothing follows: straight
    FlightState from;
    float pitch_rate = 0.0F;  ///< [rad/s]
    float yaw_rate = 0.0F;    ///< [rad/s]
    Exit exit;

    [[nodiscard]] float end() const noexcept { return begin + order.duration; }
};
/// The automaton's builder (Gomola eq. 6.19): adds the transitions of an order.
/// @param last  no order follows, so the leg must end in straight flight (Gomola definition 2) O(1).
[[nodiscard]] Leg build_leg(const AutomatonSettings& settings, const SegmentLimits& limits, const FlightState& from,
                            const Exit& before, const Order& order, float begin, bool last) noexcept;
/// The same in the segment of the state before (Gomola eq. 6.48). False, and nothing written, when the order cannot be
/// flown or its speed is too far from that of the state.
/// @param outside  out: the state lies outside the envelope
/// O(movements + intervals).
[[nodiscard]] bool build_leg(const AutomatonSettings& settings, const Segments& segments, const FlightState& from,
                             const Exit& before, const Order& order, float begin, bool last, Leg& out,
                             bool& outside) noexcept;
/// State on a leg after `elapsed` in [0, duration]; exact, in float: 1e-6 of the path length. O(1).
[[nodiscard]] FlightState at(const Leg& leg, float elapsed) noexcept;

/// Orders of one trajectory: the present order and kMaxPlanned more. A path from a reach set has up to 16.
inline constexpr std::size_t kMaxPlanned = 32;
inline constexpr std::size_t kMaxLegs = kMaxPlanned + 1;
static_assert(kMaxPlanned >= 16 && kMaxPlanned <= 256);

enum class PredictStatus : std::uint8_t {
    complete,
    truncated,    ///< more orders than the capacity
    refused,      ///< an order that is too short or not a number, or a speed too far from the one before
    bad_setting,  ///< of the automaton
};

/// Back-to-back legs; that number i covers (end of i - 1, its end] (Gomola eq. 6.8, 6.10).
struct Trajectory {
    FlightState start;
    float begin = 0.0F;  ///< [s]
    StaticVector<Leg, kMaxLegs> legs;
    std::size_t not_emitted = 0;  ///< missing orders, when truncated or refused
    std::size_t outside = 0;      ///< legs whose state before lies outside the envelope

    /// Gomola eq. 6.22. With no leg: the begin.
    [[nodiscard]] float end() const noexcept { return legs.empty() ? begin : legs.back().end(); }
};

/// The trajectory of `orders` from `start` at time `begin`, up to the first order that cannot be flown. Pure.
/// O(orders).
/// @param before  end of the order flown until `start`
PredictStatus predict(const AutomatonSettings& settings, const Segments& segments, const FlightState& start,
                      const Exit& before, float begin, std::span<const Order> orders, Trajectory& out) noexcept;

/// State at time `t` (Gomola eq. 6.21). False, and nothing written, outside [begin, end]. O(legs).
[[nodiscard]] bool project(const Trajectory& trajectory, float t, FlightState& out) noexcept;

/// A point for a tracking controller.
struct ReferenceSample {
    float time = 0.0F;             ///< [s]
    Vec3 position = Vec3::Zero();  ///< [m]
};
/// Three samples within each of kMaxPlanned orders, their ends and the start.
inline constexpr std::size_t kMaxReferenceSamples = 4 * kMaxPlanned + 1;
struct Reference {
    StaticVector<ReferenceSample, kMaxReferenceSamples> samples;
    std::size_t not_emitted = 0;  ///< orders without samples: the last ones
};

/// The start and `per_order` >= 1 evenly spaced samples of each leg, its end the last of them: n M + 1 in all (Gomola's
/// eq. 6.49 omits the start). If they exceed the capacity, truncated by whole legs, with the missing orders counted.
/// O(n M).
PredictStatus sample(const Trajectory& trajectory, std::size_t per_order, Reference& out) noexcept;

}  // namespace jink::reach
