// SPDX-License-Identifier: BSD-3-Clause
// The flight log of the running program: it replays bit for bit, survives a kill, and its folder never delays the loop.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <ctime>
#include <fstream>
#include <limits>

#include "core/geometry/shape.hpp"
#include "firmware/linux/flight_log/replay.hpp"
#include "firmware/linux/flight_log/topics.hpp"
#include "firmware/linux/map_file.hpp"
#include "tests/daemon/harness.hpp"
#include "tests/daemon/stalling_folder.hpp"
#include "tests/oracle/map_of_hulls.hpp"
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
        while (Clock::now() < end && (ballast > 0 || !plant.finished())) {
            next += std::chrono::microseconds(sim::kStep);
            std::this_thread::sleep_until(next);
            plant.deliver(line.read());
            plant.step();
            const std::vector<std::byte> fresh = plant.collect();
            waiting.insert(waiting.end(), fresh.begin(), fresh.end());
            waiting.resize(waiting.size() + ballast);
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
    std::size_t ballast = 0;  ///< zeros between the autopilot's frames in each kStep, so that logs grow faster
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

/// A map file with one box.
std::string map_of_box(const Vec3& centre, const Vec3& half)
{
    std::vector<Vec3> corners;
    for (unsigned i = 0; i < 8; ++i) {
        const Vec3 sign((i & 1U) != 0 ? 1.0F : -1.0F, (i & 2U) != 0 ? 1.0F : -1.0F, (i & 4U) != 0 ? 1.0F : -1.0F);
        corners.push_back(centre + half.cwiseProduct(sign));
    }
    const oracle::MapOfHulls tables({corners});
    return files::map_file_of(tables.map());
}

/// Obstacles in a log: the map's one piece, as the box about it.
void expect_piece(const std::filesystem::path& file, const Vec3& centre, const Vec3& half)
{
    std::ifstream in(file, std::ios::binary);
    ulog::Reader log(in);
    std::size_t n = 0;
    while (const auto message = log.next()) {
        if (message->type != ulog::Type::data ||
            log.topic(ulog::read_number<std::uint16_t>(message->content))->name != "jink_obstacle") {
            continue;
        }
        flightlog::ObstacleTopic o;
        std::memcpy(static_cast<void*>(&o), message->content.data() + 2, flightlog::kBytesOf<flightlog::ObstacleTopic>);
        ++n;
        EXPECT_TRUE(o.of_map && o.is_bound);
        EXPECT_EQ(o.kind, static_cast<std::uint8_t>(geometry::ShapeKind::hull));
        EXPECT_EQ(o.turn, (std::array{1.0F, 0.0F, 0.0F, 0.0F}));
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(o.centre[k], centre[static_cast<int>(k)], 0.01F);
            EXPECT_NEAR(o.half[k], half[static_cast<int>(k)], 0.01F);
        }
    }
    EXPECT_GT(n, 5U);
}

TEST_F(DaemonFlightLog, AFlightWithAMapReplaysWithThatMapAlone)
{
    scenario.threats.clear();
    const sim::Vec leg = scenario.mission[1] - scenario.mission[0];
    const Vec3 tower = (scenario.mission[0] + 45.0 * leg.normalized()).cast<float>();
    const auto write = [&](const char* name, const std::string& text) {
        std::ofstream(scratch / name, std::ios::binary) << text;
        return (scratch / name).string();
    };
    const std::string map = write("tower.map", map_of_box(tower, {3.0F, 3.0F, 60.0F}));
    const std::string other = write("other.map", map_of_box(tower, {3.0F, 3.0F, 59.5F}));
    const std::string damaged = write("damaged.map", text_of(map).substr(0, 100));
    {
        sim::Plant plant(scenario);
        Daemon daemon(arguments({"--map", map}), scratch / "said");
        fly(plant, milliseconds(14'000));
        daemon.signal(SIGTERM);
        ASSERT_EQ(daemon.wait(kPatience), 0) << text_of(scratch / "said");
    }
    ASSERT_EQ(logs().size(), 1U);
    expect_piece(logs().front(), tower, {3.0F, 3.0F, 60.0F});
    EXPECT_GT(number("manoeuvres"), 0.0) << "nothing was decided about the tower";
    EXPECT_EQ(jink_log("--replay --map '" + map + "'" + quoted()), 0) << out;
    EXPECT_NE(out.find("bit-identical\n"), std::string::npos) << out;
    EXPECT_NE(out.find(std::to_string(static_cast<int>(number("steps"))) + " steps replayed"), std::string::npos)
        << out;
    const struct {
        std::string options;
        const char* said;
    } refusals[] = {{"", "a map was used: its file is needed (--map)"},
                    {" --map '" + other + "'", "the map is not the one that was used: its checksum differs"},
                    {" --map '" + damaged + "'", "damaged.map: the file ends too early"},
                    {" --map '" + (scratch / "none.map").string() + "'", "none.map: no such file"}};
    for (const auto& refusal : refusals) {
        EXPECT_EQ(jink_log("--replay" + refusal.options + quoted()), 2) << refusal.options;
        EXPECT_NE(out.find(refusal.said), std::string::npos) << refusal.options << ": " << out;
        EXPECT_EQ(out.find("bit-identical"), std::string::npos) << refusal.options << ": " << out;
    }
}

/// A file system whose writes get no answer while a conflict is flown, and until the queue is full.
TEST_F(DaemonFlightLog, AFileSystemThatDoesNotAnswerDelaysNoStepAndItsLossesAreCounted)
{
    test::StallingFolder disk(folder);
    if (!disk.why_not().empty()) {
        GTEST_SKIP() << disk.why_not();
    }
    sim::Plant plant(scenario);
    const auto heard = [&] { return plant.autopilot().heard(); };
    Daemon daemon(arguments({"--status-period", "1"}), scratch / "said");
    fly(plant, milliseconds(1'500));
    disk.hold();
    ballast = 300;
    fly(plant, milliseconds(500));
    ASSERT_GT(disk.waiting(), 0U) << "the log was not being written";
    const sim::Heard before = heard();
    const auto drops = [&] {
        const std::string said = text_of(scratch / "said");
        const std::size_t at = said.rfind("log files 1 dropped ");
        return at == std::string::npos ? 0L : std::strtol(said.c_str() + at + 20, nullptr, 10);
    };
    for (const auto end = Clock::now() + milliseconds(60'000); drops() == 0 && Clock::now() < end;) {
        fly(plant, milliseconds(500));
    }
    EXPECT_GT(drops(), 0) << text_of(scratch / "said");
    EXPECT_GT(disk.waiting(), 0U) << "the write was answered in between";
    const sim::Heard after = heard();
    EXPECT_GT(after.setpoints, before.setpoints + 10) << "no conflict was flown";
    EXPECT_EQ(after.bad_setpoints, 0U);
    // Also when messages are dropped.
    fly(plant, milliseconds(2'000));
    EXPECT_GT(heard().heartbeats, after.heartbeats);
    EXPECT_GT(after.heartbeats, before.heartbeats);
    disk.release();
    fly(plant, milliseconds(1'500));
    EXPECT_EQ(disk.waiting(), 0U);
    daemon.signal(SIGTERM);
    ASSERT_EQ(daemon.wait(kPatience), 0) << text_of(scratch / "said");
    disk.end(scratch / "kept");
    folder = scratch / "kept";

    ASSERT_EQ(logs().size(), 1U);
    EXPECT_EQ(number("log_files"), 1.0);
    EXPECT_EQ(number("log_write_failures"), 0.0);
    EXPECT_GE(number("log_messages_dropped"), static_cast<double>(drops()));
    std::ifstream file(logs().front(), std::ios::binary);
    const host::LogSummary summary = host::summarise_log(file);
    EXPECT_EQ(summary.end, ulog::End::complete);
    EXPECT_GE(summary.dropouts, 1U);
    EXPECT_GT(summary.dropout_time, 1.0) << "messages were dropped for at least 2 s";
    EXPECT_LT(summary.steps, number("steps")) << "steps of the time without an answer are missing";
    ASSERT_FALSE(summary.lines.empty());
    EXPECT_EQ(summary.lines.back().text, "jinkd stops") << "it is written on";
    EXPECT_EQ(jink_log("--replay" + quoted()), 1) << out;
    EXPECT_NE(out.find("not exact from step"), std::string::npos) << out;
    EXPECT_EQ(out.find("first difference"), std::string::npos) << out;
}

}  // namespace
