// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "firmware/app/step_log.hpp"
#include "firmware/flight_log/message_ring.hpp"
#include "firmware/flight_log/stream_head.hpp"
#include "firmware/flight_log/topics.hpp"

namespace jink::flightlog {

/// Counters of a stream since the start of the program.
struct StreamCounts {
    std::uint32_t starts = 0;               ///< logs begun
    std::uint32_t refused = 0;              ///< LOGGING_START of a second receiver, or for another format
    std::uint32_t parts = 0;                ///< queued, repeated ones too
    std::uint32_t repeated = 0;             ///< parts that were not acknowledged in time
    std::uint32_t given_up = 0;             ///< logs whose receiver acknowledged no more
    std::uint32_t candidates_left_out = 0;  ///< another plan came before they went out, or another decision
};

/// A board's flight log, streamed as ULog over MAVLink to the receiver that asks for it (docs/guides/board_log.md).
///
/// The protocol is that of PX4 (src/modules/mavlink/mavlink_ulog.cpp, src/modules/logger/log_writer_mavlink.cpp,
/// msg/UlogStreamAck.msg): definitions first, each part acknowledged before the next; then data without
/// acknowledgements. One receiver at a time. LOGGING_START of the same receiver begins anew; within kSameStart it is
/// the same command once more, whose answer was lost. LOGGING_STOP may come from anyone.
///
/// Line: never more than kLinePercent of it over any time, and one part (link::kMaxLogFrame) more; at most one part a
/// step, behind all other messages, and only where the port has taken all bytes of the steps before.
///
/// Candidates of a decision go out in a round over the steps after it, as long as the planner's last plan is the same
/// one. If another plan overwrites them, or another decision comes, the rest of them is left out and counted; the
/// decision says how many they were.
///
/// Memory: sizeof(LogStream), about 2.6 KiB (ring of messages, values of the parameters). No allocation.
/// Work of a step: at most one part is composed, two tracks, the step, own state, one set of counters, the decision,
/// two candidates and two texts; for the changes of parameters all of them are compared. O(kMaxLogPart + parameters).
class LogStream final : public app::StepLog {
public:
    static constexpr std::int64_t kLinePercent = 10;
    /// ULOG_STREAM_ACK's ACK_TIMEOUT and ACK_MAX_TRIES.
    static constexpr std::int64_t kAckTimeout = 50'000;  ///< [us]
    static constexpr int kMaxTries = 50;
    /// Also the end for a receiver on a line that is too slow for all repetitions.
    static constexpr std::int64_t kMaxWait = 10'000'000;    ///< [us]
    static constexpr std::int64_t kSameStart = 10'000'000;  ///< [us]
    /// Tracks and counters leave so much of the ring to what is decided [bytes].
    static constexpr std::size_t kSpare = 512;
    /// Candidates wait while more than this waits in the ring [bytes]: they take no place from tracks and counters.
    static constexpr std::size_t kCandidatesWait = 512;

    /// @param baud  of the line, 10 bits a byte
    explicit LogStream(std::uint32_t baud) noexcept : bytes_per_second_(baud / 10 * kLinePercent / 100) {}
    LogStream(const LogStream&) = delete;
    LogStream& operator=(const LogStream&) = delete;

    [[gnu::cold]] void begin(TimePoint now, std::span<const link::LogAck> acks) noexcept override;
    [[nodiscard, gnu::cold]] link::CommandResult take(const link::CommandRequest& request,
                                                      const app::Parameters& parameters) noexcept override;
    [[gnu::cold]] void note_text(link::Severity severity, std::string_view text) noexcept override;
    [[gnu::cold]] void end(const app::LoggedStep& step, link::Link& link) noexcept override;

    [[nodiscard]] bool is_on() const noexcept { return phase_ != Phase::off; }
    [[nodiscard]] const StreamCounts& counts() const noexcept { return counts_; }
    [[nodiscard]] const MessageRing& ring() const noexcept { return ring_; }

private:
    enum class Phase : std::uint8_t { off, definitions, data };

    /// A part that waits for its acknowledgement.
    struct Waiting {
        int tries = 0;  ///< 0: not sent yet
        TimePoint since;
        TimePoint sent;
        StreamHead::Place next;
    };
    /// Of the step before: a change is logged at once.
    struct Last {
        link::SystemState state = link::SystemState::boot;
        std::uint16_t faults = 0;
        app::Control control = app::Control::autopilot;
        avoid::State guidance = avoid::State::watching;
        std::uint32_t conflict_id = 0;
        bool has_conflict = false;
        friend bool operator==(const Last&, const Last&) = default;
    };

    /// Candidates of the last decision that have not gone out.
    struct Round {
        std::uint32_t plan = 0;  ///< LastPlan::number
        std::uint16_t next = 0;
        std::uint16_t end = 0;
    };

    // All of them compiled for size: a step runs through few hundred bytes of them.
    [[gnu::cold]] void start(const link::CommandRequest& request, const app::Parameters& parameters) noexcept;
    [[gnu::cold]] void stop() noexcept;
    [[gnu::cold]] void earn() noexcept;
    [[nodiscard, gnu::cold]] bool is_hopeless() const noexcept;
    [[nodiscard, gnu::cold]] bool queue(link::Link& link, bool acknowledged, std::span<const std::byte> bytes,
                                        std::uint8_t first_message) noexcept;
    [[gnu::cold]] void send_definitions(link::Link& link) noexcept;
    [[gnu::cold]] void send_data(link::Link& link) noexcept;
    [[gnu::cold]] void log_step(const app::LoggedStep& step) noexcept;
    [[gnu::cold]] void log_changes(const app::StepReport& report) noexcept;
    [[gnu::cold]] void log_decision(const app::LoggedStep& step) noexcept;
    [[gnu::cold]] void log_candidates(const app::LastPlan& plan) noexcept;
    [[gnu::cold]] void leave_candidates_out() noexcept;
    [[gnu::cold]] void log_tracks(std::span<const world::Track> tracks) noexcept;
    [[gnu::cold]] void log_counters(const app::LoggedStep& step) noexcept;
    [[gnu::cold]] void log_parameters(const app::Parameters& parameters) noexcept;
    [[gnu::cold]] void log_text(char level, std::string_view text) noexcept;
    template <class T>
    bool put(TopicId id, const T& topic, std::size_t spare = 0) noexcept
    {
        return put_content(id, content_of(topic), spare);
    }
    template <class T>
    void put_counters(TopicId id, std::span<const Counter<T>> counters, const T& values) noexcept;
    [[gnu::cold, gnu::noinline]] bool put_content(TopicId id, std::span<const std::byte> content,
                                                  std::size_t spare) noexcept;

    std::int64_t bytes_per_second_;
    std::int64_t earned_ = 0;  ///< bytes that may be sent, in millionths
    TimePoint earned_at_;
    Phase phase_ = Phase::off;
    std::uint8_t to_system_ = 0;
    std::uint8_t to_component_ = 0;
    std::uint16_t sequence_ = 0;
    TimePoint now_;
    TimePoint started_;
    StreamHead head_;
    StreamHead::Place place_;
    Waiting waiting_;
    MessageRing ring_;
    StreamCounts counts_;
    std::uint32_t tick_ = 0;       ///< of a second
    std::uint32_t decisions_ = 0;  ///< since the start of the program
    std::size_t next_track_ = 0;
    Round candidates_;
    std::uint32_t generation_ = 0;
    std::optional<Last> last_;  ///< nothing before the first step of a log
};

}  // namespace jink::flightlog
