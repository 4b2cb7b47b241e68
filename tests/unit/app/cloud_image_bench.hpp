// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/cloud.hpp"
#include "firmware/app/near_field.hpp"

namespace jink::app::test {

/// A range image with its own obstacle table, and scans made of hits.
class CloudImageBench : public ::testing::Test {
protected:
    CloudImageBench()
    {
        image->give_to(*table);
        view.is_placed = true;
        view.stamp = now;
    }
    void look() { image->look_from(view); }
    /// Nothing is known of former scans.
    void forget()
    {
        table->clear();
        image = std::make_unique<CloudObstacles>(0x1000000);
        image->give_to(*table);
        look();
    }
    /// What happens before each scan.
    virtual void before_scan() {}
    void begin(std::uint8_t sensor = 0)
    {
        before_scan();
        link::CloudScan scan;
        scan.stamp = now;
        scan.sensor = sensor;
        scan.max_range = 100.0F;
        image->begin_scan(scan);
    }
    /// Returns the number of obstacles afterwards.
    std::size_t scan(const std::vector<Vec3>& hits, std::uint32_t lost = 0, std::uint8_t sensor = 0)
    {
        begin(sensor);
        for (const Vec3& hit : hits) {
            image->add(link::Ray::hit, hit);
        }
        image->end_scan(lost);
        return obstacles().size();
    }
    [[nodiscard]] std::span<const world::Obstacle> obstacles() const { return table->obstacles(); }
    [[nodiscard]] bool is_covered(const Vec3& place) const
    {
        return std::any_of(obstacles().begin(), obstacles().end(), [&](const world::Obstacle& o) {
            return (nearest_point(o.shape, place) - place).norm() <= 1e-3F;
        });
    }
    [[nodiscard]] const CloudDiagnostics& count() const { return image->diagnostics(); }
    /// At `azimuth` and `elevation` [degrees].
    static Vec3 at(float azimuth, float elevation, float range)
    {
        const float a = azimuth * kPi / 180.0F;
        const float e = elevation * kPi / 180.0F;
        return range * Vec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    }

    std::unique_ptr<world::ObstacleTable> table = std::make_unique<world::ObstacleTable>();
    std::unique_ptr<CloudObstacles> image = std::make_unique<CloudObstacles>(0x1000000);
    CloudView view;
    TimePoint now{20'000'000};
};

}  // namespace jink::app::test
