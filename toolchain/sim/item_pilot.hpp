// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Flies the items of a NominalFlight as ArduCopter and PX4's multirotor do.
///
/// When the mission mode is entered or the mission is replaced, the item begins at the vehicle's position. After a
/// reached item, the next item begins at the reached item's place.
class ItemPilot {
public:
    /// @param scenario  outlives the pilot; it has a flight with items
    explicit ItemPilot(const Scenario& scenario);
    virtual ~ItemPilot() = default;
    ItemPilot(const ItemPilot&) = delete;
    ItemPilot& operator=(const ItemPilot&) = delete;

    /// Velocity command for one kStep; advances to the next item when the present item is done. O(items).
    [[nodiscard]] virtual Vec command(const Truth& own);
    /// The mission mode is entered: the present item begins at the vehicle's position.
    virtual void resume(const Truth& own);
    /// The mission mode is left.
    virtual void leave() {}
    /// Replaces the mission; the index stays.
    virtual void replace(const std::vector<Item>& items, const Truth& own);

    [[nodiscard]] const std::vector<Item>& items() const noexcept { return items_; }
    /// Index of the present item; the last item's index at the end.
    [[nodiscard]] std::size_t index() const noexcept { return index_; }
    /// Speed of the last DO_CHANGE_SPEED, or the cruise speed [m/s].
    [[nodiscard]] double speed() const noexcept { return speed_; }

protected:
    [[nodiscard]] const Scenario& scenario() const noexcept { return scenario_; }
    [[nodiscard]] const Item& item() const noexcept { return items_[index_]; }
    [[nodiscard]] bool is_last() const noexcept { return index_ + 1 == items_.size(); }
    /// Start of the present item.
    [[nodiscard]] const Vec& from() const noexcept { return from_; }
    void begin_from(const Vec& place) noexcept { from_ = place; }
    /// Advances to the next item, which begins at `from`.
    void go_on(const Vec& from);
    void go_back_to(std::size_t index) noexcept { index_ = index; }
    /// Sets another mission; the index stays.
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
    Vec tangent_ = Vec::Zero();  ///< tangent at the start of a curve [m]
    double speed_;
    double share_ = 0.0;   ///< flown share of a curve
    double turned_ = 0.0;  ///< [rad]
    double waited_ = 0.0;  ///< [s]
    std::vector<int> jumps_;
};

}  // namespace jink::sim
