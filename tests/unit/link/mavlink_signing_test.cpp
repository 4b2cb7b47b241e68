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

TEST(MavlinkSigning, SignedFramesAreRefusedWithoutAKey)
{
    Parser parser;
    Bytes stream = signed_frame(kNow);
    const Bytes next = frame_of(Heartbeat{});
    stream.insert(stream.end(), next.begin(), next.end());
    EXPECT_EQ(parse(parser, stream).size(), 1U);
    EXPECT_EQ(parser.diagnostics().signed_refused, 1U);
    EXPECT_EQ(parser.diagnostics().noise_bytes, 0U) << "the signature must not be searched for frames";
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
