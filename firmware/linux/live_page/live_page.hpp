// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "firmware/app/parameters.hpp"
#include "firmware/linux/flight_log/output.hpp"

namespace jink::livepage {

struct PageOptions {
    std::string address;  ///< [ADDRESS:]PORT; empty: no page
    std::string file;     ///< the page; empty: the installed one
};

/// The live view of a flight in a browser, read only: `jinkd --page`.
///
/// Takes the messages of the flight log, so that log and page tell the same. `add` never waits (feed.hpp). One thread
/// of lower priority takes the messages, makes an event every kPeriod and serves clients (server.hpp).
///
/// Memory: twice kQueueBytes, the page, and the server's clients.
class LivePage final : public flightlog::Output {
public:
    static constexpr std::size_t kQueueBytes = 256U * 1024U;  ///< about 20 s without the thread
    static constexpr std::int64_t kPeriod = 100'000;          ///< of events [us]

    /// Reads the page and listens. Nothing, with a message, where that cannot be.
    /// @param parameters  in force at the start
    [[nodiscard]] static std::unique_ptr<LivePage> open(const PageOptions& options, const app::ParamValues& parameters);
    /// Waits for the thread, kPeriod at most.
    ~LivePage();
    LivePage(const LivePage&) = delete;
    LivePage& operator=(const LivePage&) = delete;

    bool add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records records) noexcept override;
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override;

private:
    struct Shared;
    explicit LivePage(std::unique_ptr<Shared> shared);

    std::unique_ptr<Shared> shared_;
};

}  // namespace jink::livepage
