// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "firmware/link/messages.hpp"

namespace jink::app {

/// Notices that the pilot moved the sticks since the take-over began.
///
/// Each source has its own rest position: the newest report before streaming began, or the first one after. A stick
/// that is away from there by the threshold or more in kReports consecutive reports of one source has moved. Where the
/// sticks rest does not matter: a throttle stick may lie anywhere. Reports that are not valid do not arrive here
/// (link::SticksReport).
///
/// Pure, O(1).
class StickWatch {
public:
    /// One tick.
    ///
    /// @param report     nullptr: none came
    /// @param streaming  a take-over is under way
    /// @param threshold  of half a stick's travel [-]; 0: the sticks are not watched
    /// @return moved since streaming began
    [[nodiscard]] bool update(const link::SticksReport* report, bool streaming, float threshold) noexcept;

    static constexpr int kReports = 2;

private:
    struct Source {
        bool known = false;
        std::array<float, 4> rest{};
        int away = 0;  ///< consecutive reports
    };
    std::array<Source, 2> sources_{};
    bool moved_ = false;
    bool was_streaming_ = false;
};

}  // namespace jink::app
