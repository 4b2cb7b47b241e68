// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink {

/// Units of work that a computation may still spend.
///
/// One unit stands for about 100 instructions of a Cortex-M7. What each kind of work costs is said by weights
/// (work_units.hpp, and core/geometric for its candidates), before it is done; no work takes more than 160 instructions
/// a unit in any recorded case, on the Cortex-M7 and on the Cortex-M4F, which pays more for doubles in software. So a
/// budget bounds the instructions of what it counts: `units` * 160. Never time, so results do not depend on the
/// machine; with the same weights they are the same, and where doubles are in software they differ only where a budget
/// runs out.
///
/// A method that finds its budget spent stops and answers with what is safe to say, never with a guess: what was not
/// looked at to the end counts as contact.
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
