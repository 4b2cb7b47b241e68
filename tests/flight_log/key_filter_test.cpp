// SPDX-License-Identifier: BSD-3-Clause
// Signing keys in the messages of a log, however their frames are split over reads, records, parts and files, and
// whatever messages are missing. Messages are composed by the real flight log.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "firmware/link/dronecan/tunnel.hpp"
#include "firmware/linux/flight_log/writer.hpp"
#include "tests/flight_log/memory_disk.hpp"
#include "tests/flight_log/recorded_flight.hpp"
#include "tests/flight_log/recorded_input.hpp"
#include "tests/flight_log/setup_signing.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;

constexpr std::size_t kChance = 2;  ///< bytes of the key that other bytes of a log may have in common with it

Bytes stream_with_key(std::size_t before, std::size_t behind)
{
    Bytes stream(before, std::byte{0xEE});
    const Bytes frame = setup_signing_frame();
    stream.insert(stream.end(), frame.begin(), frame.end());
    stream.insert(stream.end(), behind, std::byte{0xEF});
    return stream;
}

/// Without some of the messages.
Bytes filtered_without(const std::vector<Bytes>& messages, std::size_t from, std::size_t count)
{
    std::vector<Bytes> left(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(from));
    left.insert(left.end(), messages.begin() + static_cast<std::ptrdiff_t>(std::min(from + count, messages.size())),
                messages.end());
    return filtered(left);
}

/// Two cuts at every pair of bytes, the three reads in one record or in three.
TEST(KeyFilter, FindsAKeyHoweverItsFrameIsSplit)
{
    const Bytes stream = stream_with_key(3, 20);
    const std::span<const std::byte> all(stream);
    for (std::size_t a = 0; a <= stream.size(); ++a) {
        for (std::size_t b = a; b <= stream.size(); b += 1 + a % 3) {
            const std::array pieces{all.first(a), all.subspan(a, b - a), all.subspan(b)};
            RecordedInput one;
            RecordedInput three;
            one.step([&](HalRecorder& recorder) {
                for (const auto& piece : pieces) {
                    recorder.read(Port::line, piece);
                    recorder.write(Port::line, piece.first(0), 0);
                    recorder.read(Port::cloud, Bytes(7, std::byte{0xFD}));  // another stream between
                }
            });
            for (const auto& piece : pieces) {
                three.read(piece);
            }
            for (const RecordedInput* input : {&one, &three}) {
                bool is_marked = false;
                const std::vector<Bytes> before = records_of(joined(input->messages()));
                ASSERT_EQ(longest_part(line_of(before, is_marked), secret()), secret().size());
                ASSERT_FALSE(is_marked);
                const Bytes log = filtered(input->messages());
                ASSERT_EQ(log.size(), joined(input->messages()).size());
                ASSERT_LE(longest_part(log, secret()), kChance) << a << " " << b;
                const Bytes kept = line_of(records_of(log), is_marked);
                ASSERT_TRUE(is_marked);
                ASSERT_EQ(kept.size(), stream.size());
                ASSERT_TRUE(std::equal(kept.begin(), kept.begin() + 13, stream.begin())) << "up to the payload";
                ASSERT_TRUE(std::equal(kept.end() - 20, kept.end(), stream.end() - 20)) << "behind the frame";
            }
        }
    }
}

/// Any run of messages is missing, the header among them or not.
TEST(KeyFilter, LeavesNoKeyBehindMissingMessages)
{
    const Bytes stream = stream_with_key(15, 110);
    for (const std::size_t size : {1U, 3U, 8U, 13U, 21U, 43U, 53U}) {
        RecordedInput input;
        for (std::size_t at = 0; at < stream.size(); at += size) {
            input.read(std::span(stream).subspan(at, std::min(size, stream.size() - at)));
        }
        for (std::size_t from = 0; from < input.messages().size() / 2; ++from) {
            for (const std::size_t count : {1U, 2U, 7U, 40U}) {
                const Bytes log = filtered_without(input.messages(), from, count);
                ASSERT_LE(longest_part(log, secret()), kChance) << size << " " << from << " " << count;
                const auto lost = static_cast<std::ptrdiff_t>(KeyEraser::kUnknown + (count / 2 + 1) * size);
                ASSERT_GE(std::count(log.begin(), log.end(), std::byte{0xEF}), 110 - lost) << "not more than needed";
            }
        }
    }
}

/// Records of several parts: the frame lies over a cut at each of its bytes, and each of the messages is missing once.
TEST(KeyFilter, FindsAKeyThatIsCutOverPartsOfARecord)
{
    const Bytes frame = setup_signing_frame();
    const Bytes other(frame.size(), std::byte{0x55});  // parts of two records may fit together
    for (std::size_t shift = 0; shift <= frame.size() + 12; shift += 1 + shift % 2) {
        RecordedInput input;
        const auto step = [&](std::span<const std::byte> bytes, std::size_t cut) {
            input.step([&](HalRecorder& recorder) {
                recorder.read(Port::cloud, Bytes(4'076 - shift, std::byte{0x33}));
                recorder.read(Port::line, bytes.first(cut));
                recorder.read(Port::line, bytes.subspan(cut));
                recorder.read(Port::cloud, Bytes(5'000, std::byte{0x44}));
            });
        };
        step(other, frame.size());
        step(frame, frame.size());
        step(frame, shift % frame.size());
        const std::vector<Bytes>& messages = input.messages();
        ASSERT_EQ(messages.size(), 3U * (3U + 1U));
        const Bytes log = filtered(messages);
        ASSERT_LE(longest_part(log, secret()), kChance) << shift;
        ASSERT_EQ(log, filtered(messages, 3)) << "in any groups";
        ASSERT_EQ(log, filtered(messages, 100));
        bool is_marked = false;
        ASSERT_EQ(line_of(records_of(log), is_marked).size(), 3 * frame.size()) << "all records are whole";
        ASSERT_TRUE(is_marked);
        for (std::size_t i = 0; i < messages.size(); ++i) {
            for (const std::size_t count : {1U, 2U, 3U, 4U, 5U}) {
                const Bytes rest = filtered_without(messages, i, count);
                ASSERT_LE(longest_part(rest, secret()), kChance) << shift << " " << i << " " << count;
            }
        }
    }
}

/// Parts that wait for the rest of their record are not passed.
TEST(KeyFilter, HoldsTheBeginningOfARecordUntilItIsWhole)
{
    RecordedInput input;
    input.step([](HalRecorder& recorder) { recorder.read(Port::cloud, Bytes(9'000, std::byte{0x33})); });
    Bytes log = joined(input.messages());
    const std::size_t first = ulog::size_of_message(log);
    KeyFilter filter;
    EXPECT_EQ(filter.pass(std::span(log).first(first)), 0U);
    EXPECT_EQ(filter.pass(std::span(log).first(2 * first)), 0U);
    EXPECT_EQ(filter.pass(log), log.size());
    EXPECT_EQ(log, joined(input.messages())) << "without a key nothing changes";
}

/// A record that does not fit is lost; the key goes on behind it.
TEST(KeyFilter, FindsAKeyWhoseHeaderIsInARecordThatWasTooLong)
{
    const Bytes stream = stream_with_key(0, 80);
    for (std::size_t cut = 1; cut < stream.size() - 80; ++cut) {
        RecordedInput input;
        input.step([&](HalRecorder& recorder) {
            recorder.read(Port::cloud, Bytes(50'000, std::byte{0x33}));
            recorder.read(Port::line, std::span(stream).first(cut));
        });
        input.read(std::span(stream).subspan(cut));
        ASSERT_LE(longest_part(filtered(input.messages()), secret()), kChance) << cut;
    }
}

/// Through the tunnel of a bus, in transfers of any length, whole and with missing messages.
TEST(KeyFilter, FindsAKeyInTheTunnelOfABus)
{
    using namespace link::dronecan;
    const Bytes frame = setup_signing_frame();
    for (std::size_t piece = 1; piece <= frame.size(); ++piece) {
        NodeOptions options;
        options.node = 10;
        Node peer(options);
        Tunnel tunnel(TunnelOptions{42, 0});
        RecordedInput input;
        std::size_t frames = 0;
        for (std::span<const std::byte> rest(frame); !rest.empty();) {
            rest = rest.subspan(tunnel.write(peer, rest.first(std::min(piece, rest.size()))));
            input.step([&](HalRecorder& recorder) {
                while (const Frame* const out = peer.outgoing().front()) {
                    hal::CanFrame received;
                    received.id = out->id;
                    received.extended = true;
                    received.length = out->length;
                    std::copy_n(out->data.begin(), Frame::kBytes, received.data.begin());
                    recorder.received(&received);
                    peer.outgoing().pop();
                    ++frames;
                }
            });
        }
        ASSERT_GT(frames, 8U);
        const Bytes log = filtered(input.messages());
        ASSERT_LE(longest_part(log, secret()), kChance) << piece;
        bool is_marked = false;
        static_cast<void>(line_of(records_of(log), is_marked));
        ASSERT_TRUE(is_marked) << piece;
        for (std::size_t i = 0; i < input.messages().size(); ++i) {
            for (const std::size_t count : {1U, 3U, 12U}) {
                ASSERT_LE(longest_part(filtered_without(input.messages(), i, count), secret()), kChance)
                    << piece << " " << i << " " << count;
            }
        }
    }
}

/// Damage stays within the records: the messages before and behind are as they were.
TEST(KeyFilter, TakesDamagedRecords)
{
    std::mt19937_64 random(4);
    for (int i = 0; i < 3'000; ++i) {
        RecordedInput input;
        for (int k = 0; k < 3; ++k) {
            input.step([&](HalRecorder& recorder) {
                recorder.areas(std::vector<app::Constraint>(random() % 3), {5});
                recorder.read(Port::line, stream_with_key(random() % 9, random() % 5'000));
                recorder.received(random() % 2 == 0 ? nullptr : &static_cast<const hal::CanFrame&>(hal::CanFrame{}));
                hal::PortHealth health;
                health.overruns = random();
                recorder.health(Port::line, health);
            });
        }
        std::vector<Bytes> messages = input.messages();
        for (std::size_t n = 1 + random() % 8; n > 0; --n) {
            Bytes& message = messages[random() % messages.size()];
            if (is_record(message)) {
                message[5 + random() % (message.size() - 5)] ^= static_cast<std::byte>(1U << random() % 8);
            }
        }
        const Bytes before = joined(messages);
        const Bytes log = filtered(messages, 1 + random() % 5);
        ASSERT_LE(log.size(), before.size());
        for (std::span<const std::byte> was(before), is(log); !is.empty();) {
            const std::size_t n = ulog::size_of_message(was);
            ASSERT_EQ(ulog::size_of_message(is), n);
            ASSERT_TRUE(is_record(was) ||
                        std::equal(was.begin(), was.begin() + static_cast<std::ptrdiff_t>(n), is.begin()));
            was = was.subspan(n);
            is = is.subspan(n);
        }
    }
}

/// Files that follow each other within a frame, and within the parts of a record.
TEST(LogFiles, HaveNoKeyInAnyOfThem)
{
    std::mt19937_64 random(6);
    for (const std::uint64_t file_bytes : {1U, 15'000U, 17'000U, 25'000U}) {
        Store store;
        LogFiles files({"folder", file_bytes, 10'000}, definitions_of(plain_setup()),
                       std::make_unique<MemoryDisk>(store));
        RecordedInput input;
        std::size_t given = 0;
        for (int i = 0; i < (file_bytes == 1 ? 5 : 40); ++i) {
            const Bytes stream = stream_with_key(random() % 20, random() % 100);
            for (std::size_t at = 0; at < stream.size();) {
                const std::size_t n = std::min(stream.size() - at, 1 + random() % 40);
                input.step([&](HalRecorder& recorder) {
                    recorder.read(Port::cloud, Bytes(i % 6 == 0 ? 6'000 : 0, std::byte{0x33}));
                    recorder.read(Port::line, std::span(stream).subspan(at, n));
                });
                at += n;
            }
            const Bytes all = joined(input.messages());
            while (given < all.size()) {
                const std::size_t n = std::min({all.size() - given, files.room(), std::size_t{1} + random() % 9'000});
                files.take(std::span(all).subspan(given, n));
                files.work(i, false);
                given += n;
            }
        }
        files.work(100, true);
        ASSERT_GT(store.files.size(), 3U);
        std::size_t data = 0;
        for (const auto& [name, text] : store.files) {
            ASSERT_LE(longest_part(text), kChance) << name;
            data += text.size() - head_of_file(definitions_of(plain_setup()), 0, name.substr(0, 20), 0).size();
        }
        ASSERT_EQ(data, joined(input.messages()).size()) << "nothing else is left out";
    }
}

/// The last parts of a record were dropped and nothing follows.
TEST(LogFiles, LeaveARecordOutThatIsNotWholeAtTheEnd)
{
    RecordedInput input;
    input.read(Bytes(100, std::byte{0x11}));
    input.step([](HalRecorder& recorder) {
        recorder.read(Port::cloud, Bytes(4'000, std::byte{0x33}));
        recorder.read(Port::line, stream_with_key(0, 300));
    });
    ASSERT_EQ(input.messages().size(), 5U);
    Store store;
    LogFiles files({"folder"}, definitions_of(plain_setup()), std::make_unique<MemoryDisk>(store));
    files.take(joined(std::span(input.messages()).first(3)));
    files.work(0, true);
    ASSERT_EQ(store.files.size(), 1U);
    std::istringstream in(store.files.begin()->second);
    ulog::Reader reader(in);
    std::size_t records = 0;
    while (const auto message = reader.next()) {
        records += message->type == ulog::Type::data ? 1U : 0U;
    }
    EXPECT_EQ(reader.end(), ulog::End::complete);
    EXPECT_EQ(records, 1U);
    EXPECT_LE(longest_part(store.files.begin()->second), kChance);
}

/// Tells when the thread that owns it is gone.
class CountedDisk final : public Disk {
public:
    CountedDisk(Store& store, std::atomic<int>& alive) : disk_(store), alive_(alive) { ++alive_; }
    ~CountedDisk() override { --alive_; }
    CountedDisk(const CountedDisk&) = delete;
    CountedDisk& operator=(const CountedDisk&) = delete;
    int create(const std::string& path) override { return disk_.create(path); }
    int write(std::span<const std::byte> bytes, std::size_t& written) override { return disk_.write(bytes, written); }
    int sync() override { return disk_.sync(); }
    void close() override { disk_.close(); }
    void remove(const std::string& path) override { disk_.remove(path); }
    std::vector<std::string> names_in(const std::string& folder) override { return disk_.names_in(folder); }

private:
    MemoryDisk disk_;
    std::atomic<int>& alive_;
};

/// The real queue and its thread. The loop is faster than the thread, so that messages are dropped anywhere.
TEST(LogWriter, WritesNoKeyWhateverIsDropped)
{
    std::mt19937_64 random(8);
    std::uint32_t dropped = 0;
    for (int run = 0; run < 8; ++run) {
        Store store;
        std::atomic<int> alive{0};
        LogCounts counts;
        {
            Writer writer({"folder", 200'000, 1'000}, definitions_of(plain_setup()),
                          std::make_unique<CountedDisk>(store, alive), 1U << 14U);
            FlightLog log(writer, {}, app::Parameters().values());
            const Bytes stream = stream_with_key(17, 23);
            for (std::int64_t step = 0; step < 3'000; ++step) {
                const std::size_t at = static_cast<std::size_t>(step) * 11 % stream.size();
                writer.set_time(step);
                log.begin({step});
                log.recorder().read(Port::cloud, Bytes(random() % 50 == 0 ? 5'000 : 0, std::byte{0x33}));
                const std::size_t n = std::min<std::size_t>(11, stream.size() - at);
                log.recorder().read(Port::line, std::span(stream).subspan(at, n));
                log.end_shut_down({step});
                if (random() % 100 == 0) {
                    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 9));
                }
            }
            counts = writer.finish();
        }
        while (alive > 0) {
            std::this_thread::yield();
        }
        dropped += counts.dropped;
        ASSERT_GT(store.files.size(), 0U);
        for (const auto& [name, text] : store.files) {
            ASSERT_LE(longest_part(text), kChance + 1) << run << " " << name;
        }
    }
    EXPECT_GT(dropped, 100U);
}

}  // namespace
