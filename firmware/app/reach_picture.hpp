// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reach/scan_picture.hpp"
#include "core/reach/vehicle_sets.hpp"
#include "core/world/cost_to_go_field.hpp"
#include "firmware/app/clouds.hpp"
#include "firmware/app/sight.hpp"

namespace jink::app {

/// What the point clouds say to the reach sets: which of their cells are hit, and which are seen. Only of sensors that
/// tell the pitch of their rays; of others it is not known what they do not see.
///
/// Owned by whoever has clouds. Memory: that of a ScanPicture, and of a CostToGoField, about 150 KiB.
class ReachPicture final : public link::CloudSink, public Sight {
public:
    /// Of the sets whose grid is the widest; they outlive this.
    explicit ReachPicture(const reach::VehicleSets& sets) noexcept;

    /// Holds for scans that begin after this.
    void look_from(const CloudView& view) noexcept { view_ = view; }
    [[nodiscard]] reach::ScanPicture& picture() noexcept { return picture_; }
    [[nodiscard]] const reach::ScanPicture& picture() const noexcept { return picture_; }

    [[nodiscard]] reach::CellSource& cells() noexcept override { return picture_; }
    [[nodiscard]] const world::CostToGo& way_of(const world::Situation& situation, bool plan_runs) noexcept override;
    void advance(WorkBudget& budget) noexcept override;
    void forget_way() noexcept override { way_.forget(); }

    void begin_scan(const link::CloudScan& scan) noexcept override;
    void add(link::Ray ray, const Vec3& point) noexcept override;
    void end_scan(std::uint32_t points_lost) noexcept override;

    [[nodiscard]] std::uint32_t scans() const noexcept { return scans_; }
    /// That could not be used: the own place is not known, or the pitch of the rays, or it is too coarse for the cells.
    [[nodiscard]] std::uint32_t unused() const noexcept { return unused_; }

private:
    const reach::VehicleSets& sets_;
    CloudView view_;
    reach::ScanPicture picture_;
    world::CostToGoField way_;
    std::uint32_t scans_ = 0;
    std::uint32_t unused_ = 0;
};

}  // namespace jink::app
