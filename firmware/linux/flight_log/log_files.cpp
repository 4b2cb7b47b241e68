// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/log_files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <tuple>
#include <utility>

#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/flight_log/ulog.hpp"
#include "firmware/linux/flight_log/ulog_reader.hpp"

namespace jink::flightlog {
namespace {

constexpr std::string_view kSuffix = ".ulg";

std::string name_of_run(std::time_t time)
{
    std::tm utc{};
    ::gmtime_r(&time, &utc);
    std::array<char, 40> text{};
    static_cast<void>(std::strftime(text.data(), text.size(), "jink_%Y%m%d_%H%M%S", &utc));
    return text.data();
}

std::string numbered(const std::string& run, std::uint32_t number)
{
    std::string digits = std::to_string(number);
    digits.insert(0, 3 - std::min<std::size_t>(digits.size(), 3), '0');
    return run + "_" + digits + std::string(kSuffix);
}

/// As numbered() makes them: a log that was renamed to be kept is none.
bool is_log(const std::string& name)
{
    constexpr std::string_view kForm = "jink_dddddddd_dddddd_ddd";  // d: a digit, as many more as there are at the end
    if (name.size() < kForm.size() + kSuffix.size() || !name.ends_with(kSuffix)) {
        return false;
    }
    const std::string_view stem = std::string_view(name).substr(0, name.size() - kSuffix.size());
    for (std::size_t i = 0; i < stem.size(); ++i) {
        const char form = i < kForm.size() ? kForm[i] : 'd';
        const bool digit = stem[i] >= '0' && stem[i] <= '9';
        if (form == 'd' ? !digit : stem[i] != form) {
            return false;
        }
    }
    return true;
}

}  // namespace

Definitions definitions_of(const Setup& setup)
{
    Definitions definitions;
    ulog::Messages before;
    ulog::Messages behind;
    before.flag_bits(ulog::kDefaultParameters);
    std::uint16_t id = 0;
    for (const std::string& format : topic_formats()) {
        before.format(format);
        behind.subscription(id++, name_of_format(format));
    }
    put_infos(setup, before);
    put_defaults(setup.initial, before);
    for (std::size_t i = 0; i < setup.stored.size(); ++i) {
        ulog::Messages parameter;
        put_parameter(i, setup.stored[i], parameter);
        definitions.parameters[std::string(app::param_table()[i].name)] = parameter.bytes();
    }
    definitions.before = before.bytes();
    definitions.behind = behind.bytes();
    return definitions;
}

std::vector<std::byte> head_of_file(const Definitions& definitions, std::int64_t started, const std::string& run,
                                    std::uint32_t number)
{
    ulog::Messages all;
    all.file_header(static_cast<std::uint64_t>(started));
    all.append(definitions.before);
    all.info("jink_run", run);
    all.info("jink_file", number);
    for (const auto& [name, message] : definitions.parameters) {
        all.append(message);
    }
    all.append(definitions.behind);
    return all.bytes();
}

std::size_t whole_messages(std::span<const std::byte> bytes, std::uint64_t limit) noexcept
{
    std::size_t whole = 0;
    while (bytes.size() - whole >= ulog::kMessageHeader) {
        const std::size_t next = whole + ulog::size_of_message(bytes.subspan(whole));
        if (next > bytes.size() || next > limit) {
            break;
        }
        whole = next;
    }
    return whole;
}

LogFiles::LogFiles(FileOptions options, Definitions definitions, std::unique_ptr<Disk> disk)
    : options_(std::move(options)), definitions_(std::move(definitions)), disk_(std::move(disk)),
      run_time_(std::time(nullptr))
{
    waiting_.reserve(3 * kPiece);
    choose_run();
}

/// The first name from run_time_ on that no file has: two runs may begin within a second, and the clock of a machine
/// may start at the same time after each boot.
void LogFiles::choose_run()
{
    const std::vector<std::string> there = disk_->names_in(options_.folder);
    const auto is_taken = [&](const std::string& run) {
        return std::any_of(there.begin(), there.end(), [&](const std::string& name) { return name.starts_with(run); });
    };
    for (run_ = name_of_run(run_time_); is_taken(run_);) {
        run_ = name_of_run(++run_time_);
    }
}

std::size_t LogFiles::room() const noexcept { return ready_ < 2 * kPiece ? kPiece : 0; }

void LogFiles::take(std::span<const std::byte> bytes)
{
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    const std::span<std::byte> fresh = std::span(waiting_).subspan(ready_);
    ready_ += keys_.pass(fresh.first(whole_messages(fresh, ~std::uint64_t{0})));
}

void LogFiles::fail(int error, std::int64_t now)
{
    ++failures_;
    if (!reported_) {
        news_ = error;
        reported_ = true;
    }
    disk_->close();
    is_open_ = false;
    is_dirty_ = false;
    retry_at_ = now + kRetry;
}

/// Under the next name that no other program has taken. @return errno
int LogFiles::create_file()
{
    constexpr int kMaxNames = 100;
    int error = EEXIST;
    for (int i = 0; i < kMaxNames && error == EEXIST; ++i) {
        path_ = options_.folder + "/" + numbered(run_, next_);
        error = disk_->create(path_);
        if (error == EEXIST && begun_ == 0) {  // another run's
            ++run_time_;
            choose_run();
        } else if (error == EEXIST) {
            ++next_;
        }
    }
    return error;
}

bool LogFiles::begin_file(std::int64_t now)
{
    int error = create_file();
    if (error != 0) {
        fail(error, now);
        return false;
    }
    const std::vector<std::byte> head = head_of_file(definitions_, now, run_, next_);
    std::size_t written = 0;
    error = disk_->write(head, written);
    if (error != 0) {
        disk_->close();
        disk_->remove(path_);  // it holds nothing
        fail(error, now);
        return false;
    }
    is_open_ = true;
    is_dirty_ = true;
    is_stored_ = false;
    size_ = head.size();
    ++next_;
    ++begun_;
    return true;
}

bool LogFiles::sync(std::int64_t now)
{
    is_dirty_ = false;
    if (const int error = disk_->sync(); error != 0) {
        fail(error, now);
        return false;
    }
    if (!is_stored_) {  // writes succeed in memory: a medium that stores nothing keeps its old logs
        is_stored_ = true;
        reported_ = false;
        prune();
    }
    return true;
}

/// Removes the oldest logs: those of earlier runs first, by name.
void LogFiles::prune()
{
    std::vector<std::string> logs = disk_->names_in(options_.folder);
    std::erase_if(logs, [](const std::string& name) { return !is_log(name); });
    const auto age = [&](const std::string& name) {
        return std::tuple(name.starts_with(run_), name.substr(0, run_.size()), name.size(), name);
    };
    std::sort(logs.begin(), logs.end(), [&](const std::string& a, const std::string& b) { return age(a) < age(b); });
    for (std::size_t i = 0; i + options_.files < logs.size(); ++i) {
        disk_->remove(options_.folder + "/" + logs[i]);
    }
}

/// Parameters that change are in force at the beginning of the next file.
void LogFiles::note_parameters(std::span<const std::byte> messages)
{
    while (!messages.empty()) {
        const std::span<const std::byte> message = messages.first(ulog::size_of_message(messages));
        if (static_cast<ulog::Type>(message[2]) == ulog::Type::parameter) {
            if (const auto keyed = ulog::parse_keyed(message.subspan(ulog::kMessageHeader), ulog::Type::parameter)) {
                definitions_.parameters[keyed->name] = {message.begin(), message.end()};
            }
        }
        messages = messages.subspan(message.size());
    }
}

void LogFiles::write_messages(std::int64_t now)
{
    for (;;) {
        const std::uint64_t left = options_.file_bytes > size_ ? options_.file_bytes - size_ : 0;
        const std::span<const std::byte> ready = std::span(waiting_).first(ready_);
        std::size_t n = is_open_ ? whole_messages(ready, left) : 0;
        if (n == 0) {
            if (ready.empty()) {
                return;
            }
            if (is_open_) {  // full
                if (!sync(now)) {
                    return;
                }
                disk_->close();
                is_open_ = false;
            }
            if (!begin_file(now)) {
                return;
            }
            n = std::max(whole_messages(ready, options_.file_bytes - std::min(size_, options_.file_bytes)),
                         ulog::size_of_message(ready));  // a message at least, however small files are to be
        }
        std::size_t written = 0;
        const int error = disk_->write(ready.first(n), written);
        const std::size_t whole = whole_messages(ready.first(n), written);
        note_parameters(ready.first(whole));
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(whole));
        ready_ -= whole;
        size_ += written;
        if (error != 0) {
            fail(error, now);
            return;
        }
        is_dirty_ = true;
    }
}

void LogFiles::work(std::int64_t now, bool last)
{
    if (is_open_ || last || now >= retry_at_) {
        write_messages(now);
    }
    if (is_open_ && is_dirty_ && (last || now - synced_at_ >= kSyncPeriod)) {
        synced_at_ = now;
        static_cast<void>(sync(now));
    }
}

}  // namespace jink::flightlog
