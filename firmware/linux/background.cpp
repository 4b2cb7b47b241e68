// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/background.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "firmware/linux/airspace_file.hpp"
#include "firmware/linux/param_store.hpp"
#include "hal/linux/system_clock.hpp"
#include "hal/ring.hpp"

namespace jink::host {
namespace {

constexpr std::int64_t kPatience = 50'000;        ///< between checks of a stream that accepts nothing [us]
constexpr std::int64_t kStoreRetry = 10'000'000;  ///< after a failure [us]
constexpr std::int64_t kFarewell = 500'000;       ///< time limit of the end [us]
constexpr int kNiceness = 10;

bool takes_bytes(int descriptor, int patience_ms)
{
    pollfd waiting{descriptor, POLLOUT, 0};
    return ::poll(&waiting, 1, patience_ms) > 0;
}

timespec in_future(std::int64_t us)
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    t.tv_sec += us / 1'000'000;
    t.tv_nsec += us % 1'000'000 * 1'000;
    if (t.tv_nsec >= 1'000'000'000) {
        t.tv_nsec -= 1'000'000'000;
        ++t.tv_sec;
    }
    return t;
}

}  // namespace

namespace detail {

struct Line {
    std::uint16_t size = 0;
    std::array<char, Background::kLineBytes> text;
};

/// One of the standard streams. The loop fills `ring`; the thread owns all other members.
struct Channel {
    int descriptor = -1;
    hal::Ring<Line, Background::kLines> ring;
    std::string backlog;

    /// @return number of lost lines
    std::uint32_t add(const std::string& line)
    {
        if (backlog.size() + line.size() >= Background::kBacklog) {
            return 1;
        }
        backlog += line;
        backlog += '\n';
        return 0;
    }

    /// Writes as much as the stream accepts without blocking: a pipe that polls writable takes PIPE_BUF bytes whole.
    /// @return number of lost lines
    std::uint32_t flush()
    {
        constexpr std::size_t kPart = 4096;
        Line line;
        while (backlog.size() + line.text.size() < Background::kBacklog && ring.pop(line)) {
            backlog.append(line.text.data(), line.size);
            backlog += '\n';
        }
        std::size_t written = 0;
        std::uint32_t lost = 0;
        while (written < backlog.size() && takes_bytes(descriptor, 0)) {
            const ssize_t n = ::write(descriptor, backlog.data() + written, std::min(kPart, backlog.size() - written));
            if (n < 0 && errno != EAGAIN && errno != EINTR) {
                const auto rest = backlog.begin() + static_cast<std::ptrdiff_t>(written);
                lost = static_cast<std::uint32_t>(std::count(rest, backlog.end(), '\n'));
                written = backlog.size();
            } else if (n <= 0) {
                break;
            } else {
                written += static_cast<std::size_t>(n);
            }
        }
        backlog.erase(0, written);
        return lost;
    }
    [[nodiscard]] bool waits() const { return !backlog.empty() || ring.size() > 0; }
};

/// A file that is replaced as a whole. A failed write is tried again.
class Store {
public:
    Store(const char* failure, files::FileAccess access) : failure_(failure), access_(access) {}

    void take(std::string text)
    {
        text_ = std::move(text);
        is_due_ = true;
        retry_at_ = 0;
    }
    [[nodiscard]] bool is_due() const { return is_due_; }
    /// Writes the text if it is due. `last`: no further try follows. @return complaint, once per series of failures
    std::string work(const std::string& path, std::int64_t now, bool last)
    {
        is_due_ = is_due_ && !path.empty();
        if (!is_due_ || (now < retry_at_ && !last)) {
            return {};
        }
        const std::string why = files::replace_file(path, text_, access_);
        is_due_ = !why.empty() && !last;
        ++(why.empty() ? done : failed);
        const bool is_news = !why.empty() && !reported_;
        reported_ = !why.empty();
        retry_at_ = now + kStoreRetry;
        return is_news ? path + ": " + failure_ + ": " + why : std::string{};
    }

    std::atomic<std::uint32_t> done{0}, failed{0};

private:
    const char* failure_;
    files::FileAccess access_;
    std::string text_;
    bool is_due_ = false;
    bool reported_ = false;
    std::int64_t retry_at_ = 0;
};

}  // namespace detail

struct Background::Shared {
    using Line = detail::Line;
    using NewParams = std::pair<files::ParamValues, std::uint32_t>;  ///< with their generation

    BackgroundFiles wanted;
    sem_t wake{};
    std::array<detail::Channel, 2> channels;
    std::atomic<bool> stop{false};
    std::atomic<bool> stopped{false};
    std::atomic<bool> reload{false};
    std::atomic<Areas*> ready{nullptr};
    std::atomic<Areas*> spent{nullptr};
    std::mutex values_mutex;
    std::optional<NewParams> values;               ///< to be stored; guarded by values_mutex
    std::optional<files::SigningState> signature;  ///< likewise
    std::atomic<std::uint32_t> dropped{0}, reloads{0}, reload_failures{0};
    static constexpr std::uint64_t kNothing = ~std::uint64_t{0};
    std::atomic<std::uint64_t> stored{kNothing};  ///< generation of the parameters in the state file

    // Owned by the thread, except for their counters.
    hal::SystemClock clock;
    std::uint32_t generation = 0;  ///< of the values in `params`
    detail::Store params{"parameters are not stored", files::FileAccess::everyone_reads};
    detail::Store signing{"the signing key and time are not stored", files::FileAccess::owner_only};

    explicit Shared(const BackgroundFiles& given) : wanted(given)
    {
        ::sem_init(&wake, 0, 0);
        channels[0].descriptor = STDOUT_FILENO;
        channels[1].descriptor = STDERR_FILENO;
    }
    ~Shared()
    {
        delete ready.load();
        delete spent.load();
        ::sem_destroy(&wake);
    }
    Shared(const Shared&) = delete;
    Shared& operator=(const Shared&) = delete;

    void complain(const std::string& text) { dropped += channels[1].add("jinkd: " + text); }
    void read_airspace();
    void store_values();
    [[nodiscard]] bool waits() const { return channels[0].waits() || channels[1].waits(); }
    [[nodiscard]] bool work();
};

void Background::Shared::read_airspace()
{
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    const double unix_seconds = static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
    files::Complaints complaints;
    const TimePoint now{clock.now_us()};
    auto areas = files::read_airspace_file(wanted.airspace, {unix_seconds, now}, complaints);
    for (const files::Complaint& complaint : complaints) {
        complain(files::to_string(complaint));
    }
    ++reloads;
    if (!areas) {
        ++reload_failures;
        return;
    }
    complain(files::areas_text(wanted.airspace, *areas, now));
    delete ready.exchange(new Areas(std::move(*areas)));
}

void Background::Shared::store_values()
{
    std::optional<NewParams> new_values;
    std::optional<files::SigningState> new_signature;
    {
        const std::lock_guard lock(values_mutex);
        std::swap(new_values, values);
        std::swap(new_signature, signature);
    }
    if (new_values) {
        params.take(files::state_text(wanted.initial, new_values->first));
        generation = new_values->second;
    }
    if (new_signature) {
        signing.take(files::signing_text(*new_signature));
    }
    const std::int64_t now = clock.now_us();
    const std::uint32_t done = params.done;
    if (const std::string why = params.work(wanted.state, now, stop); !why.empty()) {
        complain(why);
    }
    if (params.done != done) {
        stored = generation;
    }
    if (const std::string why = signing.work(wanted.signing, now, stop); !why.empty()) {
        complain(why);
    }
}

/// False at the end.
bool Background::Shared::work()
{
    if (waits() || params.is_due() || signing.is_due()) {
        const timespec until = in_future(kPatience);
        ::sem_clockwait(&wake, CLOCK_MONOTONIC, &until);
    } else {
        ::sem_wait(&wake);
    }
    const bool last = stop;
    delete spent.exchange(nullptr);
    if (reload.exchange(false) && !wanted.airspace.empty()) {
        read_airspace();
    }
    store_values();
    for (detail::Channel& channel : channels) {
        dropped += channel.flush();
    }
    return !last;
}

void Background::run(const std::shared_ptr<Shared>& shared)
{
    sched_param normal{};
    ::sched_setscheduler(0, SCHED_OTHER, &normal);
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNiceness);
    while (shared->work()) {
    }
    shared->stopped = true;
}

Background::Background(const BackgroundFiles& files) : shared_(std::make_shared<Shared>(files))
{
    // Signals belong to the loop: they end its sleep, and must not be delivered to this thread.
    sigset_t all;
    sigset_t before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread([shared = shared_] { run(shared); }).detach();
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Background::~Background()
{
    // Streams first: after a stop request the thread does one more pass and ends.
    const auto wait_for = [&](const auto& condition) {
        const std::int64_t end = shared_->clock.now_us() + kFarewell / 2;
        while (!condition() && shared_->clock.now_us() < end) {
            const timespec pause{0, 2'000'000};
            ::nanosleep(&pause, nullptr);
        }
    };
    ::sem_post(&shared_->wake);
    wait_for([&] { return shared_->channels[0].ring.size() == 0 && shared_->channels[1].ring.size() == 0; });
    shared_->stop = true;
    ::sem_post(&shared_->wake);
    wait_for([&] { return shared_->stopped.load(); });
}

void Background::print(Stream stream, std::string_view line) noexcept
{
    Shared::Line item;
    item.size = static_cast<std::uint16_t>(std::min(line.size(), item.text.size() - 1));
    std::memcpy(item.text.data(), line.data(), item.size);
    if (!shared_->channels[static_cast<std::size_t>(stream)].ring.push(item)) {
        ++shared_->dropped;
    }
    ::sem_post(&shared_->wake);
}

void Background::reload() noexcept
{
    if (!shared_->reload.exchange(true)) {
        ::sem_post(&shared_->wake);
    }
}

std::unique_ptr<Areas> Background::take_areas() noexcept
{
    return std::unique_ptr<Areas>(shared_->ready.exchange(nullptr));
}

void Background::done(std::unique_ptr<Areas> areas) noexcept
{
    delete shared_->spent.exchange(areas.release());
    ::sem_post(&shared_->wake);
}

template <class T>
bool Background::hand_over(const T& value, std::optional<T>& place) noexcept
{
    const std::unique_lock lock(shared_->values_mutex, std::try_to_lock);
    if (!lock.owns_lock()) {
        return false;
    }
    place = value;
    ::sem_post(&shared_->wake);
    return true;
}

bool Background::store(const files::ParamValues& values, std::uint32_t generation) noexcept
{
    return hand_over(Shared::NewParams{values, generation}, shared_->values);
}

std::optional<std::uint32_t> Background::stored_generation() const noexcept
{
    const std::uint64_t stored = shared_->stored;
    return stored == Shared::kNothing ? std::nullopt : std::optional(static_cast<std::uint32_t>(stored));
}

bool Background::store_signing(const files::SigningState& state) noexcept
{
    return hand_over(state, shared_->signature);
}

BackgroundCounts Background::counts() const noexcept
{
    const Shared& s = *shared_;
    return {s.dropped, s.reloads, s.reload_failures, s.params.done, s.params.failed, s.signing.done, s.signing.failed};
}

void complain_now(std::string_view line)
{
    const std::string text = "jinkd: " + std::string(line) + "\n";
    static int patience_ms = 100;  // one limit for all lines: a file may cause a thousand
    const bool taken = takes_bytes(STDERR_FILENO, patience_ms);
    patience_ms = taken ? patience_ms : 0;
    if (taken) {
        static_cast<void>(!::write(STDERR_FILENO, text.data(), std::min<std::size_t>(text.size(), 4096)));
    }
}

bool write_file(const std::string& path, std::string_view text)
{
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0644);
    if (file < 0) {
        return false;
    }
    while (!text.empty()) {
        const ssize_t n = ::write(file, text.data(), text.size());
        if (n > 0) {
            text.remove_prefix(static_cast<std::size_t>(n));
        } else if (n == 0 || errno != EINTR) {
            break;
        }
    }
    return ::close(file) == 0 && text.empty();
}

}  // namespace jink::host
