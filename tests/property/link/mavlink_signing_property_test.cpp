// SPDX-License-Identifier: BSD-3-Clause
// Signed frames of every message: single bits flipped with a corrected checksum, and random orders of genuine, replayed
// and late frames against an independent record of senders and time stamps.
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <tuple>
#include <vector>

#include "firmware/link/mavlink/catalogue.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

constexpr std::uint64_t kSigningStart = 34'715'520'000'000;

std::uint64_t signing_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20261124;
}

Signing::Key property_key(unsigned char fill)
{
    Signing::Key key;
    key.fill(std::byte{fill});
    return key;
}

template <Message M>
Bytes signed_by(Signing& signing, const M& message, Header header = {1, 1, 0})
{
    Bytes frame(kMaxFrame);
    frame.resize(encode_signed(message, header, signing, frame));
    return frame;
}

/// As an attacker does: corrects the checksum after a change.
void repair_checksum(Bytes& frame)
{
    const std::uint32_t id = std::to_integer<std::uint32_t>(frame[7]) | std::to_integer<std::uint32_t>(frame[8]) << 8U |
                             std::to_integer<std::uint32_t>(frame[9]) << 16U;
    const MessageInfo* const info = find_message(id);
    if (info == nullptr) {
        return;
    }
    const std::size_t at = frame.size() - kSignatureSize - kChecksumSize;
    const std::uint16_t crc = reference_crc(std::span(frame).subspan(1, at - 1), info->crc_extra);
    frame[at] = static_cast<std::byte>(crc & 0xFFU);
    frame[at + 1] = static_cast<std::byte>(crc >> 8U);
}

TEST(MavlinkSigningLaws, NoFlippedBitOfASignedFrameIsAccepted)
{
    Random random(signing_seed());
    std::size_t flips = 0;
    std::uint32_t by_signature = 0;
    for_each_message([&]<class M>() {
        Signing sender(property_key(7), 1, kSigningStart);
        const Bytes good = signed_by(sender, random_message<M>(random));
        for (const bool repaired : {false, true}) {
            for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
                Bytes bad = good;
                bad[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
                if (repaired) {
                    repair_checksum(bad);
                }
                if (bad == good) {  // a bit of the checksum, repaired
                    continue;
                }
                Signing ours(property_key(7), 0, kSigningStart);
                Parser parser(&ours, LongerPayload::accept);
                const std::size_t found = parse(parser, bad, 1U << 20U, true).size();
                ASSERT_EQ(found, 0U) << M::kInfo.id << " bit " << bit << " JINK_SEED=" << signing_seed();
                ASSERT_EQ(ours.time(), kSigningStart) << "a forged time must not move ours";
                by_signature += parser.diagnostics().wrong_signature;
                ++flips;
            }
        }
        Signing ours(property_key(7), 0, kSigningStart);
        Parser parser(&ours);
        ASSERT_EQ(parse(parser, good).size(), 1U) << M::kInfo.id;
    });
    EXPECT_GT(by_signature, flips / 3) << "most repaired frames must get as far as the signature";
}

TEST(MavlinkSigningLaws, RandomOrdersOfFramesAgainstABookOfTimes)
{
    constexpr std::uint64_t kBehind = 6'000'000;
    for (std::uint64_t round = 0; round < 60; ++round) {
        const std::uint64_t seed = signing_seed() + round;
        Random random(seed);
        Signing ours(property_key(7), 0, kSigningStart);
        Parser parser(&ours);
        std::map<std::tuple<int, int, int>, std::uint64_t> book;
        std::uint64_t time = kSigningStart;
        std::vector<std::pair<Bytes, std::tuple<int, int, int>>> heard;
        std::vector<std::uint64_t> stamps;
        std::uint32_t refused = 0;
        for (int i = 0; i < 200; ++i) {
            Bytes frame;
            std::tuple<int, int, int> who;
            std::uint64_t stamp = 0;
            if (!heard.empty() && random.below(3) == 0) {  // played again
                const std::size_t which = random.below(static_cast<unsigned>(heard.size()));
                std::tie(frame, who) = heard[which];
                stamp = stamps[which];
            } else {
                who = {1 + static_cast<int>(random.below(2)), 1 + static_cast<int>(random.below(2)),
                       static_cast<int>(random.below(2))};
                const std::uint64_t spread = random.below(10) == 0 ? 3 * kBehind : 2000;
                stamp = time - spread + random.below(static_cast<unsigned>(2 * spread)) + 1;
                Signing sender(property_key(7), static_cast<std::uint8_t>(std::get<2>(who)), stamp - 1);
                frame = signed_by(
                    sender, Heartbeat{},
                    {static_cast<std::uint8_t>(std::get<0>(who)), static_cast<std::uint8_t>(std::get<1>(who)), 0});
            }
            const auto last = book.find(who);
            const bool expected = stamp + kBehind >= time && (last == book.end() || stamp > last->second);
            ASSERT_EQ(parse(parser, frame).size(), expected ? 1U : 0U) << "frame " << i << " JINK_SEED=" << seed;
            if (expected) {
                book[who] = stamp;
                time = std::max(time, stamp);
            } else {
                ++refused;
            }
            heard.emplace_back(frame, who);
            stamps.push_back(stamp);
            ASSERT_EQ(ours.time(), time);
        }
        ASSERT_EQ(parser.diagnostics().stale_signature, refused) << "JINK_SEED=" << seed;
        ASSERT_GT(refused, 20U);
    }
}

}  // namespace
}  // namespace jink::link::mavlink
