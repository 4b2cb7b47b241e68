// SPDX-License-Identifier: BSD-3-Clause
// Tables of a flight log of another writer: topics whose names only differ in "/", several instances of one, odd
// levels.
#include <gtest/gtest.h>

#include <cstdint>
#include <sstream>
#include <string>

#include "tests/host/scratch.hpp"
#include "toolchain/host/log_summary.hpp"

namespace {

using jink::test::Scratch;
using jink::test::slurp;

template <class T>
std::string bytes_of(T value)
{
    return {static_cast<const char*>(static_cast<const void*>(&value)), sizeof value};
}

std::string message(char type, const std::string& content)
{
    return bytes_of(static_cast<std::uint16_t>(content.size())) + type + content;
}

/// One topic as it is defined, subscribed as `id`, and a message with the value `x`.
std::string topic(const std::string& name, std::uint16_t id, std::uint8_t instance, std::uint8_t x)
{
    return message('A', bytes_of(instance) + bytes_of(id) + name) +
           message('D', bytes_of(id) + bytes_of(std::uint64_t{7}) + bytes_of(x));
}

std::string text(char level, const std::string& said)
{
    return message('L', level + bytes_of(std::uint64_t{8}) + said);
}

const std::string kStart = std::string("ULog\x01\x12\x35\x01", 8) + bytes_of(std::uint64_t{0});

std::string formats(std::initializer_list<const char*> names)
{
    std::string out;
    for (const char* const name : names) {
        out += message('F', std::string(name) + ":uint64_t timestamp;uint8_t x;");
    }
    return out;
}

TEST(LogCsv, EachInstanceOfATopicHasAFileOfItsOwn)
{
    const Scratch scratch;
    std::istringstream in(kStart + formats({"a/b", "a_b", "texts"}) + topic("a/b", 0, 0, 1) + topic("a_b", 1, 0, 2) +
                          topic("a_b", 2, 1, 3) + topic("texts", 3, 0, 4) + text('6', "said") + text('\x1b', "odd") +
                          text(',', "odd"));
    jink::ulog::Reader log(in);
    EXPECT_EQ(jink::host::write_log_csv(log, scratch.path()), 7U);
    EXPECT_EQ(log.end(), jink::ulog::End::complete);
    EXPECT_EQ(slurp(scratch.path() / "a_b.csv"), "timestamp,x\n7,1\n");
    EXPECT_EQ(slurp(scratch.path() / "a_b_.csv"), "timestamp,x\n7,2\n");
    EXPECT_EQ(slurp(scratch.path() / "a_b_1.csv"), "timestamp,x\n7,3\n");
    EXPECT_EQ(slurp(scratch.path() / "texts_.csv"), "timestamp,x\n7,4\n");
    EXPECT_EQ(slurp(scratch.path() / "texts.csv"), "timestamp,level,text\n8,6,\"said\"\n8,?,\"odd\"\n8,?,\"odd\"\n");
}

TEST(LogCsv, TheSummaryPrintsNoControlCharacterAsALevel)
{
    std::istringstream in(kStart + text('\x1b', "odd"));
    std::ostringstream out;
    jink::host::print_log_summary("x.ulg", jink::host::summarise_log(in), out);
    EXPECT_NE(out.str().find(" s  ?  odd\n"), std::string::npos) << out.str();
    EXPECT_EQ(out.str().find('\x1b'), std::string::npos);
}

}  // namespace
