// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/linux/live_page/http_request.hpp"
#include "firmware/linux/live_page/snapshot.hpp"
#include "hal/linux/network_port.hpp"

namespace jink::livepage {

/// One HTTP/1.1 server for one page and one stream of events. Opens no file. Each connection carries one request.
///
/// Nothing here blocks but the wait in `pass`. For one thread. Memory: kMaxClients times kMaxHead and kMaxWaiting.
class Server {
public:
    static constexpr std::size_t kMaxClients = 8;
    /// Of one client's events that are not yet sent: beyond, it is too slow. Two seconds of events with all tracks, or
    /// two of the largest decisions.
    static constexpr std::size_t kMaxWaiting = 256U * 1024U;
    static constexpr std::int64_t kHeadTime = 5'000'000;     ///< for a request's head [us]
    static constexpr std::int64_t kAnswerTime = 20'000'000;  ///< for an answer [us]
    static constexpr std::int64_t kStallTime = 5'000'000;    ///< in which a hearer of events takes nothing [us]
    static constexpr std::int64_t kLingerTime = 1'000'000;   ///< behind an answer, for the client to close [us]

    /// @param page  what GET / answers
    explicit Server(std::string page) : page_(std::move(page)) {}
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    /// Binds and listens. @return 0, or the errno of what failed
    [[nodiscard]] int listen(const hal::NetworkAddress& address);

    /// Waits for clients until `until_us` at most, and does what they ask for.
    /// @param snapshot  what a new hearer of events is sent at once
    void pass(std::int64_t now_us, std::int64_t until_us, const Snapshot& snapshot);
    /// Sends an event to all who hear events.
    void send(std::string_view json, std::int64_t now_us);

    [[nodiscard]] const PageCounts& counts() const noexcept { return counts_; }
    void note_lost(std::uint32_t messages) noexcept { counts_.messages = messages; }

private:
    enum class State : std::uint8_t { reading, answering, hearing, lingering, gone };
    struct Client {
        int descriptor = -1;
        State state = State::reading;
        std::int64_t deadline_us = 0;
        std::string in;
        std::string out;        ///< not yet sent
        std::string_view body;  ///< not yet sent, behind `out`
        std::size_t discarded = 0;
    };

    void accept_all(std::int64_t now_us);
    void read(Client& client, std::int64_t now_us, const Snapshot& snapshot);
    void read_head(Client& client, std::int64_t now_us, const Snapshot& snapshot);
    void answer(Client& client, HttpStatus status, std::int64_t now_us);
    void begin_events(Client& client, std::int64_t now_us, const Snapshot& snapshot);
    void write(Client& client, std::int64_t now_us);
    void check_time(Client& client, std::int64_t now_us) noexcept;
    void drop(Client& client, bool is_slow) noexcept;
    void remove_gone();

    std::string page_;
    int listener_ = -1;
    std::string loopback_;  ///< the address that is served; empty: not on loopback
    std::vector<Client> clients_;
    PageCounts counts_;
};

}  // namespace jink::livepage
