// SPDX-License-Identifier: BSD-3-Clause
// Each cause for which a frame leads to nothing, repetitions, and every pool at N - 1, N and N + 1.
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

constexpr std::array kWanted{LogMessage::kType, NodeStatus::kType, Allocation::kType, GetNodeInfoRequest::kType,
                             GetSetRequest::kType};

std::vector<Frame> log_frames(std::uint8_t source, std::uint8_t transfer, std::size_t length = 40)
{
    return frames_of(TransferHead{LogMessage::kType, Priority::medium, source, 0, transfer},
                     long_payload(source, length));
}

class DronecanReceiver : public testing::Test {
protected:
    /// Feeds frames; how many transfers came of them.
    int feed(const std::vector<Frame>& frames)
    {
        int transfers = 0;
        for (const Frame& frame : frames) {
            transfers += take(frame) != nullptr ? 1 : 0;
        }
        return transfers;
    }
    const Transfer* take(const Frame& frame) { return receiver.accept(frame, now); }
    const ReceiverDiagnostics& seen() { return receiver.diagnostics(); }

    Receiver receiver{kWanted};
    TimePoint now{5'000'000};
};

TEST_F(DronecanReceiver, PutsALongTransferTogether)
{
    const std::vector<Frame> frames = log_frames(9, 3);
    ASSERT_EQ(frames.size(), 6U);
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
        EXPECT_EQ(take(frames[i]), nullptr);
        now = now + 0.3F;
    }
    const Transfer* const transfer = take(frames.back());
    ASSERT_NE(transfer, nullptr);
    EXPECT_EQ(transfer->source, 9);
    EXPECT_EQ(transfer->transfer, 3);
    EXPECT_EQ(transfer->stamp, TimePoint{5'000'000});  // of the first frame
    EXPECT_EQ(to_hex(transfer->payload), to_hex(long_payload(9)));
}

TEST_F(DronecanReceiver, EveryLengthArrives)
{
    std::uint8_t id = 0;
    for (std::size_t length = 0; length <= LogMessage::kType.max_length; ++length) {
        const std::vector<Frame> frames = log_frames(5, id, length);
        id = static_cast<std::uint8_t>((id + 1U) % kTransferIds);
        const Transfer* transfer = nullptr;
        for (const Frame& frame : frames) {
            transfer = take(frame);
        }
        ASSERT_NE(transfer, nullptr) << length;
        EXPECT_EQ(to_hex(transfer->payload), to_hex(long_payload(5, length)));
        now = now + 0.01F;
    }
}

TEST_F(DronecanReceiver, ForeignFramesAreRefusedEachByItsCause)
{
    Frame frame = log_frames(9, 0, 5)[0];
    Frame bad = frame;
    bad.extended = false;
    EXPECT_EQ(take(bad), nullptr);
    EXPECT_EQ(seen().standard_id, 1U);
    bad = frame;
    bad.remote = true;
    EXPECT_EQ(take(bad), nullptr);
    EXPECT_EQ(seen().remote, 1U);
    bad = frame;
    bad.length = 0;
    EXPECT_EQ(take(bad), nullptr);
    bad.length = 9;
    EXPECT_EQ(take(bad), nullptr);
    bad.length = 64;
    EXPECT_EQ(take(bad), nullptr);
    EXPECT_EQ(seen().bad_length, 3U);
    bad = frame;
    bad.id |= 0x20000000;
    EXPECT_EQ(take(bad), nullptr);
    EXPECT_EQ(seen().bad_id, 1U);
    EXPECT_NE(take(frame), nullptr);
    EXPECT_EQ(seen().frames, 7U);
}

TEST_F(DronecanReceiver, ServicesAreTakenForOurNodeOnly)
{
    const auto request = [](std::uint8_t from, std::uint8_t to) {
        return frames_of(GetNodeInfoRequest{}, from, 0, Priority::medium, to)[0];
    };
    EXPECT_EQ(take(request(9, 42)), nullptr);  // no id yet
    receiver.set_node(42);
    EXPECT_EQ(take(request(9, 43)), nullptr);
    EXPECT_EQ(seen().ignored, 2U);
    EXPECT_NE(take(request(9, 42)), nullptr);

    Frame nobody = request(9, 42);
    nobody.id = pack(FrameId{TransferKind::request, 16, 1, 0, 42, 0});
    EXPECT_EQ(take(nobody), nullptr);
    nobody.id = pack(FrameId{TransferKind::request, 16, 1, 9, 0, 0});
    EXPECT_EQ(take(nobody), nullptr);
    EXPECT_EQ(seen().bad_id, 2U);

    Frame response = request(9, 42);
    response.id = pack(FrameId{TransferKind::response, 16, 1, 9, 42, 0});
    EXPECT_EQ(take(response), nullptr);
    EXPECT_EQ(seen().ignored, 3U);
}

TEST_F(DronecanReceiver, AnonymousMessagesAreOfOneFrame)
{
    Allocation request;
    request.first_part = true;
    request.unique_id.resize(6);
    std::vector<Frame> frames = frames_of(request, kAnonymous);
    ASSERT_EQ(frames.size(), 1U);
    const Transfer* const transfer = take(frames[0]);
    ASSERT_NE(transfer, nullptr);
    EXPECT_EQ(transfer->source, kAnonymous);
    EXPECT_EQ(transfer->type.id, Allocation::kType.id);
    EXPECT_NE(take(frames[0]), nullptr);  // another client may send the same: the sender is not stored
    frames[0].data[7] = pack(Tail{true, false, false, 0});
    EXPECT_EQ(take(frames[0]), nullptr);
    EXPECT_EQ(seen().anonymous_refused, 1U);
    frames[0].data[7] = pack(Tail{false, true, true, 0});
    EXPECT_EQ(take(frames[0]), nullptr);
    EXPECT_EQ(seen().anonymous_refused, 2U);
    // Two bits of type cannot name a status (341), whose lowest two bits are those of Allocation.
    Receiver other(std::span(&NodeStatus::kType, 1));
    EXPECT_EQ(other.accept(frames[0], now), nullptr);
    EXPECT_EQ(other.diagnostics().ignored, 1U);
}

TEST_F(DronecanReceiver, MissedStart)
{
    std::vector<Frame> frames = log_frames(9, 0);
    frames.erase(frames.begin());
    EXPECT_EQ(feed(frames), 0);
    EXPECT_EQ(seen().missed_start, 5U);
    EXPECT_EQ(feed(log_frames(9, 1)), 1);
}

TEST_F(DronecanReceiver, OneMissingFrameShowsInTheToggle)
{
    for (std::size_t missing = 1; missing + 1 < 6; ++missing) {
        std::vector<Frame> frames = log_frames(9, static_cast<std::uint8_t>(missing));
        frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(missing));
        EXPECT_EQ(feed(frames), 0) << missing;
        EXPECT_EQ(seen().wrong_toggle, missing);
    }
    EXPECT_EQ(feed(log_frames(9, 9)), 1);
}

TEST_F(DronecanReceiver, TwoMissingFramesShowInTheChecksum)
{
    std::vector<Frame> frames = log_frames(9, 0);
    frames.erase(frames.begin() + 1, frames.begin() + 3);
    EXPECT_EQ(feed(frames), 0);
    EXPECT_EQ(seen().bad_crc, 1U);
}

TEST_F(DronecanReceiver, TheChecksumIsThatOfTheType)
{
    TypeInfo other = LogMessage::kType;
    other.crc_seed ^= 1U;
    EXPECT_EQ(feed(frames_of(TransferHead{other, Priority::medium, 9, 0, 0}, long_payload(9))), 0);
    EXPECT_EQ(seen().bad_crc, 1U);
}

TEST_F(DronecanReceiver, AFrameOfAnotherTransferEndsTheFirst)
{
    const std::vector<Frame> first = log_frames(9, 0);
    const std::vector<Frame> second = log_frames(9, 1);
    EXPECT_EQ(take(first[0]), nullptr);
    EXPECT_EQ(take(second[1]), nullptr);
    EXPECT_EQ(seen().wrong_transfer, 1U);
    EXPECT_EQ(feed({first.begin() + 1, first.end()}), 0);
    EXPECT_EQ(seen().missed_start, 5U);
}

TEST_F(DronecanReceiver, ANewStartInterrupts)
{
    const std::vector<Frame> first = log_frames(9, 0);
    EXPECT_EQ(feed({first.begin(), first.begin() + 3}), 0);
    EXPECT_EQ(feed(log_frames(9, 1)), 1);
    EXPECT_EQ(seen().interrupted, 1U);
    // With the same transfer id the frames of the two are indistinguishable: neither is delivered.
    const std::vector<Frame> third = log_frames(9, 2);
    EXPECT_EQ(feed({third.begin(), third.begin() + 3}), 0);
    EXPECT_EQ(feed(third), 0);
    EXPECT_EQ(seen().interrupted, 2U);
}

TEST_F(DronecanReceiver, ShortFramesWithinATransfer)
{
    std::vector<Frame> frames = log_frames(9, 0);
    frames[0].length = 7;
    frames[0].data[6] = pack(Tail{true, false, false, 0});
    EXPECT_EQ(take(frames[0]), nullptr);
    EXPECT_EQ(seen().short_frame, 1U);
    frames = log_frames(9, 1);
    frames[2].length = 4;
    frames[2].data[3] = pack(Tail{false, false, false, 1});
    EXPECT_EQ(feed(frames), 0);
    EXPECT_EQ(seen().short_frame, 2U);
    frames = log_frames(9, 2);
    frames[5].length = 1;
    frames[5].data[0] = pack(Tail{false, true, true, 2});
    EXPECT_EQ(feed(frames), 0);
    EXPECT_EQ(seen().short_frame, 3U);
}

TEST_F(DronecanReceiver, TooLongForItsType)
{
    TypeInfo type = LogMessage::kType;
    EXPECT_EQ(feed(frames_of(TransferHead{type, Priority::medium, 9, 0, 0}, long_payload(9, type.max_length))), 1);
    EXPECT_EQ(feed(frames_of(TransferHead{type, Priority::medium, 9, 0, 1}, long_payload(9, type.max_length + 1U))), 0);
    EXPECT_EQ(seen().too_long, 1U);
    receiver.set_node(42);
    // A single frame with payload, of a request that has none.
    EXPECT_EQ(feed(frames_of(TransferHead{GetNodeInfoRequest::kType, Priority::medium, 9, 42, 0}, long_payload(9, 1))),
              0);
    EXPECT_EQ(seen().too_long, 2U);
}

TEST_F(DronecanReceiver, ATransferHasTwoSeconds)
{
    const std::vector<Frame> frames = log_frames(9, 0);
    EXPECT_EQ(feed({frames.begin(), frames.begin() + 5}), 0);
    now = now + kTransferTimeout;
    EXPECT_EQ(feed({frames.begin() + 5, frames.end()}), 1);  // just in time

    const std::vector<Frame> late = log_frames(9, 1);
    EXPECT_EQ(feed({late.begin(), late.begin() + 5}), 0);
    now = now + (kTransferTimeout + 0.001F);
    EXPECT_EQ(feed({late.begin() + 5, late.end()}), 0);
    EXPECT_EQ(seen().timed_out, 1U);

    EXPECT_EQ(feed({late.begin(), late.begin() + 5}), 0);
    now = now + (kTransferTimeout + 0.001F);
    EXPECT_EQ(feed(late), 1);  // the same id is a new one by now
    EXPECT_EQ(seen().timed_out, 2U);
}

TEST_F(DronecanReceiver, ARepeatedTransferIsDeliveredOnce)
{
    const Frame single = frames_of(NodeStatus{}, 9, 4)[0];
    EXPECT_NE(take(single), nullptr);
    EXPECT_EQ(take(single), nullptr);
    EXPECT_EQ(seen().duplicates, 1U);
    EXPECT_EQ(feed(log_frames(9, 4)), 1);  // of another type: its own ids
    EXPECT_EQ(feed(log_frames(9, 4)), 0);
    EXPECT_EQ(seen().duplicates, 7U);  // all six frames
    now = now + kTransferTimeout;
    EXPECT_EQ(take(single), nullptr);
    now = now + 0.001F;
    EXPECT_NE(take(single), nullptr);
}

TEST_F(DronecanReceiver, ARepetitionIsJudgedFromTheFirstFrame)
{
    const std::vector<Frame> frames = log_frames(9, 0);
    EXPECT_EQ(feed({frames.begin(), frames.begin() + 5}), 0);
    now = now + 1.5F;
    EXPECT_EQ(feed({frames.begin() + 5, frames.end()}), 1);
    now = now + 0.5F;
    EXPECT_EQ(feed(frames), 0);
    now = now + 0.001F;
    EXPECT_EQ(feed(frames), 1);
}

TEST_F(DronecanReceiver, AFirstFrameThatLooksLikeTheLastOneIsNoRepetitionOfIt)
{
    const Frame first = log_frames(9, 0)[0];
    Frame second = first;
    second.data[7] = pack(Tail{false, false, true, 0});
    EXPECT_EQ(feed({first, second, first}), 0);
    EXPECT_EQ(seen().duplicates, 0U);
    EXPECT_EQ(seen().interrupted, 1U);
}

TEST_F(DronecanReceiver, FramesDeliveredTwiceByTheControllerChangeNothing)
{
    std::vector<Frame> doubled;
    for (const Frame& frame : log_frames(9, 0)) {
        doubled.push_back(frame);
        doubled.push_back(frame);
    }
    EXPECT_EQ(feed(doubled), 1);
    EXPECT_EQ(seen().duplicates, 6U);
}

TEST_F(DronecanReceiver, AssembliesAtTheirLimit)
{
    for (const std::size_t senders : {kAssemblies - 1, kAssemblies, kAssemblies + 1}) {
        Receiver fresh(kWanted);
        std::size_t delivered = 0;
        for (std::size_t f = 0; f < 6; ++f) {
            for (std::size_t s = 1; s <= senders; ++s) {
                now = now + 0.001F;
                const Transfer* const transfer = fresh.accept(log_frames(static_cast<std::uint8_t>(s), 0)[f], now);
                if (transfer != nullptr) {
                    ++delivered;
                    EXPECT_EQ(to_hex(transfer->payload), to_hex(long_payload(transfer->source)));
                    EXPECT_NE(transfer->source, senders > kAssemblies ? 1 : 0);  // the first begun transfer was
                                                                                 // replaced
                }
            }
        }
        EXPECT_EQ(delivered, std::min(senders, kAssemblies));
        EXPECT_EQ(fresh.diagnostics().assemblies_evicted, senders > kAssemblies ? 1U : 0U);
    }
}

TEST_F(DronecanReceiver, SessionsAtTheirLimit)
{
    for (const std::size_t senders : {kSessions - 1, kSessions, kSessions + 1}) {
        Receiver fresh(kWanted);
        const auto status = [](std::size_t s) { return frames_of(NodeStatus{}, static_cast<std::uint8_t>(s), 7)[0]; };
        for (std::size_t s = 1; s <= senders; ++s) {
            now = now + 0.001F;
            EXPECT_NE(fresh.accept(status(s), now), nullptr);
        }
        EXPECT_EQ(fresh.diagnostics().sessions_evicted, senders > kSessions ? 1U : 0U);
        // All but the one that was silent for longest are remembered.
        for (std::size_t s = senders; s >= 2; --s) {
            EXPECT_EQ(fresh.accept(status(s), now), nullptr) << s;
        }
        EXPECT_EQ(fresh.accept(status(1), now) != nullptr, senders > kSessions);
    }
}

TEST_F(DronecanReceiver, AnEvictedSessionTakesItsAssemblyAlong)
{
    const std::vector<Frame> frames = log_frames(100, 0);
    EXPECT_EQ(feed({frames.begin(), frames.begin() + 2}), 0);
    for (std::size_t s = 1; s <= kSessions; ++s) {
        now = now + 0.001F;
        EXPECT_NE(take(frames_of(NodeStatus{}, static_cast<std::uint8_t>(s))[0]), nullptr);
    }
    EXPECT_EQ(seen().sessions_evicted, 1U);
    EXPECT_EQ(seen().assemblies_evicted, 1U);
    EXPECT_EQ(feed({frames.begin() + 2, frames.end()}), 0);
    EXPECT_EQ(seen().missed_start, 4U);
}

TEST_F(DronecanReceiver, EveryFrameKeepsItsSession)
{
    const std::vector<Frame> frames = log_frames(100, 0);
    EXPECT_EQ(take(frames[0]), nullptr);
    for (std::size_t s = 1; s < kSessions; ++s) {
        now = now + 0.001F;
        EXPECT_NE(take(frames_of(NodeStatus{}, static_cast<std::uint8_t>(s))[0]), nullptr);
    }
    EXPECT_EQ(take(frames[1]), nullptr);
    EXPECT_NE(take(frames_of(NodeStatus{}, 101)[0]), nullptr);  // takes the place of the first status
    EXPECT_EQ(seen().sessions_evicted, 1U);
    EXPECT_EQ(feed({frames.begin() + 2, frames.end()}), 1);
}

}  // namespace
}  // namespace jink::link::dronecan
