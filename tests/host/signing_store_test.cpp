// SPDX-License-Identifier: BSD-3-Clause
// Key files and the signing state: reading, refusal, persistence over a restart, and read permissions.
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "firmware/linux/param_store.hpp"
#include "firmware/linux/signing_store.hpp"
#include "tests/host/scratch.hpp"

namespace jink::files {
namespace {

using link::mavlink::Signing;
using test::all_of;
using test::Scratch;
using test::slurp;

constexpr std::uint64_t kStoredTime = 34'715'520'000'000;
constexpr const char* kHexKey = "000102030405060708090a0B0C0d0e0f101112131415161718191a1b1c1d1e1f";

SigningKey counting_key()
{
    SigningKey key;
    for (std::size_t i = 0; i < key.size(); ++i) {
        key[i] = static_cast<std::byte>(i);
    }
    return key;
}

SigningState some_state()
{
    SigningState state;
    state.has_key = true;
    state.key = counting_key();
    state.time = kStoredTime;
    state.given.fill(std::byte{0xA5});
    return state;
}

std::optional<SigningKey> key_in(const std::string& text)
{
    Complaints complaints;
    const auto key = parse_key_file(text, "key", complaints);
    EXPECT_EQ(complaints.empty(), key.has_value()) << text;
    return key;
}

std::string write_key(const Scratch& scratch, const std::string& name, const std::string& text)
{
    const std::string path = scratch.write(name, text).string();
    chmod(path.c_str(), 0600);
    return path;
}

TEST(SigningStore, KeyFilesHoldHexadecimalDigitsOrAPassphrase)
{
    EXPECT_EQ(key_in(kHexKey), counting_key());
    EXPECT_EQ(key_in(std::string("# of 2026\n\n") + kHexKey + "\r\n"), counting_key());
    // `echo -n secret | sha256sum`
    EXPECT_EQ(key_in("passphrase secret\n"),
              key_in("2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b"));
    for (const std::string& bad :
         {std::string(), std::string("# none\n"), std::string(kHexKey).substr(1), std::string(kHexKey) + "0",
          std::string(kHexKey) + "\n" + kHexKey, "g" + std::string(kHexKey).substr(1),
          "-1" + std::string(kHexKey).substr(2), std::string("passphrase "), std::string("passphrase\n"),
          std::string(64, '0'), " " + std::string(kHexKey)}) {
        EXPECT_FALSE(key_in(bad)) << bad;
    }
}

TEST(SigningStore, AKeyThatOthersMayReadIsTakenAndComplainedOf)
{
    const Scratch scratch;
    const std::string path = write_key(scratch, "key", kHexKey);
    Complaints complaints;
    EXPECT_EQ(read_key_file(path, complaints), counting_key());
    EXPECT_TRUE(complaints.empty()) << all_of(complaints);
    chmod(path.c_str(), 0640);
    EXPECT_EQ(read_key_file(path, complaints), counting_key());
    ASSERT_EQ(complaints.size(), 1U);
    EXPECT_EQ(all_of(complaints).find("0001"), std::string::npos) << "no complaint may hold the key";
}

TEST(SigningStore, TheStateComesBackAndNothingOfItWhenCutOrChanged)
{
    SigningState none = some_state();
    none.has_key = false;
    none.key = {};
    for (const SigningState& state : {some_state(), none}) {
        const std::string text = signing_text(state);
        EXPECT_EQ(parse_signing_text(text), state);
        for (std::size_t size = 0; size < text.size(); ++size) {
            EXPECT_FALSE(parse_signing_text(text.substr(0, size))) << size;
        }
        for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
            std::string bad = text;
            bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
            EXPECT_FALSE(parse_signing_text(bad)) << bit;
        }
    }
    EXPECT_FALSE(parse_signing_text(with_checksum("key none\n")));
}

TEST(SigningStore, TheFileIsForItsOwnerAloneAlsoWhereALeftoverWasNot)
{
    const Scratch scratch;
    const std::string path = (scratch.path() / "state.signing").string();
    chmod(scratch.write("state.signing.new", "left behind by a power cut").c_str(), 0644);
    ASSERT_EQ(replace_file(path, signing_text(some_state()), FileAccess::owner_only), "");
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    EXPECT_EQ(slurp(path), signing_text(some_state()));
}

TEST(SigningStore, TheTimeStartsBeyondWhatWasStoredOrAtTheClock)
{
    const Scratch scratch;
    const std::string store = scratch.write("s", signing_text(some_state())).string();
    Complaints complaints;
    for (const std::uint64_t clock : {std::uint64_t{0}, kStoredTime, kStoredTime + 500'000'000}) {
        const auto state = load_signing("", store, clock, complaints);
        ASSERT_TRUE(state);
        EXPECT_EQ(state->key, counting_key());
        EXPECT_EQ(state->time, std::max(clock, kStoredTime + Signing::kRestartMargin));
    }
    EXPECT_GE(Signing::kRestartMargin, 6'000'000U) << "a minute at least";
    const auto fresh = load_signing("", (scratch.path() / "none").string(), 77, complaints);
    ASSERT_TRUE(fresh);
    EXPECT_FALSE(fresh->has_key);
    EXPECT_EQ(fresh->time, 77U);
    EXPECT_TRUE(complaints.empty()) << all_of(complaints);
}

TEST(SigningStore, AKeySetOverTheLinkCountsUntilTheKeyFileChanges)
{
    const Scratch scratch;
    Complaints complaints;
    const std::string file = write_key(scratch, "key", "passphrase one\n");
    const auto first = load_signing(file, "", 0, complaints);
    ASSERT_TRUE(first);
    EXPECT_NE(first->key, counting_key());
    SigningState rotated = *first;
    rotated.key = counting_key();
    const std::string store = scratch.write("s", signing_text(rotated)).string();
    EXPECT_EQ(load_signing(file, store, 0, complaints)->key, counting_key()) << "set over the link since";
    EXPECT_EQ(load_signing("", store, 0, complaints)->key, counting_key()) << "without the key file";
    static_cast<void>(write_key(scratch, "key", "passphrase two\n"));
    const auto changed = load_signing(file, store, 0, complaints);
    EXPECT_NE(changed->key, counting_key()) << "another key file wins";
    EXPECT_EQ(changed->time, Signing::kRestartMargin) << "and time goes on";
    SigningState off = *first;
    off.has_key = false;
    static_cast<void>(scratch.write("s", signing_text(off)));
    static_cast<void>(write_key(scratch, "key", "passphrase one\n"));
    EXPECT_FALSE(load_signing(file, store, 0, complaints)->has_key) << "signing was taken off over the link";
    EXPECT_TRUE(complaints.empty()) << all_of(complaints);
}

TEST(SigningStore, ADamagedStateStopsTheStartUnlessAKeyFileSaysWhatTheKeyIs)
{
    const Scratch scratch;
    Complaints complaints;
    const std::string store = scratch.write("s", "garbage").string();
    EXPECT_FALSE(load_signing("", store, 0, complaints));
    EXPECT_EQ(complaints.size(), 1U);
    const std::string file = write_key(scratch, "key", kHexKey);
    const auto state = load_signing(file, store, 5, complaints);
    ASSERT_TRUE(state);
    EXPECT_EQ(state->key, counting_key());
    EXPECT_FALSE(load_signing((scratch.path() / "none").string(), "", 0, complaints));
}

TEST(SigningStore, UnsignedFramesByName)
{
    link::mavlink::UnsignedFrames frames;
    EXPECT_TRUE(parse_unsigned_frames("none", frames));
    EXPECT_TRUE(!frames.all && frames.messages.empty());
    EXPECT_TRUE(parse_unsigned_frames("109,246", frames));
    EXPECT_EQ(frames.messages.size(), 2U);
    EXPECT_EQ(frames.messages[1], 246U);
    for (const char* bad : {"", ",", "1,", "1,,2", "-1", "1 ,2", "16777216", "x", "all,1", "1,2,3,4,5,6,7,8,9"}) {
        EXPECT_FALSE(parse_unsigned_frames(bad, frames)) << bad;
        EXPECT_EQ(frames.messages.size(), 2U) << "left as it was";
    }
    EXPECT_TRUE(parse_unsigned_frames("all", frames));
    EXPECT_TRUE(frames.all);
}

TEST(SigningStore, TheClockCountsFrom2015)
{
    EXPECT_EQ(signing_clock(0), 0U);
    EXPECT_EQ(signing_clock(1'420'070'400'000'000), 0U);
    EXPECT_EQ(signing_clock(1'420'070'401'000'000), 100'000U);
}

}  // namespace
}  // namespace jink::files
