// SPDX-License-Identifier: BSD-3-Clause
// Parameters that outlive a restart: cut files, foreign lines, values that no longer fit, kills between two steps.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "firmware/linux/param_store.hpp"
#include "tests/host/scratch.hpp"

namespace jink::files {
namespace {

using test::Scratch;
using test::slurp;

ParamValues changed(app::Param p, float value)
{
    app::Parameters parameters;
    EXPECT_EQ(parameters.set(p, value), app::ParamStatus::ok);
    return parameters.values();
}

/// A state file with these lines and the right checksum.
std::string sealed(const std::string& lines)
{
    const ParamValues same = app::Parameters().values();
    // The checksum is over all before it: that of an empty state, with lines put in, is not right; so compute it anew.
    std::uint32_t crc = 0xFFFFFFFFU;
    const std::string text = state_text(same, same).substr(0, state_text(same, same).rfind("# end ")) + lines;
    for (const char c : text) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
        }
    }
    std::array<char, 32> end{};
    std::snprintf(end.data(), end.size(), "# end %08x\n", ~crc);
    return text + end.data();
}

TEST(ParamStore, WhatWasSetComesBackBitForBit)
{
    app::Parameters parameters;
    const ParamValues initial = parameters.values();
    ASSERT_EQ(parameters.set(app::Param::track_age, 7.3F), app::ParamStatus::ok);
    ASSERT_EQ(parameters.set(app::Param::cruise, 4.1F), app::ParamStatus::ok);
    const std::string text = state_text(initial, parameters.values());
    app::Parameters again;
    Complaints complaints;
    const StateLoad load = apply_state(text, "s", again, complaints);
    EXPECT_EQ(again.values(), parameters.values());
    EXPECT_EQ(load.taken, 2U);
    EXPECT_EQ(load.refused, 0U);
    EXPECT_TRUE(complaints.empty());
    EXPECT_EQ(sealed("TRK_AGE,7.3\n"), state_text(initial, changed(app::Param::track_age, 7.3F)));
}

TEST(ParamStore, AFileThatIsCutAtAnyByteChangesNothing)
{
    const ParamValues initial = app::Parameters().values();
    const std::string text = state_text(initial, changed(app::Param::track_age, 12.5F));
    for (std::size_t size = 0; size < text.size(); ++size) {
        app::Parameters parameters;
        Complaints complaints;
        const StateLoad load = apply_state(text.substr(0, size), "s", parameters, complaints);
        EXPECT_EQ(parameters.values(), initial) << size;
        EXPECT_EQ(load.refused, 1U) << size;
        EXPECT_EQ(complaints.size(), 1U) << size;
    }
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::string bad = text;
        bad[i] = static_cast<char>(bad[i] ^ 1);
        app::Parameters parameters;
        Complaints complaints;
        EXPECT_EQ(apply_state(bad, "s", parameters, complaints).refused, 1U) << i;
        EXPECT_EQ(parameters.values(), initial) << i;
    }
}

TEST(ParamStore, AWriteThatIsCutAtAnyByteLeavesTheFormerContent)
{
    // As a power cut leaves it: a new file of any length beside the old one.
    const Scratch scratch;
    const ParamValues initial = app::Parameters().values();
    const std::string path = scratch.write("state", state_text(initial, changed(app::Param::track_age, 5.0F)));
    const std::string next = state_text(initial, changed(app::Param::track_age, 6.0F));
    for (std::size_t size = 0; size <= next.size(); ++size) {
        static_cast<void>(scratch.write("state.new", next.substr(0, size)));
        app::Parameters parameters;
        Complaints complaints;
        EXPECT_EQ(load_state(path, parameters, complaints).taken, 1U);
        EXPECT_EQ(parameters.get(app::Param::track_age), 5.0F) << size;
    }
    EXPECT_EQ(replace_file(path, next), "");
    EXPECT_EQ(slurp(path), next);
    EXPECT_FALSE(std::filesystem::exists(path + ".new"));
}

TEST(ParamStore, AKillAtAnyTimeLeavesAWholeFile)
{
    const Scratch scratch;
    const ParamValues initial = app::Parameters().values();
    const std::string path = scratch.write("state", state_text(initial, initial));
    for (int i = 0; i < 20; ++i) {
        const pid_t child = fork();
        if (child == 0) {
            for (int k = 0;; ++k) {
                static_cast<void>(replace_file(
                    path, state_text(initial, changed(app::Param::track_age, 2.0F + static_cast<float>(k % 50)))));
            }
        }
        usleep(static_cast<useconds_t>(1000 + 937 * i));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        app::Parameters parameters;
        Complaints complaints;
        EXPECT_EQ(load_state(path, parameters, complaints).refused, 0U);
        EXPECT_TRUE(complaints.empty());
    }
}

TEST(ParamStore, UnknownAndOutOfRangeLinesAreLeftOutAndTheOthersCount)
{
    app::Parameters parameters;
    Complaints complaints;
    const StateLoad load = apply_state(sealed("NO_SUCH,1\nTRK_AGE,9\nTRK_RADIUS,1e9\nTRK_ACCEL,nan\nJNK_MODE,1\n"), "s",
                                       parameters, complaints);
    EXPECT_EQ(load.taken, 2U);
    EXPECT_EQ(load.refused, 3U);
    EXPECT_EQ(complaints.size(), 3U);
    EXPECT_EQ(complaints.at(0).line, 2U) << "the head is the first line";
    EXPECT_EQ(parameters.get(app::Param::track_age), 9.0F);
    EXPECT_EQ(parameters.get(app::Param::mode), 1.0F);
}

TEST(ParamStore, ValuesThatNoLongerFitTogetherAreLeftOutSingly)
{
    // The files have changed since: a ceiling below the floor fits no more, the rest does.
    app::Parameters parameters;
    ASSERT_EQ(parameters.set(app::Param::bounds, 3.0F), app::ParamStatus::ok);
    Complaints complaints;
    const float ceiling = parameters.get(app::Param::floor);
    const StateLoad load =
        apply_state(sealed("JNK_CEILING," + to_text(ceiling) + "\nTRK_AGE,9\n"), "s", parameters, complaints);
    EXPECT_EQ(load.refused, 1U);
    EXPECT_EQ(load.taken, 1U);
    EXPECT_EQ(parameters.get(app::Param::track_age), 9.0F);
    EXPECT_GT(parameters.get(app::Param::ceiling), ceiling);
}

TEST(ParamStore, AFileThatIsNotThereIsNoComplaintAndAFifoIsOne)
{
    const Scratch scratch;
    app::Parameters parameters;
    Complaints complaints;
    EXPECT_EQ(load_state((scratch.path() / "none").string(), parameters, complaints).refused, 0U);
    EXPECT_TRUE(complaints.empty());
    const std::string fifo = (scratch.path() / "fifo").string();
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    EXPECT_EQ(load_state(fifo, parameters, complaints).refused, 1U);
    EXPECT_EQ(complaints.size(), 1U);
}

TEST(ParamStore, AFullDiskLeavesTheFormerContent)
{
    // A limit on the size of files simulates a full disk: a write then ends short, and the next one fails.
    const Scratch scratch;
    const std::string path = scratch.write("state", "the former content").string();
    for (const rlim_t room : {rlim_t{0}, rlim_t{1}, rlim_t{100}}) {
        const pid_t child = fork();
        if (child == 0) {
            signal(SIGXFSZ, SIG_IGN);
            const rlimit limit{room, room};
            setrlimit(RLIMIT_FSIZE, &limit);
            _exit(replace_file(path, std::string(200, 'x')).empty() ? 0 : 7);
        }
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 7) << room;
        EXPECT_EQ(slurp(path), "the former content") << room;
        EXPECT_FALSE(std::filesystem::exists(path + ".new")) << room;
    }
}

TEST(ParamStore, WhatCannotBeWrittenSaysWhyAndLeavesNothingBehind)
{
    const Scratch scratch;
    EXPECT_NE(replace_file((scratch.path() / "none/state").string(), "x"), "");
    const std::string folder = (scratch.path() / "folder").string();
    std::filesystem::create_directory(folder);
    EXPECT_NE(replace_file(folder, "x"), "");
    EXPECT_FALSE(std::filesystem::exists(folder + ".new"));
    const std::string fifo = (scratch.path() / "state.new").string();
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    EXPECT_NE(replace_file((scratch.path() / "state").string(), "x"), "") << "and does not wait for a reader";
}

TEST(ParamStore, APipeIsWrittenAndALinkKeepsItsName)
{
    const Scratch scratch;
    const std::string pipe = (scratch.path() / "pipe").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_NE(replace_file(pipe, "x"), "") << "nobody reads";
    const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(reader, 0);
    EXPECT_EQ(replace_file(pipe, "text"), "");
    std::array<char, 10> read_back{};
    EXPECT_EQ(read(reader, read_back.data(), read_back.size()), 4);
    close(reader);
    EXPECT_TRUE(std::filesystem::is_fifo(pipe));
    EXPECT_NE(replace_file(pipe, "key", FileAccess::owner_only), "") << "a secret belongs into a file";
    const std::string file = (scratch.path() / "file").string();
    const std::string link = (scratch.path() / "link").string();
    std::ofstream(file) << "before";
    std::filesystem::create_symlink("file", link);
    EXPECT_EQ(replace_file(link, "after"), "");
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(slurp(file), "after");
    EXPECT_EQ(replace_file("/dev/null", "x"), "");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace
}  // namespace jink::files
