// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "firmware/linux/complaint.hpp"
#include "toolchain/sim/input_file.hpp"
#include "toolchain/sim/uniform.hpp"

namespace jink::sim {
namespace {

constexpr double kKnot = 1852.0 / 3600.0;
constexpr double kFoot = 0.3048;
constexpr double kDegree = std::numbers::pi / 180.0;

constexpr const char* kBetweenNumbers = " \t";

/// Line and column, from 1.
struct Place {
    std::size_t line = 1;
    std::size_t column = 1;
};

struct Line {
    std::size_t number = 0;
    std::string text;
};

/// The numbers of a section or a line, each with its place.
struct Numbers {
    std::vector<double> values;
    std::vector<Place> places;
    Place end;  ///< where one more would have been expected

    /// Of the number `i`, or of the end where there are fewer.
    [[nodiscard]] Place place(std::size_t i) const { return i < places.size() ? places[i] : end; }
};

/// "# name" begins a section, which lasts until the next one.
class Sections {
public:
    Sections(std::istream& in, std::string name) : name_(std::move(name))
    {
        Section* section = nullptr;
        std::size_t number = 0;
        for (std::string line; std::getline(in, line);) {
            ++number;
            line.erase(line.find_last_not_of(" \t\r") + 1);
            if (line.starts_with("#")) {
                const std::string title = line.substr(std::min(line.size(), line.find_first_not_of("# ")));
                section = &sections_[title];
                if (section->heading != 0) {
                    refuse({number, 1}, "section " + files::in_quotes(title) + " comes twice");
                }
                section->heading = number;
            } else if (!line.empty() && section == nullptr) {
                refuse({number, 1}, "expected '# ' and a section's name, not " + files::in_quotes(line));
            } else if (!line.empty()) {
                section->lines.push_back({number, std::move(line)});
            }
        }
    }

    [[noreturn]] void refuse(Place at, const std::string& what) const
    {
        throw std::runtime_error(files::to_string({at.line, at.column, what, name_}));
    }

    [[nodiscard]] Place heading(const std::string& section) const { return {found(section).heading, 1}; }
    [[nodiscard]] const std::vector<Line>& lines(const std::string& section) const { return found(section).lines; }
    [[nodiscard]] std::vector<std::string> labels(const std::string& section) const
    {
        std::string text;
        for (const Line& line : lines(section)) {
            text += line.text + ' ';
        }
        std::vector<std::string> words;
        std::istringstream list(text);
        for (std::string word; std::getline(list, word, ',');) {
            std::erase_if(word, [](char c) { return c == '"' || c == ' '; });
            words.push_back(word);
        }
        return words;
    }
    [[nodiscard]] Numbers numbers(const std::string& section) const
    {
        Numbers all;
        all.end = heading(section);
        for (const Line& line : lines(section)) {
            append(line, section, all);
        }
        return all;
    }
    [[nodiscard]] Numbers of(const Line& line, const std::string& section) const
    {
        Numbers all;
        append(line, section, all);
        return all;
    }

private:
    struct Section {
        std::size_t heading = 0;  ///< its line
        std::vector<Line> lines;
    };

    [[nodiscard]] const Section& found(const std::string& section) const
    {
        const auto place = sections_.find(section);
        if (place == sections_.end()) {
            throw std::runtime_error(name_ + ": no section " + section);
        }
        return place->second;
    }
    void append(const Line& line, const std::string& section, Numbers& all) const
    {
        const std::string_view text = line.text;
        for (std::size_t from = text.find_first_not_of(kBetweenNumbers); from < text.size();) {
            const std::size_t end = std::min(text.find_first_of(kBetweenNumbers, from), text.size());
            const std::string_view word = text.substr(from, end - from);
            double value = 0.0;
            if (files::parse_number(word, value) != files::NumberStatus::ok) {
                refuse({line.number, from + 1}, section + ": expected a number, not " + files::in_quotes(word));
            }
            all.values.push_back(value);
            all.places.push_back({line.number, from + 1});
            from = text.find_first_not_of(kBetweenNumbers, end);
        }
        all.end = {line.number, text.size() + 1};
    }

    std::string name_;
    std::map<std::string, Section> sections_;
};

/// Refuses a section of another size than `count`.
void expect_count(const Sections& in, const Numbers& numbers, const std::string& section, std::size_t count)
{
    if (numbers.values.size() != count) {
        in.refuse(numbers.place(count), section + ": expected " + std::to_string(count) + " numbers, not " +
                                            std::to_string(numbers.values.size()));
    }
}

/// The numbers of bins of the first `count` variables.
std::vector<std::size_t> bins_of(const Sections& in, const std::string& section, std::size_t count)
{
    constexpr double kMaxBins = 1000.0;
    const Numbers bins = in.numbers(section);
    expect_count(in, bins, section, count);
    for (std::size_t i = 0; i < count; ++i) {
        const double value = bins.values[i];
        if (!(value >= 1.0 && value <= kMaxBins && value == std::floor(value))) {
            in.refuse(bins.place(i), section + ": expected a number of bins, a whole one from 1 to 1000");
        }
    }
    return {bins.values.begin(), bins.values.end()};
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
        const Numbers graph = sections.numbers("G_" + suffix);
        expect_count(sections, graph, "G_" + suffix, count * count);
        const std::vector<std::size_t> bins = bins_of(sections, "r_" + suffix, count);
        const Numbers counts = sections.numbers("N_" + suffix);
        for (std::size_t i = 0; i < counts.values.size(); ++i) {
            if (counts.values[i] < 0.0) {
                sections.refuse(counts.place(i), "N_" + suffix + ": a count is not below 0");
            }
        }
        std::vector<Node> nodes;
        std::size_t at = 0;
        for (std::size_t j = from; j < count; ++j) {
            Node node;
            node.bins = bins[j];
            std::size_t size = bins[j];
            for (std::size_t i = 0; i < count; ++i) {
                if (graph.values[i * count + j] != 0.0) {
                    node.parents.push_back(i);
                    node.parent_bins.push_back(bins[i]);
                    size *= bins[i];
                }
            }
            if (at + size > counts.values.size()) {
                sections.refuse(counts.end, "N_" + suffix + ": has too few counts");
            }
            node.counts.assign(counts.values.begin() + static_cast<std::ptrdiff_t>(at),
                               counts.values.begin() + static_cast<std::ptrdiff_t>(at + size));
            at += size;
            nodes.push_back(std::move(node));
        }
        if (at != counts.values.size()) {
            sections.refuse(counts.place(at), "N_" + suffix + ": has too many counts");
        }
        return nodes;
    };
    const std::vector<std::string> labels = sections.labels("labels_initial");
    const std::vector<std::string> followers = sections.labels("labels_transition");
    if (followers.size() < labels.size()) {
        sections.refuse(sections.heading("labels_transition"),
                        "labels_transition: expected the variables of labels_initial and those that follow them");
    }
    model.initial_ = network("initial", 0, labels.size());
    model.next_ = network("transition", labels.size(), followers.size());
    constexpr std::array<const char*, kVariables> kNames{"L", "v", "\\dotv", "\\doth", "\\dot\\psi"};
    for (std::size_t i = 0; i < kVariables; ++i) {
        const auto found = std::find(labels.begin(), labels.end(), kNames[i]);
        if (found == labels.end()) {
            sections.refuse(sections.heading("labels_initial"), std::string("no variable ") + kNames[i]);
        }
        model.index_[i] = static_cast<std::size_t>(found - labels.begin());
    }
    for (std::size_t j = labels.size(); j < followers.size(); ++j) {
        const std::string plain = followers[j].substr(0, followers[j].find('('));
        const auto found = std::find(labels.begin(), labels.end(), plain);
        if (found == labels.end() || model.next_[j - labels.size()].bins !=
                                         model.initial_[static_cast<std::size_t>(found - labels.begin())].bins) {
            sections.refuse(sections.heading("labels_transition"),
                            files::in_quotes(followers[j]) + " follows no variable of as many bins");
        }
        model.followed_.push_back(static_cast<std::size_t>(found - labels.begin()));
    }
    const std::vector<Line>& boundaries = sections.lines("boundaries");
    if (boundaries.size() != labels.size()) {
        const Place at = boundaries.size() > labels.size() ? Place{boundaries[labels.size()].number, 1}
                                                           : sections.heading("boundaries");
        sections.refuse(at, "boundaries: expected a line for each of " + std::to_string(labels.size()) + " variables");
    }
    for (std::size_t i = 0; i < labels.size(); ++i) {
        Numbers edges;
        if (!boundaries[i].text.starts_with("*")) {
            edges = sections.of(boundaries[i], "boundaries");
            expect_count(sections, edges, "boundaries", model.initial_[i].bins + 1);
            const auto back = std::is_sorted_until(edges.values.begin(), edges.values.end());
            if (back != edges.values.end()) {
                sections.refuse(edges.place(static_cast<std::size_t>(back - edges.values.begin())),
                                "boundaries: expected an edge that is not below the one before it");
            }
        }
        model.edges_.push_back(std::move(edges.values));
    }
    for (const std::size_t moving : model.index_) {
        if (model.edges_[moving].empty()) {
            sections.refuse({boundaries[moving].number, 1}, labels[moving] + " has no edges");
        }
    }
    const Numbers rates = sections.numbers("resample_rates");
    expect_count(sections, rates, "resample_rates", labels.size());
    model.resampled_ = rates.values;
    if (model.order().size() != labels.size()) {
        sections.refuse(sections.heading("G_initial"), "the initial network has a cycle");
    }
    return model;
}

/// Parents before their children, without those on a cycle and behind it.
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
            break;
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
