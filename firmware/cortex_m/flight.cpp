// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/cortex_m/flight.hpp"

#include "firmware/app/built_map.hpp"
#include "firmware/app/reach_sets.hpp"

#include <bit>

namespace jink::firmware {
namespace {

using hal::cortex_m::FaultRecord;

/// Only hard faults are enabled; the cause (CFSR) gives the kind that became one.
std::string_view name_of(const FaultRecord& record) noexcept
{
    constexpr std::uint32_t kMemory = 0x000000FF;
    constexpr std::uint32_t kBus = 0x0000FF00;
    constexpr std::uint32_t kUsage = 0xFFFF0000;
    switch (record.exception) {
    case 2: return "watchdog";
    case 3:
        return (record.cause & kBus) != 0      ? "bus fault"
               : (record.cause & kMemory) != 0 ? "memory fault"
               : (record.cause & kUsage) != 0  ? "usage fault"
                                               : "hard fault";
    case 15: return "stuck step";
    case hal::cortex_m::kSilentReset: return "watchdog reset";
    default: return "stray interrupt";
    }
}

}  // namespace

FaultStory tell_story(const FaultRecord& record) noexcept
{
    FaultStory story;
    story.what << "jink: restart " << record.count << " by " << name_of(record);
    if (record.exception == hal::cortex_m::kSilentReset) {
        return story;
    }
    story.what << " at " << app::Hex{record.pc};
    story.where << "jink: exc " << record.exception << " cause " << app::Hex{record.cause} << " address "
                << app::Hex{record.address};
    return story;
}

void settle_reach_sets(app::Coprocessor& coprocessor) noexcept
{
    if constexpr (app::kHasReach) {
        if (reach::check(app::reach_sets()) != reach::SetStatus::good) {
            coprocessor.leave_out_reach_sets();
        }
    }
}

void settle_map([[maybe_unused]] app::Coprocessor& coprocessor) noexcept
{
#if defined(JINK_MAP)
    if (geometry::check(app::built_map()) == geometry::MapStatus::good) {
        coprocessor.use_map(app::built_map());
        return;
    }
    app::Text text;
    text << "jink: map damaged, passive";
    static_cast<void>(coprocessor.tell_when_heard(link::Severity::critical, text));
    coprocessor.stay_passive();
#endif
}

bool settle_faults(app::Coprocessor& coprocessor, hal::Clock& clock) noexcept
{
    FaultRecord record{};
    if (!hal::cortex_m::take_fault_record(record)) {
        return false;
    }
    const bool passive = record.streak >= kFaultsInARow;
    // The coprocessor is new and has space for three texts.
    if (record.streak <= kFaultsInARow || std::has_single_bit(record.count)) {
        const FaultStory story = tell_story(record);
        static_cast<void>(coprocessor.tell_when_heard(link::Severity::critical, story.what));
        if (!story.where.view().empty()) {
            static_cast<void>(coprocessor.tell_when_heard(link::Severity::notice, story.where));
        }
        if (passive) {
            app::Text text;
            text << "jink: " << record.streak << " faults in a row, passive until power-on";
            static_cast<void>(coprocessor.tell_when_heard(link::Severity::critical, text));
        }
    }
    if (passive) {
        coprocessor.stay_passive();
        for (const std::int64_t start = clock.now_us(); clock.now_us() - start < kPassiveWait;) {
            hal::cortex_m::wait_for_interrupt();
        }
    }
    return passive;
}

}  // namespace jink::firmware
