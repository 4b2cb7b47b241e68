// SPDX-License-Identifier: BSD-3-Clause
// The cycle counter against a model of the debug registers, written from the manual (ARM DDI 0403E, C1.6.5 and C1.8):
// the counter stands while trace is off, and a Cortex-M7 takes no write to its registers before the key.
#include <gtest/gtest.h>

#include "hal/cortex_m/cycle_counter.hpp"

namespace jink::hal {
namespace {

struct DebugModel {
    bool has_lock = false;
    bool has_counter = true;
    bool is_emulated = false;  ///< as in qemu 7.2: reads 0, keeps nothing
    bool open = false;
    std::uint32_t trace = 0x00000001;  ///< another bit that is set already
    std::uint32_t control = 0x40000000;
    std::uint32_t cycles = 0;

    void pass(std::uint32_t n) { cycles += (trace & 1U << 24U) != 0 && (control & 1U) != 0 ? n : 0U; }
};

struct DebugRegisters {
    DebugModel* model;

    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        if (model->is_emulated) {
            return 0;
        }
        switch (offset) {
        case 0x1000: return model->control | (model->has_counter ? 0U : 1U << 25U);
        case 0x1004: return model->cycles;
        case 0xEDFC: return model->trace;
        default: ADD_FAILURE() << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        const bool may = !model->has_lock || model->open;
        switch (offset) {
        case 0x1000: model->control = may && model->has_counter ? value : model->control; break;
        case 0x1FB0: model->open = model->open || value == 0xC5ACCE55; break;
        case 0xEDFC: model->trace = value; break;
        default: ADD_FAILURE() << offset;
        }
    }
};

TEST(CycleCounter, CountsWithAndWithoutALock)
{
    for (const bool has_lock : {false, true}) {
        DebugModel model;
        model.has_lock = has_lock;
        const cortex_m::CycleCounter counter(DebugRegisters{&model});
        ASSERT_TRUE(counter.is_there());
        EXPECT_EQ(model.trace, 0x01000001U) << "the other bits stay";
        model.cycles = 0xFFFFFFF0;
        const std::uint32_t began = counter.cycles();
        model.pass(100);
        EXPECT_EQ(counter.cycles() - began, 100U) << "over the wrap";
    }
}

TEST(CycleCounter, IsNotThereWhereItIsMissingOrEmulated)
{
    DebugModel without;
    without.has_counter = false;
    EXPECT_FALSE(cortex_m::CycleCounter(DebugRegisters{&without}).is_there());
    DebugModel emulated;
    emulated.is_emulated = true;
    EXPECT_FALSE(cortex_m::CycleCounter(DebugRegisters{&emulated}).is_there());
}

}  // namespace
}  // namespace jink::hal
