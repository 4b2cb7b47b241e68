// SPDX-License-Identifier: BSD-3-Clause
// Files of a log: a queue that never waits, files that follow each other, disks that are full, slow or gone.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <thread>

#include "firmware/linux/flight_log/queue.hpp"
#include "firmware/linux/flight_log/writer.hpp"
#include "tests/flight_log/memory_disk.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;

/// Messages of a flight without the head of their file.
struct Flown {
    std::string log;
    std::size_t head = 0;
    [[nodiscard]] std::span<const std::byte> data() const { return std::as_bytes(std::span(log)).subspan(head); }
};

const Flown& flown()
{
    static const Flown flight = [] {
        sim::Scenario scenario = sim::random_scenario(5);
        scenario.duration = 12.0;
        return Flown{fly_recorded(scenario, {}).log,
                     head_of_file(definitions_of(plain_setup()), 0, "jink_test", 0).size()};
    }();
    return flight;
}

/// Writes the flight piece by piece; a piece takes 10 ms.
void write_all(LogFiles& files, std::int64_t& now, std::size_t piece = 3'000)
{
    std::span<const std::byte> rest = flown().data();
    while (!rest.empty()) {
        const std::size_t n = std::min({rest.size(), files.room(), piece});
        files.take(rest.first(n));
        rest = rest.subspan(n);
        files.work(now, false);
        now += 10'000;
    }
    files.work(now, true);
}

ReplayResult replay_all(const Store& store)
{
    const auto flight = std::make_unique<FlightReplay>(ReplayOptions{});
    for (const auto& [name, text] : store.files) {
        std::istringstream in(text);
        ulog::Reader reader(in);
        if (!flight->play(reader)) {
            break;
        }
    }
    return flight->result();
}

TEST(LogFiles, FollowEachOtherAndReplayTogether)
{
    Store store;
    FileOptions options{"folder", 50'000, 100};
    LogFiles files(options, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    std::int64_t now = 0;
    write_all(files, now, 701);
    ASSERT_GT(store.files.size(), 2U);
    EXPECT_EQ(files.files(), store.files.size());
    EXPECT_EQ(files.failures(), 0U);
    for (const auto& [name, text] : store.files) {
        EXPECT_LE(text.size(), options.file_bytes) << name;
        std::istringstream in(text);
        ulog::Reader reader(in);
        std::size_t data = 0;
        while (const auto message = reader.next()) {
            data += message->type == ulog::Type::data ? 1U : 0U;
        }
        EXPECT_EQ(reader.end(), ulog::End::complete) << name;
        EXPECT_GT(data, 0U) << "each file has complete definitions";
    }
    EXPECT_TRUE(replay_all(store).is_identical());
    store.files.erase(store.files.begin());
    EXPECT_NE(replay_all(store).incomplete.find("first file"), std::string::npos);
}

TEST(LogFiles, TheOldestAreRemovedAndOtherFilesStay)
{
    Store store;
    store.files["jink_20200101_000000_000.ulg"] = "old";
    store.files["jink_29990101_000000_000.ulg"] = "of a clock that was wrong";
    const std::string renamed[] = {"notes.txt", "jink_2020-01-01_crash_kept.ulg", "jink_20200101_000000_000_kept.ulg"};
    for (const std::string& name : renamed) {
        store.files[name] = "not a log";
    }
    LogFiles files({"folder", 50'000, 3}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    std::int64_t now = 0;
    write_all(files, now);
    ASSERT_GT(files.files(), 3U);
    EXPECT_EQ(store.files.size(), 6U);
    for (const std::string& name : renamed) {
        EXPECT_TRUE(store.files.contains(name)) << name;
    }
    EXPECT_FALSE(store.files.contains("jink_20200101_000000_000.ulg"));
    EXPECT_FALSE(store.files.contains("jink_29990101_000000_000.ulg")) << "of an earlier run";
}

std::string run_of(const std::string& file)
{
    std::istringstream in(file);
    ulog::Reader reader(in);
    while (reader.next()) {
    }
    return reader.info("jink_run");
}

/// Two programs choose the name of their run in the same second, before either has a file.
TEST(LogFiles, OfTwoRunsInOneSecondHaveNamesOfTheirOwn)
{
    Store store;
    const FileOptions options{"folder", 50'000, 100};
    LogFiles one(options, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    LogFiles other(options, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    std::int64_t now = 0;
    write_all(one, now);
    now = 0;
    write_all(other, now);
    EXPECT_EQ(one.failures() + other.failures(), 0U);
    EXPECT_EQ(store.files.size(), one.files() + other.files());
    std::map<std::string, std::size_t> runs;
    for (const auto& [name, text] : store.files) {
        ++runs[run_of(text)];
        EXPECT_TRUE(name.starts_with(run_of(text))) << name;
    }
    EXPECT_EQ(runs.size(), 2U) << "a run for each of them";
}

TEST(LogFiles, PassOverANameThatIsTaken)
{
    Store store;
    LogFiles files({"folder", 50'000, 100}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    files.take(flown().data().first(whole_messages(flown().data(), 1'000)));
    files.work(0, false);
    ASSERT_EQ(store.files.size(), 1U);
    std::string next = store.files.begin()->first;
    next.replace(next.size() - 7, 3, "001");
    store.files[next] = "of somebody else";
    std::int64_t now = 0;
    write_all(files, now);
    EXPECT_EQ(files.failures(), 0U);
    EXPECT_GT(files.files(), 1U);
    EXPECT_EQ(store.files.size(), files.files() + 1U);
    EXPECT_EQ(store.files[next], "of somebody else");
}

/// Writes succeed in memory, and nothing gets to the medium: no old log gives way to files that may be lost.
TEST(LogFiles, ADiskThatCannotSynchroniseKeepsOldLogsAndIsReportedOnce)
{
    Store store;
    const std::string old = "jink_20200101_000000_000.ulg";
    store.files[old] = "old";
    store.files["jink_20200102_000000_000.ulg"] = "old";
    store.sync_error = EIO;
    LogFiles files({"folder", 100'000'000, 2}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    ulog::Messages text;
    text.parameter("TRK_AGE", 13.0F);
    int news = 0;
    std::int64_t now = 0;
    const auto run = [&](std::int64_t until) {
        for (; now < until; now += 50'000) {
            files.take(text.bytes());
            files.work(now, false);
            news += files.take_news() != 0 ? 1 : 0;
        }
    };
    run(60'000'000);
    EXPECT_GE(files.failures(), 5U);
    EXPECT_LE(files.failures(), 7U) << "every 10 s";
    EXPECT_EQ(news, 1);
    EXPECT_TRUE(store.files.contains(old));
    store.sync_error = 0;
    run(80'000'000);
    EXPECT_FALSE(store.files.contains(old));
    EXPECT_EQ(store.files.size(), 2U);
    store.sync_error = EIO;
    run(85'000'000);
    EXPECT_EQ(news, 2) << "a new series";
}

TEST(LogFiles, AFullDiskKeepsOldLogsAndIsTriedAgain)
{
    Store store;
    store.files["jink_20200101_000000_000.ulg"] = std::string(1'000, 'x');
    store.capacity = 30'000;
    LogFiles files({"folder", 1'000'000, 1}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    std::int64_t now = 0;
    std::span<const std::byte> rest = flown().data();
    const auto feed = [&](std::int64_t until) {
        for (; now < until; now += 10'000) {
            const std::size_t n = std::min({rest.size(), files.room(), std::size_t{3'000}});
            files.take(rest.first(n));
            rest = rest.subspan(n);
            files.work(now, false);
        }
    };
    feed(9'000'000);
    EXPECT_EQ(files.failures(), 1U);
    EXPECT_EQ(files.take_news(), ENOSPC);
    EXPECT_EQ(files.take_news(), 0) << "said once";
    feed(45'000'000);
    EXPECT_GE(files.failures(), 3U);
    EXPECT_LE(files.failures(), 6U) << "every 10 s";
    EXPECT_EQ(files.take_news(), 0);
    store.capacity = ~std::size_t{0};
    feed(90'000'000);
    files.work(now, true);
    EXPECT_TRUE(rest.empty());
    EXPECT_GE(store.files.size(), 1U);
}

/// Nothing is lost while the queue holds it: a message that was cut is whole in the next file.
TEST(LogFiles, AfterAFullDiskTheRunIsStillComplete)
{
    Store store;
    store.capacity = 30'000;
    LogFiles files({"folder", 1'000'000, 100}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    std::int64_t now = 0;
    std::span<const std::byte> rest = flown().data();
    while (!rest.empty()) {
        const std::size_t n = std::min({rest.size(), files.room(), std::size_t{3'000}});
        files.take(rest.first(n));
        rest = rest.subspan(n);
        files.work(now, false);
        now += 100'000;
        store.capacity = files.failures() > 0 ? ~std::size_t{0} : store.capacity;
    }
    files.work(now, true);
    EXPECT_EQ(files.failures(), 1U);
    ASSERT_EQ(store.files.size(), 2U);
    std::istringstream in(store.files.begin()->second);
    ulog::Reader first(in);
    while (first.next()) {
    }
    EXPECT_TRUE(first.end() == ulog::End::cut || first.end() == ulog::End::complete);
    EXPECT_TRUE(replay_all(store).is_identical());
}

TEST(LogFiles, ADeletedFileIsCountedAndFollowedByANewOne)
{
    std::string folder = (std::filesystem::temp_directory_path() / "jink_log_XXXXXX").string();
    ASSERT_NE(::mkdtemp(folder.data()), nullptr);
    LogFiles files({folder, 64U << 20U, 10}, definitions_of(plain_setup()), std::make_unique<PosixDisk>());
    const std::size_t piece = whole_messages(flown().data(), 3'000);
    const auto write = [&](std::int64_t now) {
        files.take(flown().data().first(piece));
        files.work(now, false);
    };
    write(LogFiles::kSyncPeriod);
    ASSERT_EQ(files.failures(), 0U);
    ASSERT_EQ(files.files(), 1U);
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::filesystem::remove(entry.path());
    }
    const std::int64_t deleted = 2 * LogFiles::kSyncPeriod;
    write(deleted);
    EXPECT_EQ(files.failures(), 1U);
    EXPECT_EQ(files.take_news(), ENOENT);
    write(deleted + LogFiles::kRetry);
    files.work(deleted + LogFiles::kRetry, true);
    EXPECT_EQ(files.files(), 2U);
    EXPECT_EQ(files.failures(), 1U);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
    std::filesystem::remove_all(folder);
}

TEST(LogFiles, AreSynchronisedAboutOnceASecond)
{
    Store store;
    LogFiles files({"folder", 100'000'000, 100}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    const std::span<const std::byte> data = flown().data();
    files.take(data.first(std::min<std::size_t>(data.size(), 60'000)));
    for (std::int64_t now = 1'000'000; now < 11'000'000; now += 50'000) {
        files.take(data.first(whole_messages(data, 2'000)));
        files.work(now, false);
    }
    EXPECT_GE(store.syncs, 10);
    EXPECT_LE(store.syncs, 13);
    store.sync_error = EIO;
    files.take(data.first(whole_messages(data, 2'000)));
    files.work(12'000'000, false);
    EXPECT_EQ(files.failures(), 1U);
    EXPECT_EQ(files.take_news(), EIO);
}

TEST(LogFiles, AParameterThatChangedIsInTheNextFile)
{
    Store store;
    LogFiles files({"folder", 40'000, 100}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    ulog::Messages change;
    change.parameter("TRK_AGE", 13.0F);
    std::int64_t now = 0;
    files.take(change.bytes());
    write_all(files, now);
    ASSERT_GT(store.files.size(), 1U);
    std::vector<float> values;
    for (const auto& [name, text] : store.files) {
        std::istringstream in(text);
        ulog::Reader reader(in);
        while (reader.next()) {
        }
        values.push_back(reader.parameters().at("TRK_AGE").number().value_or(-1.0F));
    }
    EXPECT_EQ(values.front(), app::Parameters().get(app::Param::track_age));
    EXPECT_EQ(values[1], 13.0F);
}

TEST(LogQueue, DropsWholeMessagesAndTellsForHowLong)
{
    Queue queue(64);
    std::array<std::byte, 20> message{};
    message[0] = std::byte{17};
    message[2] = std::byte{'D'};
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(queue.add(message, 1'000'000, 1));
    }
    EXPECT_FALSE(queue.add(message, 2'000'000, 1));
    EXPECT_FALSE(queue.add(message, 2'500'000, 2)) << "two messages of ten bytes";
    EXPECT_EQ(queue.dropped(), 3U);
    EXPECT_EQ(queue.messages(), 3U);
    std::array<std::byte, 64> out{};
    EXPECT_EQ(queue.take(std::span(out).first(30)), 30U) << "in any pieces";
    EXPECT_EQ(queue.take(out), 30U);
    EXPECT_TRUE(queue.add(message, 4'250'000, 1));
    ASSERT_EQ(queue.take(out), 25U);
    EXPECT_EQ(static_cast<char>(out[2]), 'O');
    EXPECT_EQ(ulog::read_number<std::uint16_t>(std::span(out).subspan(3)), 2'250) << "milliseconds";
    EXPECT_EQ(static_cast<char>(out[7]), 'D');
}

/// A disk that does not answer until it is let go.
class StalledDisk final : public Disk {
public:
    struct Gate {
        std::mutex mutex;
        std::condition_variable opened;
        bool open = false;
        std::atomic<int> calls{0};
    };
    explicit StalledDisk(std::shared_ptr<Gate> gate) : gate_(std::move(gate)) {}
    int create(const std::string& /*path*/) override { return wait(); }
    int write(std::span<const std::byte> bytes, std::size_t& written) override
    {
        written = bytes.size();
        return wait();
    }
    int sync() override { return wait(); }
    void close() override {}
    void remove(const std::string& /*path*/) override {}
    std::vector<std::string> names_in(const std::string& /*folder*/) override { return {}; }

private:
    int wait()
    {
        ++gate_->calls;
        std::unique_lock lock(gate_->mutex);
        gate_->opened.wait(lock, [&] { return gate_->open; });
        return 0;
    }
    std::shared_ptr<Gate> gate_;
};

/// A loop that waited for the disk would never end here: nobody opens the gate before the last message.
TEST(LogWriter, AStalledDiskNeverDelaysTheLoop)
{
    const auto gate = std::make_shared<StalledDisk::Gate>();
    Writer writer({"folder"}, definitions_of(plain_setup()), std::make_unique<StalledDisk>(gate), 1U << 20U);
    std::span<const std::byte> data = flown().data();
    std::int64_t now = 0;
    std::uint32_t given = 0;
    while (writer.counts().dropped < 1'000) {
        const std::size_t n = 3U + ulog::read_number<std::uint16_t>(data);
        writer.set_time(now += 20'000);
        writer.add(data.first(n), 1, {});
        ++given;
        data = n < data.size() ? data.subspan(n) : flown().data();
        if (given == 2'000) {  // the thread is at the disk before the queue is full
            while (gate->calls == 0) {
                std::this_thread::yield();
            }
        }
    }
    EXPECT_EQ(writer.counts().messages + writer.counts().dropped, given);
    EXPECT_GT(writer.counts().peak, (1U << 20U) - 10'000U);
    {
        const std::lock_guard lock(gate->mutex);
        gate->open = true;
    }
    gate->opened.notify_all();
    const LogCounts counts = writer.finish();
    EXPECT_EQ(counts.files, 1U);
    EXPECT_EQ(counts.write_failures, 0U);
}

/// The end waits half a second at most, and the thread outlives the writer.
TEST(LogWriter, AStalledDiskDoesNotHoldUpTheEnd)
{
    const auto gate = std::make_shared<StalledDisk::Gate>();
    {
        Writer writer({"folder"}, definitions_of(plain_setup()), std::make_unique<StalledDisk>(gate), 1U << 20U);
        const std::span<const std::byte> data = flown().data();
        writer.add(data.first(whole_messages(data, 1'000)), 1, {});
        while (gate->calls == 0) {
            std::this_thread::yield();
        }
    }
    const std::lock_guard lock(gate->mutex);
    gate->open = true;
    gate->opened.notify_all();
}

}  // namespace
