// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/cost_to_go_field.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/threat.hpp"

namespace jink::world {
namespace {

constexpr Seconds kInfinite = std::numeric_limits<Seconds>::infinity();
constexpr float kMinSpeed = 1.0F;
constexpr float kMinClimb = 0.5F;
/// Of a field that does not settle: each round makes longer ways known, with more turns.
constexpr int kMaxRounds = 16;
constexpr unsigned kOrders = 8;
constexpr float kDiagonal = 1.41421356F;
constexpr float kTight = 0.501F * kDiagonal * CostToGoField::kWidth;

constexpr int kMiddleColumn = CostToGoField::kColumns / 2;
constexpr int kMiddleLayer = CostToGoField::kLayers / 2;

/// Cells between two coordinates, of those from 0 to `count` - 1, `width` apart.
std::array<int, 2> cells_between(float low, float high, float width, int count) noexcept
{
    const auto cell = [&](float at) { return static_cast<int>(std::clamp(at, -1.0F, static_cast<float>(count))); };
    return {std::max(0, cell(std::ceil(low / width))), std::min(count - 1, cell(std::floor(high / width)))};
}

/// Cells between a cell and those that come before it in an order.
std::array<int, kOrders> steps_back(unsigned order) noexcept
{
    constexpr std::array<int, 3> kApart{1, CostToGoField::kColumns, CostToGoField::kColumns * CostToGoField::kColumns};
    std::array<int, kOrders> back{};
    for (unsigned d = 1; d < kOrders; ++d) {
        for (unsigned axis = 0; axis < kApart.size(); ++axis) {
            const int apart = (order >> axis & 1U) != 0 ? -kApart[axis] : kApart[axis];
            back[d] += (d >> axis & 1U) != 0 ? apart : 0;
        }
    }
    return back;
}

}  // namespace

Vec3 CostToGoField::Field::middle(const Cell& cell) const noexcept
{
    return origin + Vec3(kWidth * static_cast<float>(cell.x), kWidth * static_cast<float>(cell.y),
                         kHeight * static_cast<float>(cell.z));
}

/// Of a way in level steps along the axes and the diagonals, as the cells allow, and of its climb.
Seconds CostToGoField::Field::time_of(const Vec3& way) const noexcept
{
    const float x = std::abs(way.x());
    const float y = std::abs(way.y());
    return (std::max(x, y) + (kDiagonal - 1.0F) * std::min(x, y)) / speed + std::abs(way.z()) / climb;
}

bool CostToGoField::Field::contains(const Vec3& place) const noexcept
{
    constexpr auto kWide = kWidth * static_cast<float>(kColumns - 1);
    constexpr auto kHigh = kHeight * static_cast<float>(kLayers - 1);
    const Vec3 in = place - origin;
    return in.minCoeff() >= 0.0F && in.x() <= kWide && in.y() <= kWide && in.z() <= kHigh;
}

std::size_t CostToGoField::index(const Cell& cell) noexcept
{
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    return (at(cell.z) * kColumns + at(cell.y)) * kColumns + at(cell.x);
}

CostToGoField::Times CostToGoField::Field::times_of_steps() const noexcept
{
    Times times{};
    for (unsigned d = 0; d < times.size(); ++d) {
        times[d] =
            time_of(Vec3((d & 1U) != 0 ? kWidth : 0.0F, (d & 2U) != 0 ? kWidth : 0.0F, (d & 4U) != 0 ? kHeight : 0.0F));
    }
    return times;
}

void CostToGoField::forget() noexcept
{
    known_ = false;
    stage_ = Stage::idle;
}

void CostToGoField::next_stage(Stage stage) noexcept
{
    stage_ = stage;
    piece_ = 0;
}

void CostToGoField::begin(const Situation& s) noexcept
{
    const path::RouteView route = s.reference.route();
    is_needed_ = s.reference.valid && route.length() > 0.0F;
    next_stage(Stage::complete);
    if (!is_needed_) {
        return;
    }
    Field& field = built();
    const float abeam = route.abeam_of(s.own.position, s.reference.segment).arc_length;
    field.goal = route.at(std::min(abeam + kAhead, route.length())).position;
    field.speed = std::max(kMinSpeed, s.reference.speed);
    field.climb = std::max(kMinClimb, std::min(s.limits.max_climb, s.limits.max_descent));
    field.origin = Vec3::Zero();
    field.origin = s.own.position - field.middle({kMiddleColumn, kMiddleColumn, kMiddleLayer});
    half_ = s.limits.half_extents;
    half_.x() = half_.y() = std::max(half_.x(), half_.y());
    bounds_ = {};
    blocks_.clear();
    for (const Threat& threat : s.threats) {
        const float reach = threat.growth.radius + kSpare;
        switch (threat.form) {
        case ThreatForm::floor: bounds_.floor = threat.position.z() + half_.z() + reach; break;
        case ThreatForm::ceiling: bounds_.ceiling = threat.position.z() - half_.z() - reach; break;
        case ThreatForm::keep_in:
            bounds_.home = threat.position;
            bounds_.keep_in = threat.level_radius - half_.x() - reach;
            break;
        case ThreatForm::cylinder: {
            const Cylinder& area = *threat.cylinder;
            const Vec3 low(area.circle.centre.x(), area.circle.centre.y(), area.bottom);
            const Vec3 high(low.x(), low.y(), area.top);
            add_block(geometry::make_cylinder(low, high, area.circle.radius + area.margin), reach);
            break;
        }
        case ThreatForm::point:
            if (threat.ref.kind == ThreatKind::obstacle) {
                const Vec3 up = threat.half_height * Vec3::UnitZ();
                add_block(geometry::make_capsule(threat.position - up, threat.position + up, 0.0F), reach);
            }
            break;
        case ThreatForm::solid: add_block(*threat.solid, reach); break;
        }
    }
    is_needed_ = !blocks_.empty();
    if (is_needed_) {
        next_stage(Stage::bounds);
    }
}

/// A block that no cell is near to is left out. Two cells that are diagonally next to each other have no wall between
/// them that blocks neither, however thin.
void CostToGoField::add_block(const geometry::Shape& shape, float reach) noexcept
{
    const Field& field = built();
    Block block{shape, std::max(reach + half_.x(), kTight), {}};
    Vec3 low;
    Vec3 high;
    for (int axis = 0; axis < 3; ++axis) {
        const float grown = block.reach + (axis == 2 ? half_.z() : 0.0F);
        low[axis] = geometry::support(shape, -Vec3::Unit(axis))[axis] - grown - field.origin[axis];
        high[axis] = geometry::support(shape, Vec3::Unit(axis))[axis] + grown - field.origin[axis];
    }
    const std::array<int, 2> x = cells_between(low.x(), high.x(), kWidth, kColumns);
    const std::array<int, 2> y = cells_between(low.y(), high.y(), kWidth, kColumns);
    const std::array<int, 2> z = cells_between(low.z(), high.z(), kHeight, kLayers);
    if (x[0] <= x[1] && y[0] <= y[1] && z[0] <= z[1]) {
        block.cells = {Cell{x[0], y[0], z[0]}, Cell{x[1], y[1], z[1]}};
        static_cast<void>(blocks_.try_push_back(block));
    }
}

Progress CostToGoField::advance(WorkBudget& budget) noexcept
{
    while (stage_ != Stage::idle && stage_ != Stage::complete) {
        const std::uint32_t units = units_of_next();
        if (budget.left() < units || !budget.spend(units)) {
            return Progress::running;
        }
        do_next();
    }
    return stage_ == Stage::complete ? Progress::done : Progress::running;
}

/// Of a layer of cells, or of those of a block in it.
std::uint32_t CostToGoField::units_of_next() const noexcept
{
    constexpr auto kLayer = static_cast<std::uint32_t>(kColumns * kColumns);
    static_assert(units::kFieldSweep * kLayer <= kPiece && units::kFieldMark * kLayer + 1 <= kPiece);
    if (stage_ == Stage::sweeps) {
        return units::kFieldSweep * kLayer;
    }
    if (stage_ == Stage::blocks) {
        const Block& block = blocks_[piece_ / kLayers];
        const auto z = static_cast<int>(piece_ % kLayers);
        const bool is_in = z >= block.cells[0].z && z <= block.cells[1].z;
        const auto cells = static_cast<std::uint32_t>((block.cells[1].x - block.cells[0].x + 1) *
                                                      (block.cells[1].y - block.cells[0].y + 1));
        return is_in ? units::kFieldMark * cells + 1 : 1;
    }
    return units::kFieldCells * kLayer / 2;
}

void CostToGoField::do_next() noexcept
{
    const auto z = static_cast<int>(piece_ % kLayers);
    const std::size_t part = piece_ / kLayers;
    ++piece_;
    const bool is_last_layer = z == kLayers - 1;
    switch (stage_) {
    case Stage::bounds:
        mark_bounds(z);
        if (is_last_layer) {
            next_stage(Stage::blocks);
        }
        break;
    case Stage::blocks:
        mark_block(blocks_[part], z);
        if (is_last_layer && part + 1 == blocks_.size()) {
            nearest_to_goal_ = kInfinite;
            next_stage(Stage::goal);
        }
        break;
    case Stage::goal:
        find_goal(z);
        if (is_last_layer) {
            next_stage(Stage::sources);
        }
        break;
    case Stage::sources:
        set_sources(z);
        if (is_last_layer) {
            rounds_ = 0;
            changed_ = false;
            next_stage(Stage::sweeps);
        }
        break;
    case Stage::sweeps:
        sweep(static_cast<unsigned>(part), z);
        if (is_last_layer && part + 1 == kOrders) {
            next_stage(changed_ && ++rounds_ < kMaxRounds ? Stage::sweeps : Stage::complete);
            changed_ = false;
        }
        break;
    default: break;
    }
}

void CostToGoField::mark_bounds(int z) noexcept
{
    const Field& field = built();
    for (int y = 0; y < kColumns; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            const Vec3 at = field.middle({x, y, z});
            blocked_[index({x, y, z})] = at.z() < bounds_.floor || at.z() > bounds_.ceiling ||
                                         (at - bounds_.home).head<2>().norm() > bounds_.keep_in;
        }
    }
}

void CostToGoField::mark_block(const Block& block, int z) noexcept
{
    if (z < block.cells[0].z || z > block.cells[1].z) {
        return;
    }
    const Field& field = built();
    for (int y = block.cells[0].y; y <= block.cells[1].y; ++y) {
        for (int x = block.cells[0].x; x <= block.cells[1].x; ++x) {
            const Vec3 at = field.middle({x, y, z});
            const Vec3 off = geometry::nearest_point(block.shape, at) - at;
            const float height = std::max(std::abs(off.z()) - half_.z(), 0.0F);
            if (off.head<2>().squaredNorm() + height * height < block.reach * block.reach) {
                blocked_[index({x, y, z})] = true;
            }
        }
    }
}

/// Of a goal within the grid, what the free cell nearest to it is away.
void CostToGoField::find_goal(int z) noexcept
{
    const Field& field = built();
    if (!field.contains(field.goal)) {
        return;
    }
    for (int y = 0; y < kColumns; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            if (!blocked_[index({x, y, z})]) {
                nearest_to_goal_ = std::min(nearest_to_goal_, field.straight(field.middle({x, y, z})));
            }
        }
    }
}

void CostToGoField::set_sources(int z) noexcept
{
    Field& field = built();
    const bool is_within = nearest_to_goal_ < kInfinite;
    const bool is_end = (z == 0 && field.goal.z() < field.middle({0, 0, z}).z()) ||
                        (z == kLayers - 1 && field.goal.z() > field.middle({0, 0, z}).z());
    const Seconds near = nearest_to_goal_ + (kDiagonal * kWidth) / field.speed + kHeight / field.climb;
    for (int y = 0; y < kColumns; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            const Cell cell{x, y, z};
            const bool is_side = x == 0 || y == 0 || x == kColumns - 1 || y == kColumns - 1 || is_end;
            const Seconds straight = field.straight(field.middle(cell));
            const bool is_source = !blocked_[index(cell)] && (is_within ? straight <= near : is_side);
            field.cost[index(cell)] = kInfinite;
            if (is_source) {
                field.cost[index(cell)] = straight;
            }
        }
    }
}

/// The cells of a layer in one of eight orders, each from its neighbours that come before it.
void CostToGoField::sweep(unsigned order, int layer) noexcept
{
    Field& field = built();
    const auto at = [&](unsigned axis, int i, int count) { return (order >> axis & 1U) != 0 ? count - 1 - i : i; };
    const Times time = field.times_of_steps();
    const std::array<int, kOrders> back = steps_back(order);
    const unsigned without_z = layer > 0 ? 0U : 4U;
    for (int j = 0; j < kColumns; ++j) {
        const unsigned without_y = without_z | (j > 0 ? 0U : 2U);
        for (int i = 0; i < kColumns; ++i) {
            const unsigned without = without_y | (i > 0 ? 0U : 1U);
            const std::size_t cell = index({at(0, i, kColumns), at(1, j, kColumns), at(2, layer, kLayers)});
            if (blocked_[cell]) {
                continue;
            }
            const Seconds* const here = &field.cost[cell];
            Seconds best = *here;
            for (unsigned d = 1; d < kOrders; ++d) {
                best = (d & without) == 0 ? std::min(best, *(here - back[d]) + time[d]) : best;
            }
            changed_ = changed_ || best < *here;
            field.cost[cell] = best;
        }
    }
}

void CostToGoField::show() noexcept
{
    if (stage_ == Stage::complete) {
        shown_ = is_needed_ ? 1 - shown_ : shown_;
        known_ = is_needed_;
        stage_ = Stage::idle;
    }
}

}  // namespace jink::world
