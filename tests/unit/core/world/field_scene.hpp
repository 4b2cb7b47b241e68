// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include <Eigen/Geometry>

#include "core/world/cost_to_go_field.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world::test {

inline const Vec3 kOwn(0, 0, 30);

/// The vehicle at kOwn on a level leg east at 5 m/s.
struct FieldScene : Scene {
    FieldScene()
    {
        own.position = kOwn;
        leg(Vec3(-10, 0, 30), Vec3(200, 0, 30));
    }
    void box(const Vec3& centre, const Vec3& half, float yaw = 0.0F)
    {
        const Vec3 off = Eigen::AngleAxisf(yaw, Vec3::UnitZ()) * (centre - kOwn);
        obstacle(geometry::make_box(kOwn + off, half, Eigen::AngleAxisf(yaw, Vec3::UnitZ()).toRotationMatrix()));
    }
    /// A U about the vehicle, open to the west, 16 m wide; turned about the vehicle.
    void pocket(float yaw = 0.0F)
    {
        box(Vec3(10, 0, 30), Vec3(0.2F, 8, 40), yaw);
        box(Vec3(0, 8, 30), Vec3(10, 0.2F, 40), yaw);
        box(Vec3(0, -8, 30), Vec3(10, 0.2F, 40), yaw);
    }
};

inline Seconds lost(const CostToGoField& field, const Vec3& place) { return field.lost_from(place).value_or(-1.0F); }

/// Builds what was begun to its end, and shows it.
inline void finish(CostToGoField& field)
{
    for (int i = 0; i < 1000 && !field.is_idle(); ++i) {
        WorkBudget budget(100'000);
        if (field.advance(budget) == Progress::done) {
            field.show();
        }
    }
    EXPECT_TRUE(field.is_idle()) << "it does not end";
}

/// The field of a scene, complete and shown.
inline std::unique_ptr<CostToGoField> field_of(const Scene& scene)
{
    auto field = std::make_unique<CostToGoField>();
    field->begin(scene.situation());
    finish(*field);
    return field;
}

}  // namespace jink::world::test
