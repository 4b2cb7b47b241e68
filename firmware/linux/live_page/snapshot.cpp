// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/snapshot.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "firmware/app/step_report.hpp"
#include "firmware/app/takeover.hpp"
#include "firmware/linux/live_page/json_text.hpp"

namespace jink::livepage {
namespace {

using flightlog::name_of;
using flightlog::Xyz;

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
        if (const auto decision = topic_of<flightlog::DecisionTopic>(content)) {
            ++decisions_;
            paths_.take(*decision);
        }
    } else if (id == flightlog::TopicId::candidate) {
        if (const auto candidate = topic_of<flightlog::CandidateTopic>(content)) {
            paths_.take(*candidate);
        }
    } else if (id == flightlog::TopicId::nominal) {
        if (const auto segment = topic_of<flightlog::NominalTopic>(content)) {
            paths_.take(*segment);
        }
    } else if (id == flightlog::TopicId::obstacle) {
        if (const auto obstacle = topic_of<flightlog::ObstacleTopic>(content)) {
            shapes_.take(*obstacle);
        }
    } else if (id == flightlog::TopicId::area) {
        if (const auto area = topic_of<flightlog::AreaTopic>(content)) {
            shapes_.take(*area);
        }
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
    paths_.end_decision();
    shapes_.note_step(step.timestamp, step.obstacles > 0 || step.areas > 0);
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
    const auto take_value = [content](std::string_view key, float& value) {
        if (content.size() == 1 + key.size() + sizeof(float) && static_cast<std::size_t>(content[0]) == key.size() &&
            std::memcmp(content.data() + 1, key.data(), key.size()) == 0) {
            value = number_at<float>(content, 1 + key.size());
        }
    };
    take_value("float JNK_HALF_XY", shown_.half_xy);
    take_value("float JNK_LOOKAHEAD", shown_.lookahead);
    take_value("float GEO_MAX_COST", shown_.max_cost);
}

void Snapshot::begin_next() noexcept
{
    texts_reported_ = texts_seen_;
    paths_.begin_next();
    shapes_.begin_next();
    max_work_ = 0;
    max_us_ = 0;
    news_ = false;
}

std::string Snapshot::json(bool is_first, const PageCounts& counts) const
{
    std::string out = "{";
    add_step(out);
    add_own(out);
    add_conflict(out);
    add_tracks(out);
    add_paths(out, is_first);
    add_shapes(out, is_first);
    add_texts(out, is_first);
    add(out, ",\"page\":{\"clients\":%u,\"slow\":%u,\"refused\":%u,\"messages_lost\":%u}}", counts.clients, counts.slow,
        counts.refused, counts.messages);
    return out;
}

void Snapshot::add_step(std::string& out) const
{
    const auto control = static_cast<app::Control>(step_.control);
    const bool in_control = control == app::Control::ours || control == app::Control::returning;
    // Of the machine's monotonic clock: another run of jinkd begins at another time.
    add(out, "\"run\":%llu,", static_cast<unsigned long long>(start_.value_or(0)));
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
    add_number(out, static_cast<double>(shown_.half_xy));
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
        add(out, "%s{\"id\":%u,\"instance\":%u,\"position\":", separator, track.id, unsigned{track.instance});
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

void Snapshot::add_paths(std::string& out, bool is_first) const
{
    const double now = seconds(step_.timestamp);
    Vec3 own = Vec3::Constant(std::numeric_limits<float>::quiet_NaN());
    if (own_ && static_cast<app::OwnSource>(step_.own_source) != app::OwnSource::none) {
        const auto since = static_cast<float>(now - seconds(own_->timestamp));
        for (int k = 0; k < 3; ++k) {
            own[k] = own_->position[static_cast<std::size_t>(k)] + since * own_->velocity[static_cast<std::size_t>(k)];
        }
    }
    const bool is_known = static_cast<app::OwnSource>(step_.own_source) != app::OwnSource::none &&
                          now - seconds(paths_.nominal_time().value_or(0)) <= kTrackLife;
    out += ",\"nominal\":";
    if (is_known) {
        paths_.add_nominal(out, own, shown_.lookahead);
    } else {
        out += "[]";
    }
    out += ",\"decision\":";
    const std::optional<std::uint64_t> decided = paths_.decision_time();
    if (decided && (is_first || paths_.has_new_decision())) {
        paths_.add_decision(out, seconds(*decided), shown_.max_cost);
    } else {
        out += "null";
    }
}

void Snapshot::add_shapes(std::string& out, bool is_first) const
{
    out += ",\"shapes\":";
    if (is_first || shapes_.is_new()) {
        shapes_.add(out, seconds(shapes_.known() != 0 ? shapes_.known() : step_.timestamp));
    } else {
        out += "null";
    }
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
