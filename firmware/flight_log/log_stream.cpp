// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/flight_log/log_stream.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/capacity.hpp"
#include "firmware/app/text.hpp"
#include "firmware/flight_log/ulog.hpp"

namespace jink::flightlog {
namespace {

constexpr std::uint16_t kLoggingStart = 2510;  // MAV_CMD
constexpr std::uint16_t kLoggingStop = 2511;
constexpr std::int64_t kMillion = 1'000'000;
constexpr std::int64_t kMaxEarned = static_cast<std::int64_t>(link::kMaxLogFrame) * kMillion;

// Steps of a second: what is logged when. No two of these fall together, so that no step has much to do.
constexpr std::uint32_t kTicks = 50;
constexpr std::uint32_t kStepTicks = 5;
constexpr std::uint32_t kOwnAt = 2;  ///< of kStepTicks
constexpr std::uint32_t kTrackTicks = 25;
constexpr std::size_t kTrackSteps = 16;  ///< all of them within so many
constexpr int kCandidatesAtOnce = 2;
constexpr std::uint32_t kAppCountersAt = 19;
constexpr std::uint32_t kAvoidCountersAt = 23;
constexpr std::uint32_t kStreamAt = 44;

/// Of a topic that is streamed [bytes].
constexpr std::size_t kMaxContent =
    sizeof(std::uint64_t) + std::max(sizeof(app::Diagnostics), sizeof(avoid::Diagnostics));
static_assert(kMaxContent >= sizeof(StepTopic) && kMaxContent >= sizeof(TrackTopic) &&
              kMaxContent >= sizeof(DecisionTopic) && kMaxContent >= sizeof(CandidateTopic));

std::uint64_t stamp_of(TimePoint now) { return static_cast<std::uint64_t>(now.us); }

}  // namespace

void LogStream::begin(TimePoint now, std::span<const link::LogAck> acks) noexcept
{
    now_ = now;
    bool is_answered = false;
    for (const link::LogAck& ack : acks) {
        is_answered = is_answered || (ack.sequence == sequence_ && ack.from_system == to_system_ &&
                                      ack.from_component == to_component_);
    }
    if (phase_ != Phase::definitions || waiting_.tries == 0 || !is_answered) {
        return;
    }
    place_ = waiting_.next;
    ++sequence_;
    waiting_ = {0, now, now, {}};
    if (StreamHead::is_end(place_)) {
        phase_ = Phase::data;
    }
}

link::CommandResult LogStream::take(const link::CommandRequest& request, const app::Parameters& parameters) noexcept
{
    if (request.command == kLoggingStop) {
        stop();
        return link::CommandResult::accepted;
    }
    if (request.command != kLoggingStart) {
        return link::CommandResult::unsupported;
    }
    const bool is_same = request.from_system == to_system_ && request.from_component == to_component_;
    const bool is_ulog = request.params[0] == 0.0F;
    if (!is_ulog || (is_on() && !is_same)) {
        ++counts_.refused;
        return is_ulog ? link::CommandResult::temporarily_rejected : link::CommandResult::denied;
    }
    if (!is_on() || now_.us - started_.us >= kSameStart) {
        start(request, parameters);
    }
    return link::CommandResult::accepted;
}

void LogStream::start(const link::CommandRequest& request, const app::Parameters& parameters) noexcept
{
    stop();
    phase_ = Phase::definitions;
    to_system_ = request.from_system;
    to_component_ = request.from_component;
    started_ = now_;
    sequence_ = 0;
    place_ = {};
    waiting_ = {0, now_, now_, {}};
    head_.begin(now_, parameters.values());
    generation_ = parameters.generation();
    tick_ = 0;
    next_track_ = kMaxTracks;
    last_.reset();
    candidates_ = {};
    ++counts_.starts;
}

void LogStream::stop() noexcept
{
    phase_ = Phase::off;
    ring_.clear();
}

void LogStream::earn() noexcept
{
    const std::int64_t passed = std::clamp<std::int64_t>(now_.us - earned_at_.us, 0, kMillion);
    earned_ = std::min(kMaxEarned, earned_ + bytes_per_second_ * passed);
    earned_at_ = now_;
}

bool LogStream::queue(link::Link& link, bool acknowledged, std::span<const std::byte> bytes,
                      std::uint8_t first_message) noexcept
{
    constexpr std::size_t kOverhead = link::kMaxLogFrame - link::kMaxLogPart;
    const std::int64_t cost = static_cast<std::int64_t>(bytes.size() + kOverhead) * kMillion;
    if (earned_ < cost || !link.send_log({to_system_, to_component_, sequence_, first_message, acknowledged, bytes})) {
        return false;
    }
    earned_ -= cost;
    ++counts_.parts;
    return true;
}

bool LogStream::is_hopeless() const noexcept
{
    const bool tried = waiting_.tries >= kMaxTries && now_.us - waiting_.sent.us >= kAckTimeout;
    return phase_ == Phase::definitions && (tried || now_.us - waiting_.since.us >= kMaxWait);
}

void LogStream::send_definitions(link::Link& link) noexcept
{
    if (waiting_.tries > 0 && now_.us - waiting_.sent.us < kAckTimeout) {
        return;
    }
    std::array<std::byte, link::kMaxLogPart> buffer;
    const StreamHead::Part part = head_.part(place_, buffer);
    if (queue(link, true, part.bytes, part.first_message)) {
        counts_.repeated += waiting_.tries > 0 ? 1U : 0U;
        ++waiting_.tries;
        waiting_.sent = now_;
        waiting_.next = part.next;
    }
}

/// Full parts alone, as PX4 sends them: the last quarter of a second waits here.
void LogStream::send_data(link::Link& link) noexcept
{
    if (ring_.size() < link::kMaxLogPart) {
        return;
    }
    std::array<std::byte, link::kMaxLogPart> buffer;
    const std::span<const std::byte> bytes = ring_.peek(buffer);
    if (queue(link, false, bytes, ring_.first_message(bytes.size()))) {
        ring_.remove(bytes.size());
        ++sequence_;
    }
}

void LogStream::end(const app::LoggedStep& step, link::Link& link) noexcept
{
    earn();
    decisions_ += step.report.guidance.new_manoeuvre ? 1U : 0U;
    if (is_hopeless()) {
        ++counts_.given_up;
        stop();
    }
    if (phase_ == Phase::data) {
        log_step(step);
    }
    if (!step.is_line_free) {
        return;
    }
    if (phase_ == Phase::definitions) {
        send_definitions(link);
    } else if (phase_ == Phase::data) {
        send_data(link);
    }
}

bool LogStream::put_content(TopicId id, std::span<const std::byte> content, std::size_t spare) noexcept
{
    std::array<std::byte, ulog::kDataHeader + kMaxContent> buffer;
    ulog::Composer message(buffer);
    message.begin(ulog::Type::data).put(id).put_bytes(content);
    return ring_.add(message.end(), now_, spare);
}

template <class T>
void LogStream::put_counters(TopicId id, std::span<const Counter<T>> counters, const T& values) noexcept
{
    static_assert(sizeof(std::uint64_t) + sizeof(T) <= kMaxContent);
    std::array<std::byte, sizeof(std::uint64_t) + sizeof(T)> content;
    const std::uint64_t stamp = stamp_of(now_);
    std::memcpy(content.data(), &stamp, sizeof stamp);
    std::size_t at = sizeof stamp;
    for (const Counter<T>& counter : counters) {
        std::memcpy(content.data() + at, &(values.*counter.member), sizeof(std::uint32_t));
        at += sizeof(std::uint32_t);
    }
    put_content(id, content, kSpare);
}

void LogStream::log_text(char level, std::string_view text) noexcept
{
    std::array<std::byte, ulog::kMessageHeader + 1 + sizeof(std::uint64_t) + 50> buffer;
    ulog::Composer message(buffer);
    message.begin(ulog::Type::text).put(level).put(stamp_of(now_)).put_text(text);
    ring_.add(message.end(), now_);
}

void LogStream::note_text(link::Severity severity, std::string_view text) noexcept
{
    if (phase_ == Phase::data) {
        log_text(static_cast<char>('0' + static_cast<int>(severity)), text);
    }
}

void LogStream::log_step(const app::LoggedStep& step) noexcept
{
    const app::StepReport& report = step.report;
    const Last now{report.state,          report.faults,         report.control,
                   report.guidance.state, report.conflict_track, report.guidance.conflict.has_value()};
    log_parameters(step.parameters);
    const bool has_changed = !last_ || *last_ != now || report.guidance.new_manoeuvre;
    if (has_changed || tick_ % kStepTicks == 0) {
        StepTopic topic = step_topic(report, now_);
        topic.step = step.counts.steps;
        topic.duration_us = step.duration_us;
        put(TopicId::step, topic);
    }
    if (has_changed && last_) {
        log_changes(report);
    }
    if (report.guidance.new_manoeuvre) {
        log_decision(step);
    } else {
        log_candidates(step.plan);
    }
    last_ = now;
    if (tick_ % kStepTicks == kOwnAt && report.own_source != app::OwnSource::none) {
        put(TopicId::own,
            OwnTopic{stamp_of(now_), stamp_of(step.own.stamp), xyz_of(step.own.position), xyz_of(step.own.velocity),
                     step.own.yaw, static_cast<std::uint8_t>(report.own_source)});
    }
    log_tracks(step.tracks);
    log_counters(step);
    tick_ = (tick_ + 1) % kTicks;
}

/// In words, once each.
void LogStream::log_changes(const app::StepReport& report) noexcept
{
    if (report.control != last_->control) {
        app::Text text;
        text << "control " << name_of(last_->control) << " -> " << name_of(report.control);
        log_text('5', text.view());
    }
    const avoid::Guidance& g = report.guidance;
    if (g.new_manoeuvre || g.state != last_->guidance) {
        app::Text text;
        text << "guidance " << name_of(last_->guidance) << " -> " << name_of(g.state) << ", " << name_of(g.kind);
        log_text('5', text.view());
    }
}

/// Without its decision a candidate has no place: no candidates follow a decision that was dropped.
void LogStream::log_decision(const app::LoggedStep& step) noexcept
{
    leave_candidates_out();
    const DecisionTopic topic = decision_topic(step.report, step.own.position, step.plan.result, now_, decisions_);
    candidates_ = {step.plan.number, 0, topic.candidates};
    if (!put(TopicId::decision, topic)) {
        leave_candidates_out();
    }
}

/// The next portion of the round.
void LogStream::log_candidates(const app::LastPlan& plan) noexcept
{
    if (plan.number != candidates_.plan) {
        leave_candidates_out();
    }
    for (int i = 0; i < kCandidatesAtOnce && candidates_.next < candidates_.end && ring_.size() <= kCandidatesWait;
         ++i, ++candidates_.next) {
        put(TopicId::candidate, candidate_topic(*plan.result, candidates_.next, now_, decisions_));
    }
}

void LogStream::leave_candidates_out() noexcept
{
    counts_.candidates_left_out += static_cast<std::uint32_t>(candidates_.end - candidates_.next);
    candidates_.next = candidates_.end;
}

void LogStream::log_tracks(std::span<const world::Track> tracks) noexcept
{
    next_track_ = tick_ % kTrackTicks == kOwnAt + 1 ? 0 : next_track_;
    const std::size_t at_once = (tracks.size() + kTrackSteps - 1) / kTrackSteps;
    for (std::size_t i = 0; i < at_once && next_track_ < tracks.size(); ++i, ++next_track_) {
        const world::Track& t = tracks[next_track_];
        put(TopicId::track,
            TrackTopic{stamp_of(now_), t.id, xyz_of(t.position), xyz_of(t.velocity), t.radius, t.half_height,
                       now_ - t.stamp, t.instance, static_cast<std::uint8_t>(t.source), t.manned, t.cooperative},
            kSpare);
    }
}

void LogStream::log_counters(const app::LoggedStep& step) noexcept
{
    if (tick_ == kAppCountersAt) {
        put_counters(TopicId::app_counters, app_counters(), step.counts);
    } else if (tick_ == kAvoidCountersAt) {
        put_counters(TopicId::avoid_counters, avoid_counters(), step.supervisor_counts);
    } else if (tick_ == kStreamAt) {
        put(TopicId::log,
            StreamTopic{stamp_of(now_), ring_.messages(), ring_.dropped(), counts_.parts, counts_.repeated,
                        counts_.starts, counts_.given_up, ring_.peak(), counts_.candidates_left_out},
            kSpare);
    }
}

/// A change that does not fit is tried again with the next step.
void LogStream::log_parameters(const app::Parameters& parameters) noexcept
{
    if (parameters.generation() == generation_) {
        return;
    }
    app::ParamValues& logged = head_.values();
    for (std::size_t i = 0; i < logged.size(); ++i) {
        const float value = parameters.values()[i];
        if (value == logged[i]) {
            continue;
        }
        const float before = std::exchange(logged[i], value);
        std::array<std::byte, StreamHead::kMaxParameter> buffer;
        if (!ring_.add(head_.parameter(i, buffer), now_)) {
            logged[i] = before;
            return;
        }
    }
    generation_ = parameters.generation();
}

}  // namespace jink::flightlog
