// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/mode_evidence.hpp"

#include <algorithm>

namespace jink::app {

void ModeEvidence::note_heartbeat(TimePoint now) noexcept
{
    if (!has_polled_ && heard_unasked_) {
        gaps_[next_gap_] = std::clamp(now - heard_, kShortestPeriod, kLongestPeriod);
        next_gap_ = (next_gap_ + 1) % gaps_.size();
        period_ = std::max(std::min(gaps_[0], gaps_[1]), std::min(std::max(gaps_[0], gaps_[1]), gaps_[2]));
    }
    heard_unasked_ = !has_polled_;
    has_polled_ = is_void_ = false;
    has_heard_ = true;
    heard_ = now;
}

void ModeEvidence::note_request(TimePoint now) noexcept
{
    has_asked_ = true;
    barrier_ = now;
    waits_ = needed_ = false;
}

void ModeEvidence::note_accepted(TimePoint now) noexcept { barrier_ = std::max(barrier_, TimePoint{now.us - 1}); }

bool ModeEvidence::is_clear_to_ask(TimePoint now) noexcept
{
    needed_ = true;
    if (!waits_) {
        waits_ = true;
        waits_since_ = now;
    }
    const bool answered = now - heard_ <= kFresh;
    const bool is_unanswered = now - std::max(waits_since_, heard_) >= kAnswer;
    return is_newer_than_requests() && (answered || (is_unanswered && is_fresh(now)));
}

bool ModeEvidence::is_due(bool kept_fresh, TimePoint now) noexcept
{
    const bool stale = !is_newer_than_requests() || now - heard_ >= 0.5F * kFresh;
    const bool wanted = (needed_ || kept_fresh) && stale;
    waits_ = waits_ && needed_;
    needed_ = false;
    if (!wanted || (has_polled_ && now - polled_ < kPoll)) {
        return false;
    }
    has_polled_ = true;
    polled_ = now;
    return true;
}

}  // namespace jink::app
