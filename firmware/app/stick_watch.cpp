// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/stick_watch.hpp"

#include <cmath>

namespace jink::app {

bool StickWatch::update(const link::SticksReport* report, bool streaming, float threshold) noexcept
{
    moved_ = moved_ && streaming && threshold > 0.0F;
    if (was_streaming_ && !streaming) {
        sources_ = {};  // what a former take-over saw says nothing of the next one
    }
    was_streaming_ = streaming;
    if (report == nullptr) {
        return moved_;
    }
    Source& source = sources_[report->from_radio ? 0 : 1];
    if (!streaming || !source.known) {
        source = {true, report->sticks, 0};
        return moved_;
    }
    bool away = false;
    for (std::size_t i = 0; i < source.rest.size(); ++i) {
        away = away || std::abs(report->sticks[i] - source.rest[i]) >= threshold;
    }
    source.away = away ? source.away + 1 : 0;
    moved_ = threshold > 0.0F && (moved_ || source.away >= kReports);
    return moved_;
}

}  // namespace jink::app
