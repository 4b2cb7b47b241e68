// SPDX-License-Identifier: BSD-3-Clause
// Laws of the command filter (G-ORCA section 12), against the sum as it is written, in double.
#include "core/orca/smoothing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/base/random.hpp"

namespace jink::orca {
namespace {

Vec3 random_velocity(Random& random, float most)
{
    return {random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
}

/// Eq. 8.3 with its weights, over the available commands.
Eigen::Vector3d mean_of(const std::deque<Vec3>& commands)
{
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0.0;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        sum += static_cast<double>(i + 1) * commands[i].cast<double>();
        weights += static_cast<double>(i + 1);
    }
    return sum / weights;
}

TEST(CommandFilterLaws, IsTheWeightedMeanForLong)
{
    double worst = 0.0;
    for (const std::size_t length : {1U, 2U, 3U, 10U, 31U, 32U}) {
        Random random(length);
        CommandFilter filter(length);
        std::deque<Vec3> last;
        for (int i = 0; i < 50'000; ++i) {
            // Alternating large and small speeds: remainders of large ones would be visible.
            const Vec3 command = random_velocity(random, i / 1500 % 2 == 0 ? 20.0F : 0.01F);
            last.push_back(command);
            if (last.size() > length) {
                last.pop_front();
            }
            const double error = (filter.add(command).cast<double>() - mean_of(last)).cwiseAbs().maxCoeff();
            ASSERT_LT(error, 1e-4) << "length " << length << ", command " << i;
            worst = std::max(worst, error);
        }
    }
    std::printf("[ measured ] worst rounding of the filter %.2g m/s\n", worst);
}

/// After the exact sums nothing of older commands is left.
TEST(CommandFilterLaws, ForgetsRoundingWithTheExactSums)
{
    CommandFilter filter(10);
    Random random(3);
    std::size_t n = 0;
    for (; n < 64 * CommandFilter::kExact - 12; ++n) {
        static_cast<void>(filter.add(random_velocity(random, 1e5F)));
    }
    Vec3 out = Vec3::Zero();
    for (; n < 64 * CommandFilter::kExact + 1; ++n) {
        out = filter.add(Vec3(1e-3F, 0.0F, 0.0F));
    }
    EXPECT_LT((out - Vec3(1e-3F, 0.0F, 0.0F)).norm(), 1e-9F);
}

TEST(CommandFilterLaws, KeepsTheSlewLimitThatTheCommandsKeep)
{
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Random random(seed);
        const float slew = random.uniform(0.01F, 0.5F);
        CommandFilter filter(1 + random.below(CommandFilter::kMax));
        Vec3 command = random_velocity(random, 3.0F);
        Vec3 before = filter.add(command);
        for (int i = 0; i < 500; ++i) {
            const Vec3 direction = random_velocity(random, 1.0F).normalized();
            command += direction * (random.uniform() < 0.5F ? slew : slew * random.uniform());
            const Vec3 out = filter.add(command);
            ASSERT_LE((out - before).norm(), slew * 1.0001F + 1e-5F) << "seed " << seed << ", command " << i;
            before = out;
        }
    }
}

/// Measured on a ramp, once it is warm: (N - 1) / 3 periods late, to the rounding.
TEST(CommandFilterLaws, ARampComesAThirdOfTheLengthLate)
{
    for (std::size_t length = 1; length <= CommandFilter::kMax; ++length) {
        CommandFilter filter(length);
        for (int i = 0; i < 100; ++i) {
            const float value = 0.01F * static_cast<float>(i);
            const float out = filter.add(Vec3(value, 0.0F, 0.0F)).x();
            if (i >= static_cast<int>(length)) {
                const float late = (value - out) / 0.01F * 0.025F;
                ASSERT_NEAR(late, filter.delay(0.025F), 2e-5F) << length << ", command " << i;
            }
        }
    }
}

}  // namespace
}  // namespace jink::orca
