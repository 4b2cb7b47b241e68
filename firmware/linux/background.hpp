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

/// Closed areas of a file.
using Areas = std::vector<app::Constraint>;

enum class Stream : std::uint8_t { out, error };

struct BackgroundFiles {
    std::string airspace;          ///< read again by reload(); may be empty
    std::string state;             ///< target of store(); may be empty: nothing is stored
    std::string signing;           ///< target of store_signing(), readable by the owner alone; may be empty
    files::ParamValues initial{};  ///< parameters without the state file: values that differ are stored
};

/// Counters of losses and failures.
struct BackgroundCounts {
    std::uint32_t dropped = 0;  ///< lines: the reader of a stream is too slow, or the stream cannot be written
    std::uint32_t reloads = 0;  ///< of the airspace file, good or bad
    std::uint32_t reload_failures = 0;
    std::uint32_t stores = 0;          ///< of parameters
    std::uint32_t store_failures = 0;  ///< read-only, full disk: tried again with the next change and every 10 s
    std::uint32_t signing_stores = 0;
    std::uint32_t signing_store_failures = 0;
};

/// A thread of lower priority that does all blocking work of jinkd: it writes status lines and messages, reads and
/// parses the airspace file, and stores parameters and the signing state.
///
/// The methods below are for one thread, the control loop. They never wait for the background thread, a file, a pipe or
/// a terminal. Lines that do not fit are dropped whole and counted: kLines lines of kLineBytes wait per stream, and
/// kBacklog bytes in the thread. A stream that accepts nothing delays neither the other stream nor the files.
///
/// Memory: 16 KiB per stream and the backlog; the areas of a file twice during the transfer.
class Background {
public:
    static constexpr std::size_t kLines = 32;
    static constexpr std::size_t kLineBytes = 512;
    static constexpr std::size_t kBacklog = 8U * 1024U;

    explicit Background(const BackgroundFiles& files);
    /// Writes as much as the streams and the disk accept within 0.5 s, and discards the rest.
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    /// Prints a line, given without its end. A line longer than kLineBytes - 1 is cut.
    void print(Stream stream, std::string_view line) noexcept;

    /// Requests a read of the airspace file. Requests while one waits become one.
    void reload() noexcept;
    /// The complete areas read since the last call; nullptr if there are none. Return them with `done`.
    [[nodiscard]] std::unique_ptr<Areas> take_areas() noexcept;
    /// Passes the areas to the thread, which frees them.
    void done(std::unique_ptr<Areas> areas) noexcept;

    /// Requests that these values are stored, app::Parameters::values() of this generation. False: busy, try again in
    /// the next step.
    [[nodiscard]] bool store(const files::ParamValues& values, std::uint32_t generation) noexcept;
    /// Generation of the values that the state file certainly holds; nothing before the first store.
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

/// Prints to standard error, before there is a Background: waits at most 0.1 s for a stream that accepts nothing.
void complain_now(std::string_view line);

/// Writes a file without waiting for a reader: a FIFO without a reader, a full disk or a folder is a failure.
[[nodiscard]] bool write_file(const std::string& path, std::string_view text);

}  // namespace jink::host
