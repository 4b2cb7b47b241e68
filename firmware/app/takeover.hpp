// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/app/mode_evidence.hpp"
#include "firmware/link/messages.hpp"

namespace jink::app {

/// Who flies, as far as we know it.
enum class Control : std::uint8_t {
    autopilot,   ///< the autopilot flies by itself; we are silent
    announcing,  ///< set-points are streamed, the mode is not asked for yet
    requesting,  ///< the external mode was asked for
    ours,        ///< the autopilot follows us, confirmed by its HEARTBEAT
    returning,   ///< still ours, the former mode was asked for
    refused,     ///< the autopilot did not give control: advise only until this conflict is over, and ask it to hold in
                 ///< time
    overruled,   ///< a pilot or the autopilot chose another mode: hands off until this conflict is over
};

/// "?" for none of them. Ends with a zero byte.
[[nodiscard]] constexpr std::string_view name_of(Control control) noexcept
{
    switch (control) {
    case Control::autopilot: return "autopilot";
    case Control::announcing: return "announcing";
    case Control::requesting: return "requesting";
    case Control::ours: return "ours";
    case Control::returning: return "returning";
    case Control::refused: return "refused";
    case Control::overruled: return "overruled";
    }
    return "?";
}

/// What the application has to send because of it.
enum class TakeoverAction : std::uint8_t { none, request_external, request_former, request_hold };

/// What happened, for STATUSTEXT and counters.
enum class TakeoverEvent : std::uint8_t {
    none,
    took_over,
    gave_back,
    refused,
    overruled,
    lost,        ///< a fault of ours while in control: silent, and the autopilot is asked to hold
    held,        ///< the hold mode came that was asked for after control was given up
    sticks,      ///< the pilot moved the sticks: hands off, and the former mode is asked for
    unfollowed,  ///< the vehicle does not follow our commands: silent, and the autopilot is asked to hold
    found,       ///< the autopilot is armed in its external mode, and nobody knows whose that is: left alone
};

struct TakeoverInput {
    bool wants_control = false;    ///< the supervisor has something to fly
    bool in_conflict = false;      ///< a conflict is still predicted
    bool may_act = false;          ///< acting is allowed and everything needed is healthy
    bool urgent_hold = false;      ///< not in control, it is time to stop, and to stop is safer than to go on
    bool has_report = false;       ///< a HEARTBEAT of the autopilot arrived since the last tick
    bool report_is_late = false;   ///< it may have waited for us: we were not there when it came
    link::AutopilotReport report;  ///< the newest one
    /// HEARTBEATs that arrived before `report` since the last tick and showed another mode.
    std::span<const link::AutopilotReport> earlier{};
    bool mode_denied = false;    ///< a COMMAND_ACK refused the mode
    bool mode_accepted = false;  ///< a COMMAND_ACK accepted the mode
    bool link_alive = true;      ///< what is asked for can leave
    bool stands_by = false;      ///< what a take-over needs is kept ready before it is wanted
    bool sticks_moved = false;   ///< by the pilot, since streaming() began
    bool unfollowed = false;     ///< the vehicle's motion shows that it does not follow what we command
};

struct TakeoverOutput {
    TakeoverAction action = TakeoverAction::none;
    TakeoverEvent event = TakeoverEvent::none;
    bool ask_heartbeat = false;  ///< ask the autopilot for a HEARTBEAT now
};

struct TakeoverDiagnostics {
    std::uint32_t requests = 0;  ///< of the external mode
    std::uint32_t taken = 0;
    std::uint32_t given_back = 0;
    std::uint32_t refused = 0;
    std::uint32_t overruled = 0;
    std::uint32_t lost_by_fault = 0;  ///< control dropped because of a fault of ours
    std::uint32_t hold_requests = 0;  ///< after a loss or a refusal
    std::uint32_t held = 0;           ///< TakeoverEvent::held
    std::uint32_t sticks = 0;         ///< TakeoverEvent::sticks
    std::uint32_t unfollowed = 0;     ///< TakeoverEvent::unfollowed
    std::uint32_t heartbeats_asked = 0;
};

/// Taking over and giving back as autopilots want it: stream first, ask for the external mode, wait for the HEARTBEAT
/// that shows it (1 s, two more tries), flown from the accepted answer on, fly, ask for the former mode, stream until
/// that is confirmed. Any other mode seen is the pilot's: stop at once. A mode asked for stays ours to fly or to give
/// back when a fault of ours silences us meanwhile: as soon as acting is allowed again and the HEARTBEAT shows it.
///
/// PX4 documents (up to v1.16) that it grants OFFBOARD only after more than a second of set-points; its sources since
/// v1.14 ask for recent ones alone. So it is asked early, and while it refuses and the stream is younger than that,
/// asked again without counting tries.
///
/// What decides a late conflict is the time to the request. With `stands_by` it is made in the tick in which control is
/// wanted: in flight on a mission HEARTBEATs are asked for so often that the newest is always evidence, and a slow
/// stream runs to a PX4, which takes note of it and does not fly it outside OFFBOARD (its MavlinkReceiver). ArduPilot
/// asks for no stream.
///
/// A loss of control asks for the hold mode, again and again (kHoldTries) until a HEARTBEAT shows any other mode than
/// the external one: the hold, or somebody else's choice.
///
/// A mode is asked for on fresh evidence alone (ModeEvidence): a HEARTBEAT that shows the mode that the request is
/// meant for. One is asked for as soon as control is wanted, so that the answer is there when the request is due.
/// Without such evidence nothing is asked for and no new stream begins. What remains: a pilot's choice within the time
/// that a HEARTBEAT and a request take on the line, or within the 1.5 periods on a line that does not answer. No
/// autopilot offers a request that depends on its present mode.
///
/// While nothing is heard, no mode is asked for, the hold mode included: the pilot may fly by now. The autopilot's own
/// rule for a stream that ends stops the vehicle. A HEARTBEAT is asked for every ModeEvidence::kPoll, and the first one
/// that shows the external mode lets the request go. HEARTBEATs before the newest of a tick are no evidence, but each
/// change of mode in them counts.
///
/// The former mode is the one that stood at the take-over. The claim to give it back ends with any other mode seen, or
/// when no HEARTBEAT came for kClaim: a pilot may have flown meanwhile.
///
/// Sticks that moved end the take-over at once; the former mode is asked for without a stream, kTries at most.
/// Commands that are not followed end it as well: the hold mode is asked for, and until the vehicle is disarmed nothing
/// is taken over again. A vehicle that cannot be steered (AutopilotReport::steerable) is never taken over.
///
/// Pure: no messages, no clock; O(1) per tick.
class Takeover {
public:
    [[nodiscard]] TakeoverOutput update(const TakeoverInput& input, TimePoint now) noexcept;

    /// A fault of ours or a rebooted autopilot: back to silence at once.
    void drop(bool by_fault) noexcept;

    /// The mode to give back, as on the wire.
    [[nodiscard]] std::uint32_t former_mode() const noexcept { return former_mode_; }
    [[nodiscard]] Control control() const noexcept { return control_; }
    /// Set-points are due: from before the request until the former mode is confirmed.
    [[nodiscard]] bool streaming() const noexcept
    {
        return control_ == Control::announcing || control_ == Control::requesting || in_control();
    }
    /// A slow stream is due, so that a PX4 grants its external mode without delay.
    [[nodiscard]] bool proving() const noexcept { return stream_.is_proving; }
    /// The autopilot follows us.
    [[nodiscard]] bool in_control() const noexcept
    {
        return control_ == Control::ours || control_ == Control::returning;
    }
    /// The autopilot flies our set-points: in control, or the external mode was granted and no HEARTBEAT has come
    /// since, which a PX4 sends once a second.
    [[nodiscard]] bool follows() const noexcept
    {
        return in_control() || (control_ == Control::requesting && request_.granted);
    }
    /// The newest HEARTBEAT showed the external mode and is fresh enough to ask for another one.
    [[nodiscard]] bool may_ask_to_hold(TimePoint now) const noexcept
    {
        return in_control() && evidence_.is_newer_than_requests() && evidence_.is_fresh(now);
    }
    [[nodiscard]] const TakeoverDiagnostics& diagnostics() const noexcept { return diagnostics_; }

    /// Stream this long before the request [s]: PX4's commander, which runs 100 times a second, refuses OFFBOARD, with
    /// a text to the pilot, where it reads the first set-point and the request in one pass.
    static constexpr Seconds kAnnounce = 0.015F;
    /// Wait this long for a confirmation [s].
    static constexpr Seconds kConfirm = 1.0F;
    static constexpr int kTries = 3;
    /// A PX4 may refuse the external mode while the stream is younger than this [s].
    static constexpr Seconds kProof = 1.3F;
    /// And is asked again this long after it did [s].
    static constexpr Seconds kAskAgain = 0.2F;
    /// Any other refusal is answered after this [s].
    static constexpr Seconds kRetry = 0.06F;
    /// The hold mode is asked for again after this long without an answer, after kConfirm where it was accepted [s].
    static constexpr Seconds kHoldRepeat = 0.5F;
    static constexpr int kHoldTries = 5;
    /// A silence longer than this ends the claim to an external mode [s].
    static constexpr Seconds kClaim = 10.0F;

private:
    TakeoverEvent heed_earlier(const TakeoverInput& input, TimePoint now) noexcept;
    void note_report(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput decide(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput idle(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput ask(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput fly(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput stand_by(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput keep_off(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput yield_to_sticks(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput give_up(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverOutput lose(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] bool foreign(const TakeoverInput& input) const noexcept;
    [[nodiscard]] bool is_free(const TakeoverInput& input) const noexcept;
    [[nodiscard]] TakeoverOutput overrule() noexcept;
    [[nodiscard]] TakeoverOutput take(TimePoint now) noexcept;
    void expire_claim(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverAction begin_hold(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] TakeoverAction insist_on_hold(const TakeoverInput& input, TimePoint now) noexcept;
    [[nodiscard]] bool hold_is_ours(TimePoint now) const noexcept;

    /// Why the autopilot may be, or come to be, in the external mode; outlasts a fault of ours.
    enum class Claim : std::uint8_t {
        none,   ///< an external mode would be somebody else's
        asked,  ///< we asked for it and have not seen it
        held,   ///< we asked for it and have seen it
    };

    /// The external mode, as it is asked for.
    struct Request {
        TimePoint asked;
        int tries = 0;  ///< in this conflict; once refused, of the hold mode
        bool denied = false;
        bool granted = false;
    };
    struct ClaimState {
        Claim kind = Claim::none;
        bool is_seen = false;  ///< a HEARTBEAT has shown the external mode since: any other mode ends the claim
    };
    struct Stream {
        bool is_proving = false;
        TimePoint since;
    };
    /// The hold mode after a loss of control: due until a HEARTBEAT shows that the external mode is over.
    struct Hold {
        bool due = false;
        bool accepted = false;  ///< the last request
        int tries = 0;          ///< since the loss
        TimePoint asked;
    };
    /// The former mode after sticks that moved: asked for without a stream.
    struct Back {
        bool due = false;
        int tries = 0;
        TimePoint asked;
    };

    Control control_ = Control::autopilot;
    std::uint32_t former_mode_ = 0;
    link::FlightMode mode_ = link::FlightMode::unknown;
    TimePoint since_;
    Request request_;
    ClaimState claim_;
    bool asked_back_ = false;  ///< the former mode was asked for and its confirmation may still be on its way
    Stream stream_;
    Hold hold_;
    Back back_;
    bool unfollowed_ = false;                            ///< since the vehicle was armed
    TakeoverAction last_action_ = TakeoverAction::none;  ///< asked for last
    bool found_ = false;                                 ///< the first HEARTBEAT was seen

    ModeEvidence evidence_;
    TakeoverDiagnostics diagnostics_;
};

}  // namespace jink::app
