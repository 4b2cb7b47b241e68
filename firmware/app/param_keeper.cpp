// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/param_keeper.hpp"

namespace jink::app {
namespace {

[[gnu::noinline]] void report(Coprocessor& coprocessor, link::Severity severity, std::string_view what) noexcept
{
    Text text;
    text << what;
    static_cast<void>(coprocessor.tell_when_heard(severity, text));
}

}  // namespace

void ParamKeeper::start(Coprocessor& coprocessor) noexcept
{
    ParamValues values = coprocessor.initial_parameters();
    const ParamLoad load = flash_.load(values);
    const std::size_t refused = load.unknown + (load.taken > 0 ? coprocessor.restore_parameters(values) : 0U);
    if (load.damaged) {
        report(coprocessor, link::Severity::critical, "jink: stored parameters damaged, left out");
    } else if (refused > 0) {
        report(coprocessor, link::Severity::warning, "jink: some stored parameters left out");
    }
    kept_ = coprocessor.parameters().generation();
    coprocessor.note_stored(kept_);
}

void ParamKeeper::work(Coprocessor& coprocessor, TimePoint now) noexcept
{
    const std::uint32_t generation = coprocessor.parameters().generation();
    if (generation == kept_ || (failed_ && now < retry_) || !coprocessor.is_disarmed(now)) {
        return;
    }
    if (flash_.save(coprocessor.initial_parameters(), coprocessor.parameters().values())) {
        kept_ = generation;
        failed_ = false;
        coprocessor.note_stored(generation);
        return;
    }
    if (!failed_) {
        report(coprocessor, link::Severity::warning, "jink: parameters are not stored");
    }
    failed_ = true;
    retry_ = now + kRetry;
}

}  // namespace jink::app
