// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink {

/// Work units that a computation may still spend.
///
/// One work unit stands for about 100 instructions of a Cortex-M7. Weights (work_units.hpp, and core/geometric for its
/// candidates) say the cost of each kind of work before the work is done. No work takes more than 160 instructions a
/// unit in any recorded case, on the Cortex-M7 and on the Cortex-M4F, whose weights are higher for doubles in software.
/// So a budget bounds the instructions of the work that it counts: `units` * 160. The budget never measures time, so
/// results do not depend on the machine. With the same weights results are the same. Where doubles are in software,
/// results differ only where a budget runs out.
///
/// A method whose budget is spent stops and gives a conservative answer: whatever it has not checked completely counts
/// as contact.
class WorkBudget {
public:
    explicit constexpr WorkBudget(std::uint32_t units) noexcept : left_(units) {}

    /// Takes `units`; false, with nothing left afterwards, when fewer remain.
    [[nodiscard]] constexpr bool spend(std::uint32_t units = 1) noexcept
    {
        if (units > left_) {
            spent_ += left_;
            left_ = 0;
            exhausted_ = true;
            return false;
        }
        left_ -= units;
        spent_ += units;
        return true;
    }

    [[nodiscard]] constexpr std::uint32_t left() const noexcept { return left_; }
    [[nodiscard]] constexpr std::uint32_t spent() const noexcept { return spent_; }
    /// True once a `spend` has been refused.
    [[nodiscard]] constexpr bool exhausted() const noexcept { return exhausted_; }

private:
    std::uint32_t left_;
    std::uint32_t spent_ = 0;
    bool exhausted_ = false;
};

}  // namespace jink
