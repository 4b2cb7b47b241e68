// SPDX-License-Identifier: BSD-3-Clause
// The interrupt-fed UART drivers against models of their hardware. The models are written from the manuals (ARM DDI
// 0479, 4.3; ST RM0090, 30), not from the drivers, and lose bytes where the hardware would.
#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "hal/cmsdk/cmsdk_uart.hpp"
#include "hal/stm32f4/usart.hpp"

namespace jink::hal {
namespace {

using Bytes = std::vector<std::byte>;

Bytes random_bytes(Random& random, std::size_t count)
{
    Bytes bytes(count);
    for (std::byte& b : bytes) {
        b = static_cast<std::byte>(random.below(256));
    }
    return bytes;
}

/// The CMSDK APB UART: one byte of buffer each way.
struct CmsdkModel {
    std::uint32_t state = 0, control = 0, interrupts = 0, divider = 0;
    std::uint8_t received = 0;
    std::deque<std::byte> shifting;  ///< one byte at most
    Bytes line;                      ///< sent bytes
    bool woken = false;
    bool free_running = false;  ///< a byte is sent at each read of the state

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x00: state &= ~2U; return received;
        case 0x04:
            if (free_running) {
                shift_out();
            }
            return state;
        case 0x08: return control;
        case 0x0C: return interrupts | overrun_interrupt();
        case 0x10: return divider;
        default: ADD_FAILURE() << "no register at " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        switch (offset) {
        case 0x00:
            if ((state & 1U) != 0) {
                state |= 4U;  // transmit overrun: the byte before is overwritten
                shifting.clear();
            }
            shifting.push_back(static_cast<std::byte>(value));
            state |= 1U;
            break;
        case 0x04: state &= ~(value & 0xCU); break;
        case 0x08: control = value & 0x7F; break;
        case 0x0C:
            interrupts &= ~value;
            state &= ~(value & 0xCU);
            break;
        case 0x10: divider = value & 0xFFFFF; break;
        default: ADD_FAILURE() << "no register at " << offset;
        }
    }
    [[nodiscard]] std::uint32_t overrun_interrupt() const { return state & (control >> 2U) & 0xCU; }
    void arrive(std::byte byte)
    {
        if ((control & 2U) == 0) {
            return;
        }
        state |= (state & 2U) != 0 ? 8U : 0U;
        received = std::to_integer<std::uint8_t>(byte);
        state |= 2U;
        interrupts |= (control & 8U) != 0 ? 2U : 0U;
    }
    void shift_out()
    {
        if (!shifting.empty()) {
            line.push_back(shifting.front());
            shifting.clear();
            state &= ~1U;
            interrupts |= (control & 4U) != 0 ? 1U : 0U;
        }
    }
};

/// A USART of the STM32F4: a shift register and one byte behind it, each way.
struct UsartModel {
    std::uint32_t control1 = 0, divider = 0;
    bool rxne = false, ore = false, line_error = false, read_status = false;
    std::uint8_t received = 0;
    std::deque<std::byte> to_shift;  ///< one byte behind the shift register
    std::deque<std::byte> shifting;
    Bytes line;
    bool woken = false;
    bool free_running = false;  ///< a byte is sent at each read of the status

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x00:
            if (free_running) {
                shift_out();
            }
            read_status = true;
            return (rxne ? 1U << 5U : 0U) | (ore ? 1U << 3U : 0U) | (line_error ? 2U : 0U) |
                   (to_shift.empty() ? 1U << 7U : 0U);
        case 0x04: {
            rxne = false;
            if (read_status) {
                ore = line_error = false;
            }
            return received;
        }
        case 0x0C: return control1;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        switch (offset) {
        case 0x04:
            if (!to_shift.empty()) {
                to_shift.clear();  // overwritten
            }
            to_shift.push_back(static_cast<std::byte>(value));
            feed_shifter();
            break;
        case 0x08: divider = value; break;
        case 0x0C: control1 = value; break;
        case 0x10:
        case 0x14: EXPECT_EQ(value, 0U); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void feed_shifter()
    {
        if (shifting.empty() && !to_shift.empty()) {
            shifting.push_back(to_shift.front());
            to_shift.clear();
        }
    }
    void arrive(std::byte byte, bool damaged = false)
    {
        if ((control1 & 4U) == 0) {
            return;
        }
        if (rxne) {
            ore = true;  // the new byte is lost, the old one stays
            return;
        }
        received = std::to_integer<std::uint8_t>(byte);
        rxne = true;
        line_error = damaged;
        read_status = false;
    }
    void shift_out()
    {
        if (!shifting.empty()) {
            line.push_back(shifting.front());
            shifting.clear();
        }
        feed_shifter();
    }
    [[nodiscard]] bool interrupt() const
    {
        return ((control1 & (1U << 5U)) != 0 && (rxne || ore)) || ((control1 & (1U << 7U)) != 0 && to_shift.empty());
    }
};

template <class Model>
struct By {
    Model* model;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return model->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { model->write(offset, value); }
};
template <class Model>
struct Waking {
    Model* model;
    void operator()() const { model->woken = true; }
};

struct CmsdkCase {
    using Model = CmsdkModel;
    using Driver = CmsdkUart<By<Model>, Waking<Model>>;
    static constexpr std::uint32_t kClock = 25'000'000;
    static void serve(Model& m, Driver& d)
    {
        if ((m.interrupts & 2U) != 0) {
            d.on_receive();
        }
        if (m.overrun_interrupt() != 0) {
            d.on_overrun();
        }
        if ((m.interrupts & 1U) != 0 || m.woken) {
            m.woken = false;
            d.on_transmit();
        }
    }
};
struct UsartCase {
    using Model = UsartModel;
    using Driver = stm32f4::Usart<By<Model>, Waking<Model>>;
    static constexpr std::uint32_t kClock = 84'000'000;
    static void serve(Model& m, Driver& d)
    {
        for (int i = 0; i < 3 && (m.interrupt() || m.woken); ++i) {
            m.woken = false;
            d.on_interrupt();
        }
    }
};

template <class Case>
class UartDriver : public testing::Test {
protected:
    typename Case::Model model;
    typename Case::Driver driver{By<typename Case::Model>{&model}, Waking<typename Case::Model>{&model}};
    void start() { ASSERT_TRUE(driver.start(Case::kClock, 921600)); }
    void serve() { Case::serve(model, driver); }
};
using Cases = testing::Types<CmsdkCase, UsartCase>;
TYPED_TEST_SUITE(UartDriver, Cases);

TYPED_TEST(UartDriver, TakesRatesItCanMakeAndRefusesOthers)
{
    EXPECT_FALSE(this->driver.start(TypeParam::kClock, 0));
    EXPECT_FALSE(this->driver.start(TypeParam::kClock, TypeParam::kClock));           // divider below 16
    EXPECT_FALSE(this->driver.start(TypeParam::kClock, TypeParam::kClock / 33 * 2));  // between 16 and 17: 3 % off
    EXPECT_EQ(this->driver.health().state, PortState::closed);
    for (const std::uint32_t baud : {57600U, 115200U, 460800U, 921600U}) {
        ASSERT_TRUE(this->driver.start(TypeParam::kClock, baud)) << baud;
        const double made = static_cast<double>(TypeParam::kClock) / this->model.divider;
        EXPECT_NEAR(made / baud, 1.0, 0.02) << baud;
    }
    EXPECT_EQ(this->driver.health().state, PortState::open);
}

TYPED_TEST(UartDriver, BytesGoThroughBothWaysInAnyPieces)
{
    this->start();
    Random random(11);
    const Bytes in = random_bytes(random, 50'000);
    const Bytes out = random_bytes(random, 50'000);
    Bytes heard;
    std::size_t sent = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        this->model.arrive(in[i]);
        this->serve();
        this->model.shift_out();
        this->serve();
        if (random.below(64) == 0) {
            std::array<std::byte, 300> piece{};
            const std::size_t n = this->driver.read(piece);
            heard.insert(heard.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(n));
            const std::size_t wanted = std::min<std::size_t>(random.below(100), out.size() - sent);
            sent += this->driver.write({out.data() + sent, wanted});
        }
    }
    for (int i = 0; i < 3000; ++i) {
        this->model.shift_out();
        this->serve();
    }
    std::array<std::byte, 4096> rest{};
    const std::size_t n = this->driver.read(rest);
    heard.insert(heard.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_EQ(heard, in);
    ASSERT_GT(sent, 10'000U);
    EXPECT_EQ(this->model.line, Bytes(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(sent)));
    const PortHealth health = this->driver.health();
    EXPECT_EQ(health.overruns, 0U);
    EXPECT_EQ(health.bytes_in, in.size());
    EXPECT_EQ(health.bytes_out, sent);
}

TYPED_TEST(UartDriver, BytesThatComeFasterThanTheHandlerAreCounted)
{
    this->start();
    for (int i = 0; i < 100; ++i) {
        this->model.arrive(std::byte{1});
        this->model.arrive(std::byte{2});  // before the handler could run
        this->serve();
    }
    EXPECT_EQ(this->driver.health().overruns, 100U);
    std::array<std::byte, 512> got{};
    EXPECT_EQ(this->driver.read(got), 100U);
}

TYPED_TEST(UartDriver, BytesThatFindTheRingFullAreCounted)
{
    this->start();
    constexpr std::size_t kRing = TypeParam::Driver::kReceiveBytes;
    for (std::size_t i = 0; i < kRing + 5; ++i) {
        this->model.arrive(static_cast<std::byte>(i));
        this->serve();
    }
    EXPECT_EQ(this->driver.health().overruns, 5U);
    std::vector<std::byte> got(kRing + 5);
    EXPECT_EQ(this->driver.read(got), kRing);
    EXPECT_EQ(got[0], std::byte{0});  // the oldest are kept
}

TYPED_TEST(UartDriver, WhatFindsNoRoomIsRefusedAndCounted)
{
    EXPECT_EQ(this->driver.write(Bytes(3)), 0U);  // not started
    EXPECT_EQ(this->driver.health().bytes_refused, 3U);
    this->start();
    constexpr std::size_t kRing = TypeParam::Driver::kTransmitBytes;
    EXPECT_EQ(this->driver.write(Bytes(kRing + 7)), kRing);
    EXPECT_EQ(this->driver.health().bytes_refused, 10U);
    EXPECT_EQ(this->driver.health().bytes_out, kRing);
}

TYPED_TEST(UartDriver, LastWordsAreWrittenByWaiting)
{
    this->start();
    this->model.free_running = true;
    Random random(3);
    const Bytes words = random_bytes(random, 200);
    this->driver.write_waiting(words, 10);
    for (int i = 0; i < 4; ++i) {
        this->model.shift_out();
    }
    EXPECT_EQ(this->model.line, words);
}

TYPED_TEST(UartDriver, LastWordsToALineThatIsStuckEnd)
{
    this->start();
    this->driver.write_waiting(Bytes(200), 10);
    EXPECT_LE(this->model.line.size(), 2U);
}

TEST(Usart, DamagedBytesAreCountedAndHandedOn)
{
    UsartModel model;
    UsartCase::Driver driver{By<UsartModel>{&model}, Waking<UsartModel>{&model}};
    ASSERT_TRUE(driver.start(UsartCase::kClock, 921600));
    model.arrive(std::byte{0x55}, true);
    UsartCase::serve(model, driver);
    EXPECT_EQ(driver.health().line_errors, 1U);
    std::array<std::byte, 4> got{};
    EXPECT_EQ(driver.read(got), 1U);
}

}  // namespace
}  // namespace jink::hal
