// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/cost_tables.hpp"

#include <cmath>
#include <stdexcept>

namespace jink::host {
namespace {

using cost::tables::kArcSteps;
using cost::tables::kBendSteps;
using cost::tables::kLargestRatio;

float single(double value) { return static_cast<float>(value); }

/// |r| of a column. The costs are even in r: the column before the first equals the column after it.
double ratio_of(std::size_t column, std::size_t steps)
{
    return std::abs(static_cast<double>(column) - 1.0) * static_cast<double>(kLargestRatio) /
           static_cast<double>(steps);
}

/// Replaces r = 0 by a small value: limit of a quotient whose terms vanish as r^2.
double not_zero(double ratio) { return std::max(ratio, 1e-5); }

bool is_mirrored(const ExactCurve& curve)
{
    const std::size_t chords = curve.chords();
    for (std::size_t i = 0; i <= chords; ++i) {
        if (std::abs(curve.offset()[i] - curve.offset()[chords - i]) > 1e-12) {
            return false;
        }
    }
    return chords % 2 == 0;
}

std::vector<std::uint8_t> runs_of(const ExactCurve& curve)
{
    constexpr double kSame = 1e-9;
    std::vector<std::uint8_t> ends;
    int direction = 0;
    for (std::size_t i = 0; i + 1 < curve.chords(); ++i) {
        const double change = curve.slope()[i + 1] - curve.slope()[i];
        const int now = change > kSame ? 1 : change < -kSame ? -1 : direction;
        if (direction != 0 && now != direction) {
            ends.push_back(static_cast<std::uint8_t>(i + 1));
            direction = 0;
        } else {
            direction = now;
        }
    }
    ends.push_back(static_cast<std::uint8_t>(curve.chords()));
    if (ends.size() > cost::tables::kMaxRuns) {
        throw std::runtime_error("a family's slope turns too often for tables");
    }
    return ends;
}

MadeTables::Family make_family(const CurveFamily& family, std::size_t waypoints)
{
    const ExactCurve curve(family, waypoints);
    MadeTables::Family out;
    out.name = family.name;
    out.length = single(family.length);
    out.mirrored = is_mirrored(curve);
    out.runs = runs_of(curve);
    for (const double offset : curve.offset()) {
        out.offset.push_back(single(offset));
    }
    for (const double slope : curve.slope()) {
        out.slope.push_back(single(slope));
    }
    const std::size_t rows = out.mirrored ? curve.chords() / 2 : curve.chords();
    std::vector<double> sum(cost::tables::kArcColumns, 0.0);
    for (std::size_t k = 0; k < rows; ++k) {
        for (std::size_t column = 0; column < sum.size(); ++column) {
            sum[column] += curve.chord(k, ratio_of(column, kArcSteps));
            out.arc.push_back(single(sum[column]));
        }
    }
    for (std::size_t column = 0; column < cost::tables::kArcColumns; ++column) {
        const double ratio = not_zero(ratio_of(column, kArcSteps));
        out.turn.push_back(single(curve.turn(ratio) / (ratio * ratio)));
    }
    for (std::size_t column = 0; column < cost::tables::kBendColumns; ++column) {
        const double ratio = not_zero(ratio_of(column, kBendSteps));
        out.bend.push_back(single(curve.bend(ratio) / (ratio * ratio)));
    }
    return out;
}

/// Rounds up to two digits.
float rounded_up(double value)
{
    const double scale = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return single(std::ceil(value / scale) * scale);
}

cost::tables::Bounds bounds_of(const TableErrors& errors)
{
    return {.length = rounded_up(kBoundMargin * errors.length),
            .time = rounded_up(kBoundMargin * std::max(errors.time, errors.chords)),
            .smoothness = rounded_up(kBoundMargin * errors.smoothness),
            .energy = rounded_up(kBoundMargin * errors.energy)};
}

}  // namespace

std::size_t MadeTables::bytes() const
{
    std::size_t sum = 0;
    for (const Family& f : families) {
        sum += sizeof(float) * (f.offset.size() + f.slope.size() + f.arc.size() + f.turn.size() + f.bend.size()) +
               f.runs.size();
    }
    return sum;
}

cost::tables::Tables MadeTables::view()
{
    family_views.clear();
    for (const Family& f : families) {
        family_views.push_back(
            {f.name, f.length, f.mirrored, f.offset, f.slope, f.runs, f.arc, f.turn, f.bend, f.bounds});
    }
    cost::tables::Tables out;
    out.vehicle = vehicle;
    out.families = family_views;
    out.waypoints = waypoints;
    out = with_limits(out, limits, airframe);
    out.caps = caps;
    out.bytes = bytes();
    return out;
}

MadeTables make_tables(const files::Vehicle& vehicle, std::uint16_t waypoints)
{
    MadeTables made;
    made.vehicle = vehicle.name;
    made.limits = vehicle.limits;
    made.airframe = vehicle.airframe;
    made.caps = vehicle.caps;
    made.waypoints = waypoints;
    for (const CurveFamily& family : curve_families()) {
        made.families.push_back(make_family(family, waypoints));
    }
    const cost::tables::Tables tables = made.view();
    for (std::size_t i = 0; i < made.families.size(); ++i) {
        made.families[i].bounds = bounds_of(sample_errors(tables, i, kMeasuring));
    }
    return made;
}

}  // namespace jink::host
