// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "firmware/linux/c_interface/jink.h"
#include "tests/numbers.hpp"

namespace jink_c_test {

using jink::kInfinity;
using jink::kNan;

struct Destroyer {
    void operator()(jink_coprocessor* handle) const { jink_destroy(handle); }
};
using Handle = std::unique_ptr<jink_coprocessor, Destroyer>;

/// Zeros but for its size.
template <class Sized>
Sized sized()
{
    Sized value{};
    value.size = sizeof value;
    return value;
}

inline Handle create(const jink_options& options = sized<jink_options>())
{
    jink_coprocessor* handle = nullptr;
    EXPECT_EQ(jink_create(JINK_ABI, &options, &handle), JINK_OK);
    return Handle(handle);
}

inline jink_track_report good_track()
{
    auto report = sized<jink_track_report>();
    report.id = 7;
    report.source = JINK_SOURCE_OWN_SENSOR;
    report.position[0] = 50.0F;
    report.stamp_us = 1'000'000;
    return report;
}

inline jink_range_report good_range()
{
    auto report = sized<jink_range_report>();
    report.direction[0] = 2.0F;
    report.range = 5.0F;
    report.max_range = 20.0F;
    report.half_angle = 0.1F;
    report.stamp_us = 1'000'000;
    return report;
}

inline jink_closed_area good_area()
{
    auto area = sized<jink_closed_area>();
    area.radius = 20.0F;
    area.top = 100.0F;
    return area;
}

}  // namespace jink_c_test
