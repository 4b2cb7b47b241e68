// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/autopilot_state.hpp"

#include <algorithm>

namespace jink::app {

bool AutopilotState::take(const link::Inbox& inbox) noexcept
{
    is_new_ = inbox.has_autopilot;
    earlier_ = inbox.earlier_autopilot;
    const bool rebooted = is_new_ && inbox.autopilot.rebooted;
    if (is_new_) {
        report_ = inbox.autopilot;
        is_heard_ = true;
    }
    if (rebooted) {
        ++counts_.autopilot_reboots;
        leg_.reset();
    }
    if (inbox.leg_lost) {
        // Without a leg the measured motion is the nominal path: better than a leg that is no longer flown.
        counts_.legs_dropped += leg_ ? 1U : 0U;
        leg_.reset();
    }
    if (inbox.has_leg) {
        leg_ = inbox.leg.leg;
    }
    const auto has_answer = [&](bool accepted) {
        return std::any_of(inbox.mode_answers.begin(), inbox.mode_answers.end(),
                           [=](const link::ModeAnswer& a) { return a.accepted == accepted; });
    };
    mode_denied_ = has_answer(false);
    mode_accepted_ = has_answer(true);
    return rebooted;
}

const world::Leg* AutopilotState::flown_leg(bool follows_us) const noexcept
{
    const bool led_by_others = report_.mode == link::FlightMode::external && !follows_us;
    return leg_ && !led_by_others ? &*leg_ : nullptr;
}

}  // namespace jink::app
