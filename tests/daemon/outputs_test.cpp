// SPDX-License-Identifier: BSD-3-Clause
// The daemon never fails or blocks because of its outputs and files. A late step is excused only by the host: by the
// kernel's count of the time that the loop was ready to run without a processor.
#include <sys/stat.h>

#include <algorithm>
#include <limits>
#include <span>

#include "tests/daemon/harness.hpp"

namespace {

using namespace jink::test;

/// A number of the summary; -1: not there.
double number_of(const std::string& summary, const std::string& name)
{
    const std::size_t at = summary.find("\"" + name + "\": ");
    return at == std::string::npos ? -1.0 : std::strtod(summary.c_str() + at + name.size() + 4, nullptr);
}

/// A pipe that is full, and whose reader never reads.
class FullPipe {
public:
    FullPipe()
    {
        EXPECT_EQ(pipe(ends_.data()), 0);
        fcntl(ends_[1], F_SETFL, fcntl(ends_[1], F_GETFL) | O_NONBLOCK);
        const std::array<char, 4096> filling{};
        while (write(ends_[1], filling.data(), filling.size()) > 0) {
        }
        fcntl(ends_[1], F_SETFL, fcntl(ends_[1], F_GETFL) & ~O_NONBLOCK);
    }
    ~FullPipe() { close(ends_[0]); }
    FullPipe(const FullPipe&) = delete;
    FullPipe& operator=(const FullPipe&) = delete;
    /// For the daemon, which closes it.
    [[nodiscard]] int writer() const { return ends_[1]; }

private:
    std::array<int, 2> ends_{};
};

class DaemonOutputs : public testing::Test {
protected:
    Scratch scratch;
    Cable cable;

    [[nodiscard]] std::string path(const std::string& name) const { return (scratch / name).string(); }
    [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more = {}) const
    {
        more.insert(more.begin(), {"--serial", cable.path(), "--summary", path("summary.json")});
        return more;
    }
    [[nodiscard]] std::string airspace(std::size_t areas) const
    {
        std::ofstream file(path("airspace.yaml"));
        file << "frame: local\nareas:\n";
        for (std::size_t i = 0; i < areas; ++i) {
            file << "  - {centre: [" << 100 + i << ", 5000], radius: 20, bottom: 0, top: 100}\n";
        }
        return path("airspace.yaml");
    }

    /// HEARTBEATs for a while, with `each_millisecond` called a thousand times a second.
    template <class F>
    void expect_heartbeats(const Daemon& daemon, milliseconds lasting, F each_millisecond)
    {
        const double held_before = daemon.waited() + waited_in("/proc/thread-self/schedstat");
        const auto end = Clock::now() + lasting;
        auto last = Clock::now();
        std::chrono::duration<double> longest{};
        while (Clock::now() < end) {
            each_millisecond();
            const bool heard = cable.heartbeat(milliseconds(1)).has_value();
            const auto now = Clock::now();
            longest = std::max(longest, std::chrono::duration<double>(now - last));
            last = heard ? now : last;
        }
        const double held_up = daemon.waited() + waited_in("/proc/thread-self/schedstat") - held_before;
        EXPECT_LT(longest.count(), 1.5 + held_up);
    }
    void expect_heartbeats(const Daemon& daemon, milliseconds lasting)
    {
        expect_heartbeats(daemon, lasting, [] {});
    }

    /// 1000 SIGHUPs, or JINK_HANGUPS of them (the long form: 10000), ten in each millisecond.
    void hang_up(const Daemon& daemon)
    {
        const char* const given = std::getenv("JINK_HANGUPS");
        const int wanted = given != nullptr ? std::atoi(given) : 1000;
        int sent = 0;
        const auto send_ten = [&] {
            for (int i = 0; i < 10 && sent < wanted; ++i, ++sent) {
                daemon.signal(SIGHUP);
            }
        };
        while (sent < wanted) {
            expect_heartbeats(daemon, milliseconds(1600), send_ten);
        }
    }

    /// Stops it. Each late step (over two ticks after the one before) must have been delayed by the host for a tick.
    std::string stop(Daemon& daemon)
    {
        const double held_up = daemon.waited();
        daemon.signal(SIGTERM);
        EXPECT_EQ(daemon.wait(kPatience), 0);
        std::string summary = text_of(scratch / "summary.json");
        const double missed = number_of(summary, "deadlines_missed");
        EXPECT_GE(missed, 0.0) << summary;
        EXPECT_LE(missed * 0.02, held_up) << "steps late by more than the machine held them up";
        return summary;
    }
};

TEST_F(DaemonOutputs, AStalledStatusPipeHoldsUpNothing)
{
    const FullPipe pipe;
    Daemon daemon(arguments({"--status-period", "0.01"}), pipe.writer());
    ASSERT_TRUE(cable.heartbeat(kPatience));
    expect_heartbeats(daemon, milliseconds(3000));
    const std::string summary = stop(daemon);
    EXPECT_GT(number_of(summary, "lines_dropped"), 0.0) << summary;
}

TEST_F(DaemonOutputs, AClosedStatusPipeKillsNobody)
{
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe(ends.data()), 0);
    Daemon daemon(arguments({"--status-period", "0.02"}), ends[1]);
    close(ends[0]);
    ASSERT_TRUE(cable.heartbeat(kPatience));
    expect_heartbeats(daemon, milliseconds(1200));
    const std::string summary = stop(daemon);
    EXPECT_GT(number_of(summary, "lines_dropped"), 10.0) << summary;
}

TEST_F(DaemonOutputs, AFullDiskIsCounted)
{
    Daemon daemon(arguments({"--status-period", "0.02"}), open("/dev/full", O_WRONLY | O_CLOEXEC));
    ASSERT_TRUE(cable.heartbeat(kPatience));
    expect_heartbeats(daemon, milliseconds(1200));
    const std::string summary = stop(daemon);
    EXPECT_GT(number_of(summary, "lines_dropped"), 10.0) << summary;
}

TEST_F(DaemonOutputs, ASummaryThatCannotBeWrittenIsAFailureAndNoHang)
{
    ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
    for (const std::string& summary : {path("fifo"), std::string("/dev/full"), path("none/summary")}) {
        cable.drain();  // else the HEARTBEAT of the daemon before is taken for that of this one
        Daemon daemon({"--serial", cable.path(), "--summary", summary}, scratch / "out");
        ASSERT_TRUE(cable.heartbeat(kPatience)) << summary;
        daemon.signal(SIGTERM);
        EXPECT_EQ(daemon.wait(kPatience), 1) << summary;
        EXPECT_NE(text_of(scratch / "out").find(summary + " cannot be written"), std::string::npos);
    }
}

TEST_F(DaemonOutputs, HangupsWithoutAnAirspaceFile)
{
    const auto started = Clock::now();
    Daemon daemon(arguments(), scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    const auto heard = Clock::now();
    hang_up(daemon);
    expect_heartbeats(daemon, milliseconds(1200));  // nor may steps be missing afterwards
    const double held_up = daemon.waited();
    const std::chrono::duration<double> least = Clock::now() - heard;
    const double steps = number_of(stop(daemon), "steps");
    const std::chrono::duration<double> most = Clock::now() - started;
    EXPECT_GT(steps, 0.9 * 50.0 * (least.count() - held_up)) << "steps are missing";
    EXPECT_LT(steps, 50.0 * most.count() + 5.0) << "a signal must not bring a step early";
}

TEST_F(DaemonOutputs, HangupsWithTwoThousandAreas)
{
    Daemon daemon(arguments({"--airspace", airspace(2000)}), scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    hang_up(daemon);
    expect_heartbeats(daemon, milliseconds(1200));
    const std::string summary = stop(daemon);
    EXPECT_GT(number_of(summary, "airspace_reloads"), 0.0) << summary;
    EXPECT_EQ(number_of(summary, "airspace_reload_failures"), 0.0) << summary;
    EXPECT_GE(number_of(summary, "areas_reported"), 4000.0) << summary;
}

TEST_F(DaemonOutputs, AFifoInPlaceOfAFileIsRefusedAtOnce)
{
    ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
    for (const char* option : {"--params", "--vehicle", "--airspace", "--serial", "--cloud"}) {
        std::vector<std::string> given{"--serial", cable.path(), option, path("fifo")};
        if (std::string(option) == "--serial") {
            given.erase(given.begin(), given.begin() + 2);
        }
        Daemon daemon(given, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << option << "\n" << text_of(scratch / "out");
        EXPECT_NE(text_of(scratch / "out").find("fifo"), std::string::npos) << option;
    }
}

TEST_F(DaemonOutputs, AnAirspaceFileThatBecomesAFifoChangesNothing)
{
    const std::string file = airspace(3);
    Daemon daemon(arguments({"--airspace", file}), scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    fs::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    daemon.signal(SIGHUP);
    expect_heartbeats(daemon, milliseconds(1200));
    const std::string summary = stop(daemon);
    EXPECT_EQ(number_of(summary, "airspace_reload_failures"), 1.0) << summary;
    EXPECT_EQ(number_of(summary, "areas_reported"), 3.0) << summary;
    EXPECT_NE(text_of(scratch / "out").find("is not a regular file"), std::string::npos);
}

/// Sets a parameter as a ground station does, until the daemon answers with that value.
bool set_parameter(Cable& cable, const std::string& name, float value)
{
    Heartbeat autopilot;
    autopilot.type = 2;
    autopilot.autopilot = 3;
    ParamSet m;
    m.param_value = value;
    m.target_system = 1;
    m.target_component = 196;
    m.param_type = 9;
    std::copy(name.begin(), name.end(), m.param_id.begin());
    for (int i = 0; i < 100; ++i) {
        cable.send(autopilot);
        cable.send(m);
        const std::optional<ParamValue> answer = cable.wait_for<ParamValue>(milliseconds(100));
        if (answer && answer->param_value == value) {
            return true;
        }
    }
    return false;
}

TEST_F(DaemonOutputs, ParametersSetOverTheLinkSurviveAKill)
{
    std::ofstream(path("my.param")) << "TRK_AGE,7\n";
    for (const float value : {11.0F, 12.0F, 13.0F}) {
        cable.drain();
        Daemon daemon({"--serial", cable.path(), "--params", path("my.param")}, scratch / "out");
        ASSERT_TRUE(cable.heartbeat(kPatience));
        ASSERT_TRUE(set_parameter(cable, "TRK_AGE", value));
        const std::string wanted = "TRK_AGE," + std::to_string(static_cast<int>(value)) + "\n";
        const auto end = Clock::now() + kPatience;
        while (text_of(scratch / "my.param.state").find(wanted) == std::string::npos && Clock::now() < end) {
            std::this_thread::sleep_for(milliseconds(5));
        }
        daemon.signal(SIGKILL);
        EXPECT_EQ(daemon.wait(kPatience), 1000 + SIGKILL);
        EXPECT_NE(text_of(scratch / "my.param.state").find(wanted), std::string::npos);
        EXPECT_EQ(text_of(scratch / "my.param"), "TRK_AGE,7\n") << "the user's file is the user's";
    }
    cable.drain();
    Daemon daemon({"--serial", cable.path(), "--params", path("my.param")}, scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    EXPECT_NE(text_of(scratch / "out").find("1 parameters as set over a link"), std::string::npos)
        << text_of(scratch / "out");
}

TEST_F(DaemonOutputs, AStateFileThatCannotBeWrittenIsSaidOnceAndCounted)
{
    Daemon daemon(arguments({"--state", path("none/state")}), scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    for (const float value : {11.0F, 12.0F, 13.0F}) {
        ASSERT_TRUE(set_parameter(cable, "TRK_AGE", value));
        std::this_thread::sleep_for(milliseconds(100));
    }
    const std::string summary = stop(daemon);
    EXPECT_GE(number_of(summary, "params_store_failures"), 3.0) << summary;
    EXPECT_EQ(number_of(summary, "params_stored"), 0.0) << summary;
    const std::string said = text_of(scratch / "out");
    const std::size_t first = said.find("parameters are not stored");
    ASSERT_NE(first, std::string::npos) << said;
    EXPECT_EQ(said.find("parameters are not stored", first + 1), std::string::npos) << said;
}

/// A wrong value of each kind that the link refuses, and bytes that are no frame.
TEST_F(DaemonOutputs, TheSummaryCountsWhatTheLinkRefuses)
{
    Daemon daemon(arguments(), scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    Heartbeat autopilot;
    autopilot.type = 2;
    autopilot.autopilot = 3;
    cable.send(autopilot);
    LocalPositionNed state;
    state.time_boot_ms = 1000;
    state.x = std::numeric_limits<float>::quiet_NaN();
    cable.send(state);
    state.x = 1e9F;
    cable.send(state);
    cable.send(state);
    cable.send_bytes(std::as_bytes(std::span("noise", 5)));
    ASSERT_TRUE(cable.heartbeat(kPatience));
    const std::string summary = stop(daemon);
    const std::string link = summary.substr(std::min(summary.find("\"mavlink\""), summary.size()));
    EXPECT_EQ(number_of(link, "not_finite"), 1.0) << summary;
    EXPECT_EQ(number_of(link, "out_of_range"), 2.0) << summary;
    EXPECT_EQ(number_of(link, "noise_bytes"), 5.0) << summary;
    EXPECT_GT(number_of(link, "bytes_in"), 50.0) << summary;
    for (const char* name :
         {"no_origin", "inbox_full", "frames_ignored", "outbox_full", "line_errors", "bad_checksum"}) {
        EXPECT_GE(number_of(link, name), 0.0) << name;
    }
}

}  // namespace
