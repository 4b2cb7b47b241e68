// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "toolchain/sim/input_file.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kKnot = 1852.0 / 3600.0;
constexpr double kFoot = 0.3048;
constexpr double kDegree = std::numbers::pi / 180.0;

using Lines = std::vector<std::string>;

class Sections {
public:
    Sections(std::istream& in, std::string name) : name_(std::move(name))
    {
        Lines* lines = nullptr;
        for (std::string line; std::getline(in, line);) {
            line.erase(line.find_last_not_of(" \t\r") + 1);
            if (line.starts_with("#")) {
                lines = &sections_[line.substr(std::min(line.size(), line.find_first_not_of("# ")))];
            } else if (lines != nullptr && !line.empty()) {
                lines->push_back(line);
            }
        }
    }

    [[noreturn]] void refuse(const std::string& what) const { throw std::runtime_error(name_ + ": " + what); }

    [[nodiscard]] const Lines& lines(const std::string& section) const
    {
        const auto found = sections_.find(section);
        if (found == sections_.end()) {
            refuse("no section " + section);
        }
        return found->second;
    }
    [[nodiscard]] std::vector<std::string> labels(const std::string& section) const
    {
        std::vector<std::string> words;
        std::istringstream line(all(section));
        for (std::string word; std::getline(line, word, ',');) {
            std::erase_if(word, [](char c) { return c == '"' || c == ' '; });
            words.push_back(word);
        }
        return words;
    }
    [[nodiscard]] std::vector<double> numbers(const std::string& section) const { return of(all(section), section); }
    [[nodiscard]] std::vector<double> of(const std::string& text, const std::string& section) const
    {
        std::vector<double> values;
        std::istringstream words(text);
        for (double value = 0.0; words >> value;) {
            values.push_back(value);
        }
        if (!words.eof() || std::any_of(values.begin(), values.end(), [](double v) { return !std::isfinite(v); })) {
            refuse("a number of " + section + " is none");
        }
        return values;
    }

private:
    [[nodiscard]] std::string all(const std::string& section) const
    {
        std::string text;
        for (const std::string& line : lines(section)) {
            text += line + ' ';
        }
        return text;
    }

    std::string name_;
    std::map<std::string, Lines> sections_;
};

/// Whole numbers of at least 1 and at most a thousand.
std::vector<std::size_t> bins_of(const Sections& in, const std::string& section, std::size_t count)
{
    const std::vector<double> values = in.numbers(section);
    const bool good = values.size() == count && std::all_of(values.begin(), values.end(), [](double v) {
                          return v >= 1.0 && v <= 1000.0 && v == std::floor(v);
                      });
    if (!good) {
        in.refuse(section + " does not have a number of bins for each variable");
    }
    return {values.begin(), values.end()};
}

}  // namespace

std::size_t EncounterModel::Node::row(const std::vector<std::size_t>& values) const
{
    std::size_t at = 0;
    std::size_t stride = bins;
    for (std::size_t i = 0; i < parents.size(); ++i) {
        at += stride * values[parents[i]];
        stride *= parent_bins[i];
    }
    return at;
}

EncounterModel EncounterModel::load(const std::filesystem::path& file)
{
    std::ifstream in = open_input(file);
    return read(in, file.filename().string());
}

EncounterModel EncounterModel::read(std::istream& in, const std::string& name)
{
    const Sections sections(in, name);
    EncounterModel model;
    const auto network = [&](const std::string& suffix, std::size_t from, std::size_t count) {
        const std::vector<double> graph = sections.numbers("G_" + suffix);
        const std::vector<std::size_t> bins = bins_of(sections, "r_" + suffix, count);
        const std::vector<double> counts = sections.numbers("N_" + suffix);
        if (graph.size() != count * count) {
            sections.refuse("G_" + suffix + " is not square");
        }
        std::vector<Node> nodes;
        std::size_t at = 0;
        for (std::size_t j = from; j < count; ++j) {
            Node node;
            node.bins = bins[j];
            std::size_t size = bins[j];
            for (std::size_t i = 0; i < count; ++i) {
                if (graph[i * count + j] != 0.0) {
                    node.parents.push_back(i);
                    node.parent_bins.push_back(bins[i]);
                    size *= bins[i];
                }
            }
            if (at + size > counts.size()) {
                sections.refuse("N_" + suffix + " has too few counts");
            }
            node.counts.assign(counts.begin() + static_cast<std::ptrdiff_t>(at),
                               counts.begin() + static_cast<std::ptrdiff_t>(at + size));
            if (std::any_of(node.counts.begin(), node.counts.end(), [](double c) { return c < 0.0; })) {
                sections.refuse("N_" + suffix + " has a negative count");
            }
            at += size;
            nodes.push_back(std::move(node));
        }
        if (at != counts.size()) {
            sections.refuse("N_" + suffix + " has too many counts");
        }
        return nodes;
    };
    const std::vector<std::string> labels = sections.labels("labels_initial");
    const std::vector<std::string> followers = sections.labels("labels_transition");
    if (followers.size() < labels.size()) {
        sections.refuse("the dynamic network has fewer variables than the initial one");
    }
    model.initial_ = network("initial", 0, labels.size());
    model.next_ = network("transition", labels.size(), followers.size());
    constexpr std::array<const char*, kVariables> kNames{"L", "v", "\\dotv", "\\doth", "\\dot\\psi"};
    for (std::size_t i = 0; i < kVariables; ++i) {
        const auto found = std::find(labels.begin(), labels.end(), kNames[i]);
        if (found == labels.end()) {
            sections.refuse(std::string("no variable ") + kNames[i]);
        }
        model.index_[i] = static_cast<std::size_t>(found - labels.begin());
    }
    for (std::size_t j = labels.size(); j < followers.size(); ++j) {
        const std::string plain = followers[j].substr(0, followers[j].find('('));
        const auto found = std::find(labels.begin(), labels.end(), plain);
        if (found == labels.end() || model.next_[j - labels.size()].bins !=
                                         model.initial_[static_cast<std::size_t>(found - labels.begin())].bins) {
            sections.refuse(followers[j] + " follows no variable of as many bins");
        }
        model.followed_.push_back(static_cast<std::size_t>(found - labels.begin()));
    }
    const Lines& boundaries = sections.lines("boundaries");
    if (boundaries.size() != labels.size()) {
        sections.refuse("there are not as many lines of boundaries as variables");
    }
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const bool numbered = boundaries[i].starts_with("*");
        std::vector<double> edges = numbered ? std::vector<double>{} : sections.of(boundaries[i], "boundaries");
        if (!numbered && (edges.size() != model.initial_[i].bins + 1 || !std::is_sorted(edges.begin(), edges.end()))) {
            sections.refuse("the bins of " + labels[i] + " do not have one edge more than there are bins");
        }
        model.edges_.push_back(std::move(edges));
    }
    for (const std::size_t moving : model.index_) {
        if (model.edges_[moving].empty()) {
            sections.refuse(labels[moving] + " has no edges");
        }
    }
    model.resampled_ = sections.numbers("resample_rates");
    if (model.resampled_.size() != labels.size()) {
        sections.refuse("there are not as many resample rates as variables");
    }
    static_cast<void>(model.order());
    return model;
}

/// Parents before their children.
std::vector<std::size_t> EncounterModel::order() const
{
    std::vector<std::size_t> sorted;
    std::vector<bool> done(initial_.size(), false);
    while (sorted.size() < initial_.size()) {
        const std::size_t before = sorted.size();
        for (std::size_t i = 0; i < initial_.size(); ++i) {
            const std::vector<std::size_t>& parents = initial_[i].parents;
            if (!done[i] && std::all_of(parents.begin(), parents.end(), [&](std::size_t p) { return done[p]; })) {
                done[i] = true;
                sorted.push_back(i);
            }
        }
        if (sorted.size() == before) {
            throw std::runtime_error("the initial network of an encounter model has a cycle");
        }
    }
    return sorted;
}

/// Combinations that were never seen: `otherwise`, or any bin where that is none.
std::size_t EncounterModel::draw(Random& random, const Node& node, const std::vector<std::size_t>& values,
                                 std::size_t otherwise)
{
    const auto first = node.counts.begin() + static_cast<std::ptrdiff_t>(node.row(values));
    const double all = std::accumulate(first, first + static_cast<std::ptrdiff_t>(node.bins), 0.0);
    if (!(all > 0.0)) {
        return otherwise < node.bins ? otherwise : random.below(node.bins);
    }
    double left = static_cast<double>(random.next() >> 11U) * 0x1p-53 * all;
    for (std::size_t bin = 0; bin + 1 < node.bins; ++bin) {
        left -= first[static_cast<std::ptrdiff_t>(bin)];
        if (left < 0.0) {
            return bin;
        }
    }
    return node.bins - 1;
}

/// Uniform within the bin's edges; a bin about zero is zero.
double EncounterModel::value_in(Random& random, std::size_t variable, std::size_t bin) const
{
    const double low = edges_[variable][bin];
    const double high = edges_[variable][bin + 1];
    const double value = uniform(random, low, high);
    return low < 0.0 && high > 0.0 ? 0.0 : value;
}

std::vector<std::size_t> EncounterModel::sample_bins(Random& random) const
{
    std::vector<std::size_t> values(initial_.size(), 0);
    for (const std::size_t i : order()) {
        values[i] = draw(random, initial_[i], values, initial_[i].bins);
    }
    return values;
}

ModelTrack EncounterModel::sample(Random& random, std::size_t seconds) const
{
    std::vector<std::size_t> bins = sample_bins(random);
    std::array<double, kVariables> value{};
    for (std::size_t i = 0; i < kVariables; ++i) {
        value[i] = value_in(random, index_[i], bins[index_[i]]);
    }
    ModelTrack track;
    track.height = value[layer] * kFoot;
    for (std::size_t second = 0; second < seconds; ++second) {
        track.states.push_back(
            {value[speed] * kKnot, value[acceleration] * kKnot, value[climb] * kFoot / 60.0, value[turn] * kDegree});
        const std::vector<double>& speeds = edges_[index_[speed]];
        value[speed] = std::clamp(value[speed] + value[acceleration], speeds.front(), speeds.back());
        std::vector<std::size_t> all = bins;
        all.resize(initial_.size() + next_.size());
        for (std::size_t j = 0; j < next_.size(); ++j) {
            all[initial_.size() + j] = draw(random, next_[j], all, bins[followed_[j]]);
        }
        for (std::size_t i = 0; i < kVariables; ++i) {
            const auto follower = std::find(followed_.begin(), followed_.end(), index_[i]);
            if (follower == followed_.end()) {
                continue;
            }
            const std::size_t bin = all[initial_.size() + static_cast<std::size_t>(follower - followed_.begin())];
            const bool anew = static_cast<double>(random.uniform()) < resampled_[index_[i]];
            if (bin != bins[index_[i]] || anew) {
                value[i] = value_in(random, index_[i], bin);
            }
            bins[index_[i]] = bin;
        }
    }
    return track;
}

std::vector<double> EncounterModel::marginal(std::size_t variable) const
{
    const std::vector<std::size_t> sorted = order();
    std::vector<double> chances(initial_[variable].bins, 0.0);
    std::vector<std::size_t> values(initial_.size(), 0);
    const auto visit = [&](auto&& self, std::size_t depth, double chance) -> void {
        if (chance == 0.0) {
            return;
        }
        const std::size_t i = sorted[depth];
        const Node& node = initial_[i];
        const std::size_t row = node.row(values);
        double all = 0.0;
        for (std::size_t bin = 0; bin < node.bins; ++bin) {
            all += node.counts[row + bin];
        }
        for (std::size_t bin = 0; bin < node.bins; ++bin) {
            values[i] = bin;
            const double each = all > 0.0 ? node.counts[row + bin] / all : 1.0 / static_cast<double>(node.bins);
            if (i == variable) {
                chances[bin] += chance * each;
            } else {
                self(self, depth + 1, chance * each);
            }
        }
    };
    visit(visit, 0, 1.0);
    return chances;
}

}  // namespace jink::sim
