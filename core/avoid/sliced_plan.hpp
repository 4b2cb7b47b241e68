// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/planning.hpp"
#include "core/base/flow.hpp"
#include "core/world/snapshot.hpp"

namespace jink::avoid {

/// One plan that goes on over several updates, on a snapshot of the situation in which it began. Its answer is that of
/// the same plan in one piece, bit for bit, however its work is sliced. What asks for it checks the answer against what
/// is known by then.
class SlicedPlan {
public:
    /// `flow` outlives this; nothing else runs in it.
    explicit SlicedPlan(Flow& flow) noexcept : flow_(flow), slice_(&SlicedPlan::wait, this) {}
    SlicedPlan(const SlicedPlan&) = delete;
    SlicedPlan& operator=(const SlicedPlan&) = delete;

    /// Begins a plan; one that runs is dropped. `diagnostics` outlives the plan. O(threats).
    void begin(const world::Situation& situation, const Planning& planning, const Settings& settings,
               Diagnostics& diagnostics) noexcept;
    /// Goes on until the next piece of work (core/base/work_units.hpp) takes more than is left of so many units, or to
    /// its end; true there. No more is done, but for a piece that is more than a whole slice.
    [[nodiscard]] bool advance(std::uint32_t units) noexcept;
    void drop() noexcept { flow_.drop(); }

    [[nodiscard]] bool runs() const noexcept { return flow_.runs(); }
    [[nodiscard]] std::uint32_t spent() const noexcept { return spent_; }
    /// The largest piece of work so far [work units].
    [[nodiscard]] std::uint32_t largest_piece() const noexcept { return slice_.largest(); }
    // Of the last plan that has ended.
    [[nodiscard]] world::PlanStatus status() const noexcept { return status_; }
    [[nodiscard]] bool ran_out() const noexcept { return ran_out_; }
    /// After PlanStatus::found; chosen by what is in the snapshot.
    [[nodiscard]] const world::Manoeuvre& answer() const noexcept { return answer_; }
    [[nodiscard]] const Choice& choice() const noexcept { return choice_; }

private:
    static void wait(void* self) noexcept { static_cast<SlicedPlan*>(self)->flow_.pause(); }
    static void run(void* self) noexcept;

    Flow& flow_;
    WorkSlice slice_;
    world::Snapshot snapshot_;
    Planning planning_;
    Settings settings_;
    Diagnostics* diagnostics_ = nullptr;
    world::Manoeuvre answer_;
    Choice choice_;
    world::PlanStatus status_ = world::PlanStatus::none_available;
    std::uint32_t spent_ = 0;  ///< of the slices until now [work units]
    bool ran_out_ = false;
};

}  // namespace jink::avoid
