// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "tests/oracle/problem_threats.hpp"

namespace jink::geometric {

/// Settings that evaluate every candidate as far as possible.
inline Settings every_candidate()
{
    Settings settings;
    settings.evaluate_all = settings.all_terms = true;
    settings.check_units = 1'000'000;
    return settings;
}

/// Level leg along x at 50 m height, a main threat of radius 1 on it 20 m ahead.
struct Scene : ProblemThreats {
    Problem problem;
    Settings settings = every_candidate();
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    Result result;
    WorkBudget budget{1'000'000};

    static Sphere still(const Vec3& position, float radius) { return {{position, Vec3::Zero()}, radius}; }

    Scene()
    {
        threats = {still(Vec3(20.0F, 0.0F, 50.0F), 1.0F)};
        problem.frame = make_path_frame(Vec3(0.0F, 0.0F, 50.0F), Vec3::UnitX());
        problem.distance = 20.0F;
        problem.main_radius = 1.0F;
        problem.main = 0;
        problem.start_velocity = Vec3(5.0F, 0.0F, 0.0F);
    }

    world::PlanStatus run()
    {
        put_into(problem);
        return solve(problem, settings, limits, airframe, budget, result);
    }

    std::size_t count(CandidateStatus status) const
    {
        return static_cast<std::size_t>(std::count_if(result.candidates.begin(), result.candidates.end(),
                                                      [&](const Candidate& c) { return c.status == status; }));
    }
};

/// Two symmetric level candidates, 3.2 radii of the main threat to either side of a leg of 60 m, checked as curves; no
/// threats.
inline Scene two_level_candidates(float main_radius)
{
    Scene scene;
    scene.settings.simple = false;
    scene.settings.extra_planes = 0;
    scene.settings.offset_rule = OffsetRule::source;
    scene.settings.offsets = 2;
    scene.settings.verify_flight = scene.settings.check_acceleration = false;
    scene.problem.distance = 60.0F;
    scene.problem.main_radius = main_radius;
    scene.problem.main = kNoThreat;
    scene.threats.clear();
    return scene;
}

}  // namespace jink::geometric
