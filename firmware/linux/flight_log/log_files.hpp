// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/linux/flight_log/disk.hpp"
#include "firmware/linux/flight_log/key_filter.hpp"
#include "firmware/linux/flight_log/setup.hpp"

namespace jink::flightlog {

/// Where a log goes, and how much of it is kept.
struct FileOptions {
    std::string folder;
    std::uint64_t file_bytes = 64U << 20U;  ///< a file that would grow beyond this is followed by the next
    std::uint32_t files = 32;               ///< kept in the folder, those of earlier runs included
};

/// Definitions with which every file begins.
struct Definitions {
    std::vector<std::byte> before;                             ///< flags, formats, information messages, default values
    std::map<std::string, std::vector<std::byte>> parameters;  ///< by name: those in force
    std::vector<std::byte> behind;                             ///< subscriptions
};
/// Of a flight that is set up like this.
[[nodiscard]] Definitions definitions_of(const Setup& setup);
/// The head of a file.
/// @param started  first time of the data, or before [us]
[[nodiscard]] std::vector<std::byte> head_of_file(const Definitions& definitions, std::int64_t started,
                                                  const std::string& run, std::uint32_t number);

/// The files of one run: jink_YYYYmmdd_HHMMSS_NNN.ulg, where NNN counts within the run. Takes messages in any pieces
/// and writes whole messages, without signing keys; a record that is not whole at the end is left out. After a failure
/// it begins a new file every kRetry with the first message that is not wholly in the file before. Old logs are removed
/// once a new file is on the medium. A name that another program took meanwhile is passed over. All methods block as
/// long as the file system does.
class LogFiles {
public:
    static constexpr std::int64_t kRetry = 10'000'000;    ///< [us]
    static constexpr std::int64_t kSyncPeriod = 900'000;  ///< [us]
    static constexpr std::size_t kPiece = 64U * 1024U;    ///< bytes taken at a time: any message fits in two

    LogFiles(FileOptions options, Definitions definitions, std::unique_ptr<Disk> disk);

    /// Bytes that `take` may bring now; 0 while a file cannot be written.
    [[nodiscard]] std::size_t room() const noexcept;
    void take(std::span<const std::byte> bytes);
    /// Writes what was taken, begins files and synchronises them when it is due.
    /// @param now   on the clock of the data [us]
    /// @param last  everything is written and synchronised
    void work(std::int64_t now, bool last);

    // From any thread.
    [[nodiscard]] std::uint32_t failures() const noexcept { return failures_; }
    [[nodiscard]] std::uint32_t files() const noexcept { return begun_; }
    /// errno of a series of failures, once.
    [[nodiscard]] int take_news() noexcept { return news_ == 0 ? 0 : news_.exchange(0); }

private:
    void choose_run();
    [[nodiscard]] int create_file();
    [[nodiscard]] bool begin_file(std::int64_t now);
    [[nodiscard]] bool sync(std::int64_t now);
    void write_messages(std::int64_t now);
    void note_parameters(std::span<const std::byte> messages);
    void prune();
    void fail(int error, std::int64_t now);

    FileOptions options_;
    Definitions definitions_;
    std::unique_ptr<Disk> disk_;
    std::time_t run_time_;  ///< in the names of this run
    std::string run_;       ///< first part of the files' names
    std::string path_;      ///< of the present file
    std::uint32_t next_ = 0;
    bool is_open_ = false;
    bool is_dirty_ = false;
    bool is_stored_ = false;  ///< the present file was synchronised once
    std::uint64_t size_ = 0;
    std::int64_t retry_at_ = 0;
    std::int64_t synced_at_ = 0;
    KeyFilter keys_;
    std::vector<std::byte> waiting_;
    std::size_t ready_ = 0;  ///< bytes of `waiting_` that may be written: whole messages without keys
    bool reported_ = false;
    std::atomic<std::uint32_t> failures_{0}, begun_{0};
    std::atomic<int> news_{0};
};

/// Length of the whole messages at the start of `bytes`, as far as they stay within `limit` [bytes].
[[nodiscard]] std::size_t whole_messages(std::span<const std::byte> bytes, std::uint64_t limit) noexcept;

}  // namespace jink::flightlog
