// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/snapshot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "firmware/app/step_report.hpp"
#include "firmware/app/takeover.hpp"

namespace jink::livepage {
namespace {

using flightlog::name_of;
using flightlog::Xyz;

constexpr float kMaxShown = 1e7F;  // as toolchain/host/flight_page.hpp

template <class T>
std::optional<T> topic_of(std::span<const std::byte> content)
{
    T topic;
    if (content.size() != flightlog::kBytesOf<T>) {
        return std::nullopt;
    }
    std::memcpy(static_cast<void*>(&topic), content.data(), flightlog::kBytesOf<T>);  // the rest is padding
    return topic;
}

template <class T>
T number_at(std::span<const std::byte> content, std::size_t at)
{
    T value{};
    std::memcpy(&value, content.data() + at, sizeof value);
    return value;
}

template <class... Values>
void add(std::string& out, const char* format, Values... values)
{
    std::array<char, 240> text{};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg): GCC 12 has no std::format
    const int n = std::snprintf(text.data(), text.size(), format, values...);
    out.append(text.data(), std::min(static_cast<std::size_t>(std::max(n, 0)), text.size() - 1));
}

/// Null where it is unknown.
void add_number(std::string& out, double value)
{
    if (std::abs(value) <= static_cast<double>(kMaxShown)) {
        add(out, "%.3f", value);
    } else {
        out += "null";
    }
}

void add_vector(std::string& out, const Xyz& position, const Xyz& velocity = {}, double seconds = 0.0)
{
    for (std::size_t k = 0; k < 3; ++k) {
        out += k == 0 ? '[' : ',';
        add_number(out, static_cast<double>(position[k]) + seconds * static_cast<double>(velocity[k]));
    }
    out += ']';
}

/// In quotes. Control characters and bytes beyond ASCII become question marks.
void add_string(std::string& out, std::string_view text)
{
    out += '"';
    for (const char c : text.substr(0, text.find('\0'))) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += '\\';
        }
        out += byte >= 0x20U && byte < 0x7FU ? c : '?';
    }
    out += '"';
}

void add_name(std::string& out, const char* key, std::string_view name)
{
    add(out, ",\"%s\":", key);
    add_string(out, name);
}

}  // namespace

double Snapshot::seconds(std::uint64_t timestamp) const noexcept
{
    return static_cast<double>(static_cast<std::int64_t>(timestamp - start_.value_or(timestamp))) * 1e-6;
}

void Snapshot::take(std::span<const std::byte> messages)
{
    while (messages.size() >= ulog::kMessageHeader) {
        const std::size_t size = number_at<std::uint16_t>(messages, 0);
        const auto type = static_cast<std::uint8_t>(messages[2]);
        const std::span<const std::byte> content =
            messages.subspan(ulog::kMessageHeader, std::min(size, messages.size() - ulog::kMessageHeader));
        take_message(type, content);
        messages = messages.subspan(ulog::kMessageHeader + content.size());
    }
}

void Snapshot::take_message(std::uint8_t type, std::span<const std::byte> content)
{
    constexpr std::size_t kTextAt = 1 + sizeof(std::uint64_t);  // behind level and timestamp
    switch (static_cast<ulog::Type>(type)) {
    case ulog::Type::data: take_data(content); break;
    case ulog::Type::parameter: take_parameter(content); break;
    case ulog::Type::text:
        if (content.size() >= kTextAt) {
            const std::span<const std::byte> text = content.subspan(kTextAt);
            texts_.push_back({texts_seen_++, number_at<std::uint64_t>(content, 1),
                              static_cast<int>(content[0]) - static_cast<int>('0'),
                              std::string(reinterpret_cast<const char*>(text.data()), text.size())});
        }
        if (texts_.size() > kMaxTexts) {
            texts_.pop_front();
        }
        break;
    default: break;
    }
}

void Snapshot::take_data(std::span<const std::byte> content)
{
    if (content.size() < sizeof(std::uint16_t)) {
        return;
    }
    const auto id = static_cast<flightlog::TopicId>(number_at<std::uint16_t>(content, 0));
    content = content.subspan(sizeof(std::uint16_t));
    if (id == flightlog::TopicId::step) {
        if (const auto step = topic_of<flightlog::StepTopic>(content)) {
            take_step(*step);
        }
    } else if (id == flightlog::TopicId::own) {
        if (const auto own = topic_of<flightlog::OwnTopic>(content)) {
            own_ = own;
        }
    } else if (id == flightlog::TopicId::track) {
        if (const auto track = topic_of<flightlog::TrackTopic>(content)) {
            take_track(*track);
        }
    } else if (id == flightlog::TopicId::decision) {
        ++decisions_;
    }
}

void Snapshot::take_step(const flightlog::StepTopic& step)
{
    start_ = start_.value_or(step.timestamp);
    step_ = step;
    deadlines_ += step.deadline_missed ? 1U : 0U;
    max_work_ = std::max(max_work_, step.work);
    max_us_ = std::max(max_us_, step.duration_us);
    news_ = true;
}

/// All tracks of a time come together.
void Snapshot::take_track(const flightlog::TrackTopic& track)
{
    if (!tracks_.empty() && tracks_.front().timestamp != track.timestamp) {
        tracks_.clear();
    }
    if (tracks_.size() < kMaxTracks) {
        tracks_.push_back(track);
    }
}

void Snapshot::take_parameter(std::span<const std::byte> content)
{
    constexpr std::string_view kKey = "float JNK_HALF_XY";
    if (content.size() == 1 + kKey.size() + sizeof(float) && static_cast<std::size_t>(content[0]) == kKey.size() &&
        std::memcmp(content.data() + 1, kKey.data(), kKey.size()) == 0) {
        half_xy_ = number_at<float>(content, 1 + kKey.size());
    }
}

void Snapshot::begin_next() noexcept
{
    texts_reported_ = texts_seen_;
    max_work_ = 0;
    max_us_ = 0;
    news_ = false;
}

std::string Snapshot::json(bool all_texts, const PageCounts& counts) const
{
    std::string out = "{";
    add_step(out);
    add_own(out);
    add_conflict(out);
    add_tracks(out);
    add_texts(out, all_texts);
    add(out, ",\"page\":{\"clients\":%u,\"slow\":%u,\"refused\":%u,\"messages_lost\":%u}}", counts.clients, counts.slow,
        counts.refused, counts.messages);
    return out;
}

void Snapshot::add_step(std::string& out) const
{
    const auto control = static_cast<app::Control>(step_.control);
    const bool in_control = control == app::Control::ours || control == app::Control::returning;
    add(out, "\"time\":%.3f,\"step\":%u,\"work\":%u,\"longest_step_ms\":%.3f,\"deadlines_missed\":%u,\"decisions\":%u",
        seconds(step_.timestamp), step_.step, max_work_, max_us_ * 1e-3, deadlines_, decisions_);
    add_name(out, "state", name_of(static_cast<link::SystemState>(step_.state)));
    add_name(out, "control", name_of(control));
    add(out, ",\"in_control\":%s", in_control ? "true" : "false");
    add_name(out, "guidance", name_of(static_cast<avoid::State>(step_.guidance)));
    add_name(out, "manoeuvre", name_of(static_cast<world::ManoeuvreKind>(step_.kind)));
    add_name(out, "faults", flightlog::names_of_faults(step_.faults));
    add(out, ",\"tracks_known\":%u,\"obstacles\":%u,\"areas\":%u", unsigned{step_.tracks}, unsigned{step_.obstacles},
        unsigned{step_.areas});
    out += ",\"safety_distance\":";
    add_number(out, static_cast<double>(half_xy_));
    out += ",\"command\":";
    if (step_.wants_control) {
        add_vector(out, step_.velocity);
    } else {
        out += "null";
    }
}

/// Null without a source: an old position is not shown as a present one.
void Snapshot::add_own(std::string& out) const
{
    if (!own_ || static_cast<app::OwnSource>(step_.own_source) == app::OwnSource::none) {
        out += ",\"own\":null";
        return;
    }
    const double since = seconds(step_.timestamp) - seconds(own_->timestamp);
    out += ",\"own\":{\"position\":";
    add_vector(out, own_->position, own_->velocity, since);
    out += ",\"velocity\":";
    add_vector(out, own_->velocity);
    out += ",\"yaw\":";
    add_number(out, static_cast<double>(own_->yaw));
    out += ",\"age\":";
    add_number(out, seconds(step_.timestamp) - seconds(own_->measured));
    out += '}';
}

void Snapshot::add_conflict(std::string& out) const
{
    const auto kind = static_cast<world::ThreatKind>(step_.conflict_kind);
    if (kind == world::ThreatKind::none) {
        out += ",\"conflict\":null";
        return;
    }
    out += ",\"conflict\":{\"kind\":";
    add_string(out, name_of(kind));
    add(out, ",\"id\":%u,\"time\":", step_.conflict_id != 0 ? step_.conflict_id : unsigned{step_.conflict_index});
    add_number(out, static_cast<double>(step_.conflict_time));
    out += ",\"miss_distance\":";
    add_number(out, static_cast<double>(step_.conflict_miss));
    out += '}';
}

void Snapshot::add_tracks(std::string& out) const
{
    out += ",\"tracks\":[";
    const char* separator = "";
    for (const flightlog::TrackTopic& track : tracks_) {
        const double since = seconds(step_.timestamp) - seconds(track.timestamp);
        if (since > kTrackLife) {
            continue;
        }
        add(out, "%s{\"id\":%u,\"position\":", separator, track.id);
        add_vector(out, track.position, track.velocity, since);
        out += ",\"velocity\":";
        add_vector(out, track.velocity);
        out += ",\"radius\":";
        add_number(out, static_cast<double>(track.radius));
        out += ",\"half_height\":";
        add_number(out, static_cast<double>(track.half_height));
        out += ",\"age\":";
        add_number(out, static_cast<double>(track.age) + since);
        out += '}';
        separator = ",";
    }
    out += ']';
}

void Snapshot::add_texts(std::string& out, bool all) const
{
    out += ",\"texts\":[";
    const char* separator = "";
    for (const Text& text : texts_) {
        if (!all && text.number < texts_reported_) {
            continue;
        }
        add(out, "%s{\"number\":%llu,\"time\":%.3f,\"level\":%d,\"text\":", separator,
            static_cast<unsigned long long>(text.number), seconds(text.timestamp), text.level);
        add_string(out, text.text);
        out += '}';
        separator = ",";
    }
    out += ']';
}

}  // namespace jink::livepage
