// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/live_page.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/linux/background.hpp"
#include "firmware/linux/live_page/feed.hpp"
#include "firmware/linux/live_page/server.hpp"
#include "firmware/linux/live_page/snapshot.hpp"
#include "firmware/linux/ports.hpp"
#include "hal/linux/system_clock.hpp"

namespace jink::livepage {
namespace {

namespace fs = std::filesystem;

constexpr int kNiceness = 10;
constexpr std::uintmax_t kMaxPage = 8U << 20U;  // [bytes]

/// Between two passes of the server: clients cannot make it busy.
void pause_shortly()
{
    const timespec t{0, 1'000'000};
    ::nanosleep(&t, nullptr);
}

fs::path installed_page()
{
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = program.parent_path().parent_path() / "share/jink/report/live.html";
    return fs::exists(installed, error) ? installed : fs::path(JINK_LIVE_FOLDER) / "live.html";
}

/// Nothing, with a message: it is missing, no regular file, empty or too large.
std::optional<std::string> read_page(const PageOptions& options)
{
    const fs::path file = options.file.empty() ? installed_page() : fs::path(options.file);
    std::error_code error;
    const bool is_file = fs::is_regular_file(file, error);
    const std::uintmax_t size = is_file ? fs::file_size(file, error) : 0;
    if (!is_file || error || size == 0 || size > kMaxPage) {
        host::complain_now("--page: " + file.string() + ": expected the page, a file of 8 MiB at most" +
                           (options.file.empty() ? "; it is built after toolchain/viewer/setup.sh" : ""));
        return std::nullopt;
    }
    std::string text(static_cast<std::size_t>(size), '\0');
    std::ifstream in(file, std::ios::binary);
    if (!in.read(text.data(), static_cast<std::streamsize>(text.size()))) {
        host::complain_now("--page: " + file.string() + " cannot be read");
        return std::nullopt;
    }
    return text;
}

ShownParameters shown_of(const app::ParamValues& values)
{
    const auto value = [&](app::Param param) { return values[static_cast<std::size_t>(param)]; };
    return {value(app::Param::half_xy), value(app::Param::lookahead), value(app::Param::max_cost)};
}

}  // namespace

struct LivePage::Shared {
    Feed feed{kQueueBytes};
    Server server;
    Snapshot snapshot;
    hal::SystemClock clock;
    std::vector<std::byte> messages = std::vector<std::byte>(kQueueBytes);
    std::atomic<bool> stop{false};
    std::thread thread;

    Shared(std::string page, const ShownParameters& shown) : server(std::move(page)), snapshot(shown) {}

    void run()
    {
        sched_param normal{};
        ::sched_setscheduler(0, SCHED_OTHER, &normal);
        ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
        std::int64_t due = clock.now_us();
        while (!stop) {
            server.pass(clock.now_us(), due, snapshot);
            pause_shortly();
            const std::int64_t now = clock.now_us();
            if (now < due) {
                continue;
            }
            due = std::max(due + kPeriod, now);
            // The queue fits into the buffer, and the loop adds whole messages: what is taken are whole messages.
            snapshot.take(std::span(messages).first(feed.take(messages)));
            server.note_lost(feed.dropped());
            if (snapshot.has_news()) {
                server.send(snapshot.json(false, server.counts()), now);
                snapshot.begin_next();
            }
        }
    }
};

std::unique_ptr<LivePage> LivePage::open(const PageOptions& options, const app::ParamValues& parameters)
{
    std::string fault;
    const auto address = host::listening_address(options.address, fault);
    if (!address) {
        host::complain_now("--page " + options.address + ": " + fault);
        return nullptr;
    }
    std::optional<std::string> page = read_page(options);
    if (!page) {
        return nullptr;
    }
    auto shared = std::make_unique<Shared>(std::move(*page), shown_of(parameters));
    if (const int error = shared->server.listen(*address); error != 0) {
        host::complain_now("--page " + options.address + ": " + std::strerror(error));
        return nullptr;
    }
    return std::unique_ptr<LivePage>(new LivePage(std::move(shared)));
}

LivePage::LivePage(std::unique_ptr<Shared> shared) : shared_(std::move(shared))
{
    // Signals belong to the loop: they end its sleep, and must not be delivered to this thread.
    sigset_t all;
    sigset_t before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    shared_->thread = std::thread([shared = shared_.get()] { shared->run(); });
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

LivePage::~LivePage()
{
    shared_->stop = true;
    shared_->thread.join();
}

bool LivePage::add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records records) noexcept
{
    return shared_->feed.add(messages, count, records);
}

flightlog::LogCounts LivePage::counts() const noexcept { return shared_->feed.counts(); }

}  // namespace jink::livepage
