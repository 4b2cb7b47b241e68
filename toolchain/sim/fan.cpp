// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/fan.hpp"

#include <cmath>
#include <sstream>

namespace jink::sim {
namespace {

constexpr int kPoints = 24;

std::string_view to_string(geometric::CandidateStatus status)
{
    using geometric::CandidateStatus;
    switch (status) {
    case CandidateStatus::available: return "available";
    case CandidateStatus::chosen: return "chosen";
    case CandidateStatus::hits_static: return "hits_static";
    case CandidateStatus::hits_moving: return "hits_moving";
    case CandidateStatus::hits_airspace: return "hits_airspace";
    case CandidateStatus::not_flyable: return "not_flyable";
    case CandidateStatus::not_evaluated: break;
    }
    return "not_evaluated";
}

std::string describe(const geometric::Candidate& candidate)
{
    std::ostringstream text;
    text.precision(3);
    text << to_string(candidate.shape.family) << ", plane "
         << static_cast<double>(candidate.shape.plane) * 180.0 / 3.14159265358979 << " deg, offset "
         << static_cast<double>(candidate.shape.offset) << " m, cost " << static_cast<double>(candidate.total);
    return text.str();
}

}  // namespace

std::vector<FanCurve> fan_of(const app::Coprocessor& coprocessor, const app::StepReport& report, std::string& chosen)
{
    const geometric::Result& plan = coprocessor.planner().last();
    std::vector<FanCurve> fan;
    if (!report.guidance.conflict) {
        return fan;
    }
    const Vec3 origin = coprocessor.own().position;
    const Vec3 to_point = report.guidance.conflict->own_at_closest - origin;
    const float distance = to_point.norm();
    if (!(distance > 0.0F)) {
        return fan;
    }
    const geometric::PathFrame frame = geometric::make_path_frame(origin, to_point);
    for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
        const geometric::Candidate& candidate = plan.candidates[i];
        FanCurve curve;
        curve.status = to_string(candidate.status);
        curve.cost = static_cast<double>(candidate.total);
        const float length = geometric::curve_length_x(candidate.shape.family, distance);
        for (int k = 0; k <= kPoints; ++k) {
            const float s = length * static_cast<float>(k) / static_cast<float>(kPoints);
            const float y = geometric::curve_offset(candidate.shape, distance, s);
            const Vec3 in_frame(s, y * std::cos(candidate.shape.plane), y * std::sin(candidate.shape.plane));
            curve.points.push_back((frame.origin + frame.axes * in_frame).cast<double>());
        }
        if (candidate.status == geometric::CandidateStatus::chosen) {
            chosen = describe(candidate);
        }
        fan.push_back(curve);
    }
    return fan;
}

}  // namespace jink::sim
