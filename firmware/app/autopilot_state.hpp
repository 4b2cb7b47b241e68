// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "firmware/app/diagnostics.hpp"
#include "firmware/link/messages.hpp"

namespace jink::app {

/// What the autopilot says of itself: mode, answers to requests of a mode, and the leg that it flies.
class AutopilotState {
public:
    explicit AutopilotState(Diagnostics& counts) noexcept : counts_(counts) {}

    /// One step's reports. @return the autopilot has restarted: places of its frame no longer hold
    [[nodiscard]] bool take(const link::Inbox& inbox) noexcept;

    [[nodiscard]] bool is_heard() const noexcept { return is_heard_; }
    /// As last heard; the default values until then.
    [[nodiscard]] const link::AutopilotReport& report() const noexcept { return report_; }
    /// A HEARTBEAT came in this step.
    [[nodiscard]] bool is_new() const noexcept { return is_new_; }
    /// HEARTBEATs before the newest one in this step that showed another mode.
    [[nodiscard]] std::span<const link::AutopilotReport> earlier() const noexcept
    {
        return {earlier_.begin(), earlier_.end()};
    }
    [[nodiscard]] bool has_denied_mode() const noexcept { return mode_denied_; }      ///< in this step
    [[nodiscard]] bool has_accepted_mode() const noexcept { return mode_accepted_; }  ///< in this step

    /// The mission's leg while the autopilot flies the mission or follows us; null where none is known. An external
    /// mode that is not ours leads somewhere else.
    /// @param follows_us  Takeover::streaming()
    [[nodiscard]] const world::Leg* flown_leg(bool follows_us) const noexcept;

private:
    Diagnostics& counts_;
    link::AutopilotReport report_;
    bool is_heard_ = false;
    bool is_new_ = false;
    decltype(link::Inbox::earlier_autopilot) earlier_;
    bool mode_denied_ = false;
    bool mode_accepted_ = false;
    std::optional<world::Leg> leg_;
};

}  // namespace jink::app
