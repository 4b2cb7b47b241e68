// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <string>

#include "firmware/link/mavlink/sha256.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

std::string sha256_hex(const std::string& text)
{
    Sha256 sha;
    sha.add(std::as_bytes(std::span(text)));
    return to_hex(sha.finish());
}

// FIPS 180-4 examples (NIST), and the lengths around the padding's edge as coreutils sha256sum gives them.
TEST(MavlinkSha256, KnownAnswers)
{
    EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sha256_hex(std::string(1'000'000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    EXPECT_EQ(sha256_hex(std::string(55, 'a')), "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
    EXPECT_EQ(sha256_hex(std::string(56, 'a')), "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
    EXPECT_EQ(sha256_hex(std::string(63, 'a')), "7d3e74a05d7db15bce4ad9ec0658ea98e3f06eeecf16b4c6fff2da457ddc2f34");
    EXPECT_EQ(sha256_hex(std::string(64, 'a')), "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
}

// python3 -c "import hashlib as l; h = l.sha256(); [h.update(l.sha256(bytes((7 * i + n) % 256 for i in
// range(n))).digest()) for n in range(301)]; print(h.hexdigest())"
TEST(MavlinkSha256, EveryLengthUpTo300AsPythonHasIt)
{
    Sha256 chain;
    for (unsigned n = 0; n <= 300; ++n) {
        Sha256 sha;
        for (unsigned i = 0; i < n; ++i) {
            const std::byte b{static_cast<std::uint8_t>(7 * i + n)};
            sha.add({&b, 1});
        }
        chain.add(sha.finish());
    }
    EXPECT_EQ(to_hex(chain.finish()), "60d63ff40b5558727a9b786ac0be9300f7ca58fd9ddd3b2f3681b369018a87dc");
}

constexpr std::uint64_t kNow = 34'715'520'000'000;
constexpr std::uint64_t kMinute = 6'000'000;

Signing::Key key_of(unsigned char fill)
{
    Signing::Key key;
    key.fill(std::byte{fill});
    return key;
}

/// A signed heartbeat; the frame carries time + 1.
Bytes signed_frame(std::uint64_t time, unsigned char key = 7, Header header = {1, 1, 0}, std::uint8_t link = 0)
{
    Signing signing(key_of(key), link, time);
    Bytes frame(kMaxFrame);
    frame.resize(encode_signed(Heartbeat{}, header, signing, frame));
    return frame;
}

struct Receiver {
    Signing signing{key_of(7), 0, kNow};
    Parser parser{&signing};
    std::size_t accepted(const Bytes& bytes) { return parse(parser, bytes).size(); }
};

TEST(MavlinkSigning, SignedFramesAreTakenUncheckedWithoutAKey)
{
    Signing none;
    for (Signing* const signing : {static_cast<Signing*>(nullptr), &none}) {
        Parser parser(signing);
        Bytes stream = signed_frame(kNow);
        const Bytes next = frame_of(Heartbeat{});
        stream.insert(stream.end(), next.begin(), next.end());
        EXPECT_EQ(parse(parser, stream).size(), 2U);
        EXPECT_EQ(parser.diagnostics().signed_unchecked, 1U);
        EXPECT_EQ(parser.diagnostics().noise_bytes, 0U) << "the signature must not be searched for frames";
    }
    EXPECT_EQ(none.time(), 0U) << "a time that nobody has checked";
}

TEST(MavlinkSigning, NoUnsignedMessageIsTakenByDefaultWhenAKeyIsSet)
{
    Random random(3);
    Receiver receiver;
    std::uint32_t sent = 0;
    for_each_message([&]<class M>() {
        EXPECT_EQ(receiver.accepted(frame_of(random_message<M>(random))), 0U) << M::kInfo.id;
        ++sent;
        if (M::kInfo.id < 256) {
            EXPECT_EQ(receiver.accepted(legacy_frame_of(random_message<M>(random))), 0U) << M::kInfo.id;
            ++sent;
        }
    });
    EXPECT_EQ(receiver.parser.diagnostics().unsigned_refused, sent);
    EXPECT_EQ(receiver.parser.diagnostics().unsigned_taken, 0U);
}

TEST(MavlinkSigning, UnsignedFramesAreTakenWhereSaid)
{
    Receiver receiver;
    UnsignedFrames frames;
    ASSERT_TRUE(frames.messages.try_push_back(AdsbVehicle::kInfo.id));
    receiver.signing.take_unsigned(frames);
    EXPECT_EQ(receiver.accepted(frame_of(AdsbVehicle{})), 1U);
    EXPECT_EQ(receiver.accepted(frame_of(Heartbeat{})), 0U);
    const Bytes wrong = signed_frame(kNow, 8);
    EXPECT_EQ(receiver.accepted(wrong), 0U);
    frames.all = true;
    receiver.signing.take_unsigned(frames);
    EXPECT_EQ(receiver.accepted(frame_of(Heartbeat{})), 1U);
    EXPECT_EQ(receiver.accepted(wrong), 0U) << "a wrong signature is worse than none";
    EXPECT_EQ(receiver.parser.diagnostics().unsigned_taken, 2U);
    EXPECT_EQ(receiver.parser.diagnostics().wrong_signature, 2U);
}

TEST(MavlinkSigning, AnotherKeyTakesTheOldOnesPlaceAndReplaysStayReplays)
{
    Receiver receiver;
    const Bytes first = signed_frame(kNow + 10);
    EXPECT_EQ(receiver.accepted(first), 1U);
    receiver.signing.set_key(key_of(8), 0);
    EXPECT_EQ(receiver.signing.time(), kNow + 11) << "an earlier time is ignored";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 20)), 0U) << "the old key";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 20, 8)), 1U);
    receiver.signing.set_key(key_of(7), 0);
    EXPECT_EQ(receiver.accepted(first), 0U) << "heard before the key was changed there and back";
    receiver.signing.remove_key();
    EXPECT_FALSE(receiver.signing.has_key());
    EXPECT_EQ(receiver.accepted(frame_of(Heartbeat{})), 1U);
    EXPECT_EQ(receiver.signing.generation(), 3U);
}

TEST(MavlinkSigning, TimeFollowsTheClockButNeverBack)
{
    Signing signing(key_of(7), 0, kNow);
    signing.follow_clock(5'000'000);
    EXPECT_EQ(signing.time(), kNow);
    signing.follow_clock(35'000'000);
    EXPECT_EQ(signing.time(), kNow + 3'000'000) << "30 s";
    signing.follow_clock(1'000'000);
    EXPECT_EQ(signing.time(), kNow + 3'000'000);
    signing.advance_to(kNow + kMinute);
    signing.follow_clock(36'000'000);
    EXPECT_EQ(signing.time(), kNow + kMinute) << "a peer was ahead of our clock";
}

/// 30 s of frames at 50 Hz, the longest that stays unstored.
template <class F>
void for_one_store_step(F each)
{
    for (std::int64_t us = 20'000; us <= 30'000'000; us += 20'000) {
        each(us);
    }
}

TEST(MavlinkSigning, ARestartBeforeTheNextStoreSignsWithNewerTimes)
{
    Signing before(key_of(7), 0, kNow);
    before.follow_clock(0);
    const std::uint64_t stored = before.time();
    Receiver peer;
    Bytes out;
    const auto say = [&](Signing& signing) {
        out.resize(kMaxFrame);
        out.resize(encode_signed(Heartbeat{}, {1, 196, 0}, signing, out));
        return peer.accepted(out);
    };
    for_one_store_step([&](std::int64_t us) {
        before.follow_clock(us);
        ASSERT_EQ(say(before), 1U);
    });
    Signing after(key_of(7), 0, stored + Signing::kRestartMargin);
    EXPECT_EQ(say(after), 1U);
    EXPECT_EQ(say(before), 0U) << "the peer tells old from new";
}

TEST(MavlinkSigning, NothingHeardBeforeARestartIsTakenAfterIt)
{
    // A receiver that restarts has no memory of its senders: the margin alone must refuse all that it had heard.
    Receiver before;
    before.signing.follow_clock(0);
    const std::uint64_t stored = before.signing.time();
    std::vector<Bytes> heard;
    for_one_store_step([&](std::int64_t us) {
        before.signing.follow_clock(us);
        heard.push_back(signed_frame(kNow + static_cast<std::uint64_t>(us) / 10));
        ASSERT_EQ(before.accepted(heard.back()), 1U);
    });
    Receiver after;
    after.signing.advance_to(stored + Signing::kRestartMargin);
    for (const Bytes& frame : heard) {
        ASSERT_EQ(after.accepted(frame), 0U);
    }
    // The sender receives our frame, continues from its time stamp, and is accepted again.
    EXPECT_EQ(after.accepted(signed_frame(after.signing.time())), 1U);
}

TEST(MavlinkSigning, TheValueOf48OnesIsNeverPassed)
{
    Signing signing(key_of(7), 0, Signing::kLatestTime - 1);
    Bytes out(kMaxFrame);
    for (int i = 0; i < 3; ++i) {
        EXPECT_GT(encode_signed(Heartbeat{}, {1, 1, 0}, signing, out), 0U);
        EXPECT_EQ(signing.time(), Signing::kLatestTime) << "after a wrap every peer would take us for a replay";
    }
    signing.advance_to(~std::uint64_t{0});
    EXPECT_EQ(signing.time(), Signing::kLatestTime);
}

TEST(MavlinkSigning, UnsignedFramesAreRefusedWithAKey)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(frame_of(Heartbeat{})), 0U);
    EXPECT_EQ(receiver.accepted(legacy_frame_of(Heartbeat{})), 0U);
    EXPECT_EQ(receiver.parser.diagnostics().unsigned_refused, 2U);
}

TEST(MavlinkSigning, WrongKeyAndEveryFlippedBitOfTheSignature)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow, 8)), 0U);
    EXPECT_EQ(receiver.parser.diagnostics().wrong_signature, 1U);
    const Bytes good = signed_frame(kNow);
    for (std::size_t bit = 0; bit < 8 * kSignatureSize; ++bit) {
        Bytes bad = good;
        bad[good.size() - kSignatureSize + bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        EXPECT_EQ(receiver.accepted(bad), 0U) << bit;
        EXPECT_EQ(receiver.parser.diagnostics().wrong_signature, 2U + bit);
    }
    EXPECT_EQ(receiver.accepted(good), 1U);
}

TEST(MavlinkSigning, ReplaysAreStale)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow)), 1U);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow)), 0U) << "same time again";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow - 1)), 0U) << "older";
    EXPECT_EQ(receiver.parser.diagnostics().stale_signature, 2U);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 1)), 1U);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow, 7, {1, 2, 0})), 1U) << "another component has a time of its own";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow, 7, {2, 1, 0})), 1U) << "another system";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow, 7, {1, 1, 0}, 1)), 1U) << "another link";
}

TEST(MavlinkSigning, AMinuteBehindIsStale)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow - kMinute - 2)), 0U);
    EXPECT_EQ(receiver.parser.diagnostics().stale_signature, 1U);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow - kMinute - 1)), 1U) << "exactly a minute";
}

TEST(MavlinkSigning, ADeadStreamDoesNotComeBackWhenTimeHasGoneOn)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow)), 1U);
    receiver.signing.advance_to(kNow + 2 * kMinute);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 5)), 0U);
    receiver.signing.advance_to(kNow);
    EXPECT_EQ(receiver.signing.time(), kNow + 2 * kMinute) << "time must not go back";
}

TEST(MavlinkSigning, TimeFollowsAPeerThatIsAheadAndRisesWithEachFrameSigned)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 1000)), 1U);
    EXPECT_EQ(receiver.signing.time(), kNow + 1001);
    Bytes out(kMaxFrame);
    EXPECT_GT(encode_signed(Heartbeat{}, {1, 1, 0}, receiver.signing, out), 0U);
    EXPECT_EQ(receiver.signing.time(), kNow + 1002);
}

TEST(MavlinkSigning, AForgedTimeDoesNotMoveOurs)
{
    Receiver receiver;
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 1'000'000'000, 8)), 0U);
    EXPECT_EQ(receiver.signing.time(), kNow);
}

TEST(MavlinkSigning, FurtherStreamsAreRefusedWhenTheTableIsFull)
{
    Receiver receiver;
    for (std::uint8_t system = 1; system <= kMaxSignedStreams; ++system) {
        EXPECT_EQ(receiver.accepted(signed_frame(kNow, 7, {system, 1, 0})), 1U);
    }
    EXPECT_EQ(receiver.accepted(signed_frame(kNow, 7, {kMaxSignedStreams + 1, 1, 0})), 0U);
    EXPECT_EQ(receiver.parser.diagnostics().signature_streams, 1U);
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + 1, 7, {1, 1, 0})), 1U) << "known ones go on";
}

TEST(MavlinkSigning, AFullTableGivesUpASenderWhoseFramesAreStaleAnyway)
{
    Receiver receiver;
    const Bytes first = signed_frame(kNow, 7, {1, 1, 0});
    EXPECT_EQ(receiver.accepted(first), 1U);
    receiver.signing.advance_to(kNow + kMinute + 2);
    for (unsigned system = 2; system <= kMaxSignedStreams + 1; ++system) {
        const Header header{static_cast<std::uint8_t>(system), 1, 0};
        EXPECT_EQ(receiver.accepted(signed_frame(kNow + kMinute, 7, header)), 1U) << system;
    }
    EXPECT_EQ(receiver.parser.diagnostics().signature_streams, 0U);
    EXPECT_EQ(receiver.accepted(first), 0U) << "forgotten, and stale all the same";
    EXPECT_EQ(receiver.accepted(signed_frame(kNow + kMinute, 7, {1, 1, 0})), 0U) << "no place free";
    EXPECT_EQ(receiver.parser.diagnostics().signature_streams, 1U);
}

TEST(MavlinkSigning, EveryMessageSurvivesSigning)
{
    Random random(11);
    Signing sender(key_of(7), 5, kNow);
    Receiver receiver;
    for_each_message([&]<class M>() {
        const M message = random_message<M>(random);
        Bytes out(kMaxFrame);
        out.resize(encode_signed(message, {1, 1, 0}, sender, out));
        const auto frames = parse(receiver.parser, out, 3);
        ASSERT_EQ(frames.size(), 1U) << M::kInfo.id;
        M decoded;
        ASSERT_TRUE(decode(frames[0].frame(), decoded));
        EXPECT_EQ(payload_of(decoded), payload_of(message));
    });
}

}  // namespace
}  // namespace jink::link::mavlink
