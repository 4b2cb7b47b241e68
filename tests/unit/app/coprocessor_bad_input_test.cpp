// SPDX-License-Identifier: BSD-3-Clause
// Bad frames at Coprocessor::step, through the ports of hal/memory, one test for each kind and in it every message: no
// crash, nothing endless, the next good frame found, every refusal counted. The parser alone: property_link
// MavlinkDamage.*.
#include <bit>
#include <cmath>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "firmware/app/coprocessor.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "hal/memory/memory_serial_link.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/link/endpoint_tools.hpp"

namespace jink::app {
namespace {

using namespace link::mavlink;
using namespace link::mavlink::test;

class BadInput : public ::testing::Test {
protected:
    void SetUp() override { restart(nullptr); }

    void restart(Signing* signing)
    {
        EndpointOptions options;
        options.system_id = kSystem;
        endpoint = std::make_unique<Endpoint>(options, signing);
        Parameters parameters;
        EXPECT_EQ(parameters.set(Param::ask_rates, 0.0F), ParamStatus::ok);
        coprocessor = std::make_unique<Coprocessor>(*endpoint, line->a(), watchdog, parameters);
        ears = Parser();
    }

    void arrive(const Bytes& bytes)
    {
        ASSERT_EQ(line->b().write(bytes), bytes.size()) << "the test's own line is full";
        sent += bytes.size();
    }

    /// One tick; appends the output to `heard`.
    void step()
    {
        clock.advance(20'000);
        report = coprocessor->step({clock.now_us()});
        ASSERT_LE(report.bytes_in, Coprocessor::kMaxBytesPerStep);
        ASSERT_EQ(report.faults & static_cast<std::uint16_t>(Fault::not_finite), 0);
        ASSERT_FALSE(report.setpoint_sent);
        std::array<std::byte, 4096> bytes{};
        const std::size_t n = line->b().read(bytes);
        heard = parse(ears, std::span(bytes).first(n));
        ASSERT_LE(endpoint->parser_diagnostics().checksum_bytes, (kMaxFrame - 1) * sent) << "bounded work";
    }

    /// A good frame after any input is found and answered, at once or after the silence that ends a cut frame.
    void expect_next_good_frame(const std::string& after)
    {
        ParamRequestRead ask;
        ask.param_index = 3;
        ask.target_system = kSystem;
        ask.target_component = kUs;
        arrive(signer ? signed_bytes(ask) : frame_of(ask, {kSystem, 190, sequence++}));
        for (int i = 0; i < 10; ++i) {
            step();
            const auto answers = all_of<ParamValue>(heard);
            if (std::any_of(answers.begin(), answers.end(), [](const ParamValue& m) { return m.param_index == 3; })) {
                return;
            }
        }
        FAIL() << "good frame lost after " << after;
    }

    template <Message M>
    Bytes signed_bytes(const M& message)
    {
        Bytes bytes(kMaxFrame);
        bytes.resize(encode_signed(message, {kSystem, 190, sequence++}, *signer, bytes));
        return bytes;
    }

    /// For every message, `damage(frame)` applied to a random one: `counter` of the parser grows, and the next is
    /// found.
    template <class Damage>
    void each_is_refused(std::uint32_t ParserDiagnostics::*counter, Damage damage)
    {
        for_each_message([&]<class M>() {
            const std::uint32_t before = endpoint->parser_diagnostics().*counter;
            arrive(damage(M::kInfo, frame_of(random_message<M>(random), {kSystem, kAutopilot, sequence++})));
            expect_next_good_frame("message " + std::to_string(M::kInfo.id));
            EXPECT_GT(endpoint->parser_diagnostics().*counter, before) << M::kInfo.id;
        });
    }

    hal::ManualClock clock{10'000'000};
    std::unique_ptr<hal::MemorySerialLink> line = std::make_unique<hal::MemorySerialLink>(clock, 1);
    hal::CountingWatchdog watchdog;
    std::unique_ptr<Endpoint> endpoint;
    std::unique_ptr<Coprocessor> coprocessor;
    std::optional<Signing> signer;
    Parser ears;
    Random random{2026};
    StepReport report;
    std::vector<Received> heard;
    std::size_t sent = 0;
    std::uint8_t sequence = 0;
};

TEST_F(BadInput, WrongStartByte)
{
    each_is_refused(&ParserDiagnostics::noise_bytes, [](const MessageInfo&, Bytes frame) {
        frame[0] = std::byte{0x55};
        return frame;
    });
}

TEST_F(BadInput, WrongLength)
{
    for (const unsigned length : {0U, 1U, 254U, 255U}) {
        each_is_refused(&ParserDiagnostics::noise_bytes, [length](const MessageInfo&, Bytes frame) {
            const bool same = std::to_integer<unsigned>(frame[1]) == length;
            frame[1] = static_cast<std::byte>(same ? length ^ 2U : length);
            return frame;
        });
    }
}

TEST_F(BadInput, LengthBeyondTheMessageInAnOldFrame)
{
    each_is_refused(&ParserDiagnostics::too_long, [this](const MessageInfo& info, const Bytes&) {
        RawFrame raw{1, 0, 0, {kSystem, kAutopilot, 0}, info.id & 0xFFU, random_bytes(random, 255), info.crc_extra};
        raw.id = info.id < 256 ? info.id : 0;
        return raw.bytes();
    });
}

TEST_F(BadInput, LengthBeyondTheMessageInANewFrameIsALaterRevision)
{
    for_each_message([&]<class M>() {
        if (M::kInfo.max_length > 250 || M::kInfo.id == Timesync::kInfo.id) {
            return;
        }
        const std::uint32_t before = endpoint->parser_diagnostics().accepted;
        Bytes payload = random_bytes(random, M::kInfo.max_length + 4U);
        payload.back() = std::byte{1};
        const RawFrame raw{2, 0, 0, {kSystem, 99, sequence++}, M::kInfo.id, payload, M::kInfo.crc_extra};
        arrive(raw.bytes());
        expect_next_good_frame("message " + std::to_string(M::kInfo.id));
        EXPECT_EQ(endpoint->parser_diagnostics().accepted, before + 2) << M::kInfo.id;
    });
}

TEST_F(BadInput, UnknownId)
{
    each_is_refused(&ParserDiagnostics::unknown_message, [](const MessageInfo&, Bytes frame) {
        frame[7] = std::byte{0xDE};
        frame[8] = std::byte{0xBC};
        frame[9] = std::byte{0x8A};
        return frame;
    });
}

TEST_F(BadInput, UnknownIncompatibleFlag)
{
    each_is_refused(&ParserDiagnostics::incompatible_flags, [this](const MessageInfo& info, const Bytes&) {
        return RawFrame{
            2, 0x80, 0, {kSystem, kAutopilot, 0}, info.id, random_bytes(random, info.max_length), info.crc_extra}
            .bytes();
    });
}

TEST_F(BadInput, OldFrameOfAnIdThatOnlyTheNewVersionHas)
{
    each_is_refused(&ParserDiagnostics::noise_bytes, [this](const MessageInfo& info, const Bytes&) {
        RawFrame raw{1, 0, 0, {kSystem, kAutopilot, 0}, info.id, random_bytes(random, info.min_length), 0};
        raw.crc_extra = static_cast<std::uint8_t>(info.crc_extra + 1U + (info.id < 256 ? 0U : 1U));
        return raw.bytes();
    });
}

TEST_F(BadInput, CutAtEveryByte)
{
    for_each_message([&]<class M>() {
        const Bytes frame = frame_of(random_message<M>(random), {kSystem, kAutopilot, sequence++});
        for (std::size_t n = 1; n < frame.size(); ++n) {
            const std::uint32_t before = endpoint->parser_diagnostics().noise_bytes;
            arrive(Bytes(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n)));
            expect_next_good_frame("message " + std::to_string(M::kInfo.id) + " cut at " + std::to_string(n));
            ASSERT_GT(endpoint->parser_diagnostics().noise_bytes, before);
        }
    });
}

TEST_F(BadInput, TwoFramesGlued)
{
    for_each_message([&]<class M>() {
        const std::uint32_t before = endpoint->diagnostics().frames_in;
        Bytes glued = frame_of(random_message<M>(random), {kSystem, 99, sequence++});
        const Bytes second = frame_of(random_message<M>(random), {kSystem, 99, sequence++});
        glued.insert(glued.end(), second.begin(), second.end());
        arrive(glued);
        expect_next_good_frame("message " + std::to_string(M::kInfo.id));
        EXPECT_EQ(endpoint->diagnostics().frames_in, before + 3) << M::kInfo.id;
    });
}

TEST_F(BadInput, NoiseWithFalseStartBytes)
{
    for (int i = 0; i < 300; ++i) {
        Bytes noise = random_bytes(random, 1 + random.below(600));
        for (std::byte& b : noise) {
            b = random.below(8) == 0 ? (random.below(2) == 0 ? std::byte{0xFD} : std::byte{0xFE}) : b;
        }
        const std::uint32_t before = endpoint->parser_diagnostics().noise_bytes;
        arrive(noise);
        expect_next_good_frame("noise " + std::to_string(i));
        ASSERT_GT(endpoint->parser_diagnostics().noise_bytes, before);
    }
}

TEST_F(BadInput, DuplicatedSequenceNumber)
{
    for_each_message([&]<class M>() {
        const std::uint32_t before = endpoint->parser_diagnostics().repeated;
        const Bytes frame = frame_of(random_message<M>(random), {kSystem, 99, 77});
        arrive(frame);
        arrive(frame);
        expect_next_good_frame("message " + std::to_string(M::kInfo.id));
        EXPECT_GT(endpoint->parser_diagnostics().repeated, before) << M::kInfo.id;
    });
}

TEST_F(BadInput, SystemZero)
{
    for_each_message([&]<class M>() {
        const auto before = endpoint->diagnostics();
        const auto steps = coprocessor->diagnostics();
        arrive(frame_of(random_message<M>(random), {0, kAutopilot, sequence++}));
        expect_next_good_frame("message " + std::to_string(M::kInfo.id));
        EXPECT_EQ(endpoint->diagnostics().frames_in, before.frames_in + 2);
        EXPECT_EQ(coprocessor->diagnostics().own_states, steps.own_states) << M::kInfo.id;
        const bool for_anyone = M::kInfo.id == CommandLong::kInfo.id || M::kInfo.id == ParamSet::kInfo.id ||
                                M::kInfo.id == ParamRequestRead::kInfo.id || M::kInfo.id == ParamRequestList::kInfo.id;
        EXPECT_TRUE(for_anyone || endpoint->diagnostics().frames_ignored > before.frames_ignored) << M::kInfo.id;
    });
    EXPECT_EQ(report.faults & static_cast<std::uint16_t>(Fault::no_autopilot),
              static_cast<std::uint16_t>(Fault::no_autopilot));
}

TEST_F(BadInput, SignedWhileNoKeyIsSet)
{
    signer.emplace(Signing::Key{}, std::uint8_t{1}, std::uint64_t{1} << 40U);
    for_each_message([&]<class M>() {
        const std::uint32_t before = endpoint->parser_diagnostics().signed_unchecked;
        arrive(signed_bytes(random_message<M>(random)));
        std::optional<Signing> kept;
        std::swap(kept, signer);
        expect_next_good_frame("message " + std::to_string(M::kInfo.id));
        std::swap(kept, signer);
        EXPECT_EQ(endpoint->parser_diagnostics().signed_unchecked, before + 1) << M::kInfo.id;
    });
}

TEST_F(BadInput, UnsignedWrongAndStaleSignaturesWhenSigningIsOn)
{
    Signing ours(Signing::Key{}, 1, std::uint64_t{1} << 40U);
    restart(&ours);
    signer.emplace(Signing::Key{}, std::uint8_t{1}, std::uint64_t{1} << 40U);
    for_each_message([&]<class M>() {
        const ParserDiagnostics before = endpoint->parser_diagnostics();
        const Bytes good = signed_bytes(random_message<M>(random));
        Bytes wrong = good;
        wrong.back() ^= std::byte{1};
        arrive(frame_of(random_message<M>(random), {kSystem, 190, sequence++}));
        arrive(wrong);
        arrive(good);
        arrive(good);  // played again
        ears = Parser(nullptr);
        for (int i = 0; i < 3; ++i) {
            step();
        }
        const ParserDiagnostics& after = endpoint->parser_diagnostics();
        EXPECT_EQ(after.unsigned_refused, before.unsigned_refused + 1) << M::kInfo.id;
        EXPECT_EQ(after.wrong_signature, before.wrong_signature + 1) << M::kInfo.id;
        EXPECT_EQ(after.stale_signature, before.stale_signature + 1) << M::kInfo.id;
        EXPECT_EQ(after.accepted, before.accepted + 1) << M::kInfo.id;
        EXPECT_EQ(endpoint->diagnostics().frames_refused >= 3, true);
    });
}

TEST_F(BadInput, WrongCrcExtra)
{
    each_is_refused(&ParserDiagnostics::bad_checksum, [this](const MessageInfo& info, const Bytes&) {
        return RawFrame{2,
                        0,
                        0,
                        {kSystem, kAutopilot, 0},
                        info.id,
                        random_bytes(random, info.max_length),
                        static_cast<std::uint8_t>(info.crc_extra ^ 0x10U)}
            .bytes();
    });
}

TEST_F(BadInput, NoNumberInfinityDenormalAndHugeInEveryFloat)
{
    arrive(frame_of(heartbeat(), {kSystem, kAutopilot, sequence++}));
    for_each_message([&]<class M>() {
        for (const Field& field : M::kFields) {
            if (field.type != FieldType::f32) {
                continue;
            }
            for (unsigned k = 0; k < field.count; ++k) {
                for (const float poison : {kNan, kInfinity, -kInfinity, 1e-42F, -1e-42F, 3e38F, -3e38F}) {
                    Bytes payload(M::kInfo.max_length);
                    const auto bits = std::bit_cast<std::uint32_t>(poison);
                    for (std::size_t b = 0; b < 4; ++b) {
                        payload.at(field.wire_offset + 4U * k + b) = static_cast<std::byte>(bits >> (8U * b) & 0xFFU);
                    }
                    arrive(frame_of(from_payload<M>(payload), {kSystem, kAutopilot, sequence++}));
                    step();
                    ASSERT_TRUE(is_finite(coprocessor->own().position)) << M::kInfo.id;
                    ASSERT_TRUE(is_finite(coprocessor->own().velocity)) << M::kInfo.id;
                    ASSERT_TRUE(std::isfinite(coprocessor->own().yaw)) << M::kInfo.id;
                    ASSERT_TRUE(is_finite(report.guidance.velocity)) << M::kInfo.id;
                }
            }
        }
    });
    expect_next_good_frame("all of them");
    EXPECT_GT(endpoint->diagnostics().not_finite, 50U);
    EXPECT_GT(endpoint->diagnostics().out_of_range, 10U);
}

class BadRanges : public BadInput {
protected:
    void SetUp() override
    {
        BadInput::SetUp();
        arrive(frame_of(heartbeat(), {kSystem, kAutopilot, sequence++}));
        step();
        arrive(frame_of(local_position(boot_ms(), Vec3(0, 0, 50)), {kSystem, kAutopilot, sequence++}));
        arrive(frame_of(attitude(boot_ms(), 0.0F), {kSystem, kAutopilot, sequence++}));
        step();
        ASSERT_EQ(report.faults, 0);
    }
    [[nodiscard]] std::uint32_t boot_ms() const { return 1000 + static_cast<std::uint32_t>(clock_ms_++) * 20; }
    /// Obstacles after a scan whose sectors all say `distance`.
    std::uint16_t see(std::uint16_t distance, std::uint8_t increment, float increment_f = 0.0F)
    {
        ObstacleDistance m;
        m.distances.fill(distance);
        m.min_distance = 20;
        m.max_distance = 4000;
        m.increment = increment;
        m.increment_f = increment_f;
        arrive(frame_of(m, {kSystem, 100, sequence++}));
        step();
        return report.obstacles;
    }
    mutable int clock_ms_ = 0;
};

TEST_F(BadRanges, ZeroIncrementIsRefused)
{
    EXPECT_EQ(see(1000, 0), 0);
    EXPECT_EQ(endpoint->diagnostics().out_of_range, 1U);
    expect_next_good_frame("it");
}

TEST_F(BadRanges, NegativeIncrementTurnsTheOtherWay)
{
    EXPECT_EQ(see(1000, 0, -5.0F), 72);
    EXPECT_EQ(endpoint->diagnostics().out_of_range, 0U);
    expect_next_good_frame("it");
}

TEST_F(BadRanges, UnknownZeroAndBeyondTheGreatestDistance)
{
    EXPECT_EQ(see(65535, 5), 0) << "unknown";
    EXPECT_EQ(see(4001, 5), 0) << "nothing there";
    EXPECT_EQ(see(0, 5), 72) << "touching, not absent";
    EXPECT_EQ(see(65535, 5), 72) << "unknown changes nothing";
    EXPECT_EQ(see(4001, 5), 0);
    EXPECT_EQ(see(4000, 5), 72) << "the greatest distance is one";
    expect_next_good_frame("them");
}

}  // namespace
}  // namespace jink::app
