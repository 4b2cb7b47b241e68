// SPDX-License-Identifier: BSD-3-Clause
// Parameters served over the bus: read, set, saved and erased.
#include <gtest/gtest.h>

#include "tests/unit/app/bus_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

TEST(CoprocessorBusParameters, ParametersAreServed)
{
    const auto b = bus_bench({{Param::mode, 1.0F}, {Param::lookahead, 9.0F}});
    const auto set = [&](std::string_view name, std::int64_t whole, float real, can::ParamValue::Tag tag) {
        can::GetSetRequest m;
        for (const char c : name) {
            m.name.unchecked_push_back(static_cast<std::uint8_t>(c));
        }
        m.value.tag = tag;
        m.value.integer = whole;
        m.value.real = real;
        b->ask(m);
        b->fly(2);
        return b->heard.params.back();
    };
    using Tag = can::ParamValue::Tag;
    const auto& counted = b->f.coprocessor.diagnostics();
    const Parameters& now = b->f.coprocessor.parameters();
    can::GetSetResponse answer = set("JNK_LOOKAHEAD", 0, 12.5F, Tag::real);
    EXPECT_EQ(answer.value.real, 12.5F);
    EXPECT_EQ(answer.initial.real, 9.0F) << "what erase brings";
    EXPECT_EQ(answer.low.real, 1.0F);
    EXPECT_EQ(answer.high.real, 60.0F);
    EXPECT_EQ(now.get(Param::lookahead), 12.5F);
    EXPECT_EQ(now.configuration().rules.lookahead, 12.5F);
    EXPECT_EQ(b->f.coprocessor.parameters().configuration().rules.lookahead, 12.5F) << "taken over in the step";
    EXPECT_EQ(counted.params_set, 1U);
    answer = set("JNK_LOOKAHEAD", 0, 61.0F, Tag::real);
    EXPECT_EQ(answer.value.real, 12.5F);
    EXPECT_EQ(counted.params_refused, 1U);
    answer = set("JNK_MODE", 0, 0.0F, Tag::integer);
    EXPECT_EQ(answer.value.integer, 0);
    EXPECT_EQ(counted.params_set, 2U);
    answer = set("NO_SUCH_NAME", 0, 0.0F, Tag::integer);
    EXPECT_TRUE(answer.name.empty());
    can::GetSetRequest by_index;
    by_index.index = kParamCount;
    b->ask(by_index);
    b->fly(2);
    EXPECT_TRUE(b->heard.params.back().name.empty());
    for (std::uint16_t i = 0; i < kParamCount; ++i) {
        by_index.index = i;
        b->ask(by_index);
        b->fly(2);
        const can::GetSetResponse& m = b->heard.params.back();
        ASSERT_EQ(std::string(m.name.begin(), m.name.end()), param_table()[i].name);
        ASSERT_EQ(m.value.tag, param_table()[i].integer ? Tag::integer : Tag::real);
    }
    can::ExecuteOpcodeRequest opcode;
    opcode.opcode = can::ExecuteOpcodeRequest::kSave;
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "there is nowhere to save to";
    b->f.coprocessor.note_stored(now.generation());
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    static_cast<void>(set("JNK_LOOKAHEAD", 0, 13.0F, Tag::real));
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "a change since then is not stored yet";
    b->f.coprocessor.note_stored(now.generation());
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    opcode.opcode = can::ExecuteOpcodeRequest::kErase;
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    EXPECT_EQ(now.get(Param::mode), 1.0F) << "not the table's 2: nobody asked for more than advice";
    EXPECT_EQ(now.get(Param::lookahead), 9.0F);
    opcode.opcode = can::ExecuteOpcodeRequest::kSave;
    b->ask(opcode);
    b->fly(2);
    EXPECT_FALSE(b->heard.opcodes.back().ok) << "a restart would bring what was erased";
}

TEST(CoprocessorBusParameters, EraseBringsBackTheInitialValuesNotThoseThatWereStored)
{
    const auto b = bus_bench({{Param::lookahead, 9.0F}});
    ParamValues stored = b->f.coprocessor.initial_parameters();
    stored[static_cast<std::size_t>(Param::lookahead)] = 12.0F;
    EXPECT_EQ(b->f.coprocessor.restore_parameters(stored), 0U);
    EXPECT_EQ(b->f.coprocessor.parameters().get(Param::lookahead), 12.0F);
    EXPECT_EQ(b->f.coprocessor.parameters().configuration().rules.lookahead, 12.0F) << "before the first step";
    can::GetSetRequest ask;
    ask.index = static_cast<std::uint16_t>(Param::lookahead);
    b->ask(ask);
    b->fly(2);
    EXPECT_EQ(b->heard.params.back().value.real, 12.0F);
    EXPECT_EQ(b->heard.params.back().initial.real, 9.0F);
    can::ExecuteOpcodeRequest opcode;
    opcode.opcode = can::ExecuteOpcodeRequest::kErase;
    b->ask(opcode);
    b->fly(2);
    EXPECT_TRUE(b->heard.opcodes.back().ok);
    EXPECT_EQ(b->f.coprocessor.parameters().get(Param::lookahead), 9.0F);
}

}  // namespace
}  // namespace jink::app
