// SPDX-License-Identifier: BSD-3-Clause
// jinkd --map: a good map is taken, anything else ends the daemon with status 2 and a line that says why.
#include "firmware/linux/map_file.hpp"
#include "tests/daemon/harness.hpp"
#include "tests/oracle/map_of_hulls.hpp"

namespace {

using namespace jink::test;

std::string good_map()
{
    const jink::oracle::MapOfHulls tables(
        {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{9, 0, 0}, {9, 1, 0}, {9, 0, 5}}});
    return jink::files::map_file_of(tables.map());
}

class DaemonMap : public ::testing::Test {
protected:
    std::string path(const std::string& name) const { return (scratch / name).string(); }
    std::string write(const std::string& name, const std::string& text) const
    {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }
    void expect_refusal(const std::string& file, const std::string& why)
    {
        Daemon daemon({"--serial", cable.path(), "--map", file}, scratch / "out");
        EXPECT_EQ(daemon.wait(kPatience), 2) << file;
        EXPECT_NE(text_of(scratch / "out").find(file + ": " + why), std::string::npos) << text_of(scratch / "out");
    }
    Scratch scratch;
    Cable cable;
};

TEST_F(DaemonMap, AGoodOneIsTaken)
{
    const std::string file = write("good.map", good_map());
    Daemon daemon({"--serial", cable.path(), "--map", file, "--summary", path("summary.json")}, scratch / "out");
    ASSERT_TRUE(cable.heartbeat(kPatience));
    daemon.signal(SIGTERM);
    EXPECT_EQ(daemon.wait(kPatience), 0);
    EXPECT_NE(text_of(path("summary.json")).find("\"map_coarse\": 0"), std::string::npos);
    const std::string said = text_of(scratch / "out");
    EXPECT_NE(said.find(file + ": 2 pieces are known, in the autopilot's local frame"), std::string::npos) << said;
}

TEST_F(DaemonMap, OneThatIsNotGoodEndsIt)
{
    const std::string good = good_map();
    expect_refusal(path("none.map"), "no such file");
    expect_refusal(path(""), "is a directory");
    expect_refusal(write("text.map", "v 0 0 0\n"), "not a map file: jink mesh build makes them");
    expect_refusal(write("empty.map", ""), "not a map file");
    expect_refusal(write("cut.map", good.substr(0, good.size() - 5)), "the file ends too early");
    expect_refusal(write("long.map", good + '\0'), "the file goes on after its end");
    expect_refusal(write("large.map", good + std::string(jink::files::kMaxMapFile, '\0')), "is larger than any map");
    std::string old = good;
    old[8] = 1;
    expect_refusal(write("old.map", old), "version 1 of the file, where 2 is read: make it anew by jink mesh build");
    std::string damaged = good;
    damaged.back() = static_cast<char>(damaged.back() ^ 0x40);
    expect_refusal(write("damaged.map", damaged), "wrong checksum");
    std::string moved = good;
    moved[good.size() - 5] = static_cast<char>(moved[good.size() - 5] ^ 0x01);  // the last leaf's piece
    expect_refusal(write("moved.map", moved), "a tree that does not hold every piece once");
}

TEST_F(DaemonMap, AFifoIsRefusedAtOnce)
{
    ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
    expect_refusal(path("fifo"), "is not a regular file");
}

}  // namespace
