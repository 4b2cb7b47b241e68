// SPDX-License-Identifier: BSD-3-Clause
// The flight log of the running program: it replays bit for bit, survives a kill, and its folder never delays the loop.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <limits>

#include "firmware/linux/flight_log/replay.hpp"
#include "tests/daemon/harness.hpp"
#include "toolchain/host/log_summary.hpp"
#include "toolchain/sim/child.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink;
using test::Clock;
using test::Daemon;
using test::kPatience;
using test::milliseconds;
using test::Scratch;
using test::text_of;
namespace fs = std::filesystem;

/// The program's clock [us].
std::int64_t monotonic_us()
{
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * std::int64_t{1'000'000} + t.tv_nsec / 1000;
}

class DaemonFlightLog : public testing::Test {
protected:
    Scratch scratch;
    sim::PseudoTerminal line;
    sim::Scenario scenario = sim::random_scenario(1);
    fs::path folder = scratch / "logs";

    DaemonFlightLog() { fs::create_directory(folder); }

    [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more = {}) const
    {
        more.insert(more.begin(), {"--serial", line.path(), "--log", folder.string(), "--summary",
                                   (scratch / "summary.json").string()});
        return more;
    }
    /// Plays the autopilot for a while in real time.
    void fly(sim::Plant& plant, milliseconds lasting)
    {
        auto next = Clock::now();
        const auto end = next + lasting;
        std::vector<std::byte> waiting;
        while (Clock::now() < end && !plant.finished()) {
            next += std::chrono::microseconds(sim::kStep);
            std::this_thread::sleep_until(next);
            plant.deliver(line.read());
            plant.step();
            const std::vector<std::byte> fresh = plant.collect();
            waiting.insert(waiting.end(), fresh.begin(), fresh.end());
            waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(line.write(waiting)));
        }
    }
    [[nodiscard]] std::vector<fs::path> logs() const
    {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder)) {
            found.push_back(entry.path());
        }
        std::sort(found.begin(), found.end());
        return found;
    }
    /// Runs `jink log`; its output is in `out`.
    int jink_log(const std::string& arguments)
    {
        const std::string command =
            "'" JINK_PROGRAM "' log " + arguments + " >'" + (scratch / "out").string() + "' 2>&1";
        const int status = std::system(command.c_str());
        out = text_of(scratch / "out");
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    [[nodiscard]] std::string quoted() const
    {
        std::string text;
        for (const fs::path& log : logs()) {
            text += " '" + log.string() + "'";
        }
        return text;
    }
    [[nodiscard]] double number(const std::string& name) const
    {
        const std::string summary = text_of(scratch / "summary.json");
        const std::size_t at = summary.find("\"" + name + "\": ");
        return at == std::string::npos ? -1.0 : std::strtod(summary.c_str() + at + name.size() + 4, nullptr);
    }

    std::string out;
};

TEST_F(DaemonFlightLog, AFlightWithAManoeuvreReplaysBitForBit)
{
    {
        sim::Plant plant(scenario);
        Daemon daemon(arguments(), scratch / "said");
        fly(plant, milliseconds(14'000));
        daemon.signal(SIGTERM);
        ASSERT_EQ(daemon.wait(kPatience), 0) << text_of(scratch / "said");
    }
    ASSERT_EQ(logs().size(), 1U);
    EXPECT_GT(number("manoeuvres"), 0.0) << "nothing was decided";
    EXPECT_EQ(number("log_messages_dropped"), 0.0);
    EXPECT_EQ(number("log_write_failures"), 0.0);
    EXPECT_EQ(number("log_files"), 1.0);
    EXPECT_EQ(jink_log("--replay" + quoted()), 0) << out;
    EXPECT_NE(out.find("bit-identical\n"), std::string::npos) << out;
    EXPECT_NE(out.find(std::to_string(static_cast<int>(number("steps"))) + " steps replayed"), std::string::npos)
        << out;

    EXPECT_EQ(jink_log(quoted()), 0) << out;
    for (const char* part :
         {"jink 0.", "end: complete", "requesting -> ours", "new manoeuvre", "jink: stopped", "jink_candidate"}) {
        EXPECT_NE(out.find(part), std::string::npos) << part << "\n" << out;
    }
    EXPECT_EQ(jink_log("--csv '" + (scratch / "csv").string() + "'" + quoted()), 0) << out;
    EXPECT_EQ(text_of(scratch / "csv/jink_own.csv").substr(0, 29), "timestamp,measured,position[0") << out;
}

TEST_F(DaemonFlightLog, AKillLosesASecondAtMost)
{
    sim::Plant plant(scenario);
    Daemon daemon(arguments(), scratch / "said");
    fly(plant, milliseconds(3'000));
    const double held_up = daemon.waited();
    const std::int64_t killed = monotonic_us();
    daemon.signal(SIGKILL);
    ASSERT_EQ(daemon.wait(kPatience), 1000 + SIGKILL);
    ASSERT_EQ(logs().size(), 1U);
    std::ifstream file(logs().front(), std::ios::binary);
    ulog::Reader log(file);
    std::uint64_t newest = 0;
    while (const auto message = log.next()) {
        if (message->type == ulog::Type::data) {
            newest = ulog::read_number<std::uint64_t>(message->content.subspan(2));
        }
    }
    EXPECT_TRUE(log.end() == ulog::End::complete || log.end() == ulog::End::cut) << ulog::to_string(log.end());
    const double lost = static_cast<double>(killed - static_cast<std::int64_t>(newest)) * 1e-6;
    EXPECT_LE(lost, 1.0 + held_up);
    EXPECT_EQ(jink_log("--replay" + quoted()), 0) << out;
    EXPECT_NE(out.find("bit-identical, as far as the log goes"), std::string::npos) << out;
}

TEST_F(DaemonFlightLog, OldLogsAreRemovedAndNothingElse)
{
    for (const char* year : {"2018", "2019", "2020"}) {
        std::ofstream(folder / (std::string("jink_") + year + "0101_000000_000.ulg")) << "an old log";
    }
    std::ofstream(folder / "notes.txt") << "not a log";
    {
        sim::Plant plant(scenario);
        Daemon daemon(arguments({"--log-size", "1", "--log-count", "2"}), scratch / "said");
        fly(plant, milliseconds(2'500));
        daemon.signal(SIGTERM);
        ASSERT_EQ(daemon.wait(kPatience), 0) << text_of(scratch / "said");
    }
    EXPECT_EQ(logs().size(), 3U) << "the new log, the newest of the old ones, and what is no log";
    EXPECT_TRUE(fs::exists(folder / "jink_20200101_000000_000.ulg"));
    EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

TEST_F(DaemonFlightLog, AFolderThatIsMissingIsSaidOnceAndHarmsNothing)
{
    fs::remove(folder);
    sim::Plant plant(scenario);
    Daemon daemon(arguments(), scratch / "said");
    fly(plant, milliseconds(2'500));
    const double held_up = daemon.waited();
    daemon.signal(SIGTERM);
    ASSERT_EQ(daemon.wait(kPatience), 0);
    const std::string said = text_of(scratch / "said");
    const std::size_t first = said.find("the log is not written: No such file or directory");
    ASSERT_NE(first, std::string::npos) << said;
    EXPECT_EQ(said.find("the log is not written", first + 1), std::string::npos) << said;
    EXPECT_GE(number("log_write_failures"), 1.0);
    EXPECT_EQ(number("log_files"), 0.0);
    EXPECT_LE(number("deadlines_missed") * 0.02, held_up);
}

/// A full disk: the kernel refuses to let files grow.
TEST_F(DaemonFlightLog, AFullDiskIsCountedAndTheFlightGoesOn)
{
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{48U * 1024U, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    sim::Plant plant(scenario);
    Daemon daemon(arguments(), scratch / "said");
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    fly(plant, milliseconds(5'000));
    const double held_up = daemon.waited();
    daemon.signal(SIGTERM);
    ASSERT_EQ(daemon.wait(kPatience), 0) << text_of(scratch / "said");
    EXPECT_NE(text_of(scratch / "said").find("the log is not written: File too large"), std::string::npos);
    EXPECT_GE(number("log_write_failures"), 1.0);
    EXPECT_LE(number("deadlines_missed") * 0.02, held_up);
    ASSERT_FALSE(logs().empty());
    std::ifstream file(logs().front(), std::ios::binary);
    const host::LogSummary summary = host::summarise_log(file);
    EXPECT_GT(summary.steps, 10U) << "what fitted is readable";
}

}  // namespace
