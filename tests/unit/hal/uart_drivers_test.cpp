// SPDX-License-Identifier: BSD-3-Clause
// The interrupt-fed UART drivers against models of their hardware. The models are written from the manuals (ARM DDI
// 0479, 4.3; ST RM0090, 30; ST RM0433, 48), not from the drivers, and lose bytes where the hardware would.
#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "hal/cmsdk/cmsdk_uart.hpp"
#include "hal/last_words.hpp"
#include "hal/stm32f4/usart.hpp"
#include "hal/stm32h7/usart.hpp"
#include "tests/unit/hal/uart_models.hpp"

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

struct CmsdkCase {
    static constexpr std::size_t kHeld = 1;  ///< received bytes that wait for the handler
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
template <class OfModel, class OfDriver, std::size_t Held, std::uint32_t Clock>
struct StmCase {
    static constexpr std::size_t kHeld = Held;
    using Model = OfModel;
    using Driver = OfDriver;
    static constexpr std::uint32_t kClock = Clock;
    static void serve(Model& m, Driver& d)
    {
        for (int i = 0; i < 3 && (m.interrupt() || m.woken); ++i) {
            m.woken = false;
            d.on_interrupt();
        }
    }
};
using UsartCase = StmCase<UsartModel, stm32f4::Usart<By<UsartModel>, Waking<UsartModel>>, 1, 84'000'000>;
using FifoUsartCase =
    StmCase<FifoUsartModel, stm32h7::Usart<By<FifoUsartModel>, Waking<FifoUsartModel>>, 16, 100'000'000>;

template <class Case>
class UartDriver : public testing::Test {
protected:
    typename Case::Model model;
    typename Case::Driver driver{By<typename Case::Model>{&model}, Waking<typename Case::Model>{&model}};
    void start() { ASSERT_TRUE(driver.start(Case::kClock, 921600)); }
    void serve() { Case::serve(model, driver); }
};
using Cases = testing::Types<CmsdkCase, UsartCase, FifoUsartCase>;
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
        for (std::size_t k = 0; k < TypeParam::kHeld; ++k) {
            this->model.arrive(std::byte{1});
        }
        this->model.arrive(std::byte{2});  // before the handler could run
        this->serve();
    }
    EXPECT_EQ(this->driver.health().overruns, 100U);
    std::array<std::byte, 4096> got{};
    EXPECT_EQ(this->driver.read(got), 100U * TypeParam::kHeld);
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
    EXPECT_GE(this->model.line.size() + TypeParam::Driver::kHardwareBytes, words.size()) << "the rest is in hardware";
    for (std::size_t i = 0; i < TypeParam::Driver::kHardwareBytes; ++i) {
        this->model.shift_out();
    }
    EXPECT_EQ(this->model.line, words);
}

TYPED_TEST(UartDriver, LastWordsAreOnTheLineWhenTheyEndSoThatAResetCutsNone)
{
    this->start();
    this->model.free_running = true;
    this->model.period = 7;  // the hardware's buffers fill up
    Random random(4);
    const Bytes words = random_bytes(random, 200);
    constexpr std::size_t kFiller = 280;
    EXPECT_TRUE(say_last_words<typename TypeParam::Driver>(By<typename TypeParam::Model>{&this->model},
                                                           this->driver.to_send(), words, kFiller, 100));
    ASSERT_GE(this->model.line.size(), kFiller + words.size());
    EXPECT_TRUE(std::equal(words.begin(), words.end(), this->model.line.begin() + kFiller));
}

TYPED_TEST(UartDriver, LastWordsToALineThatIsStuckEnd)
{
    this->start();
    this->driver.write_waiting(Bytes(200), 10);
    EXPECT_LE(this->model.line.size(), 2U);
}

template <class Case>
void damage_one_byte()
{
    typename Case::Model model;
    typename Case::Driver driver{By<typename Case::Model>{&model}, Waking<typename Case::Model>{&model}};
    ASSERT_TRUE(driver.start(Case::kClock, 921600));
    model.arrive(std::byte{0x55}, true);
    Case::serve(model, driver);
    model.arrive(std::byte{0x56});
    Case::serve(model, driver);
    EXPECT_EQ(driver.health().line_errors, 1U);
    std::array<std::byte, 4> got{};
    EXPECT_EQ(driver.read(got), 2U);
    EXPECT_EQ(driver.health().overruns, 0U);
}

TEST(Usart, DamagedBytesAreCountedAndHandedOn)
{
    damage_one_byte<UsartCase>();
    damage_one_byte<FifoUsartCase>();
}

TEST(FifoUsart, AnErrorBelongsToItsByteAlone)
{
    FifoUsartModel model;
    FifoUsartCase::Driver driver{By<FifoUsartModel>{&model}, Waking<FifoUsartModel>{&model}};
    ASSERT_TRUE(driver.start(FifoUsartCase::kClock, 921600));
    for (int i = 0; i < 16; ++i) {
        model.arrive(static_cast<std::byte>(i), i % 4 == 0);
    }
    FifoUsartCase::serve(model, driver);
    EXPECT_EQ(driver.health().line_errors, 4U);
    std::array<std::byte, 32> got{};
    EXPECT_EQ(driver.read(got), 16U);
    EXPECT_EQ(got[15], std::byte{15});
}

TEST(FifoUsart, AnOverrunThatIsFoundAloneIsCountedAndEnds)
{
    FifoUsartModel model;
    FifoUsartCase::Driver driver{By<FifoUsartModel>{&model}, Waking<FifoUsartModel>{&model}};
    ASSERT_TRUE(driver.start(FifoUsartCase::kClock, 921600));
    model.overrun = true;  // the byte before it was read in the meantime
    ASSERT_TRUE(model.interrupt());
    FifoUsartCase::serve(model, driver);
    EXPECT_EQ(driver.health().overruns, 1U);
    EXPECT_FALSE(model.interrupt());
    model.arrive(std::byte{1});
    FifoUsartCase::serve(model, driver);
    std::array<std::byte, 4> got{};
    EXPECT_EQ(driver.read(got), 1U);
}

}  // namespace
}  // namespace jink::hal
