// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/flight_log/stream_head.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "firmware/app/text.hpp"
#include "firmware/flight_log/ulog.hpp"
#include "firmware/link/log_part.hpp"

namespace jink::flightlog {
namespace {

/// A topic's format: its text, and a field for each counter.
struct Described {
    TopicId id;
    std::string_view format;
};
constexpr std::array kTopics = std::to_array<Described>({
    {TopicId::step, StepTopic::kFormat},
    {TopicId::own, OwnTopic::kFormat},
    {TopicId::track, TrackTopic::kFormat},
    {TopicId::decision, DecisionTopic::kFormat},
    {TopicId::candidate, CandidateTopic::kFormat},
    {TopicId::app_counters, "jink_app_counters:uint64_t timestamp;"},
    {TopicId::avoid_counters, "jink_avoid_counters:uint64_t timestamp;"},
    {TopicId::log, StreamTopic::kFormat},
});

struct Info {
    std::string_view name;
    std::string_view text;
};
/// The format of records is jinkd's alone: without them a flight cannot be replayed.
constexpr std::array kInfos =
    std::to_array<Info>({{"sys_name", "jink"}, {"ver_sw", JINK_VERSION}, {"jink_log_format", "stream"}});

// Messages in their order.
constexpr std::size_t kHeader = 0;
constexpr std::size_t kFlags = 1;
constexpr std::size_t kFirstInfo = 2;
constexpr std::size_t kFirstFormat = kFirstInfo + kInfos.size();
constexpr std::size_t kFirstParameter = kFirstFormat + kTopics.size();
constexpr std::size_t kFirstSubscription = kFirstParameter + app::kParamCount;
constexpr std::size_t kMessages = kFirstSubscription + kTopics.size();

constexpr ulog::Type type_of(std::size_t index) noexcept
{
    return index < kFirstInfo           ? ulog::Type::flag_bits
           : index < kFirstFormat       ? ulog::Type::info
           : index < kFirstParameter    ? ulog::Type::format
           : index < kFirstSubscription ? ulog::Type::parameter
                                        : ulog::Type::subscription;
}

}  // namespace

/// Takes the bytes behind the first `skip` of what is put, as far as they fit, and counts all of them.
class StreamHead::Window {
public:
    Window(std::size_t skip, std::span<std::byte> into) noexcept : skip_(skip), into_(into) {}

    [[gnu::cold, gnu::noinline]] Window& put_bytes(std::span<const std::byte> bytes) noexcept
    {
        const std::size_t before = count_;
        count_ += bytes.size();
        if (count_ <= skip_) {
            return *this;
        }
        const std::span<const std::byte> rest = bytes.subspan(skip_ > before ? skip_ - before : 0);
        const std::size_t n = std::min(rest.size(), into_.size() - used_);
        std::copy_n(rest.begin(), n, into_.begin() + static_cast<std::ptrdiff_t>(used_));
        used_ += n;
        return *this;
    }
    template <class T>
    Window& put(T value) noexcept
    {
        return put_bytes(std::as_bytes(std::span(&value, 1)));
    }
    Window& put_text(std::string_view text) noexcept { return put_bytes(std::as_bytes(std::span(text))); }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] std::size_t used() const noexcept { return used_; }

private:
    std::size_t skip_;
    std::span<std::byte> into_;
    std::size_t count_ = 0;
    std::size_t used_ = 0;
};

namespace {

template <class Into, class T>
[[gnu::cold]] void put_counter_fields(std::span<const Counter<T>> counters, Into& into) noexcept
{
    for (const Counter<T>& counter : counters) {
        into.put_text("uint32_t ").put_text(counter.name).put_text(";");
    }
}

template <class Into>
[[gnu::cold]] void put_format(const Described& topic, Into& into) noexcept
{
    into.put_text(topic.format);
    if (topic.id == TopicId::app_counters) {
        put_counter_fields(app_counters(), into);
    } else if (topic.id == TopicId::avoid_counters) {
        put_counter_fields(avoid_counters(), into);
    }
}

template <class Into>
[[gnu::cold]] void put_parameter(std::size_t index, float value, Into& into) noexcept
{
    const app::ParamInfo& info = app::param_table()[index];
    const std::string_view type = info.integer ? "int32_t " : "float ";
    into.put(static_cast<std::uint8_t>(type.size() + info.name.size())).put_text(type).put_text(info.name);
    // A whole number is one: parameters are checked.
    into.put(info.integer ? static_cast<std::uint32_t>(static_cast<std::int32_t>(value))
                          : std::bit_cast<std::uint32_t>(value));
}

template <class Into>
[[gnu::cold]] void put_info(const Info& info, Into& into) noexcept
{
    app::Text key;
    key << "char[" << static_cast<std::uint32_t>(info.text.size()) << "] " << info.name;
    into.put(static_cast<std::uint8_t>(key.view().size())).put_text(key.view()).put_text(info.text);
}

}  // namespace

void StreamHead::put_content(std::size_t index, Window& into) const noexcept
{
    if (index < kFirstInfo) {
        into.put(std::array<std::uint8_t, ulog::kFlagBytes>{});
    } else if (index < kFirstFormat) {
        put_info(kInfos[index - kFirstInfo], into);
    } else if (index < kFirstParameter) {
        put_format(kTopics[index - kFirstFormat], into);
    } else if (index < kFirstSubscription) {
        put_parameter(index - kFirstParameter, values_[index - kFirstParameter], into);
    } else {
        const Described& topic = kTopics[index - kFirstSubscription];
        into.put(std::uint8_t{0}).put(topic.id).put_text(name_of_format(topic.format));
    }
}

void StreamHead::put_message(std::size_t index, Window& into) const noexcept
{
    if (index == kHeader) {
        into.put(ulog::kMagicAndVersion).put(static_cast<std::uint64_t>(started_.us));
        return;
    }
    Window counted(0, {});
    put_content(index, counted);
    into.put(static_cast<std::uint16_t>(counted.count())).put(type_of(index));
    put_content(index, into);
}

std::span<const std::byte> StreamHead::parameter(std::size_t index, std::span<std::byte> into) const noexcept
{
    Window window(0, into);
    put_message(kFirstParameter + index, window);
    return into.first(window.used());
}

StreamHead::Part StreamHead::part(Place from, std::span<std::byte> into) const noexcept
{
    static_assert(kFlags + 1 == kFirstInfo);
    Part part{{}, link::kNoMessageBegins, from};
    std::size_t used = 0;
    while (used < into.size() && !is_end(part.next)) {
        if (part.next.offset == 0 && part.first_message == link::kNoMessageBegins) {
            part.first_message = static_cast<std::uint8_t>(used);
        }
        Window window(part.next.offset, into.subspan(used));
        put_message(part.next.message, window);
        used += window.used();
        part.next.offset = static_cast<std::uint16_t>(part.next.offset + window.used());
        if (part.next.offset == window.count()) {
            part.next = {static_cast<std::uint16_t>(part.next.message + 1), 0};
        }
    }
    part.bytes = into.first(used);
    return part;
}

bool StreamHead::is_end(Place place) noexcept { return place.message >= kMessages; }

}  // namespace jink::flightlog
