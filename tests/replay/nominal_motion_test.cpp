// SPDX-License-Identifier: BSD-3-Clause
// The co-processor's nominal motion in every second of recorded streams, against the actual motion.
#include <gtest/gtest.h>

#include "tests/replay/nominal_oracle.hpp"
#include "tests/replay/recording.hpp"

namespace jink::replay_test {
namespace {

class NominalPath : public testing::TestWithParam<std::string> {};

TEST_P(NominalPath, IsNotContradictedByTheTrueMotionOfTheNextSeconds)
{
    const Recording* const recording = find_recording(GetParam());
    if (recording == nullptr) {
        GTEST_SKIP() << GetParam() << " is not part of this repository; say with JINK_RECORDINGS where it is";
    }
    unsigned wrong = 0;
    bool led = false;
    for (const sim::Belief& belief : beliefs_of(*recording)) {
        const bool ours = belief.control == "ours" || belief.control == "returning";
        // Given up in this very step, because the recorded vehicle follows others: still decided in control.
        const bool leads = ours || (led && belief.control == "refused");
        led = ours;
        const std::string fault = contradiction(*recording, belief);
        // In control, the nominal path is the path to return to, not the flown path.
        if (!fault.empty() && !leads) {
            ++wrong;
            ADD_FAILURE() << belief.time << " s, " << belief.mode.value_or("none") << ": " << fault << ", end "
                          << belief.nominal->end.x() << " " << belief.nominal->end.y() << " "
                          << belief.nominal->end.z();
        }
    }
    EXPECT_EQ(wrong, 0U) << "seconds in which the true motion contradicts the nominal path";
}

INSTANTIATE_TEST_SUITE_P(Recordings, NominalPath, testing::ValuesIn(recording_names()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace jink::replay_test
