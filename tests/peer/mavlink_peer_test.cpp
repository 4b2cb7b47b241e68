// SPDX-License-Identifier: BSD-3-Clause
// Frames exchanged with node-mavlink (npm), an independent implementation: every field of every frame must be
// transferred unchanged. JINK_PEER_FRAMES sets the number per direction (20000). Exit code 77: the peer is not
// installed.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "tests/peer/peer_process.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using jink::test::PeerProcess;

const std::string kKeyHex(64, '7');

std::size_t frame_count()
{
    const char* const given = std::getenv("JINK_PEER_FRAMES");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20'000;
}

std::vector<std::string> peer(std::vector<std::string> arguments)
{
    arguments.insert(arguments.begin(), {"node", "peer.js"});
    return arguments;
}

Signing::Key key()
{
    Signing::Key k;
    k.fill(std::byte{0x77});
    return k;
}

/// The codec's data on one message, without its type.
struct Kind {
    MessageInfo info;
    std::span<const Field> fields;
    Bytes (*random_frame)(Random&, Header, unsigned version, Signing*, Bytes& payload);
};

template <Message M>
Bytes random_frame(Random& random, Header header, unsigned version, Signing* signing, Bytes& payload)
{
    payload = random_bytes(random, M::kInfo.max_length);
    if (random.below(3) == 0) {
        std::fill(payload.begin() + static_cast<std::ptrdiff_t>(random.below(payload.size())), payload.end(),
                  std::byte{0});
    }
    const M message = from_payload<M>(payload);
    Bytes out(kMaxFrame);
    if (version == 1) {
        std::fill(payload.begin() + M::kInfo.min_length, payload.end(), std::byte{0});  // v1 has no extensions
        out.resize(encode_legacy(message, header, out));
    } else {
        out.resize(signing != nullptr ? encode_signed(message, header, *signing, out) : encode(message, header, out));
    }
    return out;
}

std::map<std::uint32_t, Kind> our_messages()
{
    std::map<std::uint32_t, Kind> kinds;
    for_each_message([&]<class M>() { kinds[M::kInfo.id] = {M::kInfo, M::kFields, &random_frame<M>}; });
    return kinds;
}

std::uint64_t element_bits(const Bytes& payload, std::size_t offset, std::size_t size)
{
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
        bits |= std::to_integer<std::uint64_t>(payload[offset + i]) << (8 * i);
    }
    return bits;
}

struct PeerDefects {
    std::size_t quieted_nans = 0;
    std::size_t text_after_nul = 0;
};

std::string element_text(FieldType type, std::uint64_t bits, PeerDefects& defects)
{
    char text[32];
    switch (type) {
    case FieldType::f32:
        if ((bits & 0x7FC00000U) == 0x7F800000U &&
            (bits & 0x3FFFFFU) != 0) {  // signalling NaN: no such number in JavaScript
            bits |= 0x400000U;
            ++defects.quieted_nans;
        }
        std::snprintf(text, sizeof text, "%08llx", static_cast<unsigned long long>(bits));
        break;
    case FieldType::f64: std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(bits)); break;
    case FieldType::i8: return std::to_string(static_cast<std::int8_t>(bits));
    case FieldType::i16: return std::to_string(static_cast<std::int16_t>(bits));
    case FieldType::i32: return std::to_string(static_cast<std::int32_t>(bits));
    case FieldType::i64: return std::to_string(static_cast<std::int64_t>(bits));
    default: return std::to_string(bits);
    }
    return text;
}

/// The fields as peer.js prints them, read from the wire's bytes.
std::string fields_text(const Kind& kind, const Bytes& payload, PeerDefects& defects)
{
    std::string text;
    for (const Field& field : kind.fields) {
        const std::size_t size = element_size(field.type);
        text += ' ';
        if (field.type == FieldType::character) {
            const auto begin = payload.begin() + field.wire_offset;
            const auto nul = std::find(begin, begin + field.count, std::byte{0});
            defects.text_after_nul +=
                std::any_of(nul, begin + field.count, [](std::byte b) { return b != std::byte{0}; });
            text += 't';
            text += to_hex(Bytes(begin, nul));
            continue;
        }
        for (std::size_t e = 0; e < field.count; ++e) {
            text += e > 0 ? "," : "";
            text += element_text(field.type, element_bits(payload, field.wire_offset + e * size, size), defects);
        }
    }
    return text;
}

std::string line_of(unsigned version, Header h, const Kind& kind, const Bytes& payload, bool is_signed,
                    PeerDefects& defects)
{
    std::ostringstream line;
    line << version << ' ' << +h.sequence << ' ' << +h.system_id << ' ' << +h.component_id << ' ' << kind.info.id;
    line << fields_text(kind, payload, defects) << (is_signed ? " signed" : "");
    return line.str();
}

std::vector<std::string> lines(const std::string& text)
{
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        all.push_back(line);
    }
    return all;
}

struct PeerMessage {
    unsigned crc_extra, min_length, max_length;
    std::string name;
};

const std::map<std::uint32_t, PeerMessage>& peer_catalogue()
{
    static const std::map<std::uint32_t, PeerMessage> catalogue = [] {
        std::map<std::uint32_t, PeerMessage> all;
        PeerProcess process(peer({"catalogue"}), JINK_PEER_DIR);
        for (const std::string& line : lines(process.read_output())) {
            std::istringstream in(line);
            std::uint32_t id = 0;
            PeerMessage m;
            in >> id >> m.crc_extra >> m.min_length >> m.max_length >> m.name;
            all[id] = m;
        }
        EXPECT_EQ(process.wait(), 0);
        return all;
    }();
    return catalogue;
}

/// Messages that both sides know.
std::vector<Kind> shared_messages()
{
    std::vector<Kind> shared;
    for (const auto& [id, kind] : our_messages()) {
        if (peer_catalogue().contains(id)) {
            shared.push_back(kind);
        }
    }
    return shared;
}

TEST(MavlinkPeer, CataloguesAgree)
{
    const auto& theirs = peer_catalogue();
    ASSERT_GT(theirs.size(), 250U);
    std::set<std::uint32_t> only_ours;
    for (const auto& [id, kind] : our_messages()) {
        const auto their = theirs.find(id);
        if (their == theirs.end()) {
            only_ours.insert(id);
            continue;
        }
        EXPECT_EQ(kind.info.crc_extra, their->second.crc_extra) << id;
        EXPECT_EQ(kind.info.min_length, their->second.min_length) << id;
        EXPECT_EQ(kind.info.max_length, their->second.max_length) << id;
    }
    // newer than the peer: COMMAND_CANCEL, PROTOCOL_VERSION, ONBOARD_COMPUTER_STATUS, COMPONENT_METADATA, EVENT
    EXPECT_EQ(only_ours, (std::set<std::uint32_t>{80, 300, 390, 397, 410}));
    // the message of point clouds must be shared: it is exchanged below
    EXPECT_TRUE(theirs.contains(ObstacleDistance3d::kInfo.id));
    for (const auto& [id, their] : theirs) {
        const MessageInfo* const ours = find_message(id);
        ASSERT_NE(ours, nullptr) << their.name << " would not be recognised";
        EXPECT_EQ(ours->crc_extra, their.crc_extra) << their.name;
        EXPECT_EQ(ours->min_length, their.min_length) << their.name;
        EXPECT_GE(ours->max_length, their.max_length) << their.name;
    }
}

void we_send(unsigned version, bool sign, std::size_t count)
{
    std::vector<Kind> kinds;
    for (const Kind& kind : shared_messages()) {
        if (version == 2 || kind.info.id < 256) {
            kinds.push_back(kind);
        }
    }
    Random random(20260303 + version);
    Signing signing(key(), 9, 34'715'520'000'000);
    PeerDefects defects;
    Bytes stream;
    std::vector<std::string> expected;
    for (std::size_t i = 0; i < count; ++i) {
        const Kind& kind = kinds[random.below(kinds.size())];
        const Header header{static_cast<std::uint8_t>(random.below(256)), static_cast<std::uint8_t>(random.below(256)),
                            static_cast<std::uint8_t>(i)};
        Bytes payload;
        const Bytes frame = kind.random_frame(random, header, version, sign ? &signing : nullptr, payload);
        stream.insert(stream.end(), frame.begin(), frame.end());
        expected.push_back(line_of(version, header, kind, payload, sign, defects));
    }
    expected.push_back("end");

    PeerProcess process(peer({"decode", kKeyHex}), JINK_PEER_DIR);
    std::thread writer([&] {
        EXPECT_TRUE(process.send(stream));
        process.finish_sending();
    });
    const std::vector<std::string> printed = lines(process.read_output());
    writer.join();
    EXPECT_EQ(process.wait(), 0);
    ASSERT_EQ(printed.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(printed[i], expected[i]) << "frame " << i;
    }
    std::printf("we -> node v%u%s: %zu frames of %zu messages equal (known of the peer: %zu NaNs quieted, %zu texts "
                "cut at NUL)\n",
                version, sign ? " signed" : "", count, kinds.size(), defects.quieted_nans, defects.text_after_nul);
}

TEST(MavlinkPeer, ReadsOurFrames) { we_send(2, false, frame_count()); }
TEST(MavlinkPeer, ReadsOurLegacyFrames) { we_send(1, false, frame_count() / 4); }
TEST(MavlinkPeer, ReadsOurSignedFrames) { we_send(2, true, frame_count() / 4); }

void peer_sends(const std::string& mode, std::size_t count)
{
    std::map<std::uint32_t, Kind> kinds;
    std::string ids;
    for (const Kind& kind : shared_messages()) {
        // the peer's v1 frames carry extensions, which v1 does not have: excluded
        if (mode != "v1" || (kind.info.id < 256 && kind.info.min_length == kind.info.max_length)) {
            kinds[kind.info.id] = kind;
            ids += ids.empty() ? "" : ",";
            ids += std::to_string(kind.info.id);
        }
    }
    const bool sign = mode == "signed";
    Signing signing(key(), 0, 34'715'520'000'000 - 1);
    Parser parser(sign ? &signing : nullptr);
    PeerDefects defects;
    std::vector<std::string> decoded;

    PeerProcess process(peer({"encode", std::to_string(count), "4711", mode, ids, kKeyHex}), JINK_PEER_DIR);
    std::thread reader([&] {
        for (Bytes bytes = process.receive(); !bytes.empty(); bytes = process.receive()) {
            for (const Received& frame : parse(parser, bytes)) {
                const auto kind = kinds.find(frame.message_id);
                if (kind == kinds.end()) {
                    decoded.push_back("unexpected message " + std::to_string(frame.message_id));
                    continue;
                }
                decoded.push_back(
                    line_of(frame.version, frame.header, kind->second, frame.payload, frame.is_signed, defects));
            }
        }
        decoded.emplace_back("end");
    });
    const std::vector<std::string> printed = lines(process.read_output());
    reader.join();
    EXPECT_EQ(process.wait(), 0);
    ASSERT_EQ(printed.size(), count + 1);
    ASSERT_EQ(decoded.size(), printed.size());
    for (std::size_t i = 0; i < printed.size(); ++i) {
        ASSERT_EQ(decoded[i], printed[i]) << "frame " << i;
    }
    EXPECT_EQ(parser.diagnostics().noise_bytes, 0U);
    EXPECT_EQ(parser.diagnostics().accepted, count);
    std::printf("node -> we %s: %zu frames of %zu messages equal\n", mode.c_str(), count, kinds.size());
}

TEST(MavlinkPeer, WeReadItsFrames) { peer_sends("v2", frame_count()); }
TEST(MavlinkPeer, WeReadItsLegacyFrames) { peer_sends("v1", frame_count() / 4); }
TEST(MavlinkPeer, WeReadItsSignedFrames) { peer_sends("signed", frame_count() / 4); }

/// Why the peer cannot run; empty when it can.
std::string missing()
{
    if (!std::filesystem::exists(std::filesystem::path(JINK_PEER_DIR) / "node_modules" / "node-mavlink")) {
        return "node-mavlink is not installed (run tests/peer/setup.sh; needs npm)";
    }
    if (std::system("node --version > /dev/null 2>&1") != 0) {
        return "node is not installed";
    }
    return {};
}

}  // namespace
}  // namespace jink::link::mavlink

int main(int argc, char** argv)
{
    ::testing::InitGoogleTest(&argc, argv);
    if (const std::string reason = jink::link::mavlink::missing(); !reason.empty()) {
        std::printf("SKIPPED: the MAVLink codec was NOT tested against an independent peer: %s\n", reason.c_str());
        return 77;
    }
    return RUN_ALL_TESTS();
}
