// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/c_interface/reporting_link.hpp"

namespace jink::c_interface {

template <class Report, std::size_t N, std::size_t M>
void ReportingLink::deliver(StaticVector<Report, N>& reports, TimePoint now, StaticVector<Report, M>& into) noexcept
{
    for (const Report& report : reports) {
        const bool is_taken = report.stamp <= now && into.try_push_back(report);
        ++(is_taken ? reported_ : refused_);
    }
    reports.clear();
}

void ReportingLink::receive(std::span<const std::byte> bytes, TimePoint now, link::Inbox& inbox) noexcept
{
    link_.receive(bytes, now, inbox);
    deliver(tracks_, now, inbox.tracks);
    deliver(readings_, now, inbox.readings);
    // A parameter waits rather than being lost.
    std::size_t taken = 0;
    while (taken < params_.size() && inbox.params.try_push_back(params_[taken])) {
        ++taken;
    }
    for (std::size_t i = taken; i < params_.size(); ++i) {
        params_[i - taken] = params_[i];
    }
    params_.resize(params_.size() - taken);
}

}  // namespace jink::c_interface
