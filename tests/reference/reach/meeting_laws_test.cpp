// SPDX-License-Identifier: BSD-3-Clause
// The rate of two stays in time, over random ones.
#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/reference/reach/meeting.hpp"

namespace jink::reach {
namespace {

/// The rate in time is a share, and not lost when stays have an instant in common.
TEST(MeetingLaws, RatesAreSharesAndNeverLost)
{
    constexpr std::uint64_t kSeed = 6;
    Random random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        const auto stay = [&] {
            const float from = static_cast<float>(random.below(8));
            return Stay{from, from + static_cast<float>(random.below(4)) * (i % 2 == 0 ? 1.0F : random.uniform())};
        };
        const Stay own = stay();
        const Stay other = stay();
        const float rate = time_rate(own, other);
        ASSERT_GE(rate, 0.0F);
        ASSERT_LE(rate, 1.0F);
        ASSERT_EQ(rate >= 1e-7F, meet(own, other)) << "seed " << kSeed << ", case " << i;
        ASSERT_GE(time_rate(own, padded(other, 0.1F)), rate);
    }
}

}  // namespace
}  // namespace jink::reach
