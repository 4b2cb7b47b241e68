// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink {

/// What work that goes on over several steps may spend in one of them [work units].
class WorkSlice {
public:
    /// `wait(context)` is called where a slice is used up, and returns once the next one has begun.
    constexpr WorkSlice(void (*wait)(void* context) noexcept, void* context) noexcept : wait_(wait), context_(context)
    {
    }

    constexpr void begin(std::uint32_t units) noexcept { left_ = units; }
    /// Takes `units` out of one slice: waits for the next one where fewer are left, and takes all of that where it is
    /// less.
    [[gnu::noinline]] constexpr void take(std::uint32_t units) noexcept
    {
        if (units > left_) {
            wait_(context_);
        }
        left_ -= units < left_ ? units : left_;
        largest_ = units > largest_ ? units : largest_;
    }
    /// Most units that were taken at once: a slice that is no less is never exceeded.
    [[nodiscard]] constexpr std::uint32_t largest() const noexcept { return largest_; }
    [[nodiscard]] constexpr std::uint32_t left() const noexcept { return left_; }

private:
    void (*wait_)(void* context) noexcept;
    void* context_;
    std::uint32_t left_ = 0;
    std::uint32_t largest_ = 0;
};

/// Work units that a computation may still spend.
///
/// One work unit stands for about 100 instructions of a Cortex-M7. Weights (work_units.hpp, and core/geometric for its
/// candidates) say the cost of each kind of work before the work is done. No work takes more than 170 instructions a
/// unit in any recorded case, on the Cortex-M7 and on the Cortex-M4F, whose weights are higher for doubles in software.
/// So a budget bounds the instructions of the work that it counts: `units` * 170. The budget never measures time, so
/// results do not depend on the machine. With the same weights results are the same. Where doubles are in software,
/// results differ only where a budget runs out.
///
/// A method whose budget is spent stops and gives a conservative answer: whatever it has not checked completely counts
/// as contact.
class WorkBudget {
public:
    explicit constexpr WorkBudget(std::uint32_t units) noexcept : left_(units) {}
    /// The work waits for the next slice whenever one is used up. `slice` outlives this.
    constexpr WorkBudget(std::uint32_t units, WorkSlice& slice) noexcept : left_(units), slice_(&slice) {}

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
        if (slice_ != nullptr) {
            slice_->take(units);
        }
        return true;
    }
    /// A budget for a part of the work: `units`, but no more than there are. What it has spent is charged afterwards.
    [[nodiscard]] constexpr WorkBudget part(std::uint32_t units) const noexcept
    {
        WorkBudget of(units < left_ ? units : left_);
        of.slice_ = slice_;
        return of;
    }
    /// Takes what a part has spent.
    constexpr void charge(const WorkBudget& part) noexcept
    {
        left_ -= part.spent_;
        spent_ += part.spent_;
    }
    /// Nothing is left, as after a `spend` that was refused.
    constexpr void exhaust() noexcept
    {
        spent_ += left_;
        left_ = 0;
        exhausted_ = true;
    }

    [[nodiscard]] constexpr std::uint32_t left() const noexcept { return left_; }
    [[nodiscard]] constexpr std::uint32_t spent() const noexcept { return spent_; }
    /// True once a `spend` has been refused.
    [[nodiscard]] constexpr bool exhausted() const noexcept { return exhausted_; }

private:
    std::uint32_t left_;
    std::uint32_t spent_ = 0;
    WorkSlice* slice_ = nullptr;
    bool exhausted_ = false;
};

}  // namespace jink
