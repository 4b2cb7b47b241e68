// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "firmware/linux/flight_log/log_files.hpp"
#include "firmware/linux/flight_log/output.hpp"

namespace jink::flightlog {

/// The output of jinkd's log: a queue in memory and a thread of lower priority that writes files from it.
///
/// `add` never waits, whatever the file system does. While a file system does not answer the queue fills, and then
/// messages are dropped. The thread empties the queue every kPeriod and synchronises the file about once a second: a
/// process that is killed loses kPeriod at most, a machine that loses power about a second.
class Writer final : public Output {
public:
    static constexpr std::size_t kQueueBytes = 4U << 20U;             ///< minutes of a MAVLink line
    static constexpr std::size_t kQueueBytesWithClouds = 32U << 20U;  ///< seconds of 10^6 points per second
    static constexpr std::int64_t kPeriod = 50'000;                   ///< [us]

    Writer(FileOptions options, Definitions definitions, std::unique_ptr<Disk> disk, std::size_t queue_bytes);
    /// Waits half a second at most for the thread to write everything.
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    bool add(std::span<const std::byte> messages, std::uint32_t count, Records records) noexcept override;
    void lose() noexcept override;
    [[nodiscard]] LogCounts counts() const noexcept override;

    /// Time of the present step: dropouts are measured with it.
    void set_time(std::int64_t now_us) noexcept { now_us_ = now_us; }
    /// errno of a new series of write failures, once; 0: none.
    [[nodiscard]] int take_news() noexcept;
    /// The counters after the end: writes everything, as the destructor does.
    [[nodiscard]] LogCounts finish();

private:
    struct Shared;
    static void run(const std::shared_ptr<Shared>& shared);

    // Shared with the thread, which may outlive this when a file system does not answer.
    std::shared_ptr<Shared> shared_;
    std::int64_t now_us_ = 0;
    bool finished_ = false;
};

}  // namespace jink::flightlog
