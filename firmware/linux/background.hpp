// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/constraints.hpp"
#include "firmware/linux/param_file.hpp"
#include "firmware/linux/signing_store.hpp"

namespace jink::host {

/// Closed areas as a file has them.
using Areas = std::vector<app::Constraint>;

enum class Stream : std::uint8_t { out, error };

struct BackgroundFiles {
    std::string airspace;          ///< read anew by reload(); may be empty
    std::string state;             ///< where store() writes; may be empty: nothing is stored
    std::string signing;           ///< where store_signing() writes, for the owner's eyes alone; may be empty
    files::ParamValues initial{};  ///< parameters without the state file: values that differ are stored
};

/// What has been lost or has failed so far.
struct BackgroundCounts {
    std::uint32_t dropped = 0;  ///< lines: the reader of a stream does not keep up, or the stream cannot be written
    std::uint32_t reloads = 0;  ///< of the airspace file, good or bad
    std::uint32_t reload_failures = 0;
    std::uint32_t stores = 0;          ///< of parameters
    std::uint32_t store_failures = 0;  ///< read-only, full disk: tried again with the next change and every 10 s
    std::uint32_t signing_stores = 0;
    std::uint32_t signing_store_failures = 0;
};

/// A thread of lower priority that does all of jinkd that may block: it writes status lines and messages, reads and
/// parses the airspace file, stores parameters and what signing needs.
///
/// The methods below are for one thread, the control loop. They never wait for the background thread, a file, a pipe or
/// a terminal. What does not fit is dropped whole and counted: kLines lines of kLineBytes wait per stream, and
/// kBacklog bytes in the thread. A stream that takes nothing holds up neither the other stream nor the files.
///
/// Memory: 16 KiB per stream and the backlog; the areas of a file twice while they are handed over.
class Background {
public:
    static constexpr std::size_t kLines = 32;
    static constexpr std::size_t kLineBytes = 512;
    static constexpr std::size_t kBacklog = 8U * 1024U;

    explicit Background(const BackgroundFiles& files);
    /// Writes what the streams and the disk take within 0.5 s, and leaves the rest.
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    /// A line without its end. Longer than kLineBytes - 1: cut.
    void print(Stream stream, std::string_view line) noexcept;

    /// Asks for the airspace file to be read. Requests while one waits become one.
    void reload() noexcept;
    /// The areas that were read since the last call, whole; nullptr when there are none. Give them back with `done`.
    [[nodiscard]] std::unique_ptr<Areas> take_areas() noexcept;
    /// Leaves it to the thread to free the areas.
    void done(std::unique_ptr<Areas> areas) noexcept;

    /// Asks for these values to be stored, app::Parameters::values() of this generation. False: busy, ask again in the
    /// next step.
    [[nodiscard]] bool store(const files::ParamValues& values, std::uint32_t generation) noexcept;
    /// Generation of the values that the state file holds for certain; nothing before the first store.
    [[nodiscard]] std::optional<std::uint32_t> stored_generation() const noexcept;
    [[nodiscard]] bool store_signing(const files::SigningState& state) noexcept;

    [[nodiscard]] BackgroundCounts counts() const noexcept;

private:
    struct Shared;
    static void run(const std::shared_ptr<Shared>& shared);
    template <class T>
    [[nodiscard]] bool hand_over(const T& value, std::optional<T>& place) noexcept;

    // Shared with the thread, which may outlive this when a file system does not answer.
    std::shared_ptr<Shared> shared_;
};

/// To standard error, before there is a Background: waits at most 0.1 s for a stream that takes nothing.
void complain_now(std::string_view line);

/// Writes a file without waiting for a reader: a FIFO that nobody reads, a full disk or a folder is a failure.
[[nodiscard]] bool write_file(const std::string& path, std::string_view text);

}  // namespace jink::host
