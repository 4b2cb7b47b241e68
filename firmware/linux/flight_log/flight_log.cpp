// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/flight_log.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace jink::flightlog {
namespace {

std::uint64_t stamp_of(TimePoint now) { return static_cast<std::uint64_t>(now.us); }

/// A text of a fixed size; what does not fit is cut.
class Line {
public:
    template <class... Values>
    Line& add(const char* format, Values... values) noexcept
    {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg): GCC 12 has no std::format
        const int n = std::snprintf(text_.data() + size_, text_.size() - size_, format, values...);
        size_ = std::min(size_ + static_cast<std::size_t>(std::max(n, 0)), text_.size() - 1);
        return *this;
    }
    Line& add_text(std::string_view text) noexcept
    {
        const std::size_t n = std::min(text.size(), text_.size() - 1 - size_);
        std::memcpy(text_.data() + size_, text.data(), n);
        size_ += n;
        return *this;
    }
    [[nodiscard]] std::string_view view() const noexcept { return {text_.data(), size_}; }

private:
    std::array<char, 240> text_{};
    std::size_t size_ = 0;
};

/// Index among kHalSizes of the smallest size that holds n bytes, 1 to the largest.
std::size_t size_index(std::size_t n) noexcept
{
    constexpr std::size_t kUnit = kHalSizes.front();
    static constexpr auto kOf = [] {
        std::array<std::uint8_t, kHalSizes.back() / kUnit> of{};
        for (std::size_t i = 0; i < of.size(); ++i) {
            while (kHalSizes[of[i]] < (i + 1) * kUnit) {
                ++of[i];
            }
        }
        return of;
    }();
    return kOf[(n - 1) / kUnit];
}

/// "conflict with track 7 in 3.2 s, faults none": why something changed.
void add_reason(const app::StepReport& report, Line& line)
{
    const std::uint32_t id = report.conflict_track;
    if (const auto& conflict = report.guidance.conflict) {
        line.add_text("conflict with ").add_text(name_of(conflict->threat.kind));
        line.add(" %u in %.1f s", id != 0 ? id : static_cast<unsigned>(conflict->threat.index),
                 static_cast<double>(conflict->time_to_loss));
    } else {
        line.add_text("no conflict");
    }
    line.add(", faults 0x%x", report.faults);
}

}  // namespace

FlightLog::FlightLog(Output& output, const Limits& limits, const files::ParamValues& parameters)
    : output_(output),
      recorder_(limits.record, kPartHead, limits.record / kHalSizes.back() * kPartHead + 4 * kMaxMessage),
      messages_(recorder_.end().memory()), parameters_(parameters), accepted_(parameters)
{
}

void FlightLog::flush() noexcept
{
    const bool is_accepted = output_.add(messages_.first(size_), count_, records_);
    if (has_changes_) [[unlikely]] {
        if (is_accepted) {
            accepted_ = parameters_;
        } else {  // logged again with the next step
            parameters_ = accepted_;
            has_generation_ = false;
        }
        has_changes_ = false;
    }
    size_ = 0;
    count_ = 0;
    records_ = {};
}

template <class T>
void FlightLog::put(TopicId id, const T& topic) noexcept
{
    ulog::Composer message = data(id);
    keep(message.put_bytes(content_of(topic)));
}

void FlightLog::put_text(ulog::Level level, TimePoint now, std::string_view text) noexcept
{
    ulog::Composer line = message(ulog::Type::text);
    keep(line.put(level).put(stamp_of(now)).put_text(text));
}

/// Completes a message that holds a part of the record, n bytes behind its head: zeros up to the smallest size that
/// holds them. @return size of the message
std::size_t FlightLog::put_part(std::size_t at, std::size_t n, std::uint32_t number, std::uint16_t flags,
                                TimePoint now) noexcept
{
    const std::size_t index = size_index(n);
    const std::size_t size = kHalSizes[index];
    const HalHead head{stamp_of(now), sequence_ + number, static_cast<std::uint16_t>(n), flags};
    std::memset(messages_.data() + at + kPartHead + n, 0, size - n);
    ulog::Composer part(messages_.subspan(at, kPartHead + size));
    part.begin(ulog::Type::data).put(static_cast<std::uint16_t>(static_cast<std::size_t>(TopicId::hal) + index));
    static_cast<void>(part.put(head).room(size));
    return part.end().size();
}

/// Cuts a record into parts, the last one first.
void FlightLog::put_parts(std::size_t size, std::uint32_t parts, TimePoint now) noexcept
{
    constexpr std::size_t kLargest = kHalSizes.back();
    for (std::uint32_t i = parts; i-- > 0; size = i * kLargest) {
        const std::size_t n = size - i * kLargest;
        const std::size_t at = i * kMaxMessage;
        std::memmove(messages_.data() + at + kPartHead, messages_.data() + kPartHead + i * kLargest, n);
        const std::size_t end = at + put_part(at, n, i,
                                              static_cast<std::uint16_t>((i + 1 < parts ? HalHead::kGoesOn : 0U) |
                                                                         (i > 0 ? HalHead::kContinues : 0U)),
                                              now);
        size_ = std::max(size_, end);
    }
}

/// The record becomes one message or several, where it was composed.
void FlightLog::put_record(TimePoint now) noexcept
{
    EntryWriter& entries = recorder_.end();
    const std::size_t n = entries.record().size();
    const auto parts = static_cast<std::uint32_t>((n + kHalSizes.back() - 1) / kHalSizes.back());
    if (entries.overflowed()) [[unlikely]] {
        ++sequence_;
        output_.lose();
    } else if (parts == 1) [[likely]] {
        size_ = put_part(0, n, 0, 0, now);
    } else if (parts > 1) {
        put_parts(n, parts, now);
    }
    count_ = entries.overflowed() ? 0 : parts;
    records_ = {size_, count_};
    sequence_ += count_;
    entries.clear();
}

void FlightLog::put_sent_texts(TimePoint now) noexcept
{
    for (const SentTexts::Text& text : recorder_.texts().texts()) {
        put_text(static_cast<ulog::Level>('0' + text.severity), now, text.view());
    }
    recorder_.texts().clear();
}

void FlightLog::put_own(const app::StepReport& report, const app::Coprocessor& coprocessor, TimePoint now) noexcept
{
    const vehicle::VehicleState& own = coprocessor.own();
    if (own.stamp.us == own_stamp_ || report.own_source == app::OwnSource::none) {
        return;
    }
    own_stamp_ = own.stamp.us;
    put(TopicId::own, OwnTopic{stamp_of(now), stamp_of(own.stamp), xyz_of(own.position), xyz_of(own.velocity), own.yaw,
                               static_cast<std::uint8_t>(report.own_source)});
}

void FlightLog::put_tracks(app::Coprocessor& coprocessor, TimePoint now) noexcept
{
    for (const world::Track& t : coprocessor.tracks(now)) {
        put(TopicId::track,
            TrackTopic{stamp_of(now), t.id, xyz_of(t.position), xyz_of(t.velocity), t.radius, t.half_height,
                       now - t.stamp, t.instance, static_cast<std::uint8_t>(t.source), t.manned, t.cooperative});
    }
}

/// The segments that are not flown yet.
void FlightLog::put_path(const world::Reference& reference, std::uint8_t path, bool on_route, TimePoint now) noexcept
{
    const path::RouteView route = reference.route();
    const std::size_t n = reference.valid ? route.segments().size() : 0;
    for (std::size_t i = std::min(reference.segment, n); i < n; ++i) {
        const path::RouteSegment& s = route.segments()[i];
        put(TopicId::nominal,
            NominalTopic{stamp_of(now), xyz_of(s.start), xyz_of(s.along), xyz_of(s.towards), s.radius, s.length,
                         reference.speed, path, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(n), on_route});
    }
}

void FlightLog::put_nominal(const app::NominalPaths& paths, TimePoint now) noexcept
{
    put_path(paths.primary(), 0, paths.is_intended(), now);
    if (const world::Reference* const other = paths.other()) {
        put_path(*other, 1, !paths.is_intended(), now);
    }
}

/// The next portion of the round, or of a new one.
void FlightLog::put_shapes(const app::Coprocessor& coprocessor, TimePoint now) noexcept
{
    if (shapes_.is_due(now)) {
        shapes_.begin(coprocessor.obstacles(), coprocessor.sensed_obstacles().size(), coprocessor.closed_areas(), now);
    }
    for (std::size_t i = 0; i < ShapeRound::kPerStep && shapes_.goes_on(); ++i) {
        if (shapes_.is_next_area()) {
            put(TopicId::area, shapes_.next_area(now));
        } else {
            put(TopicId::obstacle, shapes_.next_obstacle(now));
        }
    }
}

template <class T>
void FlightLog::put_counters_of(TopicId id, std::span<const Counter<T>> counters, const T& diagnostics,
                                TimePoint now) noexcept
{
    std::array<std::uint32_t, sizeof(T) / sizeof(std::uint32_t)> values{};  // topics.cpp: as many as there are counters
    std::transform(counters.begin(), counters.end(), values.begin(),
                   [&](const Counter<T>& counter) { return diagnostics.*counter.member; });
    ulog::Composer message = data(id);
    keep(message.put(stamp_of(now)).put_bytes(std::as_bytes(std::span(values))));
}

void FlightLog::put_counters(const app::Coprocessor& coprocessor, TimePoint now) noexcept
{
    put_counters_of(TopicId::app_counters, app_counters(), coprocessor.diagnostics(), now);
    put_counters_of(TopicId::avoid_counters, avoid_counters(), coprocessor.supervisor_diagnostics(), now);
    const LogCounts counts = output_.counts();
    put(TopicId::log,
        LogTopic{stamp_of(now), counts.messages, counts.dropped, counts.write_failures, counts.files, counts.peak});
}

void FlightLog::put_decision(const app::StepReport& report, const app::Coprocessor& coprocessor, TimePoint now) noexcept
{
    const geometric::Result* const plan = coprocessor.last_plan().result;
    const DecisionTopic decision = decision_topic(report, coprocessor.own().position, plan, now, decisions_);
    put(TopicId::decision, decision);
    for (std::size_t i = 0; i < decision.candidates; ++i) {
        put(TopicId::candidate, candidate_topic(*plan, i, now, decisions_));
    }
}

void FlightLog::put_changes(const app::StepReport& report, TimePoint now) noexcept
{
    if (report.state != last_.state || report.faults != last_.faults) {
        const bool is_bad = report.state >= link::SystemState::critical;
        Line line;
        line.add_text("state ").add_text(name_of(report.state)).add_text(": ");
        add_reason(report, line);
        put_text(is_bad ? ulog::Level::critical : ulog::Level::info, now, line.view());
    }
    if (report.control != last_.control) {
        Line line;
        line.add_text("control ")
            .add_text(name_of(last_.control))
            .add_text(" -> ")
            .add_text(name_of(report.control))
            .add_text(": ");
        add_reason(report, line);
        put_text(ulog::Level::notice, now, line.view());
    }
    const avoid::Guidance& g = report.guidance;
    if (g.new_manoeuvre || g.state != last_.guidance) {
        Line line;
        line.add_text("guidance ").add_text(name_of(last_.guidance)).add_text(" -> ").add_text(name_of(g.state));
        line.add_text(g.new_manoeuvre ? ", new manoeuvre " : ", ").add_text(name_of(g.kind));
        line.add(" by method %u, margin %.2f m, cost %.3f: ", g.by, static_cast<double>(g.margin),
                 static_cast<double>(g.cost));
        add_reason(report, line);
        put_text(ulog::Level::notice, now, line.view());
    }
}

void FlightLog::put_changed_parameters(const app::Parameters& parameters) noexcept
{
    generation_ = parameters.generation();
    has_generation_ = true;
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
        const float value = parameters.values()[i];
        if (value == parameters_[i]) {
            continue;
        }
        const app::ParamInfo& info = app::param_table()[i];
        const std::string_view type = info.integer ? "int32_t " : "float ";
        ulog::Composer change = message(ulog::Type::parameter);
        change.put(static_cast<std::uint8_t>(type.size() + info.name.size())).put_text(type).put_text(info.name);
        keep(info.integer ? change.put(static_cast<std::int32_t>(value)) : change.put(value));
        parameters_[i] = value;
        has_changes_ = true;
    }
}

void FlightLog::end(const app::StepReport& report, app::Coprocessor& coprocessor, TimePoint began,
                    std::int64_t took_us) noexcept
{
    put_record(began);
    StepTopic step = step_topic(report, began);
    step.step = steps_++;
    step.duration_us = static_cast<std::uint32_t>(std::clamp<std::int64_t>(took_us, 0, 0xFFFFFFFF));
    put(TopicId::step, step);
    put_own(report, coprocessor, began);
    if (report.state != last_.state || report.faults != last_.faults || report.control != last_.control ||
        report.guidance.state != last_.guidance || report.guidance.new_manoeuvre) {
        put_changes(report, began);
    }
    if (!recorder_.texts().texts().empty()) {
        put_sent_texts(began);
    }
    if (report.guidance.new_manoeuvre) {
        ++decisions_;
        put_decision(report, coprocessor, began);
    }
    if (!has_generation_ || coprocessor.parameters().generation() != generation_) {
        put_changed_parameters(coprocessor.parameters());
    }
    if (began.us >= tracks_due_) {
        put_tracks(coprocessor, began);
        if (report.own_source != app::OwnSource::none) {
            put_nominal(coprocessor.nominal_paths(), began);
        }
        tracks_due_ = began.us + kTrackPeriod;
    }
    const bool knows_shapes = (report.obstacles | report.cylinders) != 0;
    if (shapes_.goes_on() || (knows_shapes && shapes_.is_due(began))) [[unlikely]] {
        put_shapes(coprocessor, began);
    }
    if (began.us >= counters_due_) {
        put_counters(coprocessor, began);
        counters_due_ = began.us + kCounterPeriod;
    }
    last_ = {report.state, report.faults, report.control, report.guidance.state};
    flush();
}

void FlightLog::end_shut_down(TimePoint now) noexcept
{
    put_record(now);
    put_sent_texts(now);
    put_text(ulog::Level::info, now, "jinkd stops");
    flush();
}

}  // namespace jink::flightlog
