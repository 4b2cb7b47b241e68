// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <vector>

#include "core/base/work_units.hpp"
#include "core/geometric/clearance.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {

/// A point of a curve, about its start [m], and its time [s].
struct CurvePoint {
    Vec3 position;
    Seconds time = 0.0F;
};

/// A curve through these points. The array after them does not belong to the curve: filled with `behind`, early and far
/// away.
inline detail::Curve curve_through(const std::vector<CurvePoint>& points, const Vec3& behind = Vec3::Constant(1e3F))
{
    detail::Curve curve{};
    curve.points = points.size();
    for (std::size_t i = 0; i < kMaxPathPoints; ++i) {
        const Vec3& p = i < points.size() ? points[i].position : behind;
        curve.x[i] = p.x();
        curve.y[i] = p.y();
        curve.z[i] = p.z();
        curve.t[i] = i < points.size() ? points[i].time : 0.0F;
    }
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        curve.fastest = std::max(curve.fastest, curve.velocity(i).cwiseAbs().maxCoeff());
    }
    return curve;
}

/// One curve from the world's origin on, checked against the scene's static obstacles: none at first. The box extends
/// half a metre to each side.
struct CurveBench : Scene {
    detail::Curve curve{};
    detail::Selection deferred{};
    std::uint32_t spent = 0;  ///< by the last check, without collection and the check of the airspace's bounds
    std::uint32_t counted_solids = 0;

    explicit CurveBench(const std::vector<CurvePoint>& points) : curve(curve_through(points))
    {
        threats.clear();
        problem.main = kNoThreat;
        problem.frame = make_path_frame(Vec3::Zero(), Vec3::UnitX());
        limits.half_extents = Vec3::Constant(0.5F);
        settings.escape_from_margin = false;
    }

    /// `collected`: points of other curves, whose reach is checked as well.
    detail::Verdict check(detail::Clearance::Part part = detail::Clearance::Part::all,
                          std::initializer_list<Vec3> collected = {}, std::uint32_t units = 1'000'000)
    {
        put_into(problem);
        detail::Clearance clearance(problem, settings, limits);
        detail::Extent reach = detail::extent_of(curve);
        for (const Vec3& point : collected) {
            reach = {reach.low.cwiseMin(point), reach.high.cwiseMax(point)};
        }
        clearance.defer(deferred);
        WorkBudget plenty(1'000'000);
        clearance.collect(reach, curve.duration(), plenty);
        clearance.sweep_until(curve.duration());
        counted_solids = clearance.solids();
        WorkBudget left(units);
        const detail::Verdict verdict = clearance.check(curve, left, part);
        spent = left.spent() - std::min(left.spent(), units::bounds_units(curve.points));
        return verdict;
    }
    CandidateStatus status() { return check().status; }
};

}  // namespace jink::geometric
