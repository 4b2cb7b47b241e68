// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/block_folder.hpp"

#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

class BlockFolders : public ::testing::Test {
protected:
    void SetUp() override
    {
        std::string name = fs::temp_directory_path() / "jink-blocks-XXXXXX";
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        top = name;
        place = top / "campaign";
    }
    void TearDown() override { fs::remove_all(top); }

    static void put(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
    static std::string refusal(const fs::path& folder, const std::string& manifest)
    {
        try {
            BlockFolder(folder).claim(manifest);
        } catch (const BadFolder& e) {
            return e.what();
        }
        return "";
    }

    fs::path top;
    fs::path place;
};

TEST_F(BlockFolders, GivesBackWhatWasWrittenAndNamesWhatIsMissing)
{
    BlockFolder folder(place);
    folder.claim("kind 1\n");
    EXPECT_EQ(folder.missing(3), (std::vector<std::size_t>{0, 1, 2}));
    folder.write(1, "a\nb\n");
    folder.write(2, "");
    EXPECT_EQ(folder.read(1), "a\nb\n");
    EXPECT_EQ(folder.read(2), "");
    EXPECT_EQ(folder.missing(3), std::vector<std::size_t>{0});
    EXPECT_EQ(folder.manifest(), "kind 1\n");
}

TEST_F(BlockFolders, WhatIsCutOffOrChangedCountsAsMissing)
{
    BlockFolder folder(place);
    folder.claim("kind 1\n");
    folder.write(0, "12 34\n56 78\n");
    const fs::path file = place / "block_000000.txt";
    ASSERT_TRUE(folder.read(0));
    std::ifstream in(file);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    for (std::size_t length = 0; length < whole.size(); ++length) {
        put(file, whole.substr(0, length));
        EXPECT_FALSE(folder.read(0)) << length;
    }
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ 1);
        put(file, changed);
        EXPECT_FALSE(folder.read(0)) << i;
    }
    put(file, whole + "x\n");
    EXPECT_FALSE(folder.read(0));
    put(file, whole);
    EXPECT_TRUE(folder.read(0));
}

TEST_F(BlockFolders, IsRefusedToAnotherSetUpWhichIsNamed)
{
    {
        BlockFolder folder(place);
        folder.claim("kind 1\nplanner product\n");
        folder.write(0, "a\n");
    }
    EXPECT_EQ(refusal(place, "kind 1\nplanner product\n"), "");
    EXPECT_NE(refusal(place, "kind 1\nplanner source\n").find("'planner product' there, 'planner source' asked for"),
              std::string::npos);
    EXPECT_NE(refusal(place, "kind 1\nplanner product\nmore 1\n").find("'nothing' there, 'more 1' asked for"),
              std::string::npos);
    EXPECT_EQ(BlockFolder(place).read(0), "a\n");
}

TEST_F(BlockFolders, FoldersOfOthersAreLeftAlone)
{
    fs::create_directories(place);
    put(place / "letter.txt", "dear");
    EXPECT_NE(refusal(place, "kind 1\n").find("not empty"), std::string::npos);
    EXPECT_FALSE(fs::exists(place / "manifest.txt"));
    put(top / "file", "no folder");
    EXPECT_NE(refusal(top / "file", "kind 1\n").find("no folder"), std::string::npos);
    EXPECT_THROW(static_cast<void>(BlockFolder(top / "nowhere").manifest()), BadFolder);
}

TEST_F(BlockFolders, OneAtATime)
{
    BlockFolder folder(place);
    folder.claim("kind 1\n");
    EXPECT_NE(refusal(place, "kind 1\n").find("used by another run"), std::string::npos);
}

/// A program killed while writing the manifest leaves only its draft behind.
TEST_F(BlockFolders, AnUnfinishedManifestIsNoObstacle)
{
    fs::create_directories(place);
    put(place / "manifest.txt.part", "ki");
    EXPECT_EQ(refusal(place, "kind 1\n"), "");
    EXPECT_FALSE(fs::exists(place / "manifest.txt.part"));
}

/// FNV-1a's published test vectors (Noll's list): "", "a", "foobar".
TEST(Checksum, IsFnv1a)
{
    EXPECT_EQ(checksum(""), 0xcbf29ce484222325U);
    EXPECT_EQ(checksum("a"), 0xaf63dc4c8601ec8cU);
    EXPECT_EQ(checksum("foobar"), 0x85944171f73967e8U);
}

}  // namespace
}  // namespace jink::sim
