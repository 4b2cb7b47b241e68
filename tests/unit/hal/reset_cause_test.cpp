// SPDX-License-Identifier: BSD-3-Clause
// Reset causes of the STM32F4 and H7 against models of their registers: flags stay until they are removed.
#include <gtest/gtest.h>

#include "hal/stm32f4/reset_flags.hpp"
#include "hal/stm32h7/reset_flags.hpp"

namespace jink::hal {
namespace {

using stm32::ResetCause;

/// RCC_CSR as RM0090, 7.3.21 has it, or RCC_RSR as RM0433, 8.4.4 and 8.7 have it.
struct ResetModel {
    std::uint32_t offset;
    std::uint32_t remove;
    std::uint32_t kept;  ///< bits that are no flags
    std::uint32_t* value;

    [[nodiscard]] std::uint32_t read(std::uint32_t at) const
    {
        EXPECT_EQ(at, offset);
        return *value;
    }
    void write(std::uint32_t at, std::uint32_t to) const
    {
        ASSERT_EQ(at, offset);
        *value = (to & remove) != 0 ? *value & kept : *value;
    }
};

ResetCause cause_on_f4(std::uint32_t flags)
{
    std::uint32_t csr = flags | 3U;  // the slow oscillator is on
    const ResetModel model{0x74, 1U << 24U, 0x00FFFFFF, &csr};
    const ResetCause cause = take_reset_cause(model, stm32f4::kResetFlags);
    EXPECT_EQ(csr, 3U) << "flags are removed";
    EXPECT_EQ(take_reset_cause(model, stm32f4::kResetFlags), ResetCause::unknown);
    return cause;
}

ResetCause cause_on_h7(std::uint32_t flags)
{
    std::uint32_t rsr = flags;
    const ResetModel model{0xD0, 1U << 16U, 0, &rsr};
    const ResetCause cause = take_reset_cause(model, stm32h7::kResetFlags);
    EXPECT_EQ(rsr, 0U) << "flags are removed";
    EXPECT_EQ(take_reset_cause(model, stm32h7::kResetFlags), ResetCause::unknown);
    return cause;
}

TEST(ResetCause, EachIsReportedOnceOnTheF4)
{
    constexpr std::uint32_t kPin = 1U << 26U;  // pulled by every reset
    EXPECT_EQ(cause_on_f4(0), ResetCause::unknown);
    EXPECT_EQ(cause_on_f4(kPin), ResetCause::pin);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 25U | 1U << 27U), ResetCause::power);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 25U), ResetCause::power);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 28U), ResetCause::software);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 29U), ResetCause::independent_watchdog);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 30U), ResetCause::other);
    EXPECT_EQ(cause_on_f4(kPin | 1U << 31U), ResetCause::other);
    // At power-on a watchdog cannot have done anything yet.
    EXPECT_EQ(cause_on_f4(kPin | 1U << 29U | 1U << 27U), ResetCause::power);
}

TEST(ResetCause, EachIsReportedOnceOnTheH7)
{
    constexpr std::uint32_t kProcessor = 1U << 17U;  // reset in every case
    constexpr std::uint32_t kPin = kProcessor | 1U << 22U;
    constexpr std::uint32_t kDomains = 1U << 19U | 1U << 20U;
    EXPECT_EQ(cause_on_h7(0), ResetCause::unknown);
    EXPECT_EQ(cause_on_h7(0x00E80000), ResetCause::power) << "the register's value after power-on";
    EXPECT_EQ(cause_on_h7(kPin | kDomains | 1U << 21U | 1U << 23U), ResetCause::power) << "by the table of sources";
    EXPECT_EQ(cause_on_h7(kProcessor), ResetCause::unknown);
    EXPECT_EQ(cause_on_h7(1U << 19U), ResetCause::unknown) << "a domain that leaves its standby";
    EXPECT_EQ(cause_on_h7(1U << 20U), ResetCause::unknown);
    EXPECT_EQ(cause_on_h7(kPin), ResetCause::pin);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 21U), ResetCause::power);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 24U), ResetCause::software);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 26U), ResetCause::independent_watchdog);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 28U), ResetCause::other);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 30U), ResetCause::other);
    EXPECT_EQ(cause_on_h7(kPin | 1U << 26U | 1U << 28U), ResetCause::independent_watchdog) << "both watchdogs";
    EXPECT_EQ(cause_on_h7(kPin | 1U << 26U | 1U << 23U), ResetCause::power);
}

}  // namespace
}  // namespace jink::hal
