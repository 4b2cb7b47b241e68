// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/writer.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <ctime>
#include <thread>
#include <utility>

#include "firmware/linux/flight_log/queue.hpp"
#include "hal/linux/system_clock.hpp"

namespace jink::flightlog {
namespace {

constexpr std::int64_t kFarewell = 500'000;  ///< time limit of the end [us]
constexpr int kNiceness = 10;

void pause(std::int64_t us)
{
    const timespec t{0, static_cast<long>(us * 1000)};
    ::nanosleep(&t, nullptr);
}

}  // namespace

struct Writer::Shared {
    Queue queue;
    LogFiles files;
    hal::SystemClock clock;
    std::vector<std::byte> piece = std::vector<std::byte>(LogFiles::kPiece);
    std::atomic<bool> stop{false};
    std::atomic<bool> stopped{false};

    Shared(FileOptions options, Definitions definitions, std::unique_ptr<Disk> disk, std::size_t queue_bytes)
        : queue(queue_bytes), files(std::move(options), std::move(definitions), std::move(disk))
    {
    }

    void empty_queue(bool last)
    {
        std::size_t n = 0;
        do {
            n = queue.take(std::span(piece).first(files.room()));
            files.take(std::span(piece).first(n));
            files.work(clock.now_us(), last);
        } while (n > 0);
    }
};

void Writer::run(const std::shared_ptr<Shared>& shared)
{
    sched_param normal{};
    ::sched_setscheduler(0, SCHED_OTHER, &normal);
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
    bool last = false;
    while (!last) {
        last = shared->stop;
        shared->empty_queue(last);
        if (!last) {
            pause(kPeriod);
        }
    }
    shared->stopped = true;
}

Writer::Writer(FileOptions options, Definitions definitions, std::unique_ptr<Disk> disk, std::size_t queue_bytes)
    : shared_(std::make_shared<Shared>(std::move(options), std::move(definitions), std::move(disk), queue_bytes))
{
    // Signals belong to the loop: they end its sleep, and must not be delivered to this thread.
    sigset_t all;
    sigset_t before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread([shared = shared_] { run(shared); }).detach();
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Writer::~Writer() { static_cast<void>(finish()); }

LogCounts Writer::finish()
{
    constexpr std::int64_t kStep = 2'000;
    shared_->stop = true;
    for (std::int64_t waited = 0; !finished_ && !shared_->stopped && waited < kFarewell; waited += kStep) {
        pause(kStep);
    }
    finished_ = true;
    return counts();
}

bool Writer::add(std::span<const std::byte> messages, std::uint32_t count, Records /*records*/) noexcept
{
    return shared_->queue.add(messages, now_us_, count);
}

void Writer::lose() noexcept { shared_->queue.lose(now_us_, 1); }

LogCounts Writer::counts() const noexcept
{
    const Shared& s = *shared_;
    return {s.queue.messages(), s.queue.dropped(), s.files.failures(), s.files.files(), s.queue.peak()};
}

int Writer::take_news() noexcept { return shared_->files.take_news(); }

}  // namespace jink::flightlog
