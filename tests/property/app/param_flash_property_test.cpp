// SPDX-License-Identifier: BSD-3-Clause
// Parameters in flash under random power cuts: after each restart they are those before or after the change in flight.
#include <array>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "firmware/app/param_flash.hpp"
#include "tests/memory_flash.hpp"

namespace jink::app {
namespace {

/// A record of six values has three blocks of 64 bytes: five to sixteen records fill a sector.
template <std::uint32_t UnitBytes, hal::WrongCode Wrong = hal::WrongCode::unreadable>
using CutFlash = hal::MemoryFlash<1024, UnitBytes, Wrong>;

/// Up to two parameters change; of six, so that values go back to the image's own as well.
void change(Random& random, const ParamValues& own, ParamValues& values)
{
    constexpr std::array kChanged{Param::mode, Param::lookahead, Param::track_age,
                                  Param::mass, Param::sticks,    Param::sigma_compared};
    for (std::uint64_t n = 1 + random.below(2); n > 0; --n) {
        const auto i = static_cast<std::size_t>(kChanged[random.below(kChanged.size())]);
        values[i] = random.below(4) == 0 ? own[i] : random.uniform(1.0F, 2.0F);
    }
}

std::uint64_t from_environment(const char* name, std::uint64_t otherwise)
{
    const char* const text = std::getenv(name);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

struct Outcomes {
    int cuts = 0, kept = 0, undone = 0, wrong = 0;
    std::uint32_t erases = 0;
};

/// Changes with a cut in some of them; after each cut a restart.
template <class Flash>
void run(std::uint64_t seed, const ParamValues& own, Outcomes& out)
{
    Random random(seed);
    Flash flash;
    const std::uint32_t words_in_unit = flash.unit_bytes() / 4;
    ParamValues before = own;
    ParamValues after = own;
    bool was_saved = false;
    for (int restarts = 0; restarts < 3; ++restarts) {
        ParamFlash store(flash);
        ParamValues found = own;
        const ParamLoad load = store.load(found);
        const bool is_before = found == before;
        const bool is_after = found == after;
        out.undone += is_before && !is_after ? 1 : 0;
        out.kept += is_after && !is_before ? 1 : 0;
        if ((!is_before && !is_after) || (was_saved && load.damaged)) {
            ++out.wrong;
            ADD_FAILURE() << "restart " << restarts << ": a mixture, or lost; JINK_CASES=1 JINK_SEED=" << seed;
            return;
        }
        before = found;
        // Within a record, or in the erase of a sector.
        const std::uint32_t mask = random.below(3) == 0 ? ~0U : static_cast<std::uint32_t>(random.next());
        flash.cut_at(random.below(random.below(2) == 0 ? 200 : 700) / words_in_unit, mask);
        for (bool goes_on = true; goes_on;) {
            after = before;
            change(random, own, after);
            goes_on = store.save(own, after);
            before = goes_on ? after : before;
            was_saved = was_saved || goes_on;
        }
        ++out.cuts;
        flash.restore();
    }
    out.erases += flash.erases();
}

template <class Flash>
class ParamFlashLaws : public testing::Test {
};
using CutFlashes = testing::Types<CutFlash<4>, CutFlash<8>, CutFlash<32>, CutFlash<32, hal::WrongCode::as_it_looks>>;
TYPED_TEST_SUITE(ParamFlashLaws, CutFlashes);

TYPED_TEST(ParamFlashLaws, ACutAtARandomUnitLeavesTheValuesBeforeOrAfterTheChange)
{
    const ParamValues own = Parameters().values();
    const std::uint64_t sequences = from_environment("JINK_CASES", 10'000);
    const std::uint64_t first = from_environment("JINK_SEED", 20260901);
    Outcomes out;
    for (std::uint64_t i = 0; i < sequences && out.wrong < 5; ++i) {
        run<TypeParam>(first + i, own, out);
    }
    if (sequences < 1000) {
        return;
    }
    EXPECT_EQ(out.cuts, static_cast<int>(3 * sequences));
    EXPECT_GT(out.undone, static_cast<int>(sequences)) << "most cuts come amid a record or an erase";
    EXPECT_GT(out.kept, static_cast<int>(sequences / 100)) << "some complete the last word";
    EXPECT_GT(out.erases, static_cast<std::uint32_t>(sequences / 2));
}

}  // namespace
}  // namespace jink::app
