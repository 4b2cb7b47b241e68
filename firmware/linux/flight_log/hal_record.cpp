// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/hal_record.hpp"

#include <algorithm>

namespace jink::flightlog {
namespace {

constexpr unsigned kExtended = 1U;
constexpr unsigned kRemote = 2U;
constexpr unsigned kFd = 4U;
constexpr unsigned kRateSwitch = 8U;

}  // namespace

void EntryWriter::frame(const hal::CanFrame& f) noexcept
{
    put(f.id);
    put(static_cast<std::uint8_t>((f.extended ? kExtended : 0U) | (f.remote ? kRemote : 0U) | (f.fd ? kFd : 0U) |
                                  (f.bit_rate_switch ? kRateSwitch : 0U)));
    put(f.length);
    bytes(std::span(f.data).first(std::min<std::size_t>(f.length, f.data.size())));
}

void EntryWriter::area(const app::Constraint& a) noexcept
{
    const world::Cylinder& c = a.cylinder;
    for (const float value : {c.circle.centre.x(), c.circle.centre.y(), c.circle.radius, c.velocity.x(), c.velocity.y(),
                              c.bottom, c.top, c.margin}) {
        put(value);
    }
    put(a.stamp.us);
    put(a.ends.us);
    put(static_cast<std::uint8_t>(a.about ? 1 : 0));
    if (a.about) {
        put(a.about->lat);
        put(a.about->lon);
        put(a.about->alt);
    }
}

void EntryWriter::count_at_end(std::uint64_t value) noexcept
{
    for (; value >= 0x80U; value >>= 7U) {
        byte(static_cast<unsigned>(value & 0x7FU) | 0x80U);
    }
    byte(static_cast<unsigned>(value));
}

Entry EntryReader::kind() const noexcept
{
    return rest_.empty() ? Entry::none : static_cast<Entry>(static_cast<unsigned>(rest_.front()) & 0x0FU);
}

Port EntryReader::port() const noexcept
{
    return rest_.empty() ? Port::line : static_cast<Port>(static_cast<unsigned>(rest_.front()) >> 4U & 0x07U);
}

bool EntryReader::lost_key() const noexcept
{
    return !rest_.empty() && (rest_.front() & kKeyOverwritten) != std::byte{0};
}

bool EntryReader::pass_content(Entry kind) noexcept
{
    switch (kind) {
    case Entry::none: return false;
    case Entry::begin:
    case Entry::shut_down: static_cast<void>(number<std::int64_t>()); return good_;
    case Entry::read: static_cast<void>(bytes(count())); return good_;
    case Entry::write:
        static_cast<void>(count());
        static_cast<void>(bytes(count()));
        return good_;
    case Entry::health: {
        hal::CanHealth any;  // the most counters
        static_cast<void>(count());
        health(any);
        return good_;
    }
    case Entry::can_frame:
    case Entry::can_sent:
    case Entry::can_refused: static_cast<void>(frame()); return good_;
    case Entry::can_nothing: return good_;
    case Entry::areas:
        static_cast<void>(number<std::int64_t>());
        for (std::uint64_t n = count(); n > 0 && good_; --n) {
            static_cast<void>(area());
        }
        return good_;
    case Entry::stored: static_cast<void>(number<std::uint32_t>()); return good_;
    }
    return false;
}

std::uint64_t EntryReader::count() noexcept
{
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64U; shift += 7U) {
        const auto part = number<std::uint8_t>();
        value |= static_cast<std::uint64_t>(part & 0x7FU) << shift;
        if (part < 0x80U) {
            break;
        }
    }
    return value;
}

std::span<const std::byte> EntryReader::bytes(std::uint64_t n) noexcept
{
    if (n > rest_.size()) {
        good_ = false;
        rest_ = {};
        return {};
    }
    const std::span<const std::byte> taken = rest_.first(static_cast<std::size_t>(n));
    rest_ = rest_.subspan(taken.size());
    return taken;
}

hal::CanFrame EntryReader::frame() noexcept
{
    hal::CanFrame f;
    f.id = number<std::uint32_t>();
    const unsigned flags = number<std::uint8_t>();
    f.extended = (flags & kExtended) != 0;
    f.remote = (flags & kRemote) != 0;
    f.fd = (flags & kFd) != 0;
    f.bit_rate_switch = (flags & kRateSwitch) != 0;
    f.length = number<std::uint8_t>();
    const std::span<const std::byte> data = bytes(std::min<std::size_t>(f.length, f.data.size()));
    std::copy(data.begin(), data.end(), f.data.begin());
    return f;
}

app::Constraint EntryReader::area() noexcept
{
    app::Constraint a;
    world::Cylinder& c = a.cylinder;
    for (float* value : {&c.circle.centre.x(), &c.circle.centre.y(), &c.circle.radius, &c.velocity.x(), &c.velocity.y(),
                         &c.bottom, &c.top, &c.margin}) {
        *value = number<float>();
    }
    a.stamp.us = number<std::int64_t>();
    a.ends.us = number<std::int64_t>();
    if (number<std::uint8_t>() != 0) {
        link::GlobalPosition about;
        about.lat = number<decltype(about.lat)>();
        about.lon = number<decltype(about.lon)>();
        about.alt = number<decltype(about.alt)>();
        a.about = about;
    }
    return a;
}

}  // namespace jink::flightlog
