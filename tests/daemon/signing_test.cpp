// SPDX-License-Identifier: BSD-3-Clause
// jinkd beside an autopilot that signs: a key from a file, a key over the link, restarts, kills, replays.
#include <sys/stat.h>

#include "tests/daemon/harness.hpp"

namespace {

using namespace jink::test;

Signing::Key key_of(unsigned char fill)
{
    Signing::Key key;
    key.fill(std::byte{fill});
    return key;
}

class DaemonSigning : public testing::Test {
protected:
    Scratch scratch;
    Cable cable;
    Heartbeat autopilot;

    void SetUp() override
    {
        autopilot.type = 2;
        autopilot.autopilot = 3;
        autopilot.base_mode = 1;
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (scratch / name).string(); }
    [[nodiscard]] std::string key_file(const std::string& text) const
    {
        std::ofstream(path("key")) << text;
        chmod(path("key").c_str(), 0600);
        return path("key");
    }
    static SetupSigning request(unsigned char fill, std::uint64_t time = 1)
    {
        SetupSigning m;
        m.initial_timestamp = time;
        m.target_system = 1;
        m.target_component = 196;
        m.secret_key.fill(fill);
        return m;
    }
    /// HEARTBEATs and own state both ways until jinkd is in standby: reception works in both directions.
    bool work_together()
    {
        LocalPositionNed state;
        const auto end = Clock::now() + kPatience;
        for (std::uint32_t i = 0; Clock::now() < end; ++i) {
            state.time_boot_ms = 1000 + 20 * i;
            cable.send(state);
            if (i % 25 == 0) {
                cable.send(autopilot);
            }
            const auto heard = cable.heartbeat(milliseconds(20));
            if (heard && heard->system_status == 3) {
                return true;
            }
        }
        return false;
    }
    void wait_for_file(const std::string& name, const std::string& part)
    {
        const auto end = Clock::now() + kPatience;
        while (text_of(scratch / name).find(part) == std::string::npos && Clock::now() < end) {
            std::this_thread::sleep_for(milliseconds(5));
        }
        EXPECT_NE(text_of(scratch / name).find(part), std::string::npos) << name << ": " << text_of(scratch / name);
    }
};

TEST_F(DaemonSigning, ASignedAutopilotWorksWithTheKeyOfAFile)
{
    cable.sign_with(key_of(0x2a), 0);  // an autopilot that does not know the time: it follows its peers
    Daemon daemon({"--serial", cable.path(), "--signing-key",
                   key_file("2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a2a\n"), "--summary",
                   path("summary")},
                  scratch / "out");
    EXPECT_TRUE(work_together()) << text_of(scratch / "out");
    EXPECT_EQ(cable.heard().wrong_signature + cable.heard().unsigned_refused + cable.heard().stale_signature, 0U);
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    EXPECT_NE(text_of(scratch / "summary").find("\"wrong_signatures\": 0"), std::string::npos);
    struct stat status {};
    ASSERT_EQ(stat(path("key.state").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    EXPECT_EQ(text_of(scratch / "out").find("2a2a"), std::string::npos) << "no message may hold the key";
}

TEST_F(DaemonSigning, AKeySetOverTheLinkOutlivesAKill)
{
    {
        Daemon daemon({"--serial", cable.path(), "--state", path("state")}, scratch / "out");
        ASSERT_TRUE(work_together());
        cable.send(request(7));
        cable.sign_with(key_of(7), 0);
        EXPECT_TRUE(work_together()) << "signed from here on, both ways";
        EXPECT_GT(cable.heard().accepted, 0U);
        EXPECT_EQ(cable.heard().wrong_signature, 0U);
        wait_for_file("state.signing", "key 0707");
        daemon.signal(SIGKILL);
        EXPECT_EQ(daemon.wait(kPatience), 1000 + SIGKILL);
    }
    struct stat status {};
    ASSERT_EQ(stat(path("state.signing").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    cable.drain();
    const std::uint32_t stale_before = cable.heard().stale_signature;
    Daemon daemon({"--serial", cable.path(), "--state", path("state")}, scratch / "out");
    EXPECT_TRUE(work_together());
    EXPECT_EQ(cable.heard().stale_signature, stale_before) << "its times must go on where they were, or later";
    cable.send(request(0, 0));
    cable.sign_with(key_of(8), 0);
    wait_for_file("state.signing", "key none");
}

TEST_F(DaemonSigning, UnsignedFramesAreRefusedButWhereSaid)
{
    const std::string key = key_file("passphrase correct horse battery staple\n");
    for (const bool taken : {false, true}) {
        Daemon daemon({"--serial", cable.path(), "--signing-key", key, "--unsigned", taken ? "all" : "109,246",
                       "--summary", path("summary")},
                      scratch / "out");
        ASSERT_TRUE(cable.heartbeat(kPatience));
        for (int i = 0; i < 20; ++i) {
            cable.send(autopilot);
            std::this_thread::sleep_for(milliseconds(10));
        }
        std::this_thread::sleep_for(milliseconds(200));
        daemon.signal(SIGTERM);
        ASSERT_EQ(daemon.wait(kPatience), 0);
        const std::string summary = text_of(scratch / "summary");
        EXPECT_NE(summary.find(taken ? "\"unsigned_refused\": 0, \"unsigned_taken\": 20"
                                     : "\"unsigned_refused\": 20, \"unsigned_taken\": 0"),
                  std::string::npos)
            << summary;
        cable.drain();
    }
}

TEST_F(DaemonSigning, RefusesKeysItCannotUse)
{
    const std::string short_key = key_file("2a2a\n");
    std::ofstream(path("damaged.signing")) << "key 12\n";
    fs::create_symlink(path("loop.signing"), path("loop.signing"));  // is there, and cannot be opened
    const std::vector<std::vector<std::string>> cases{
        {"--signing-key", short_key},   {"--signing-key", path("none")}, {"--unsigned", "1,2,3,4,5,6,7,8,9"},
        {"--unsigned", "RADIO_STATUS"}, {"--unsigned", "1,,2"},          {"--state", path("damaged")},
        {"--state", path("loop")},
    };
    for (std::vector<std::string> arguments : cases) {
        arguments.insert(arguments.begin(), {"--serial", cable.path()});
        Daemon daemon(arguments, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << testing::PrintToString(arguments) << text_of(scratch / "out");
    }
}

}  // namespace
