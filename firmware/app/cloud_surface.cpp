// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/cloud_surface.hpp"

#include <algorithm>
#include <cmath>

namespace jink::app {
namespace {

constexpr float kAxisAngle = kPi / static_cast<float>(CloudSurface::kAxes);

/// What single precision rounds of sums over 600 m [m].
constexpr float kRounding = 0.01F;

struct LevelAxis {
    float cosine;
    float sine;
};
/// At k * kAxisAngle.
constexpr std::array<LevelAxis, CloudSurface::kAxes> kAxisOf{{{1.00000000F, 0.00000000F},
                                                              {0.98078528F, 0.19509032F},
                                                              {0.92387953F, 0.38268343F},
                                                              {0.83146961F, 0.55557023F},
                                                              {0.70710678F, 0.70710678F},
                                                              {0.55557023F, 0.83146961F},
                                                              {0.38268343F, 0.92387953F},
                                                              {0.19509032F, 0.98078528F},
                                                              {0.00000000F, 1.00000000F},
                                                              {-0.19509032F, 0.98078528F},
                                                              {-0.38268343F, 0.92387953F},
                                                              {-0.55557023F, 0.83146961F},
                                                              {-0.70710678F, 0.70710678F},
                                                              {-0.83146961F, 0.55557023F},
                                                              {-0.92387953F, 0.38268343F},
                                                              {-0.98078528F, 0.19509032F}}};

}  // namespace

CloudMoments& CloudMoments::operator+=(const CloudMoments& other) noexcept
{
    n += other.n;
    x += other.x;
    y += other.y;
    z += other.z;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    zz += other.zz;
    return *this;
}

CloudMoments::Spread CloudMoments::spread() const noexcept
{
    return n > 0.0 ? Spread{xx - x * x / n, xy - x * y / n, yy - y * y / n} : Spread{};
}

float CloudMoments::direction() const noexcept
{
    const Spread s = spread();
    const auto angle = static_cast<float>(0.5 * std::atan2(2.0 * s.xy, s.xx - s.yy));
    return angle < 0.0F ? angle + kPi : angle;
}

double CloudMoments::residual() const noexcept
{
    const Spread s = spread();
    const double upright = 0.5 * (s.xx + s.yy - std::hypot(s.xx - s.yy, 2.0 * s.xy));
    const double level = n > 0.0 ? zz - z * z / n : 0.0;
    return std::max(0.0, std::min(upright, level));
}

double CloudMoments::square_range() const noexcept { return n > 0.0 ? (xx + yy + zz) / n : 0.0; }

void Interval::add(float from, float to) noexcept
{
    low = std::min(low, from);
    high = std::max(high, to);
}

void CloudSurface::add(const Vec3& point) noexcept
{
    for (std::size_t k = 0; k < kAxes; ++k) {
        const float t = kAxisOf[k].cosine * point.x() + kAxisOf[k].sine * point.y();
        level_[k].add(t, t);
    }
    height_.add(point.z(), point.z());
    const float range = point.norm();
    range_.add(range, range);
    const Vec3& p = point;
    add_means(1.0F, {p.x(), p.y(), p.z(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.z() * p.z()});
}

void CloudSurface::add(const geometry::Shape& box) noexcept
{
    const Vec3& c = box.centre;
    const auto reach = [&](const Vec3& direction) {
        return (box.axes.transpose() * direction).cwiseAbs().dot(box.half);
    };
    for (std::size_t k = 0; k < kAxes; ++k) {
        const Vec3 axis(kAxisOf[k].cosine, kAxisOf[k].sine, 0.0F);
        const float middle = axis.dot(c);
        level_[k].add(middle - reach(axis), middle + reach(axis));
    }
    const float up = reach(Vec3::UnitZ());
    height_.add(c.z() - up, c.z() + up);
    const Vec3 local = (box.axes.transpose() * c).cwiseAbs();
    range_.add((local - box.half).cwiseMax(0.0F).norm(), (local + box.half).norm());
    // Of an evenly filled box: a third of the squared half extent along each of its axes.
    const Mat3 own = box.axes * (box.half.cwiseAbs2() / 3.0F).asDiagonal() * box.axes.transpose();
    add_means(1.0F, {c.x(), c.y(), c.z(), c.x() * c.x() + own(0, 0), c.x() * c.y() + own(0, 1),
                     c.y() * c.y() + own(1, 1), c.z() * c.z() + own(2, 2)});
}

void CloudSurface::add_means(float n, const std::array<float, 7>& means) noexcept
{
    n_ += n;
    for (std::size_t i = 0; i < means.size(); ++i) {
        means_[i] += (means[i] - means_[i]) * (n / n_);
    }
}

CloudMoments CloudSurface::moments() const noexcept
{
    return has_points() ? CloudMoments{1.0, means_[0], means_[1], means_[2], means_[3], means_[4], means_[5], means_[6]}
                        : CloudMoments{};
}

/// A direction between two axes is a sum of both with weights of 0 and more, and so are the bounds along it.
Interval CloudSurface::along(float angle) const noexcept
{
    const float steps = std::max(angle, 0.0F) / kAxisAngle;
    const std::size_t k = std::min(static_cast<std::size_t>(steps), kAxes - 1);
    const float past = std::clamp(angle - static_cast<float>(k) * kAxisAngle, 0.0F, kAxisAngle);
    const float first = std::sin(kAxisAngle - past) / std::sin(kAxisAngle);
    const float second = std::sin(past) / std::sin(kAxisAngle);
    const Interval& a = level_[k];
    // Half a turn on, an axis points the other way.
    const Interval b = k + 1 < kAxes ? level_[k + 1] : Interval{-level_[0].high, -level_[0].low};
    return {first * a.low + second * b.low, first * a.high + second * b.high};
}

geometry::Shape CloudSurface::box() const noexcept
{
    CloudBounds bounds(moments().direction());
    bounds.add(*this);
    return bounds.box(0.0F);
}

void CloudBounds::add(const CloudSurface& surface) noexcept
{
    const bool is_past = direction_ >= 0.5F * kPi;
    const Interval a = surface.along(direction_);
    const Interval b = surface.along(is_past ? direction_ - 0.5F * kPi : direction_ + 0.5F * kPi);
    along_.add(a.low, a.high);
    across_.add(is_past ? -b.high : b.low, is_past ? -b.low : b.high);
    height_.add(surface.height().low, surface.height().high);
}

geometry::Shape CloudBounds::box(float least_half) const noexcept
{
    Mat3 axes = Mat3::Identity();
    axes.col(0) = Vec3(std::cos(direction_), std::sin(direction_), 0.0F);
    axes.col(1) = Vec3(-axes(1, 0), axes(0, 0), 0.0F);
    const Vec3 low(along_.low, across_.low, height_.low);
    const Vec3 high(along_.high, across_.high, height_.high);
    return geometry::make_box(axes * (0.5F * (low + high)),
                              ((0.5F * (high - low)).array() + kRounding).cwiseMax(least_half), axes);
}

void CloudSurface::add(const CloudSurface& other) noexcept
{
    for (std::size_t k = 0; k < kAxes; ++k) {
        level_[k].add(other.level_[k].low, other.level_[k].high);
    }
    height_.add(other.height_.low, other.height_.high);
    range_.add(other.range_.low, other.range_.high);
    add_means(other.n_, other.means_);
}

float CloudSurface::patch_depth(float nearest) noexcept { return std::max(kMinDepth, kDepthShare * nearest); }

float CloudSurface::gap_to(const CloudSurface& other) const noexcept
{
    return std::max({range_.low - other.range_.high, other.range_.low - range_.high, 0.0F});
}

bool CloudSurface::is_close_to(const CloudSurface& other) const noexcept
{
    return has_points() && other.has_points() && gap_to(other) <= patch_depth(std::min(range_.low, other.range_.low));
}

void CloudBin::add(const CloudSurface& added) noexcept
{
    state = State::hit;
    CloudSurface& nearer = layers[0];
    CloudSurface& farther = layers[1];
    const auto apart = [](const CloudSurface& a, const CloudSurface& b) {
        return a.gap_to(b) / std::max(std::min(a.range().high, b.range().high), 1.0F);
    };
    if (!nearer.has_points() || nearer.is_close_to(added)) {
        nearer.add(added);
    } else if (farther.is_close_to(added)) {
        farther.add(added);
    } else if (!farther.has_points()) {
        farther = added;
    } else if (apart(nearer, farther) < std::min(apart(nearer, added), apart(farther, added))) {
        nearer.add(farther);
        farther = added;
    } else {
        (apart(nearer, added) <= apart(farther, added) ? nearer : farther).add(added);
    }
    if (farther.has_points() && farther.range().low < nearer.range().low) {
        std::swap(nearer, farther);
    }
}

}  // namespace jink::app
