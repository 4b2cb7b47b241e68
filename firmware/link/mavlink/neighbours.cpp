// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/neighbours.hpp"

#include <algorithm>

namespace jink::link::mavlink {
namespace {

// As in ClockSync [ms].
constexpr std::int32_t kJump = 200;
constexpr std::int8_t kJumpsToBelieve = 3;
constexpr std::int32_t kBucket = 5000;
constexpr std::int32_t kUnheard = 10'000;

std::uint32_t milliseconds(TimePoint t) noexcept { return static_cast<std::uint32_t>(t.us / 1000); }
std::int32_t less(std::uint32_t a, std::uint32_t b) noexcept { return static_cast<std::int32_t>(a - b); }

}  // namespace

Neighbours::System& Neighbours::of(std::uint8_t id, std::uint32_t now) noexcept
{
    auto* found = std::find_if(systems_.begin(), systems_.end(), [&](const System& s) { return s.id == id; });
    if (found == systems_.end()) {
        if (systems_.size() == systems_.capacity()) {
            found = std::max_element(systems_.begin(), systems_.end(), [&](const System& a, const System& b) {
                return less(now, a.heard) < less(now, b.heard);
            });
            ++evicted_;
        } else {
            systems_.unchecked_push_back({});
            found = &systems_.back();
        }
        *found = {};
        found->id = id;
        found->heard = now;
    }
    return *found;
}

void Neighbours::start_clock(System& system, std::uint32_t boot, std::uint32_t now) noexcept
{
    system.least = now - boot;
    system.began = now;
    system.newest = boot;
    system.ahead = system.behind = 0;
    system.has_clock = true;
    system.has_former = false;
}

void Neighbours::add(System& system, std::uint32_t sample, std::uint32_t now) noexcept
{
    if (less(now, system.began) >= kBucket) {
        system.former = system.least;
        system.has_former = true;
        system.least = sample;
        system.began = now;
    } else if (less(sample, system.least) < 0) {
        system.least = sample;
    }
}

std::uint32_t Neighbours::System::best() const noexcept
{
    return has_former && less(former, least) < 0 ? former : least;
}

TimePoint Neighbours::stamp(std::uint8_t system, std::uint32_t boot_ms, TimePoint now) noexcept
{
    const std::uint32_t arrived = milliseconds(now);
    System& s = of(system, arrived);
    if (!s.has_clock || less(arrived, s.heard) > kUnheard) {
        start_clock(s, boot_ms, arrived);
    }
    s.heard = arrived;
    const std::uint32_t sample = arrived - boot_ms;
    const std::int32_t delay = less(sample, s.best());
    const bool late = delay > kJump;
    const bool from_future = delay < -kJump;
    const bool from_past = late && less(boot_ms, s.newest) < -kJump;
    s.ahead = from_future ? static_cast<std::int8_t>(s.ahead + 1) : std::int8_t{0};
    s.behind = from_past ? static_cast<std::int8_t>(s.behind + 1) : std::int8_t{0};
    if (s.ahead >= kJumpsToBelieve || s.behind >= kJumpsToBelieve) {
        start_clock(s, boot_ms, arrived);
    } else if (!from_future && !from_past) {
        s.newest = less(boot_ms, s.newest) > 0 ? boot_ms : s.newest;
        if (!late) {
            add(s, sample, arrived);
        }
    }
    const std::int32_t age = less(sample, s.best());
    return age > 0 ? TimePoint{now.us - std::int64_t{age} * 1000} : now;
}

void Neighbours::note_armed(std::uint8_t system, bool armed, TimePoint now) noexcept
{
    of(system, milliseconds(now)).disarmed = !armed;
}

bool Neighbours::is_disarmed(std::uint8_t system) const noexcept
{
    return std::any_of(systems_.begin(), systems_.end(), [&](const System& s) { return s.id == system && s.disarmed; });
}

}  // namespace jink::link::mavlink
