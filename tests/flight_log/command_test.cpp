// SPDX-License-Identifier: BSD-3-Clause
// jink log from the user's view: output, files, exit statuses.
#include <sys/wait.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/stream_flight.hpp"
#include "tests/host/scratch.hpp"
#include "toolchain/sim/random_scenario.hpp"

namespace {

using namespace jink::test;

class LogCommand : public testing::Test {
protected:
    Scratch scratch;
    std::string out;

    /// Runs jink log in the scratch folder; arguments are shell words. Output and errors are in `out`.
    int run(const std::string& arguments)
    {
        const std::string command =
            "cd '" + scratch.path().string() + "' && '" JINK_PROGRAM "' log " + arguments + " >out.txt 2>&1";
        const int status = std::system(command.c_str());
        out = slurp(scratch.path() / "out.txt");
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    [[nodiscard]] bool says(const std::string& part) const { return out.find(part) != std::string::npos; }

    static const RecordedFlight& flight()
    {
        static const RecordedFlight flown = [] {
            jink::sim::Scenario scenario = jink::sim::random_scenario(1);
            scenario.duration = 6.0;
            return fly_recorded(scenario, {});
        }();
        return flown;
    }
};

TEST_F(LogCommand, SumsUpALog)
{
    static_cast<void>(scratch.write("good.ulg", flight().log));
    EXPECT_EQ(run("good.ulg"), 0) << out;
    EXPECT_TRUE(says(std::to_string(flight().steps) + " steps")) << out;
    EXPECT_TRUE(says("decisions: " + std::to_string(flight().manoeuvres))) << out;
    EXPECT_TRUE(says("control autopilot -> requesting: conflict with track")) << out;
    EXPECT_TRUE(says("end: complete")) << out;
    EXPECT_TRUE(says("avoid_counters.plans")) << out;
}

TEST_F(LogCommand, SumsUpALogOfABoardWhichCannotBeReplayed)
{
    StreamFlight s;
    ASSERT_TRUE(s.begin());
    ASSERT_EQ(s.ask(StreamFlight::kStart), StreamFlight::kAccepted);
    ASSERT_TRUE(s.fly_to_data());
    s.see_a_mast();
    s.fly(500);
    static_cast<void>(scratch.write("board.ulg", s.receiver.file));
    EXPECT_EQ(run("board.ulg"), 0) << out;
    EXPECT_TRUE(says("end: complete")) << out;
    EXPECT_TRUE(says("decisions: " + std::to_string(s.manoeuvres))) << out;
    EXPECT_TRUE(says("control autopilot -> requesting")) << out;
    EXPECT_TRUE(says(" steps, their durations were not measured\n")) << out;
    EXPECT_TRUE(says("stream.parts")) << out;
    EXPECT_TRUE(says("app_counters.steps")) << out;
    EXPECT_EQ(run("--replay board.ulg"), 2) << out;
    EXPECT_TRUE(says("another format")) << out;
    EXPECT_EQ(run("--csv tables board.ulg"), 0) << out;
}

TEST_F(LogCommand, SaysWhatIsDamagedAndReadsTheRest)
{
    static_cast<void>(scratch.write("cut.ulg", flight().log.substr(0, flight().log.size() - 5)));
    EXPECT_EQ(run("cut.ulg"), 0) << out;
    EXPECT_TRUE(says("end: cut within a message")) << out;
    EXPECT_EQ(run("--replay cut.ulg"), 0) << out;
    EXPECT_TRUE(says("cut within a message at byte")) << out;
    EXPECT_TRUE(says("bit-identical")) << out;

    std::string damaged = flight().log;
    damaged.replace(damaged.size() - 20'000, 3'000, 3'000, '\0');  // the heads of messages among them
    static_cast<void>(scratch.write("damaged.ulg", damaged));
    EXPECT_EQ(run("damaged.ulg"), 0) << out;
    EXPECT_EQ(run("--replay damaged.ulg"), 1) << out;

    static_cast<void>(scratch.write("text.ulg", "no log at all, but long enough"));
    EXPECT_EQ(run("text.ulg"), 2);
    EXPECT_TRUE(says("not a ULog file")) << out;
    EXPECT_EQ(run("--replay text.ulg"), 2);
    EXPECT_EQ(run("missing.ulg"), 2);
    EXPECT_TRUE(says("missing.ulg cannot be read")) << out;
    EXPECT_EQ(run("--replay ."), 2);
}

TEST_F(LogCommand, PrintsTheFirstDifference)
{
    std::string changed = flight().log;
    const std::string head("\xFD\x09\x00\x00", 4);
    std::size_t at = changed.size() / 2;
    do {
        at = changed.find(head, at + 1);
        ASSERT_NE(at, std::string::npos);
    } while (static_cast<unsigned char>(changed[at + 6]) != 196);
    changed[at + 12] ^= 1;
    static_cast<void>(scratch.write("changed.ulg", changed));
    EXPECT_EQ(run("--replay changed.ulg"), 1);
    EXPECT_TRUE(says("first difference in step ")) << out;
    EXPECT_TRUE(says("a write of")) << out;
    EXPECT_FALSE(says("bit-identical")) << out;
}

TEST_F(LogCommand, RefusesAnotherVersion)
{
    std::string other = flight().log;
    other[other.find(jink::flightlog::build_digest())] = 'x';
    static_cast<void>(scratch.write("other.ulg", other));
    EXPECT_EQ(run("--replay other.ulg"), 2);
    EXPECT_TRUE(says("the log is of another version")) << out;
    EXPECT_EQ(run("--replay --any-version other.ulg"), 0) << out;
    EXPECT_EQ(run("--any-version other.ulg"), 2) << "only a replay has versions";
}

TEST_F(LogCommand, WritesATablePerTopic)
{
    static_cast<void>(scratch.write("good.ulg", flight().log));
    EXPECT_EQ(run("--csv tables good.ulg"), 0) << out;
    const std::string steps = slurp(scratch.path() / "tables/jink_step.csv");
    EXPECT_EQ(static_cast<std::uint64_t>(std::count(steps.begin(), steps.end(), '\n')), flight().steps + 1);
    EXPECT_EQ(steps.substr(0, 32), "timestamp,step,duration_us,bytes");
    EXPECT_NE(steps.find("velocity[2],margin"), std::string::npos);
    for (const char* table : {"jink_own", "jink_track", "jink_candidate", "jink_app_counters", "jink_log", "texts"}) {
        EXPECT_FALSE(slurp(scratch.path() / "tables" / (std::string(table) + ".csv")).empty()) << table;
    }
    EXPECT_EQ(run("--csv /proc/none good.ulg"), 2);
    EXPECT_EQ(run("--csv tables good.ulg good.ulg"), 2);
}

}  // namespace
