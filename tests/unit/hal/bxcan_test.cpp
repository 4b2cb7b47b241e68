// SPDX-License-Identifier: BSD-3-Clause
// The bxCAN driver against a model of the controller, written from the manual (ST RM0090, 32).
#include "hal/stm32f4/bxcan.hpp"

#include <deque>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::hal::stm32f4 {
namespace {

/// A frame as the wire has it.
struct WireFrame {
    std::uint32_t id = 0;
    bool extended = false;
    bool remote = false;
    std::vector<std::uint8_t> data;
    friend bool operator==(const WireFrame&, const WireFrame&) = default;
};

struct Model {
    std::uint32_t master = 0x00010002, status = 0x00000C02;  // asleep after a reset
    std::uint32_t timing = 0x01230000, interrupts = 0, errors = 0;
    std::map<std::uint32_t, std::uint32_t> filters;
    struct Mailbox {
        std::uint32_t words[4] = {};
        bool pending = false;
        unsigned order = 0;
    } boxes[3];
    unsigned requests = 0;
    std::uint32_t completed = 0;
    std::deque<std::array<std::uint32_t, 4>> fifo;
    bool overrun = false, error_interrupt = false, stuck = false, woken = false;
    std::vector<WireFrame> line;
    std::function<void()> after_look;  ///< an interrupt right after a check of the errors, once

    std::uint32_t read(std::uint32_t offset)
    {
        if (offset >= 0x1B0 && offset < 0x1C0) {
            return fifo.empty() ? 0U : fifo.front()[(offset - 0x1B0) / 4];
        }
        if (offset >= 0x200) {
            return filters[offset];
        }
        switch (offset) {
        case 0x000: return master;
        case 0x004: return status | (error_interrupt ? 4U : 0U);
        case 0x008: {
            std::uint32_t value = completed;
            for (unsigned i = 0; i < 3; ++i) {
                value |= boxes[i].pending ? 0U : 1U << (26U + i);
            }
            return value;
        }
        case 0x00C:
            return static_cast<std::uint32_t>(fifo.size()) | (fifo.size() == 3 ? 8U : 0U) | (overrun ? 16U : 0U);
        case 0x014: return interrupts;
        case 0x018: {
            const std::uint32_t seen = errors;
            if (const auto interrupt = std::exchange(after_look, nullptr)) {
                interrupt();
            }
            return seen;
        }
        case 0x01C: return timing;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        if (offset >= 0x180 && offset < 0x1B0) {
            Mailbox& box = boxes[(offset - 0x180) / 0x10];
            const std::uint32_t word = (offset & 0xFU) / 4;
            EXPECT_FALSE(box.pending) << "a full mailbox is written";
            box.words[word] = value & ~(word == 0 ? 1U : 0U);
            if (word == 0 && (value & 1U) != 0) {
                box.pending = true;
                box.order = ++requests;
            }
            return;
        }
        if (offset >= 0x200) {
            if (offset >= 0x240 || offset == 0x204 || offset == 0x20C || offset == 0x214) {
                EXPECT_EQ(filters[0x200] & 1U, 1U) << "filters are set while they are initialised";
            }
            filters[offset] = value;
            return;
        }
        switch (offset) {
        case 0x000:
            master = value;
            status = (value & 1U) != 0 ? (status & ~2U) | 1U : stuck ? status : status & ~3U;
            break;
        case 0x004: error_interrupt = error_interrupt && (value & 4U) == 0; break;
        case 0x008: completed &= ~value; break;
        case 0x00C:
            overrun = overrun && (value & 16U) == 0;
            if ((value & 32U) != 0 && !fifo.empty()) {
                fifo.pop_front();
            }
            break;
        case 0x014: interrupts = value; break;
        case 0x018: errors = (errors & ~0x70U) | (value & 0x70U); break;
        case 0x01C:
            EXPECT_EQ(status & 1U, 1U) << "the timing is set in initialisation only";
            timing = value;
            break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void arrive(const WireFrame& f)
    {
        if ((status & 3U) != 0 || (filters[0x21C] & 1U) == 0 || (filters[0x200] & 1U) != 0) {
            return;
        }
        std::array<std::uint32_t, 4> w{};
        w[0] = (f.extended ? f.id << 3U | 4U : f.id << 21U) | (f.remote ? 2U : 0U);
        w[1] = static_cast<std::uint32_t>(f.data.size());
        for (std::size_t i = 0; i < f.data.size(); ++i) {
            w[2 + i / 4] |= static_cast<std::uint32_t>(f.data[i]) << (8 * (i % 4));
        }
        if (fifo.size() == 3) {
            overrun = true;
            fifo.back() = w;  // not locked: the newest takes the place of the last
            return;
        }
        fifo.push_back(w);
    }
    /// One frame leaves: the oldest request where TXFP is set, else the smallest identifier.
    void transmit()
    {
        Mailbox* next = nullptr;
        unsigned index = 0;
        for (unsigned i = 0; i < 3; ++i) {
            if (boxes[i].pending && (next == nullptr || ((master & 4U) != 0 ? boxes[i].order < next->order
                                                                            : boxes[i].words[0] < next->words[0]))) {
                next = &boxes[i];
                index = i;
            }
        }
        if (next == nullptr) {
            return;
        }
        WireFrame f;
        f.extended = (next->words[0] & 4U) != 0;
        f.remote = (next->words[0] & 2U) != 0;
        f.id = f.extended ? next->words[0] >> 3U : next->words[0] >> 21U;
        for (std::uint32_t i = 0; i < (next->words[1] & 15U) && !f.remote; ++i) {
            f.data.push_back(static_cast<std::uint8_t>(next->words[2 + i / 4] >> (8 * (i % 4))));
        }
        line.push_back(f);
        next->pending = false;
        completed |= 1U << (8 * index);
    }
};

struct ByModel {
    Model* m;
    std::uint32_t read(std::uint32_t offset) const { return m->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write(offset, value); }
};
struct Waking {
    Model* m;
    void operator()() const { m->woken = true; }
};

class BxCanTest : public testing::Test {
protected:
    Model model;
    BxCan<ByModel, Waking> can{ByModel{&model}, Waking{&model}};

    void start() { ASSERT_TRUE(can.start(42'000'000, 1'000'000)); }
    void serve()
    {
        if (!model.fifo.empty() || model.overrun) {
            can.on_receive();
        }
        if (model.completed != 0 || model.woken) {
            model.woken = false;
            can.on_transmit();
        }
    }
    static WireFrame random_frame(Random& random)
    {
        WireFrame f;
        f.extended = random.below(2) == 0;
        f.remote = random.below(8) == 0;
        f.id = static_cast<std::uint32_t>(random.below(f.extended ? 1U << 29U : 1U << 11U));
        f.data.resize(random.below(9));
        for (auto& b : f.data) {
            b = static_cast<std::uint8_t>(random.below(256));
        }
        return f;
    }
    static CanFrame as_frame(const WireFrame& f)
    {
        CanFrame out;
        out.id = f.id;
        out.extended = f.extended;
        out.remote = f.remote;
        out.length = static_cast<std::uint8_t>(f.data.size());
        for (std::size_t i = 0; i < f.data.size(); ++i) {
            out.data[i] = static_cast<std::byte>(f.data[i]);
        }
        return out;
    }
};

TEST_F(BxCanTest, MakesTheRateByTheManualsFormula)
{
    for (const std::uint32_t rate : {1'000'000U, 500'000U, 250'000U, 125'000U}) {
        ASSERT_TRUE(can.start(42'000'000, rate)) << rate;
        const std::uint32_t prescaler = (model.timing & 0x3FFU) + 1;
        const std::uint32_t before = ((model.timing >> 16U) & 15U) + 1;
        const std::uint32_t after = ((model.timing >> 20U) & 7U) + 1;
        EXPECT_EQ(42'000'000U / prescaler / (1 + before + after), rate);
        const double sampled = (1.0 + before) / (1.0 + before + after);
        EXPECT_NEAR(sampled, 0.86, 0.02);
    }
    EXPECT_EQ(can.health().state, CanState::active);
}

TEST_F(BxCanTest, RefusesRatesItCannotMakeAndABusThatIsStuck)
{
    EXPECT_FALSE(can.start(42'000'000, 0));
    EXPECT_FALSE(can.start(42'000'000, 2'000'000));
    EXPECT_FALSE(can.start(42'000'000, 83'333));
    EXPECT_FALSE(can.start(42'000'000, 2'000));  // prescaler 1500
    model.stuck = true;
    EXPECT_FALSE(can.start(42'000'000, 500'000));
    EXPECT_EQ(can.health().state, CanState::closed);
    EXPECT_FALSE(can.send({}));
    EXPECT_EQ(can.health().frames_refused, 1U);
}

TEST_F(BxCanTest, FramesComeAsTheyWere)
{
    start();
    Random random(1);
    for (int i = 0; i < 20'000; ++i) {
        const WireFrame f = random_frame(random);
        model.arrive(f);
        serve();
        CanFrame got;
        ASSERT_TRUE(can.receive(got));
        const CanFrame expected = as_frame(f);
        ASSERT_EQ(got.id, expected.id);
        ASSERT_EQ(got.extended, expected.extended);
        ASSERT_EQ(got.remote, expected.remote);
        ASSERT_EQ(got.length, expected.length);
        ASSERT_EQ(got.data, expected.data);
    }
    EXPECT_EQ(can.health().frames_in, 20'000U);
    EXPECT_EQ(can.health().overruns, 0U);
}

TEST_F(BxCanTest, FramesLeaveInTheOrderOfSendWhateverTheirIdentifiers)
{
    start();
    Random random(2);
    std::vector<WireFrame> sent;
    for (int i = 0; i < 20'000; ++i) {
        WireFrame f = random_frame(random);
        if (can.send(as_frame(f))) {
            if (f.remote) {
                f.data.clear();
            }
            sent.push_back(f);
        }
        serve();
        if (random.below(3) != 0) {
            model.transmit();
            serve();
        }
    }
    for (int i = 0; i < 100; ++i) {
        model.transmit();
        serve();
    }
    ASSERT_GT(sent.size(), 10'000U);
    EXPECT_EQ(model.line, sent);
    EXPECT_EQ(can.health().frames_out, sent.size());
    EXPECT_EQ(can.health().frames_refused, 20'000U - sent.size());
}

TEST_F(BxCanTest, OverrunsOfFifoAndRingAreCounted)
{
    start();
    Random random(3);
    for (int i = 0; i < 5; ++i) {
        model.arrive(random_frame(random));  // three deep, and not served
    }
    serve();
    EXPECT_EQ(can.health().overruns, 1U);  // the hardware reports an overrun, not the number
    for (std::size_t i = 0; i < 40; ++i) {
        model.arrive(random_frame(random));
        serve();
    }
    EXPECT_EQ(can.health().overruns, 1U + 3U + 40U - 32U);
}

TEST_F(BxCanTest, ErrorsBusOffAndTheReturnAreSeenAndCountedOnce)
{
    start();
    model.errors = 3U << 4U;  // acknowledgement
    can.on_status();
    can.on_status();  // the same one is not counted again
    EXPECT_EQ(can.health().bus_errors, 1U);
    model.errors = 2U;
    can.on_status();
    EXPECT_EQ(can.health().state, CanState::error_passive);
    can.service();
    EXPECT_EQ(can.health().state, CanState::error_passive);
    model.errors = 0;
    can.service();  // no interrupt reports this
    EXPECT_EQ(can.health().state, CanState::active);
    model.errors = 2U;
    can.on_status();
    model.errors = 4U | 2U | 1U;
    can.on_status();
    can.on_status();
    EXPECT_EQ(can.health().state, CanState::bus_off);
    EXPECT_EQ(can.health().bus_offs, 1U);
    EXPECT_FALSE(can.send({}));
    model.errors = 0;
    can.service();
    EXPECT_EQ(can.health().state, CanState::active);
    EXPECT_EQ(can.health().restarts, 1U);
    EXPECT_TRUE(can.send({}));
}

TEST_F(BxCanTest, BusOffBetweenALookAndItsConclusionStands)
{
    for (const std::uint32_t before : {2U, 4U | 2U}) {  // passive, or off the bus and just back
        start();
        model.errors = before;
        can.on_status();
        model.errors = 0;
        model.after_look = [&] {
            if (before != 2U) {
                can.on_status();  // back on it, and off again at once
            }
            model.errors = 4U | 2U;
            can.on_status();
        };
        can.service();
        EXPECT_EQ(can.health().state, CanState::bus_off) << before;
        EXPECT_FALSE(can.send({})) << before;
        model.errors = 0;
        can.service();
        EXPECT_EQ(can.health().state, CanState::active);
        EXPECT_EQ(can.health().restarts, can.health().bus_offs) << before;
    }
}

TEST_F(BxCanTest, WhatNoClassicFrameCanBeIsRefused)
{
    start();
    CanFrame fd;
    fd.fd = true;
    fd.length = 12;
    EXPECT_FALSE(can.send(fd));
    CanFrame wide;
    wide.id = 0x800;
    EXPECT_FALSE(can.send(wide));
    CanFrame odd;
    odd.length = 9;
    EXPECT_FALSE(can.send(odd));
    EXPECT_EQ(can.health().frames_bad, 3U);
    EXPECT_TRUE(model.line.empty());
}

}  // namespace
}  // namespace jink::hal::stm32f4
