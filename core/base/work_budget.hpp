// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink {

/// Units of work that a computation may still spend.
///
/// Counts contact tests, node visits, support calls; never time, so results do not depend on the machine. A method that
/// finds its budget spent stops and answers with what is safe to say, never with a guess.
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
