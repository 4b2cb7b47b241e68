// SPDX-License-Identifier: BSD-3-Clause
// The daemon from outside: options, files, signals, a cable that is pulled and put back.
#include <sys/time.h>
#include <sys/un.h>

#include "tests/daemon/harness.hpp"

namespace {

using namespace jink::test;

TEST(Jinkd, HelpNamesEveryOptionOfTheReadme)
{
    Scratch scratch;
    Daemon daemon({"--help"}, scratch / "out");
    EXPECT_EQ(daemon.wait(kPatience), 0);
    const std::string help = text_of(scratch / "out");
    for (const char* option :
         {"--serial", "--can", "--node-id", "--vehicle", "--params", "--summary", "--watchdog", "--system-id",
          "--cloud", "--map", "--clock", "--log", "--log-clouds", "--log-size", "--log-count"}) {
        EXPECT_NE(help.find(option), std::string::npos) << option;
    }
}

TEST(Jinkd, RefusesWhatItCannotUse)
{
    Scratch scratch;
    std::ofstream(scratch / "bad.param") << "JNK_MODE,7\nNO_SUCH_NAME,1\n";
    std::ofstream(scratch / "file") << "no terminal";
    const std::string bad = (scratch / "bad.param").string();
    const std::string file = (scratch / "file").string();
    const std::vector<std::vector<std::string>> cases{
        {},
        {"--serial", ""},
        {"--serial", "/dev/null:0"},
        {"--serial", file},
        {"--serial", "/dev/ptmx", "--params", bad},
        {"--serial", "/dev/ptmx", "--params", file + "-that-is-not-there"},
        {"--serial", "/dev/ptmx", "--vehicle", file},
        {"--serial", "/dev/ptmx", "--system-id", "256"},
        {"--serial", "/dev/ptmx", "--cloud", "/dev/null:0"},
        {"--serial", "/dev/ptmx", "--cloud", file},
        {"--serial", "/dev/ptmx", "--log", ""},
        {"--serial", "/dev/ptmx", "--log-clouds"},
        {"--serial", "/dev/ptmx", "--log", "/tmp", "--log-clouds"},
        {"--serial", "/dev/ptmx", "--log", "/tmp", "--log-count", "1"},
        {"--serial", "/dev/ptmx", "--log", "/tmp", "--log-size", "0"},
        {"--serial", "/dev/ptmx", "--clock", "20"},
        {"--serial", "/dev/ptmx", "--clock", "500", "--cloud", "/dev/ptmx"},
        {"--can", ""},
        {"--can", "a_name_that_no_interface_can_have"},
        {"--node-id", "42"},
        {"--serial", "/dev/ptmx", "--node-id", "42"},
        {"--can", "can0", "--node-id", "128"},
        {"--can", "can0", "--node-id", "-1"},
        {"--can", "can0", "--can-bitrate", "1000000"},
    };
    for (const auto& arguments : cases) {
        Daemon daemon(arguments, scratch / "out");
        const int status = daemon.wait(kPatience);
        EXPECT_NE(status, 0) << testing::PrintToString(arguments);
        EXPECT_LT(status, 1000) << testing::PrintToString(arguments);
        EXPECT_GT(status, 0) << testing::PrintToString(arguments);
        EXPECT_FALSE(text_of(scratch / "out").empty()) << testing::PrintToString(arguments);
    }
    Daemon daemon({"--serial", "/dev/ptmx", "--params", bad}, scratch / "out");
    EXPECT_EQ(daemon.wait(kPatience), 2);
    const std::string said = text_of(scratch / "out");
    EXPECT_NE(said.find("bad.param:1"), std::string::npos) << said;
    EXPECT_NE(said.find("bad.param:2"), std::string::npos) << said;
}

TEST(Jinkd, RefusesToWriteOverAFileOfItsUser)
{
    Scratch scratch;
    Cable cable;
    const auto path = [&](const char* name) { return (scratch / name).string(); };
    const std::vector<const char*> names{"my.param", "vehicle.yaml",    "areas.yaml",
                                         "map",      "a.state.signing", "page.html"};
    for (const char* name : names) {
        std::ofstream(path(name)) << "# the user's\n";
    }
    fs::create_symlink("my.param", path("link"));
    fs::create_hard_link(path("my.param"), path("hard"));
    const std::string param = path("my.param");
    const std::vector<std::vector<std::string>> cases{
        {"--params", param, "--state", param},
        {"--params", param, "--state", path("link")},
        {"--params", path("link"), "--state", path("hard")},
        {"--params", param, "--state", path("./my.param")},
        {"--params", param, "--summary", param},
        {"--params", param, "--summary", param + ".state"},
        {"--state", path("new"), "--summary", path("./new")},
        {"--state", path("new"), "--summary", path("new.signing")},
        {"--vehicle", path("vehicle.yaml"), "--summary", path("vehicle.yaml")},
        {"--airspace", path("areas.yaml"), "--state", path("areas.yaml")},
        {"--map", path("map"), "--summary", path("map")},
        {"--signing-key", path("a.state.signing"), "--state", path("a.state")},
        {"--page", "15999", "--page-file", path("page.html"), "--summary", path("page.html")},
    };
    for (std::vector<std::string> arguments : cases) {
        arguments.insert(arguments.begin(), {"--serial", cable.path()});
        Daemon daemon(arguments, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << testing::PrintToString(arguments);
        const std::string said = text_of(scratch / "out");
        EXPECT_NE(said.find("cannot be written: it is the same file as"), std::string::npos) << said;
        for (const char* name : names) {
            EXPECT_EQ(text_of(scratch / name), "# the user's\n") << testing::PrintToString(arguments);
        }
    }
    EXPECT_FALSE(cable.heartbeat(milliseconds(50))) << "nothing is opened before";
}

TEST(Jinkd, RefusesTheAutopilotsDeviceAsCloudLine)
{
    Scratch scratch;
    Cable cable;
    fs::create_symlink(cable.path(), scratch / "port");
    for (const std::vector<std::string>& line : {std::vector<std::string>{"--serial", cable.path()},
                                                 {"--serial", cable.path() + ":57600"},
                                                 {"--link", "serial:" + cable.path()}}) {
        for (const std::string& cloud : {cable.path(), cable.path() + ":115200", (scratch / "port").string()}) {
            Daemon daemon({line[0], line[1], "--cloud", cloud}, scratch / "out");
            EXPECT_EQ(daemon.wait(kPatience), 2) << line[1] << " " << cloud;
            EXPECT_NE(text_of(scratch / "out").find("--cloud " + cloud + ": this device is the autopilot's line"),
                      std::string::npos)
                << text_of(scratch / "out");
        }
    }
}

TEST(Jinkd, LeavesADeviceToTheDaemonThatHasIt)
{
    Scratch scratch;
    Cable cable;
    Daemon first({"--serial", cable.path(), "--summary", (scratch / "summary.json").string()}, scratch / "first");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    Daemon second({"--serial", cable.path()}, scratch / "second");
    const auto end = Clock::now() + kPatience;
    while (text_of(scratch / "second").find("held by another program; going on trying") == std::string::npos &&
           Clock::now() < end) {
        EXPECT_TRUE(cable.heartbeat(kPatience)) << "of the first";
    }
    EXPECT_LT(Clock::now(), end) << text_of(scratch / "second");
    first.signal(SIGKILL);
    first.wait(kPatience);
    cable.drain();
    EXPECT_TRUE(cable.heartbeat(kPatience)) << "the second takes over";
    second.signal(SIGTERM);
    EXPECT_EQ(second.wait(kPatience), 0);
}

TEST(Jinkd, SaysThatAStateFileCannotBeOpened)
{
    Scratch scratch;
    Cable cable;
    const std::string state = (scratch / "state").string();
    fs::create_symlink(state, state);  // is there, and cannot be opened
    Daemon daemon({"--serial", cable.path(), "--state", state}, scratch / "out");
    EXPECT_TRUE(cable.heartbeat(kPatience));
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    EXPECT_NE(text_of(scratch / "out").find("state: cannot be opened"), std::string::npos) << text_of(scratch / "out");
}

/// A descriptor that is free must not become the line, on which status lines would go out.
TEST(Jinkd, WithoutStandardOutputTheLineCarriesMavlinkAlone)
{
    Cable cable;
    Daemon daemon({"--serial", cable.path(), "--status-period", "0.05"}, -1);
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(cable.heartbeat(kPatience));
    }
    EXPECT_EQ(cable.heard().noise_bytes, 0U);
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

/// The service manager starts what waits for jinkd: READY comes when nothing can refuse any more.
TEST(Jinkd, IsReadyOnceNothingCanRefuse)
{
    Scratch scratch;
    std::ofstream(scratch / "bad.yaml") << "no airspace";
    const std::string path = (scratch / "notify").string();
    const int manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(bind(manager, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const timeval patience{std::chrono::duration_cast<std::chrono::seconds>(kPatience).count(), 0};
    ASSERT_EQ(setsockopt(manager, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience), 0);
    const auto next = [&](int flags) {
        std::array<char, 100> text{};
        const ssize_t n = recv(manager, text.data(), text.size(), flags);
        return std::string(text.data(), static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
    };
    ASSERT_EQ(setenv("NOTIFY_SOCKET", path.c_str(), 1), 0);
    Cable cable;
    const std::vector<std::vector<std::string>> cases{{"--airspace", (scratch / "bad.yaml").string()},
                                                      {"--signing-key", (scratch / "none").string()}};
    for (std::vector<std::string> arguments : cases) {
        arguments.insert(arguments.begin(), {"--serial", cable.path()});
        Daemon daemon(arguments, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << testing::PrintToString(arguments) << text_of(scratch / "out");
        EXPECT_EQ(next(MSG_DONTWAIT), "") << testing::PrintToString(arguments);
    }
    Daemon daemon({"--serial", cable.path()}, scratch / "out");
    ASSERT_EQ(unsetenv("NOTIFY_SOCKET"), 0);
    ASSERT_TRUE(cable.heartbeat(kPatience)) << text_of(scratch / "out");
    EXPECT_EQ(next(MSG_DONTWAIT), "READY=1");
    EXPECT_EQ(next(0), "WATCHDOG=1") << "it is fed after the step that sends the HEARTBEAT";
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    close(manager);
}

TEST(Jinkd, SaysWhatIsMissingForCan)
{
    const int s = socket(PF_CAN, SOCK_RAW, 1);
    const bool kernel_has_it = s >= 0 || errno != EAFNOSUPPORT;
    if (s >= 0) {
        close(s);
    }
    Scratch scratch;
    Daemon daemon({"--can", "jink_none0"}, scratch / "out");
    if (kernel_has_it) {
        EXPECT_EQ(daemon.wait(milliseconds(300)), -1) << "it may come";
        EXPECT_NE(text_of(scratch / "out").find("no such interface; going on trying"), std::string::npos);
        daemon.signal(SIGTERM);
        EXPECT_EQ(daemon.wait(kPatience), 0);
    } else {
        EXPECT_EQ(daemon.wait(kPatience), 2);
        EXPECT_NE(text_of(scratch / "out").find("no SocketCAN (AF_CAN)"), std::string::npos);
    }
}

TEST(Jinkd, SaysCriticalAndLeavesOnSigterm)
{
    Scratch scratch;
    Cable cable;
    Daemon daemon({"--serial", cable.path() + ":921600", "--summary", (scratch / "summary.json").string()},
                  scratch / "out");
    const auto first = cable.heartbeat(kPatience);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->type, 18);
    EXPECT_EQ(first->autopilot, 8);
    EXPECT_EQ(first->system_status, 1) << "boot, until there is an autopilot";
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    std::optional<Heartbeat> last;
    while (const auto next = cable.heartbeat(milliseconds(300))) {
        last = next;
    }
    ASSERT_TRUE(last);
    EXPECT_EQ(last->system_status, 5) << "critical before silence";
    EXPECT_NE(text_of(scratch / "summary.json").find("\"step_mean_us\""), std::string::npos);
}

TEST(Jinkd, WaitsForADeviceThatComesLater)
{
    Scratch scratch;
    const fs::path device = scratch / "port";
    Daemon daemon({"--serial", device.string()}, scratch / "out");
    EXPECT_EQ(daemon.wait(milliseconds(300)), -1) << text_of(scratch / "out");
    Cable cable;
    fs::create_symlink(cable.path(), device);
    EXPECT_TRUE(cable.heartbeat(kPatience)) << text_of(scratch / "out");
    daemon.signal(SIGINT);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(Jinkd, ComesBackWhenTheCableDoes)
{
    Scratch scratch;
    const fs::path device = scratch / "port";
    auto cable = std::make_unique<Cable>();
    fs::create_symlink(cable->path(), device);
    Daemon daemon({"--serial", device.string()}, scratch / "out");
    ASSERT_TRUE(cable->heartbeat(kPatience));
    for (int i = 0; i < 3; ++i) {
        // Removes the name first: the kernel gives a closed pseudo-terminal's number to the next one of any process.
        fs::remove(device);
        cable->pull();
        EXPECT_EQ(daemon.wait(milliseconds(200)), -1) << "it must outlive the cable";
        auto next = std::make_unique<Cable>();
        fs::create_symlink(next->path(), device);
        EXPECT_TRUE(next->heartbeat(kPatience)) << "after pulling it " << i + 1 << " times\n"
                                                << text_of(scratch / "out");
        cable = std::move(next);
    }
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(Jinkd, TakesPointCloudsOnALineOfTheirOwn)
{
    namespace cloud = jink::link::cloud;
    Scratch scratch;
    Cable cable;
    Cable lidar;
    Daemon daemon({"--serial", cable.path(), "--cloud", lidar.path(), "--summary", (scratch / "summary.json").string()},
                  scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    const std::vector<cloud::RawPoint> points(cloud::kMaxPoints, {0, 0, 3000});
    cloud::Part part;
    part.max_range = 10000;
    part.parts = 2;
    part.scan_points = 2 * cloud::kMaxPoints;
    std::array<std::byte, cloud::kMaxFrame> frame{};
    for (std::uint16_t i = 0; i < 20; ++i) {  // ten scans, the last one in half
        part.sequence = i;
        part.scan = static_cast<std::uint16_t>(i / 2);
        part.part = i % 2;
        part.stamp_ms = 100U * part.scan;
        const std::size_t n = cloud::write_frame(part, points, frame);
        if (i < 19) {
            lidar.send_bytes({frame.data(), n});
        }
        std::this_thread::sleep_for(milliseconds(20));
    }
    std::this_thread::sleep_for(milliseconds(500));
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    const std::string summary = text_of(scratch / "summary.json");
    EXPECT_NE(summary.find("\"scans\": 10, \"scans_complete\": 9, \"scans_missed\": 0, \"points\": 2280, "
                           "\"points_lost\": 120"),
              std::string::npos)
        << summary;
    EXPECT_NE(summary.find("\"hits\": 2280"), std::string::npos) << summary;
}

TEST(Jinkd, RunsWithTheWorkOfAClock)
{
    Scratch scratch;
    Cable cable;
    Daemon daemon({"--serial", cable.path(), "--clock", "600", "--quiet"}, scratch / "out");
    EXPECT_TRUE(cable.heartbeat(kPatience));
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
}

TEST(Jinkd, TakesTheSystemIdOfTheAutopilotItHears)
{
    Scratch scratch;
    Cable cable;
    Daemon daemon({"--serial", cable.path(), "--quiet"}, scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    Heartbeat autopilot;
    autopilot.type = 2;
    autopilot.autopilot = 3;
    autopilot.base_mode = 1;
    cable.send(autopilot);
    LocalPositionNed state;
    bool ready = false;
    for (std::uint32_t i = 0; i < 200 && !ready; ++i) {
        state.time_boot_ms = 1000 + 20 * i;
        cable.send(state);
        if (i % 25 == 0) {
            cable.send(autopilot);
        }
        const auto heard = cable.heartbeat(milliseconds(20));
        ready = heard && heard->system_status == 3;
    }
    EXPECT_TRUE(ready) << "standby once autopilot and own state are heard\n" << text_of(scratch / "out");
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    EXPECT_TRUE(text_of(scratch / "out").empty()) << text_of(scratch / "out");
}

}  // namespace
