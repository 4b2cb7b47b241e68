// SPDX-License-Identifier: BSD-3-Clause
// The monitor never misses an obstacle that is in the cylinder (G-ORCA section 15): random boxes and triangles against
// dense samples of them, in double.
#include "core/orca/monitor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/random.hpp"

namespace jink::orca {
namespace {

struct SeenByMonitor {
    Eigen::Vector3d nearest = Eigen::Vector3d::Zero();  ///< in the scaled space
    bool in_cylinder = false;
};

/// A triangle looked at point by point.
SeenByMonitor look(const Eigen::Vector3d (&corners)[3], double horizontal, double vertical)
{
    SeenByMonitor seen;
    double least = 1e9;
    constexpr int kParts = 120;
    for (int i = 0; i <= kParts; ++i) {
        for (int j = 0; j <= kParts - i; ++j) {
            const double u = static_cast<double>(i) / kParts;
            const double v = static_cast<double>(j) / kParts;
            const Eigen::Vector3d p = u * corners[0] + v * corners[1] + (1.0 - u - v) * corners[2];
            const double h = p.head<2>().norm() / horizontal;
            const double z = std::abs(p.z()) / vertical;
            // Not by a hair: the nearest sample is not quite the nearest point.
            seen.in_cylinder = seen.in_cylinder || (h < 0.97 && z < 0.97);
            if (h * h + z * z < least) {
                least = h * h + z * z;
                seen.nearest = p;
            }
        }
    }
    return seen;
}

TEST(MonitorLaws, NoPieceInTheCylinderIsMissed)
{
    MonitorSettings settings;
    settings.samples = 1;
    int inside = 0;
    int literal_misses = 0;
    int tripped_clear = 0;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        Random random(seed);
        Eigen::Vector3d corners[3];
        for (Eigen::Vector3d& corner : corners) {
            corner =
                Eigen::Vector3d(static_cast<double>(random.uniform(-2, 2)), static_cast<double>(random.uniform(-2, 2)),
                                static_cast<double>(random.uniform(-2, 2)));
        }
        const auto horizontal = static_cast<double>(settings.obstacle_horizontal);
        const auto vertical = static_cast<double>(settings.obstacle_vertical);
        const SeenByMonitor seen = look(corners, horizontal, vertical);
        const auto monitor = std::make_unique<Monitor>(settings);
        const MonitoredPiece piece{1, seen.nearest.cast<float>()};
        const MonitorReport report = monitor->update(TimePoint{1}, Vec3::Zero(), {}, {&piece, 1});
        if (seen.in_cylinder) {
            ++inside;
            ASSERT_TRUE(report.tripped) << "seed " << seed;
            literal_misses += report.horizontal < 1.0F && report.vertical < 1.0F ? 0 : 1;
        } else {
            tripped_clear += report.tripped ? 1 : 0;
        }
    }
    std::printf("[ measured ] %d of 3000 triangles in the cylinder, all seen; the nearest point alone would miss %d; "
                "%d trips without one\n",
                inside, literal_misses, tripped_clear);
    EXPECT_GT(inside, 300);
    EXPECT_GT(literal_misses, 0) << "the reason for looking at the plane";
    EXPECT_LT(tripped_clear, 300);
}

}  // namespace
}  // namespace jink::orca
