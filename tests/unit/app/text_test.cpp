// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "firmware/app/text.hpp"

namespace jink::app {
namespace {

template <typename T>
std::string text_of(T value)
{
    Text text;
    text << value;
    return std::string(text.view());
}

TEST(Text, StartsEmpty)
{
    EXPECT_EQ(Text().view(), "");
    EXPECT_EQ(text_of(std::string_view("")), "");
}

TEST(Text, JoinsParts)
{
    Text text;
    text << "jink: fault " << std::uint32_t{17} << ", in " << 2.25F << " s";
    EXPECT_EQ(text.view(), "jink: fault 17, in 2.3 s");
}

TEST(Text, WritesWholeNumbers)
{
    for (const std::uint32_t value : {0U, 1U, 9U, 10U, 99U, 100U, 1000000000U, 4294967295U}) {
        EXPECT_EQ(text_of(value), std::to_string(value));
    }
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {
        const auto value = static_cast<std::uint32_t>(random() >> (random() % 32U));
        ASSERT_EQ(text_of(value), std::to_string(value)) << "seed 1, draw " << i;
    }
}

TEST(Text, WritesOneDecimal)
{
    EXPECT_EQ(text_of(0.0F), "0.0");
    EXPECT_EQ(text_of(0.04F), "0.0");
    EXPECT_EQ(text_of(0.06F), "0.1");
    EXPECT_EQ(text_of(0.96F), "1.0");
    EXPECT_EQ(text_of(1.0F), "1.0");
    EXPECT_EQ(text_of(-1.5F), "-1.5");
    EXPECT_EQ(text_of(-9.99F), "-10.0");
    EXPECT_EQ(text_of(123456.0F), "123456.0");
}

TEST(Text, HasNoNegativeZero)
{
    EXPECT_EQ(text_of(-0.0F), "0.0");
    EXPECT_EQ(text_of(-0.04F), "0.0");
    EXPECT_EQ(text_of(-0.06F), "-0.1");
}

TEST(Text, AsksForWhatIsNotFiniteOrTooLarge)
{
    using Limits = std::numeric_limits<float>;
    for (const float value : {Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), 1e8F,
                              -1e8F, Limits::max(), Limits::lowest()}) {
        EXPECT_EQ(text_of(value), "?") << value;
    }
    EXPECT_EQ(text_of(99999992.0F), "99999992.0");
    EXPECT_EQ(text_of(-99999992.0F), "-99999992.0");
    EXPECT_EQ(text_of(Limits::denorm_min()), "0.0");
}

/// Never further from the value than half a step of the last digit; ties are decided in binary32.
TEST(Text, IsTheNearestTenth)
{
    std::mt19937 random(2);
    std::uniform_real_distribution<float> exponent(-2.0F, 5.0F);
    for (int i = 0; i < 2000; ++i) {
        const float value = std::pow(10.0F, exponent(random)) * ((i & 1) != 0 ? -1.0F : 1.0F);
        const double written = std::stod(text_of(value));
        ASSERT_NEAR(written, static_cast<double>(value), 0.05 + 1e-6) << "seed 2, draw " << i;
        const std::string shown = text_of(value);
        ASSERT_EQ(shown.size() - shown.find('.'), 2U) << shown;
    }
}

TEST(Text, CutsAtFiftyCharacters)
{
    for (std::size_t length = 48; length <= 60; ++length) {
        const std::string all(length, 'x');
        EXPECT_EQ(text_of(std::string_view(all)), all.substr(0, 50)) << length;
    }
    const std::string front(47, 'x');
    Text number;
    number << std::string_view(front) << std::uint32_t{12345};
    EXPECT_EQ(number.view(), front + "123");
    Text real;
    real << std::string_view(front) << -12.5F << "more" << std::uint32_t{7};
    EXPECT_EQ(real.view(), front + "-12");
    EXPECT_EQ(real.view().size(), 50U);
}

}  // namespace
}  // namespace jink::app
