// SPDX-License-Identifier: BSD-3-Clause
// Recordings that are complete, cut at every byte, damaged, packed; names of modes; lines that are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include <lzma.h>

#include <nlohmann/json.hpp>

#include "toolchain/sim/mode_names.hpp"
#include "toolchain/sim/replay.hpp"
#include "toolchain/sim/replay_command.hpp"
#include "toolchain/sim/wire_file.hpp"

namespace jink::replay_test {
namespace {

using Bytes = std::vector<std::byte>;

void append(Bytes& bytes, double time, std::uint8_t direction, std::uint32_t length, std::size_t given)
{
    const auto put = [&](const auto& value) {
        const auto* const from = reinterpret_cast<const std::byte*>(&value);
        bytes.insert(bytes.end(), from, from + sizeof value);
    };
    put(time);
    put(direction);
    put(length);
    for (std::size_t i = 0; i < given; ++i) {
        bytes.push_back(static_cast<std::byte>(i));
    }
}

Bytes three_records()
{
    Bytes bytes;
    append(bytes, 0.0, 0, 5, 5);
    append(bytes, 0.5, 1, 0, 0);
    append(bytes, 1.5, 0, 300, 300);
    return bytes;
}

Bytes packed(const Bytes& plain)
{
    Bytes out(plain.size() + 1000);
    std::size_t size = 0;
    const lzma_ret result =
        lzma_easy_buffer_encode(6, LZMA_CHECK_CRC64, nullptr, reinterpret_cast<const std::uint8_t*>(plain.data()),
                                plain.size(), reinterpret_cast<std::uint8_t*>(out.data()), &size, out.size());
    EXPECT_EQ(result, LZMA_OK);
    out.resize(size);
    return out;
}

TEST(WireFile, PlainAndPackedFilesGiveTheSameRecords)
{
    for (const Bytes& bytes : {three_records(), packed(three_records())}) {
        const sim::WireFile file = sim::read_wire(bytes);
        EXPECT_EQ(file.fault, "");
        ASSERT_EQ(file.records.size(), 3U);
        EXPECT_EQ(file.records[1].time, 0.5);
        EXPECT_EQ(file.records[1].direction, sim::WireDirection::from_jink);
        EXPECT_TRUE(file.records[1].bytes.empty());
        ASSERT_EQ(file.records[2].bytes.size(), 300U);
        EXPECT_EQ(file.records[2].bytes[255], std::byte{255});
    }
}

TEST(WireFile, CutAtEveryByteItGivesWholeRecordsAndAFault)
{
    const Bytes whole = three_records();
    const std::size_t ends[] = {18, 31, 344};
    ASSERT_EQ(whole.size(), ends[2]);
    for (std::size_t n = 0; n < whole.size(); ++n) {
        const sim::WireFile file = sim::read_wire({whole.data(), n});
        const auto complete = static_cast<std::size_t>(
            std::count_if(std::begin(ends), std::end(ends), [&](std::size_t e) { return e <= n; }));
        EXPECT_EQ(file.records.size(), complete) << n;
        const bool between = n == ends[0] || n == ends[1];
        EXPECT_EQ(file.fault.empty(), between) << n << " " << file.fault;
    }
}

TEST(WireFile, PackedAndCutAtEveryByteItIsNeverTakenForComplete)
{
    const Bytes whole = packed(three_records());
    for (std::size_t n = 0; n < whole.size(); ++n) {
        EXPECT_NE(sim::read_wire({whole.data(), n}).fault, "") << n;
    }
}

TEST(WireFile, HeadsThatCannotBeAreRefused)
{
    constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
    struct Case {
        double time;
        std::uint8_t direction;
        std::uint32_t length;
        const char* fault;
    };
    for (const Case& c : {Case{kNotANumber, 0, 1, "time"}, Case{-0.1, 0, 1, "time"}, Case{1.4, 0, 1, "time"},
                          Case{1e300, 0, 1, "time"}, Case{602.0, 0, 1, "time"}, Case{2.0, 2, 1, "direction 2"},
                          Case{2.0, 0, 0xFFFFFFFF, "a record of 4294967295 bytes"}}) {
        Bytes bytes = three_records();
        append(bytes, c.time, c.direction, c.length, 1);
        const sim::WireFile file = sim::read_wire(bytes);
        EXPECT_EQ(file.records.size(), 3U);
        EXPECT_NE(file.fault.find(c.fault), std::string::npos) << file.fault;
    }
}

TEST(WireFile, RandomDamageNeverBreaksTheReader)
{
    std::mt19937_64 random(7);
    const Bytes plain = three_records();
    const Bytes small = packed(plain);
    for (int i = 0; i < 4000; ++i) {
        Bytes bytes = i % 2 == 0 ? plain : small;
        for (int k = 0; k < 3; ++k) {
            bytes[random() % bytes.size()] = static_cast<std::byte>(random());
        }
        const sim::WireFile file = sim::read_wire(bytes);
        EXPECT_LE(file.records.size(), 40U);
        double before = 0.0;
        for (const sim::WireRecord& record : file.records) {
            EXPECT_GE(record.time, before);
            before = record.time;
        }
    }
}

TEST(ReplayCommand, ADamagedFileIsReplayedAsFarAsItGoesAndRefused)
{
    const std::string path = testing::TempDir() + "jink_damaged.wire";
    Bytes bytes = three_records();
    bytes.resize(bytes.size() - 1);
    append(bytes, 0.0, 0, 0, 0);
    bytes.resize(40);
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), 40);
    std::ostringstream out;
    std::ostringstream errors;
    EXPECT_EQ(sim::run_replay({path, "", "", true}, out, errors), 2);
    EXPECT_NE(errors.str().find("the last record is cut off; read until there: 2 records"), std::string::npos)
        << errors.str();
}

TEST(ReplayCommand, NothingIsKnownOfASilentAutopilotAndJsonSaysNull)
{
    const std::string path = testing::TempDir() + "jink_silent.wire";
    const Bytes bytes = three_records();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    std::ostringstream out;
    std::ostringstream errors;
    EXPECT_EQ(sim::run_replay({path, "", "", true}, out, errors), 0);
    EXPECT_EQ(out.str(),
              R"({"t":1.0,"stack":null,"vehicle":null,"mode":null,"armed":null,"control":"autopilot","position":null,)"
              R"("velocity":null,"home":null,"nominal":null,"tracks":0,"conflict":false})"
              "\n");
    EXPECT_EQ(errors.str(), "");
}

TEST(Belief, JsonHasTheDocumentedKeysAndUnits)
{
    sim::Belief belief;
    belief.time = 12.0;
    belief.stack = sim::Stack::px4;
    belief.vehicle = 2;
    belief.mode = "MISSION";
    belief.armed = true;
    belief.control = "ours";
    belief.position = sim::Vec(1.0, 2.0, 3.0);
    belief.velocity = sim::Vec(0.5, 0.0, -0.25);
    belief.home = sim::Globe{47.3977415, 8.5455961, 489.828};
    belief.nominal = sim::NominalBelief{true, sim::Vec(10.0, 20.0, 30.0), 5.0};
    belief.tracks = 2;
    belief.conflict = true;
    const auto json = nlohmann::json::parse(sim::to_json(belief));
    EXPECT_EQ(json, nlohmann::json::parse(
                        R"({"t":12.0,"stack":"px4","vehicle":2,"mode":"MISSION","armed":true,"control":"ours",
                            "position":[1.0,2.0,3.0],"velocity":[0.5,0.0,-0.25],"home":[47.3977415,8.5455961,489.828],
                            "nominal":{"kind":"route","end":[10.0,20.0,30.0],"speed":5.0},"tracks":2,"conflict":true})"));
}

TEST(ModeNames, AreTheAutopilotsOwn)
{
    using link::AutopilotStack;
    const auto px4 = [](std::uint32_t main, std::uint32_t sub) {
        return sim::mode_name(AutopilotStack::px4, false, main << 16U | sub << 24U);
    };
    EXPECT_EQ(px4(4, 4), "MISSION");
    EXPECT_EQ(px4(4, 3), "HOLD");
    EXPECT_EQ(px4(4, 5), "RTL");
    EXPECT_EQ(px4(6, 0), "OFFBOARD");
    EXPECT_EQ(px4(3, 0), "POSCTL");
    EXPECT_EQ(px4(200, 0), std::to_string(200U << 16U));
    for (const auto& [number, name] : {std::pair{3U, "AUTO"},
                                       {4U, "GUIDED"},
                                       {5U, "LOITER"},
                                       {6U, "RTL"},
                                       {9U, "LAND"},
                                       {17U, "BRAKE"},
                                       {8U, "8"},
                                       {99U, "99"}}) {
        EXPECT_EQ(sim::mode_name(AutopilotStack::ardupilot, false, number), name);
    }
    EXPECT_EQ(sim::mode_name(AutopilotStack::ardupilot, true, 10), "AUTO");
    EXPECT_EQ(sim::mode_name(AutopilotStack::ardupilot, true, 15), "GUIDED");
    EXPECT_EQ(sim::mode_name(AutopilotStack::unknown, false, 3), "3");
}

}  // namespace
}  // namespace jink::replay_test
