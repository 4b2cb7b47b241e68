// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "firmware/app/coprocessor.hpp"
#include "firmware/linux/flight_log/output.hpp"
#include "firmware/linux/flight_log/recording_ports.hpp"
#include "firmware/linux/flight_log/shape_round.hpp"
#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/param_file.hpp"

namespace jink::flightlog {

/// The control loop's side of a flight log: composes what a step did and gives it to an output. Never waits, and
/// allocates nothing after its construction.
///
/// Memory: the largest record of a step (Limits) and 36 KiB.
class FlightLog {
public:
    struct Limits {
        /// Of one record [bytes]: 4 KiB read and 8 KiB written on the line, and 2500 closed areas of up to 61 bytes.
        /// 0: no records, for an output that does not use them.
        std::size_t record = 192U * 1024U;
        static constexpr std::size_t kOfBus = 96U * 1024U;      ///< 512 frames received, and as many sent
        static constexpr std::size_t kOfClouds = 192U * 1024U;  ///< app::kMaxCloudBytesPerStep
    };

    /// @param output      outlives this
    /// @param parameters  in force at the start, as in the definitions
    FlightLog(Output& output, const Limits& limits, const files::ParamValues& parameters);
    FlightLog(const FlightLog&) = delete;
    FlightLog& operator=(const FlightLog&) = delete;

    /// For the ports, and for what is set from outside of them.
    [[nodiscard]] HalRecorder& recorder() noexcept { return recorder_; }

    /// Before everything of a step that is not bytes: the step follows.
    void begin(TimePoint began) noexcept { recorder_.begin(began); }
    /// After the step.
    void end(const app::StepReport& report, app::Coprocessor& coprocessor, TimePoint began,
             std::int64_t took_us) noexcept;
    /// Before and after Coprocessor::shut_down.
    void begin_shut_down(TimePoint now) noexcept { recorder_.begin_shut_down(now); }
    void end_shut_down(TimePoint now) noexcept;

private:
    static constexpr std::int64_t kTrackPeriod = 200'000;      ///< of tracks and nominal paths [us]
    static constexpr std::int64_t kCounterPeriod = 1'000'000;  ///< [us]

    /// A new message of kMaxMessage at most, to be given to `keep`.
    [[nodiscard]] ulog::Composer message(ulog::Type type) noexcept
    {
        if (messages_.size() - size_ < kMaxMessage) [[unlikely]] {
            flush();
        }
        return ulog::Composer(messages_.subspan(size_, kMaxMessage)).begin(type);
    }
    [[nodiscard]] ulog::Composer data(TopicId id) noexcept
    {
        return message(ulog::Type::data).put(static_cast<std::uint16_t>(id));
    }
    void keep(ulog::Composer& message) noexcept
    {
        size_ += message.end().size();
        ++count_;
    }
    void flush() noexcept;
    template <class T>
    void put(TopicId id, const T& topic) noexcept;
    void put_text(ulog::Level level, TimePoint now, std::string_view text) noexcept;
    void put_record(TimePoint now) noexcept;
    [[gnu::cold]] void put_parts(std::size_t size, std::uint32_t parts, TimePoint now) noexcept;
    [[nodiscard]] std::size_t put_part(std::size_t at, std::size_t n, std::uint32_t number, std::uint16_t flags,
                                       TimePoint now) noexcept;
    void put_sent_texts(TimePoint now) noexcept;
    void put_own(const app::StepReport& report, const app::Coprocessor& coprocessor, TimePoint now) noexcept;
    void put_tracks(app::Coprocessor& coprocessor, TimePoint now) noexcept;
    void put_nominal(const app::NominalPaths& paths, TimePoint now) noexcept;
    void put_path(const world::Reference& reference, std::uint8_t path, bool on_route, TimePoint now) noexcept;
    [[gnu::cold]] void put_shapes(const app::Coprocessor& coprocessor, TimePoint now) noexcept;
    void put_counters(const app::Coprocessor& coprocessor, TimePoint now) noexcept;
    template <class T>
    void put_counters_of(TopicId id, std::span<const Counter<T>> counters, const T& diagnostics,
                         TimePoint now) noexcept;
    void put_decision(const app::StepReport& report, const app::Coprocessor& coprocessor, TimePoint now) noexcept;
    void put_changes(const app::StepReport& report, TimePoint now) noexcept;
    void put_changed_parameters(const app::Parameters& parameters) noexcept;

    static constexpr std::size_t kPartHead = ulog::kDataHeader + HalHead::kBytes;
    static constexpr std::size_t kMaxMessage = kPartHead + kHalSizes.back();

    Output& output_;
    HalRecorder recorder_;
    /// Of this step, not yet given to the output. They begin where the record is composed: its parts stay in place but
    /// for the heads between them, and the other messages follow.
    std::span<std::byte> messages_;
    std::size_t size_ = 0;  ///< of them [bytes]
    std::uint32_t count_ = 0;
    Records records_;                ///< at the head of them
    files::ParamValues parameters_;  ///< as logged
    files::ParamValues accepted_;    ///< those of them that the output has for certain
    bool has_changes_ = false;       ///< of parameters among `messages_`
    std::uint32_t generation_ = 0;
    bool has_generation_ = false;
    std::uint32_t sequence_ = 0;
    std::uint32_t steps_ = 0;
    std::uint32_t decisions_ = 0;
    std::int64_t own_stamp_ = -1;
    std::int64_t tracks_due_ = 0;
    std::int64_t counters_due_ = 0;
    ShapeRound shapes_;
    /// Of the step before: their changes are logged as texts.
    struct Last {
        link::SystemState state = app::StepReport().state;
        std::uint16_t faults = 0;
        app::Control control = app::StepReport().control;
        avoid::State guidance = avoid::Guidance().state;
    };
    Last last_;
};

}  // namespace jink::flightlog
