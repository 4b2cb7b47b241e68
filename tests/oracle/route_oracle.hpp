// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "core/path/route.hpp"

// Routes in double precision, defined by their parts: ends of legs; centre, axis and angle of arcs.

namespace jink::oracle {

using Vec3d = Eigen::Vector3d;

struct RoutePiece {
    bool is_arc = false;
    Vec3d start, end, centre, axis;
    double angle = 0.0;
    double length = 0.0;

    [[nodiscard]] Vec3d at(double s) const
    {
        return is_arc ? Vec3d(centre + Eigen::AngleAxisd(angle * s / length, axis) * (start - centre))
                      : Vec3d(start + (end - start) * (s / length));
    }
    [[nodiscard]] Vec3d along(double s) const
    {
        return is_arc ? Vec3d((std::copysign(1.0, angle) * axis).cross(at(s) - centre).normalized())
                      : Vec3d((end - start).normalized());
    }
};

/// The same route twice: as built by core, and as pieces.
struct TwinRoute {
    path::Route route;
    std::vector<RoutePiece> pieces;

    bool leg(const Vec3& from, const Vec3& to)
    {
        if (route.add_leg(from, to) != path::RouteStatus::ok) {
            return false;
        }
        RoutePiece piece;
        piece.start = pieces.empty() ? Vec3d(from.cast<double>()) : end();
        piece.end = to.cast<double>();
        piece.length = (piece.end - piece.start).norm();
        pieces.push_back(piece);
        return true;
    }
    bool arc(const Vec3& from, const Vec3& centre, const Vec3& axis, float angle)
    {
        if (route.add_arc(from, centre, axis, angle) != path::RouteStatus::ok) {
            return false;
        }
        RoutePiece piece;
        piece.is_arc = true;
        piece.start = from.cast<double>();
        piece.centre = centre.cast<double>();
        piece.axis = axis.cast<double>().normalized();
        piece.angle = double(angle);
        piece.length = std::abs(piece.angle) * (piece.start - piece.centre).norm();
        pieces.push_back(piece);
        return true;
    }
    [[nodiscard]] double length() const
    {
        double sum = 0.0;
        for (const RoutePiece& piece : pieces) {
            sum += piece.length;
        }
        return sum;
    }
    [[nodiscard]] Vec3d end() const { return pieces.back().at(pieces.back().length); }
    /// Continues straight past the end.
    [[nodiscard]] Vec3d at(double s) const
    {
        return reported(s, [](const RoutePiece& p, double on) { return p.at(on); });
    }
    [[nodiscard]] Vec3d along(double s) const
    {
        for (const RoutePiece& piece : pieces) {
            if (s <= piece.length) {
                return piece.along(std::max(s, 0.0));
            }
            s -= piece.length;
        }
        return pieces.back().along(pieces.back().length);
    }
    [[nodiscard]] double distance(const Vec3d& point, double beyond) const
    {
        double least = 1e9;
        for (double s = 0.0; s <= length() + beyond; s += 0.01) {
            least = std::min(least, (at(s) - point).norm());
        }
        return least;
    }

private:
    [[nodiscard]] Vec3d reported(double s, auto of) const
    {
        for (const RoutePiece& piece : pieces) {
            if (s <= piece.length) {
                return of(piece, s);
            }
            s -= piece.length;
        }
        return end() + s * pieces.back().along(pieces.back().length);
    }
};

/// Legs and arcs that continue in the end direction of the previous one, up to `corner` [rad] off.
inline TwinRoute random_route(Random& random, const Vec3& start, bool level, float corner)
{
    const auto any = [&random] {
        return Vec3(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
    };
    TwinRoute twin;
    Vec3 from = start;
    Vec3 along = any();
    along.z() *= level ? 0.0F : 0.3F;
    along.normalize();
    for (std::size_t i = 0, n = 1 + random.below(kMaxRouteSegments); i < n; ++i) {
        if (i > 0 && corner > 0.0F) {
            const Vec3 up = level ? Vec3(Vec3::UnitZ()) : Vec3(any().cross(along).normalized());
            along = Eigen::AngleAxisf(random.uniform(-corner, corner), up) * along;
        }
        if (random.below(2) == 0) {
            static_cast<void>(twin.leg(from, from + random.uniform(3.0F, 60.0F) * along));
        } else {
            const Vec3 axis = level ? Vec3(Vec3::UnitZ()) : Vec3(any().cross(along).normalized());
            const float sense = random.below(2) == 0 ? 1.0F : -1.0F;
            const Vec3 centre = from + random.uniform(8.0F, 80.0F) * sense * axis.cross(along);
            static_cast<void>(twin.arc(from, centre, axis, sense * random.uniform(0.2F, 3.0F)));
        }
        from = twin.route.at(twin.route.length()).position;
        along = twin.route.at(twin.route.length()).along;
    }
    return twin;
}

}  // namespace jink::oracle
