// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/link.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/numbers.hpp"
#include "firmware/link/mavlink/text.hpp"

namespace jink::link::mavlink {

/// Our HEARTBEAT: an onboard controller, no autopilot.
[[nodiscard]] inline Heartbeat heartbeat_of(SystemState state) noexcept
{
    constexpr std::uint8_t kTypeOnboardController = 18;
    Heartbeat m;
    m.type = kTypeOnboardController;
    m.autopilot = kAutopilotInvalid;
    m.system_status = static_cast<std::uint8_t>(state);
    return m;
}

/// A STATUSTEXT, cut to 50 characters.
[[nodiscard]] inline Statustext text_of_severity(Severity severity, std::string_view text) noexcept
{
    Statustext m;
    m.severity = static_cast<std::uint8_t>(severity);
    static_cast<void>(set_text(m.text, text));  // the contract permits cutting
    return m;
}

}  // namespace jink::link::mavlink
