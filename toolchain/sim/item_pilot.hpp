// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Flies the items of a NominalFlight as ArduCopter and PX4's multirotor do.
///
/// An item begins where the vehicle stands when the mission mode is entered or the mission is replaced, and at the
/// place of the item before where that was reached.
class ItemPilot {
public:
    /// @param scenario  outlives the pilot; it has a flight with items
    explicit ItemPilot(const Scenario& scenario);
    virtual ~ItemPilot() = default;
    ItemPilot(const ItemPilot&) = delete;
    ItemPilot& operator=(const ItemPilot&) = delete;

    /// Velocity command for one kStep; goes on to the next item where the present one is done. O(items).
    [[nodiscard]] virtual Vec command(const Truth& own);
    /// The mission mode is entered: the present item is flown from here on.
    virtual void resume(const Truth& own);
    /// The mission mode is left.
    virtual void leave() {}
    /// Another mission takes the place of this one; the index stays.
    virtual void replace(const std::vector<Item>& items, const Truth& own);

    [[nodiscard]] const std::vector<Item>& items() const noexcept { return items_; }
    /// Index of the item that is flown; the last one's at the end.
    [[nodiscard]] std::size_t index() const noexcept { return index_; }
    /// Speed that DO_CHANGE_SPEED asked for last, or the cruise speed [m/s].
    [[nodiscard]] double speed() const noexcept { return speed_; }

protected:
    [[nodiscard]] const Scenario& scenario() const noexcept { return scenario_; }
    [[nodiscard]] const Item& item() const noexcept { return items_[index_]; }
    [[nodiscard]] bool is_last() const noexcept { return index_ + 1 == items_.size(); }
    /// Where the present item began.
    [[nodiscard]] const Vec& from() const noexcept { return from_; }
    void begin_from(const Vec& place) noexcept { from_ = place; }
    /// On to the next item, which begins at `from`.
    void go_on(const Vec& from);
    void go_back_to(std::size_t index) noexcept { index_ = index; }
    /// Another mission; the index stays.
    void take(const std::vector<Item>& items);
    void fly_at(double speed) noexcept { speed_ = speed; }

private:
    [[nodiscard]] bool is_done(const Truth& own) const;
    void skip_commands();
    [[nodiscard]] Vec towards(const Vec& goal, const Truth& own, bool stops) const;
    [[nodiscard]] Vec on_curve(const Item& item, const Truth& own);
    [[nodiscard]] Vec on_circle(const Item& item, const Truth& own);
    [[nodiscard]] Vec down_at(const Vec& place, const Truth& own) const;
    [[nodiscard]] const Item* next_place() const;

    const Scenario& scenario_;
    std::vector<Item> items_;
    std::size_t index_ = 0;
    Vec from_ = Vec::Zero();
    Vec tangent_ = Vec::Zero();  ///< of a curve where it begins [m]
    double speed_;
    double share_ = 0.0;   ///< of a curve that is behind
    double turned_ = 0.0;  ///< [rad]
    double waited_ = 0.0;  ///< [s]
    std::vector<int> jumps_;
};

}  // namespace jink::sim
