// SPDX-License-Identifier: BSD-3-Clause
// Memory protection and caches of a Cortex-M against models of them (ARMv7-M Architecture Reference Manual, B2.2.7,
// B3.5 and B4.8).
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "hal/cortex_m/caches.hpp"
#include "hal/cortex_m/memory_protection.hpp"

namespace jink::hal {
namespace {

using namespace cortex_m;

struct ProtectionModel {
    std::uint32_t regions = 8;
    std::uint32_t control = 0, number = 0;
    std::vector<std::uint32_t> bases = std::vector<std::uint32_t>(8, 0);
    std::vector<std::uint32_t> sizes = std::vector<std::uint32_t>(8, 0);

    /// Whether an address can be read by the program; unit off or no region: the default map.
    [[nodiscard]] bool is_allowed(std::uint32_t address) const { return access_to(address) != 0; }
    [[nodiscard]] bool is_default(std::uint32_t address) const { return access_to(address) == 1; }

    /// 0: none; 1: by the default map; 2: strongly ordered, not executable.
    [[nodiscard]] int access_to(std::uint32_t address) const
    {
        if ((control & 1U) == 0) {
            return 1;
        }
        for (std::size_t i = bases.size(); i-- > 0;) {
            const std::uint32_t size = sizes[i];
            const std::uint64_t bytes = 2ULL << (size >> 1U & 0x1FU);
            if ((size & 1U) == 0 || address < bases[i] || address - bases[i] >= bytes) {
                continue;
            }
            const std::uint64_t eighth = (address - bases[i]) / (bytes / 8);
            if ((size >> 8U >> eighth & 1U) != 0) {
                continue;
            }
            EXPECT_EQ(bases[i] % bytes, 0U) << "aligned to its size";
            EXPECT_NE(size & 1U << 28U, 0U) << "not executable";
            EXPECT_EQ(size >> 16U & 0x3FU, 0U) << "strongly ordered";
            return (size >> 24U & 7U) == 0 ? 0 : 2;
        }
        return (control & 4U) != 0 ? 1 : 0;
    }
};
struct ByProtection {
    ProtectionModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        EXPECT_EQ(offset, 0xD90U);
        return m->regions << 8U;
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        switch (offset) {
        case 0xD94: m->control = value; break;
        case 0xD98: m->number = value; break;
        case 0xD9C: m->bases[m->number] = value & ~0x1FU; break;
        case 0xDA0: m->sizes[m->number] = value; break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
};

TEST(StackGuard, RefusesTheMemoryBelowTheStackAndNothingElse)
{
    ProtectionModel model;
    constexpr std::uint32_t kBottom = 0x20000000;
    ASSERT_TRUE(guard_stack(ByProtection{&model}, kBottom));
    EXPECT_TRUE(model.is_default(kBottom));
    EXPECT_FALSE(model.is_allowed(kBottom - 1));
    EXPECT_FALSE(model.is_allowed(kBottom - 12 * 1024)) << "as much as the stack has";
    EXPECT_FALSE(model.is_allowed(kBottom - (1U << kStackGuardLog2)));
    EXPECT_TRUE(model.is_default(kBottom - (1U << kStackGuardLog2) - 1));
    Random random(1);
    for (int i = 0; i < 10'000; ++i) {
        const auto address = static_cast<std::uint32_t>(kBottom - random.below(1U << 20U));
        EXPECT_EQ(is_guarded(kBottom, address), !model.is_allowed(address)) << address;
    }
    EXPECT_FALSE(is_guarded(kBottom, kBottom));
    EXPECT_FALSE(is_guarded(kBottom, 0x08000000));
}

TEST(StackGuard, LeavesWhatChipsKeepOfThemselvesReadable)
{
    for (const std::uint32_t address : {0x1FFF7A10U, 0x1FFF7A22U,     // STM32F405: unique id, size of the flash
                                        0x1FF1E800U, 0x1FF1E880U}) {  // STM32H743
        EXPECT_FALSE(is_guarded(0x20000000, address)) << address;
        EXPECT_FALSE(is_guarded(0x20000000, address + 11)) << address;
    }
}

TEST(StackGuard, NeedsAnAlignedStackAndARegion)
{
    ProtectionModel model;
    EXPECT_FALSE(guard_stack(ByProtection{&model}, 0x20000000 + 0x1000));
    EXPECT_FALSE(guard_stack(ByProtection{&model}, 0));
    EXPECT_FALSE(guard_stack(ByProtection{&model}, 0x20000000, 8));
    model.regions = 0;
    EXPECT_FALSE(guard_stack(ByProtection{&model}, 0x20000000));
    EXPECT_EQ(model.control, 0U);
}

TEST(MemoryProtection, RegionsOfBothKindsAndLeftOutEighths)
{
    ProtectionModel model;
    ASSERT_TRUE(protect(ByProtection{&model}, {1, 0, 32, Access::none, 0xE7}));
    ASSERT_TRUE(protect(ByProtection{&model}, {2, 0x081C0000, 18, Access::strongly_ordered}));
    for (std::uint64_t eighth = 0; eighth < 8; ++eighth) {
        const auto base = static_cast<std::uint32_t>(eighth << 29U);
        for (const std::uint32_t address : {base, base + 0x1FFFFFFFU}) {
            EXPECT_EQ(model.is_allowed(address), eighth != 3 && eighth != 4) << address;
        }
    }
    EXPECT_EQ(model.access_to(0x081BFFFF), 1);
    EXPECT_EQ(model.access_to(0x081C0000), 2);
    EXPECT_EQ(model.access_to(0x081FFFFF), 2);
    EXPECT_EQ(model.access_to(0x08200000), 1);
}

/// A data cache whose lines are undefined after a reset.
struct CacheModel {
    std::uint32_t sets = 128, ways = 4, words_in_line = 8;
    std::uint32_t configuration = 0x200;
    std::set<std::uint32_t> forgotten;  ///< values written to DCISW
    bool instructions_forgotten = false, selected = false;
    int barriers = 0;
};
struct ByCache {
    CacheModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const
    {
        if (offset == 0xD80) {
            EXPECT_TRUE(m->selected && m->barriers > 0) << "after the selection took effect";
            std::uint32_t line = 0;
            while (4U << line < m->words_in_line) {
                ++line;
            }
            return (m->sets - 1) << 13U | (m->ways - 1) << 3U | line;
        }
        EXPECT_EQ(offset, 0xD14U);
        return m->configuration;
    }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        switch (offset) {
        case 0xD14:
            EXPECT_TRUE(m->instructions_forgotten);
            EXPECT_EQ(m->forgotten.size(), m->sets * m->ways) << "before it is on";
            EXPECT_EQ(m->barriers, 2);
            m->configuration = value;
            break;
        case 0xD84: m->selected = value == 0; break;
        case 0xF50: m->instructions_forgotten = true; break;
        case 0xF60: m->forgotten.insert(value); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
};

TEST(Caches, AreEmptiedLineByLineBeforeTheyAreOn)
{
    struct Geometry {
        std::uint32_t sets, ways, words;
    };
    for (const Geometry g :
         {Geometry{128, 4, 8}, Geometry{64, 4, 8}, Geometry{512, 4, 8}, Geometry{32, 2, 4}, Geometry{16, 1, 8}}) {
        CacheModel model;
        model.sets = g.sets;
        model.ways = g.ways;
        model.words_in_line = g.words;
        start_caches(ByCache{&model}, [&] { ++model.barriers; });
        EXPECT_EQ(model.configuration, 0x200U | 1U << 16U | 1U << 17U);
        EXPECT_EQ(model.barriers, 3);
        const std::uint32_t line_bytes = 4 * g.words;
        for (std::uint32_t set = 0; set < g.sets; ++set) {
            for (std::uint32_t way = 0; way < g.ways; ++way) {
                const std::uint32_t top = g.ways == 4 ? way << 30U : g.ways == 2 ? way << 31U : 0;
                EXPECT_EQ(model.forgotten.count(top | set * line_bytes), 1U) << set << " " << way;
            }
        }
    }
}

}  // namespace
}  // namespace jink::hal
