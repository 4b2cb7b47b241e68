// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/avoid/guidance.hpp"
#include "core/geometric/planner.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/flight_log/ulog.hpp"

// Topics of a flight log, of jinkd and of the boards alike. Each structure is the topic's content up to its last field,
// and kFormat names the fields in the same order. Meaning and units: docs/guides/flight_log_topics.md.

namespace jink::flightlog {

using Xyz = std::array<float, 3>;
[[nodiscard]] inline Xyz xyz_of(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }

struct StepTopic {
    static constexpr std::string_view kFormat =
        "jink_step:uint64_t timestamp;uint32_t step;uint32_t duration_us;uint32_t bytes_in;uint32_t bytes_out;"
        "uint32_t work;uint32_t transitions;uint32_t conflict_id;float[3] velocity;float margin;float cost;"
        "float conflict_time;float conflict_closest_time;float conflict_margin;float conflict_miss;uint16_t faults;"
        "uint16_t tracks;uint16_t uncertain_heights;uint16_t obstacles;uint16_t map_pieces;uint16_t areas;"
        "uint16_t conflict_index;uint8_t state;uint8_t control;uint8_t own_source;uint8_t guidance;uint8_t kind;"
        "uint8_t plan_status;uint8_t by;uint8_t answers;uint8_t alert;uint8_t conflict_kind;bool deadline_missed;"
        "bool setpoint_sent;bool wants_control;bool new_manoeuvre;bool on_other;bool other_conflict;bool blocked;";
    std::uint64_t timestamp = 0;
    std::uint32_t step = 0;
    std::uint32_t duration_us = 0;
    std::uint32_t bytes_in = 0;
    std::uint32_t bytes_out = 0;
    std::uint32_t work = 0;
    std::uint32_t transitions = 0;
    std::uint32_t conflict_id = 0;
    Xyz velocity{};
    float margin = 0.0F;
    float cost = 0.0F;
    float conflict_time = 0.0F;
    float conflict_closest_time = 0.0F;
    float conflict_margin = 0.0F;
    float conflict_miss = 0.0F;
    std::uint16_t faults = 0;
    std::uint16_t tracks = 0;
    std::uint16_t uncertain_heights = 0;
    std::uint16_t obstacles = 0;
    std::uint16_t map_pieces = 0;
    std::uint16_t areas = 0;
    std::uint16_t conflict_index = 0;
    std::uint8_t state = 0;
    std::uint8_t control = 0;
    std::uint8_t own_source = 0;
    std::uint8_t guidance = 0;
    std::uint8_t kind = 0;
    std::uint8_t plan_status = 0;
    std::uint8_t by = 0;
    std::uint8_t answers = 0;
    std::uint8_t alert = 0;
    std::uint8_t conflict_kind = 0;
    bool deadline_missed = false;
    bool setpoint_sent = false;
    bool wants_control = false;
    bool new_manoeuvre = false;
    bool on_other = false;
    bool other_conflict = false;
    bool blocked = false;
};

struct OwnTopic {
    static constexpr std::string_view kFormat =
        "jink_own:uint64_t timestamp;uint64_t measured;float[3] position;float[3] velocity;float yaw;uint8_t source;";
    std::uint64_t timestamp = 0;
    std::uint64_t measured = 0;
    Xyz position{};
    Xyz velocity{};
    float yaw = 0.0F;
    std::uint8_t source = 0;
};

struct TrackTopic {
    static constexpr std::string_view kFormat =
        "jink_track:uint64_t timestamp;uint32_t id;float[3] position;float[3] velocity;float radius;"
        "float half_height;float age;uint8_t instance;uint8_t source;bool manned;bool cooperative;";
    std::uint64_t timestamp = 0;
    std::uint32_t id = 0;
    Xyz position{};
    Xyz velocity{};
    float radius = 0.0F;
    float half_height = 0.0F;
    float age = 0.0F;
    std::uint8_t instance = 0;
    std::uint8_t source = 0;
    bool manned = false;
    bool cooperative = false;
};

/// At each new manoeuvre, before its candidates: how many they are, and where their common frame lies, which has its x
/// axis from `start` to `own_at_closest`. NaN without a conflict.
struct DecisionTopic {
    static constexpr std::uint16_t kNoneChosen = 0xFFFF;
    static constexpr std::string_view kFormat =
        "jink_decision:uint64_t timestamp;uint32_t decision;float[3] start;float[3] own_at_closest;"
        "float[3] threat_at_closest;float radius_at_closest;uint16_t candidates;uint16_t chosen;";
    std::uint64_t timestamp = 0;
    std::uint32_t decision = 0;
    Xyz start{};
    Xyz own_at_closest{};
    Xyz threat_at_closest{};
    float radius_at_closest = 0.0F;
    std::uint16_t candidates = 0;  ///< of the plan, whether or not all of them are logged
    std::uint16_t chosen = kNoneChosen;
};

/// One for each candidate of the geometric planner's last plan, at each new manoeuvre.
struct CandidateTopic {
    static constexpr std::string_view kFormat =
        "jink_candidate:uint64_t timestamp;uint32_t decision;float plane;float offset;float share;float until;"
        "float duration;float cost;float flip_penalty;float time;float smoothness;float closeness;uint16_t index;"
        "uint16_t hit_index;uint8_t family;uint8_t status;uint8_t hit_kind;uint8_t attempt;";
    std::uint64_t timestamp = 0;
    std::uint32_t decision = 0;
    float plane = 0.0F;
    float offset = 0.0F;
    float share = 0.0F;
    float until = 0.0F;
    float duration = 0.0F;
    float cost = 0.0F;
    float flip_penalty = 0.0F;
    float time = 0.0F;
    float smoothness = 0.0F;
    float closeness = 0.0F;
    std::uint16_t index = 0;
    std::uint16_t hit_index = 0;
    std::uint8_t family = 0;
    std::uint8_t status = 0;
    std::uint8_t hit_kind = 0;
    std::uint8_t attempt = 0;
};

/// Losses of the log itself, with the counters of the co-processor.
struct LogTopic {
    static constexpr std::string_view kFormat =
        "jink_log:uint64_t timestamp;uint32_t messages;uint32_t dropped;uint32_t write_failures;uint32_t files;"
        "uint32_t ring_peak;";
    std::uint64_t timestamp = 0;
    std::uint32_t messages = 0;
    std::uint32_t dropped = 0;
    std::uint32_t write_failures = 0;
    std::uint32_t files = 0;
    std::uint32_t ring_peak = 0;
};

/// Of the stream of a board, once a second: what it sent and lost since the start of the program.
struct StreamTopic {
    static constexpr std::string_view kFormat =
        "jink_stream:uint64_t timestamp;uint32_t messages;uint32_t dropped;uint32_t parts;uint32_t repeated;"
        "uint32_t starts;uint32_t given_up;uint32_t ring_peak;uint32_t candidates_left_out;";
    std::uint64_t timestamp = 0;
    std::uint32_t messages = 0;
    std::uint32_t dropped = 0;
    std::uint32_t parts = 0;
    std::uint32_t repeated = 0;
    std::uint32_t starts = 0;
    std::uint32_t given_up = 0;
    std::uint32_t ring_peak = 0;
    std::uint32_t candidates_left_out = 0;
};

/// Ids of the topics, in the order of their subscriptions in a file of jinkd; a board streams some of those before
/// `nominal`. In the place of `log` a board streams StreamTopic.
enum class TopicId : std::uint16_t {
    step,
    own,
    track,
    decision,
    candidate,
    app_counters,
    avoid_counters,
    log,
    nominal,
    obstacle,
    area,
    hal
};

template <class T>
struct Counter {
    std::string_view name;
    std::uint32_t T::*member;
};
[[nodiscard]] std::span<const Counter<app::Diagnostics>> app_counters() noexcept;
[[nodiscard]] std::span<const Counter<avoid::Diagnostics>> avoid_counters() noexcept;

/// Name of a format "name:...".
[[nodiscard]] constexpr std::string_view name_of_format(std::string_view format) noexcept
{
    return format.substr(0, format.find(':'));
}

/// Bytes of a topic that are logged.
template <class T>
inline constexpr std::size_t kBytesOf = ulog::size_of_format(T::kFormat);
template <class T>
[[nodiscard]] std::span<const std::byte> content_of(const T& topic) noexcept
{
    static_assert(kBytesOf<T> > 0 && kBytesOf<T> <= sizeof(T) && sizeof(T) - kBytesOf<T> < alignof(T),
                  "fields in the order of their sizes, as in the format");
    return std::as_bytes(std::span(&topic, 1)).first(kBytesOf<T>);
}

/// The step's topic, but for its number and duration.
[[nodiscard, gnu::cold]] StepTopic step_topic(const app::StepReport& report, TimePoint now) noexcept;
/// @param own   own position [m]
/// @param plan  the geometric planner's last one; null: there is no such planner
[[nodiscard, gnu::cold]] DecisionTopic decision_topic(const app::StepReport& report, const Vec3& own,
                                                      const geometric::Result* plan, TimePoint now,
                                                      std::uint32_t number) noexcept;
/// @param index  of a candidate of the plan
[[nodiscard, gnu::cold]] CandidateTopic candidate_topic(const geometric::Result& plan, std::size_t index, TimePoint now,
                                                        std::uint32_t decision) noexcept;

// Names of numbers in topics and in the status line; "?" for none. Each ends with a zero byte.
using app::name_of;  // of app::Control
[[nodiscard]] std::string_view name_of(link::SystemState state) noexcept;
[[nodiscard]] std::string_view name_of(avoid::State state) noexcept;
[[nodiscard]] std::string_view name_of(world::ManoeuvreKind kind) noexcept;
[[nodiscard]] std::string_view name_of(world::PlanStatus status) noexcept;
[[nodiscard]] std::string_view name_of(world::ThreatKind kind) noexcept;
[[nodiscard]] std::string_view name_of(geometric::CandidateStatus status) noexcept;
}  // namespace jink::flightlog
