// SPDX-License-Identifier: BSD-3-Clause
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "firmware/linux/complaint.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/random.hpp"
#include "tests/host/scratch.hpp"

namespace {

using namespace jink;
using namespace jink::files;
using test::Scratch;
using test::with;

TEST(Complaint, ReadsLikeACompilersMessage)
{
    EXPECT_EQ(to_string({3, 7, "wrong", "a.yaml"}), "a.yaml:3:7: wrong");
    EXPECT_EQ(to_string({3, 0, "wrong", "a.yaml"}), "a.yaml:3: wrong");
    EXPECT_EQ(to_string({0, 0, "wrong", "a.yaml"}), "a.yaml: wrong");
    EXPECT_EQ(to_string({0, 7, "wrong", "a.yaml"}), "a.yaml: wrong");
}

TEST(Complaint, PrintsWhatOutsidersWroteHarmlessly)
{
    EXPECT_EQ(printable("plain"), "plain");
    EXPECT_EQ(printable(std::string_view("\x1b[2J\0", 5)), "\\x1b[2J\\x00");
    EXPECT_EQ(printable(std::string(100, 'a')), std::string(60, 'a') + "...");
    EXPECT_EQ(in_quotes("\xff"), "'\\xff'");
}

TEST(EndOfUtf8, IsTheFirstByteThatIsNone)
{
    EXPECT_EQ(end_of_utf8(""), 0U);
    EXPECT_EQ(end_of_utf8("a \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x9A\x81"), 13U);
    EXPECT_EQ(end_of_utf8("ab\xFF"
                          "c"),
              2U);
    EXPECT_EQ(end_of_utf8("ab\xE2\x82"), 2U) << "cut off";
}

/// The oracle is the writer that refuses such bytes.
TEST(EndOfUtf8, AgreesWithTheJsonWriter)
{
    std::mt19937 random(7U);
    const std::array<unsigned char, 18> edges{0x00, 0x41, 0x7F, 0x80, 0x8F, 0x90, 0x9F, 0xA0, 0xBF,
                                              0xC0, 0xC2, 0xDF, 0xE0, 0xED, 0xEF, 0xF0, 0xF4, 0xF5};
    int good = 0;
    for (int i = 0; i < 200'000; ++i) {
        std::string text(1 + random() % 4, ' ');
        for (char& c : text) {
            c = static_cast<char>(random() % 4 == 0 ? random() % 256 : edges[random() % edges.size()]);
        }
        bool taken = true;
        try {
            static_cast<void>(nlohmann::json(text).dump());
        } catch (const nlohmann::json::exception&) {
            taken = false;
        }
        ASSERT_EQ(end_of_utf8(text) == text.size(), taken) << printable(text);
        good += taken ? 1 : 0;
    }
    EXPECT_GT(good, 1000);
}

TEST(ParseNumber, TakesDecimalsAndNothingElse)
{
    const struct {
        const char* text;
        NumberStatus status;
        float value;
    } cases[] = {
        {"0", NumberStatus::ok, 0.0F},
        {"-1.5", NumberStatus::ok, -1.5F},
        {"+2", NumberStatus::ok, 2.0F},
        {"1e3", NumberStatus::ok, 1000.0F},
        {".5", NumberStatus::ok, 0.5F},
        {"5.", NumberStatus::ok, 5.0F},
        {"007", NumberStatus::ok, 7.0F},
        {"", NumberStatus::not_a_number, 0.0F},
        {"+", NumberStatus::not_a_number, 0.0F},
        {"-", NumberStatus::not_a_number, 0.0F},
        {"+-1", NumberStatus::not_a_number, 0.0F},
        {"--1", NumberStatus::not_a_number, 0.0F},
        {"1,5", NumberStatus::not_a_number, 0.0F},
        {" 1", NumberStatus::not_a_number, 0.0F},
        {"1 ", NumberStatus::not_a_number, 0.0F},
        {"1m", NumberStatus::not_a_number, 0.0F},
        {"0x10", NumberStatus::not_a_number, 0.0F},
        {"1_000", NumberStatus::not_a_number, 0.0F},
        {"nan", NumberStatus::not_finite, 0.0F},
        {"-inf", NumberStatus::not_finite, 0.0F},
        {"infinity", NumberStatus::not_finite, 0.0F},
        {"1e39", NumberStatus::too_big, 0.0F},
        {"-1e400", NumberStatus::too_big, 0.0F},
    };
    for (const auto& c : cases) {
        float value = 0.0F;
        EXPECT_EQ(parse_number(c.text, value), c.status) << c.text;
        EXPECT_EQ(value, c.value) << c.text;
    }
}

TEST(ParseNumber, ReadsBackWhatToTextWritesBitForBit)
{
    const std::uint64_t seed = 20240611;
    Random random(seed);
    for (int i = 0; i < 20000; ++i) {
        const auto bits = static_cast<std::uint32_t>(random.next());
        float value = 0.0F;
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) {
            continue;
        }
        float back = 1.0F;
        ASSERT_EQ(parse_number(to_text(value), back), NumberStatus::ok)
            << "seed " << seed << " case " << i << " " << to_text(value);
        ASSERT_EQ(std::memcmp(&value, &back, sizeof value), 0)
            << "seed " << seed << " case " << i << " " << to_text(value);
    }
}

TEST(JudgeNumber, SaysWhatIsWrong)
{
    float value = 0.0F;
    const Range range{1.0F, 5.0F};
    EXPECT_FALSE(judge_number("1", range, true, value));
    EXPECT_FALSE(judge_number("5", range, true, value));
    EXPECT_EQ(value, 5.0F);
    EXPECT_EQ(*judge_number("5.0001", range, false, value), "'5.0001' is out of range: 1 to 5");
    EXPECT_EQ(*judge_number("0.9", range, false, value), "'0.9' is out of range: 1 to 5");
    EXPECT_EQ(*judge_number("2.5", range, true, value), "'2.5' is not a whole number");
    EXPECT_EQ(*judge_number("two", range, false, value), "'two' is not a number");
    EXPECT_EQ(*judge_number("-.inf", range, false, value), "'-.inf' is not finite");
    EXPECT_EQ(*judge_number("1e99", range, false, value), "'1e99' is beyond what single precision can hold");
    EXPECT_EQ(value, 5.0F) << "a refused number must change nothing";
}

TEST(NearestName, FindsWhatWasMeant)
{
    const std::vector<std::string_view> names{"speed", "radius", "velocity", "k_S", "k_T"};
    EXPECT_EQ(nearest_name("sped", names), "speed");
    EXPECT_EQ(nearest_name("psede", names), std::nullopt);   // two swaps are too much for five letters
    EXPECT_EQ(nearest_name("raduis", names), "radius");      // one swap
    EXPECT_EQ(nearest_name("VELOCITY", names), "velocity");  // case aside
    EXPECT_EQ(nearest_name("velocities", names), "velocity");
    EXPECT_EQ(nearest_name("kS", names), "k_S");
    EXPECT_EQ(nearest_name("altitude", names), std::nullopt);
    EXPECT_EQ(nearest_name("", names), std::nullopt);
    EXPECT_EQ(nearest_name(std::string(65, 's'), names), std::nullopt);
    EXPECT_EQ(nearest_name("x", {}), std::nullopt);
    EXPECT_EQ(suggestion("sped", names), "; did you mean 'speed'?");
    EXPECT_EQ(suggestion("altitude", names), "");
}

TEST(ReadTextFile, AFifoAndADeviceAreRefusedWithoutWaiting)
{
    const Scratch scratch;
    const std::string fifo = (scratch.path() / "fifo").string();
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    Complaints complaints;
    EXPECT_FALSE(read_text_file(fifo, complaints));
    EXPECT_FALSE(read_text_file("/dev/zero", complaints));
    ASSERT_EQ(complaints.size(), 2U);
    EXPECT_EQ(complaints[0].text, "is not a regular file");
}

TEST(ReadTextFile, RefusesWhatIsNoHandWrittenFile)
{
    const Scratch scratch;
    Complaints complaints;
    EXPECT_EQ(read_text_file(scratch.write("a", "text"), complaints), "text");
    EXPECT_EQ(read_text_file(scratch.write("empty", ""), complaints), "");
    EXPECT_EQ(read_text_file(scratch.write("most", std::string(kMaxFileSize, '#')), complaints)->size(), kMaxFileSize);
    EXPECT_TRUE(complaints.empty());

    EXPECT_FALSE(read_text_file(scratch.path() / "none", complaints));
    EXPECT_FALSE(read_text_file(scratch.path(), complaints));
    EXPECT_FALSE(read_text_file(scratch.write("large", std::string(kMaxFileSize + 1, '#')), complaints));
    ASSERT_EQ(complaints.size(), 3U);
    EXPECT_NE(with(complaints, "no such file"), nullptr);
    EXPECT_NE(with(complaints, "is a directory"), nullptr);
    EXPECT_NE(with(complaints, "is larger than 1 MiB"), nullptr);
}

}  // namespace
