// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/random.hpp"
#include "firmware/app/takeover.hpp"

// An autopilot with its own rules, a line with delays and losses, and a witness that knows only the line's traffic.

namespace jink::app::test {

using link::FlightMode;

inline constexpr int kNever = -1'000'000;
inline constexpr int kSecond = 50;  // ticks
inline constexpr float kTickTime = 0.02F;

/// Modes by their number on this wire. Two missions: control must return to the mission that was left.
enum Number : std::uint32_t { kMissionA = 3, kExternal = 4, kHold = 5, kManual = 16, kMissionB = 33 };

inline FlightMode meaning(std::uint32_t number)
{
    switch (number) {
    case kMissionA:
    case kMissionB: return FlightMode::mission;
    case kExternal: return FlightMode::external;
    case kHold: return FlightMode::hold;
    default: return FlightMode::manual;
    }
}

inline bool is_mission(std::uint32_t number) { return meaning(number) == FlightMode::mission; }

/// The line's traffic, in order.
template <class T>
class Line {
public:
    void send(const T& item, int arrives)
    {
        if (count_ < items_.size()) {
            last_ = std::max(last_, arrives);
            items_[(first_ + count_++) % items_.size()] = {item, last_};
        }
    }
    [[nodiscard]] bool take(int tick, T& item)
    {
        if (count_ == 0 || items_[first_].arrives > tick) {
            return false;
        }
        item = items_[first_].item;
        first_ = (first_ + 1) % items_.size();
        --count_;
        return true;
    }

private:
    struct Item {
        T item{};
        int arrives = 0;
    };
    std::array<Item, 16> items_{};
    std::size_t first_ = 0, count_ = 0;
    int last_ = 0;
};

struct Beat {
    std::uint32_t number = kMissionA;
    bool armed = true;
    int sent = 0;
    bool natural = true;
};
struct Request {
    TakeoverAction action = TakeoverAction::none;
    std::uint32_t number = 0;
    bool poll = false;
    int sent = 0;
};

/// One schedule's circumstances.
struct World {
    bool px4 = false;
    bool serves = true;    ///< answers a request of a HEARTBEAT
    bool refuses = false;  ///< denies the external mode
    int period = kSecond;  ///< of HEARTBEATs [ticks]
    int latency = 1;       ///< least [ticks]
    int jitter = 0;        ///< on top [ticks]
    float loss = 0.0F;     ///< of a frame, in either direction
    int proof = 0;         ///< least age of the set-point stream for which a PX4 grants the external mode [ticks]
    int phase = 0;

    /// A pilot's mode older than this when a request leaves counts as known [ticks]: transit time and age of a
    /// HEARTBEAT, ModeEvidence::kFresh if every request is answered in time, 1.5 periods otherwise.
    [[nodiscard]] int knowable() const
    {
        const bool answers = serves && loss <= 0.0F && jitter == 0;
        return (answers ? kSecond / 10 : kSecond * 3 / 2) + latency + jitter + 1;
    }
};

/// The pilot's modes that a granted request of jink ended.
struct Overridden {
    int known = 0;       ///< chosen longer ago than World::knowable
    int unknowable = 0;  ///< chosen while HEARTBEAT or request were on the line
};

/// The autopilot behind the line.
struct Machine {
    const World& world;
    Random& random;
    std::uint32_t number = kMissionA;
    bool armed = true;
    int last_setpoint = kNever;
    int stream_since = kNever;
    int chosen_at = kNever;
    bool is_chosen = false;  ///< by the pilot: the present mode, neither the mission nor the external mode
    Overridden overridden{};
    Line<Beat> beats{};
    Line<Request> requests{};
    Line<bool> answers{};
    int last_arrival = kNever;  ///< of HEARTBEATs and answers: one line, in their order

    [[nodiscard]] bool lost() const { return world.loss > 0.0F && random.uniform() < world.loss; }
    [[nodiscard]] int later(int tick) const
    {
        const int extra =
            world.jitter > 0 ? static_cast<int>(random.below(static_cast<std::uint64_t>(world.jitter))) : 0;
        return tick + world.latency + extra;
    }
    int next_arrival(int tick) { return last_arrival = std::max(last_arrival, later(tick)); }
    void beat(int tick, bool natural)
    {
        if (!lost()) {
            beats.send({number, armed, tick, natural}, next_arrival(tick));
        }
    }
    void enter(std::uint32_t next, int tick)
    {
        const bool change = next != number;
        is_chosen = is_chosen && !change;
        number = next;
        last_setpoint = next == kExternal ? tick : last_setpoint;
        if (change && !world.px4) {
            beat(tick, true);  // ArduPilot sends one with each change of mode
        }
    }
    void choose(std::uint32_t next, int tick)
    {
        enter(next, tick);
        is_chosen = next == kManual || next == kHold;
        chosen_at = tick;
    }
    void hear(int tick)
    {
        Request request;
        while (requests.take(tick, request)) {
            if (request.poll) {
                if (world.serves) {
                    beat(tick, false);
                }
                continue;
            }
            const bool external = request.action == TakeoverAction::request_external;
            const bool streamed = tick - last_setpoint <= kSecond / 2 && tick - stream_since >= world.proof;
            const bool granted = !external || (!world.refuses && (!world.px4 || streamed));
            if (granted) {
                if (is_chosen && armed && request.number != number) {
                    ++(request.sent - chosen_at > world.knowable() ? overridden.known : overridden.unknowable);
                }
                enter(request.number, tick);
            }
            if (!lost()) {
                answers.send(granted, next_arrival(tick));
            }
        }
    }
    void hear_setpoint(int tick)
    {
        stream_since = tick - last_setpoint > kSecond / 2 ? tick : stream_since;
        last_setpoint = tick;
    }
    void step(int tick)
    {
        if (world.px4 && number == kExternal && tick - last_setpoint > kSecond) {
            enter(kHold, tick);
        }
        if (tick % world.period == world.phase % world.period) {
            beat(tick, true);
        }
    }
};

/// Knows only the line's traffic. Returns the broken rule, or nullptr.
struct Witness {
    const World& world;
    Beat newest{};
    int beat_at = kNever;
    int naturals = 0;
    int request_at = kNever;
    int external_at = kNever;
    int accepted_at = kNever;
    int given_back_at = kNever;
    int held_at = kNever;  ///< the hold that was asked for came
    TakeoverAction last_action = TakeoverAction::none;
    bool effect_seen = false;       ///< another mode since the last request
    std::uint32_t number_then = 0;  ///< shown when it was made
    std::uint32_t left = 0;         ///< mission shown at the last request of the external mode
    bool claim = false;             ///< an observed external mode may be caused by us
    bool seen_external = false;
    bool hands_off = false;
    bool sticks = false;
    bool was_begun = false;     ///< a take-over
    bool may_ask_anew = false;  ///< in the next conflict, or after the next take-over

    void hear(const Beat& beat, int tick, Control control)
    {
        newest = beat;
        beat_at = tick;
        naturals += beat.natural ? 1 : 0;
        effect_seen = effect_seen || beat.number != number_then;
        const bool seen_before = seen_external;
        const bool ours = beat.armed && (beat.number == kExternal || beat.number == left);
        if (beat.number == kExternal && beat.armed) {
            seen_external = seen_external || claim;
        } else if (!ours || seen_external || (tick - external_at >= kSecond && control != Control::requesting)) {
            claim = seen_external = false;
        }
        given_back_at = beat.number == left && seen_before ? tick : given_back_at;
        held_at = beat.number == kHold && last_action == TakeoverAction::request_hold ? tick : held_at;
        const bool engaged = given_back_at != tick && held_at != tick &&
                             (control == Control::announcing || control == Control::requesting ||
                              control == Control::ours || control == Control::returning);
        hands_off = hands_off || (engaged && !ours && beat.number != kHold);
    }

    [[nodiscard]] const char* check(const TakeoverOutput& out, const Takeover& takeover, int tick, bool wants)
    {
        hands_off = hands_off && wants;
        sticks = sticks && wants;
        const Control control = takeover.control();
        const bool begun =
            control == Control::announcing || control == Control::requesting || control == Control::refused;
        if (begun && !was_begun && is_mission(newest.number)) {
            left = newest.number;
        }
        was_begun = begun;
        may_ask_anew = may_ask_anew || out.event == TakeoverEvent::took_over ||
                       (!wants && last_action == TakeoverAction::request_external);
        const bool fit = newest.armed && (newest.number == kExternal || is_mission(newest.number));
        if (takeover.streaming() && (beat_at == kNever || !fit)) {
            return "streams although the newest HEARTBEAT shows somebody else's mode";
        }
        if (takeover.streaming() && newest.number == kExternal && !claim) {
            return "streams into an external mode that was never asked for";
        }
        if (takeover.streaming() && (hands_off || sticks)) {
            return "streams after the pilot acted in this conflict";
        }
        if (out.action == TakeoverAction::none) {
            return nullptr;
        }
        if (beat_at == kNever || beat_at <= request_at) {
            return "asks for a mode without a HEARTBEAT since its last request";
        }
        const bool steady = world.loss == 0.0F && world.jitter == 0 && naturals > 4;
        const int allowed = (steady ? world.period : kSecond) * 3 / 2 + 1;
        if (tick - beat_at > allowed) {
            return "asks for a mode on an old HEARTBEAT";
        }
        if (accepted_at > request_at && !effect_seen && !may_ask_anew && out.action == last_action &&
            (beat_at < accepted_at || tick - request_at < kSecond / 2)) {
            return "repeats a request that was accepted";
        }
        effect_seen = may_ask_anew = false;
        last_action = out.action;
        number_then = newest.number;
        return check_action(out.action, takeover, tick);
    }

    [[nodiscard]] const char* check_action(TakeoverAction action, const Takeover& takeover, int tick)
    {
        if (!newest.armed) {
            return "asks a disarmed vehicle for a mode";
        }
        request_at = tick;
        switch (action) {
        case TakeoverAction::request_external:
            if (!is_mission(newest.number) || hands_off || sticks) {
                return "asks for the external mode against the pilot";
            }
            left = newest.number;
            claim = true;
            seen_external = false;
            external_at = tick;
            break;
        case TakeoverAction::request_former:
            if (newest.number != kExternal || !claim) {
                return "gives back what is not its own";
            }
            if (takeover.former_mode() != left) {
                return "gives back another mode than the one it left";
            }
            break;
        case TakeoverAction::request_hold:
            if (newest.number != kExternal && newest.number != left) {
                return "asks for the hold mode against the pilot";
            }
            break;
        case TakeoverAction::none: break;
        }
        return nullptr;
    }
};

}  // namespace jink::app::test
