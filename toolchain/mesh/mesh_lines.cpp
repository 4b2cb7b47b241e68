// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/mesh_lines.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "firmware/linux/complaint.hpp"
#include "toolchain/mesh/triangle_mesh.hpp"

namespace jink::mesh {
namespace {

using files::in_quotes;
using files::NumberStatus;

constexpr std::string_view kBlanks = " \t";

struct Word {
    std::string_view text;
    std::size_t column = 0;
};

struct Line {
    std::size_t number = 0;
    std::string_view text;
    std::vector<Word> words;

    [[noreturn]] void refuse(std::size_t column, const std::string& why) const
    {
        throw CannotBuild(number, column, why);
    }
    [[noreturn]] void refuse(const Word& word, const std::string& why) const { refuse(word.column, why); }
    /// The word at `index`; the end of the line where there is none.
    [[nodiscard]] Word word(std::size_t index) const
    {
        return index < words.size() ? words[index] : Word{"the end of the line", text.size() + 1};
    }
    [[noreturn]] void want(std::size_t index, const std::string& what) const
    {
        const Word found = word(index);
        refuse(found,
               what + " is wanted, not " + (index < words.size() ? in_quotes(found.text) : std::string(found.text)));
    }
};

std::vector<Word> words_of(std::string_view text)
{
    std::vector<Word> words;
    for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;
         at = text.find_first_not_of(kBlanks, at)) {
        const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
        words.push_back({text.substr(at, end - at), at + 1});
        at = end;
    }
    return words;
}

/// Calls `take` for each line that is not blank. @return number of the last line
template <class Take>
std::size_t for_each_line(std::string_view text, const Take& take)
{
    std::size_t number = 0;
    while (!text.empty()) {
        const std::size_t size = text.find('\n');
        Line line{++number, text.substr(0, size), {}};
        text.remove_prefix(size == std::string_view::npos ? text.size() : size + 1);
        if (line.text.ends_with('\r')) {
            line.text.remove_suffix(1);
        }
        const auto* const control = std::find_if(line.text.begin(), line.text.end(), [](char c) {
            return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
        });
        if (control != line.text.end()) {
            line.refuse(static_cast<std::size_t>(control - line.text.begin()) + 1, "a control character");
        }
        line.words = words_of(line.text);
        if (!line.words.empty()) {
            take(line);
        }
    }
    return number;
}

void check_numbers(const Line& line, std::size_t first, std::size_t count, bool all_finite)
{
    for (std::size_t i = first; i < first + count; ++i) {
        double value = 0.0;
        const NumberStatus status =
            i < line.words.size() ? files::parse_number(line.words[i].text, value) : NumberStatus::not_a_number;
        const bool fits =
            status == NumberStatus::ok && std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
        if (all_finite ? !fits : status == NumberStatus::not_a_number) {
            line.want(i, all_finite ? "a finite decimal number" : "a decimal number");
        }
    }
}

void check_vertex(const Line& line)
{
    const std::size_t count = line.words.size() - 1;
    if (count < 3) {
        line.want(line.words.size(), "a vertex of three numbers");
    }
    check_numbers(line, 1, 3, true);
    if (count != 3 && count != 4 && count != 6) {
        line.refuse(line.words[4], "three numbers are wanted, with a weight or three parts of a colour behind them");
    }
    check_numbers(line, 4, count - 3, true);
    for (std::size_t i = 1; i <= count; ++i) {
        if (line.words[i].text.front() == '.') {  // Assimp would drop the line
            line.refuse(line.words[i], "a digit is wanted before the point of " + in_quotes(line.words[i].text));
        }
    }
}

/// A corner of a face: V, V/VT, V//VN or V/VT/VN. Negative indices count back from the last vertex before the face.
void check_corner(const Line& line, const Word& word, std::size_t before, std::size_t all)
{
    std::array<std::int64_t, 3> index{};
    std::string_view rest = word.text;
    for (std::size_t part = 0;; ++part) {
        const std::size_t slash = rest.find('/');
        const std::string_view text = rest.substr(0, slash);
        const bool may_miss = part == 1 && slash != std::string_view::npos;
        const auto [end, error] = part < index.size()
                                      ? std::from_chars(text.data(), text.data() + text.size(), index[part])
                                      : std::from_chars_result{text.data(), std::errc::invalid_argument};
        const bool good = error == std::errc{} && end == text.data() + text.size() && index[part] != 0;
        if (!good && !(text.empty() && may_miss)) {
            line.refuse(word, "a corner such as 3, 3/1, 3//2 or 3/1/2 is wanted, not " + in_quotes(word.text));
        }
        if (slash == std::string_view::npos) {
            break;
        }
        rest.remove_prefix(slash + 1);
    }
    const bool known = index[0] > 0 ? static_cast<std::uint64_t>(index[0]) <= all
                                    : static_cast<std::uint64_t>(-(index[0] + 1)) < before;
    if (!known) {
        line.refuse(word, "vertex " + in_quotes(word.text) + " is missing: there are " +
                              std::to_string(index[0] > 0 ? all : before));
    }
}

void check_face(const Line& line, std::size_t before, std::size_t all)
{
    for (std::size_t i = 1; i < line.words.size(); ++i) {
        check_corner(line, line.words[i], before, all);
    }
    if (line.words.size() < 4) {
        line.want(line.words.size(), "a face of three or more corners");
    }
}

/// A line of a facet in ASCII: its keywords, and the numbers behind them.
struct FacetLine {
    std::string_view first;
    std::string_view second;
    std::size_t numbers = 0;
};
constexpr std::array<FacetLine, 7> kFacet{{{"facet", "normal", 3},
                                           {"outer", "loop", 0},
                                           {"vertex", "", 3},
                                           {"vertex", "", 3},
                                           {"vertex", "", 3},
                                           {"endloop", "", 0},
                                           {"endfacet", "", 0}}};

void check_facet_line(const Line& line, const FacetLine& wanted, bool may_end)
{
    if (line.words[0].text != wanted.first) {
        line.want(0, in_quotes(wanted.first) + (may_end ? " or 'endsolid'" : ""));
    }
    const std::size_t keywords = wanted.second.empty() ? 1 : 2;
    if (keywords == 2 && line.word(1).text != wanted.second) {
        line.want(1, in_quotes(wanted.second));
    }
    // The normal is not used; writers give none of a facet without area as NaN.
    check_numbers(line, keywords, wanted.numbers, wanted.first == "vertex");
    if (line.words.size() > keywords + wanted.numbers) {
        line.want(keywords + wanted.numbers, "the end of the line");
    }
}

}  // namespace

void check_obj(std::string_view text)
{
    constexpr auto kOthers =
        std::to_array<std::string_view>({"vn", "vt", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p"});
    std::size_t all = 0;
    for_each_line(text, [&](const Line& line) { all += line.words[0].text == "v" ? 1U : 0U; });
    std::size_t before = 0;
    for_each_line(text, [&](const Line& line) {
        const Word& keyword = line.words[0];
        if (line.text.ends_with('\\')) {
            line.refuse(line.text.size(), "a line that goes on in the next one is not taken");
        }
        if (keyword.text.starts_with('#')) {
            return;
        }
        if (keyword.column != 1) {  // Assimp would drop the line
            line.refuse(keyword, "the keyword has to be at the start of the line");
        }
        if (keyword.text == "v") {
            check_vertex(line);
            ++before;
        } else if (keyword.text == "f") {
            check_face(line, before, all);
        } else if (std::find(kOthers.begin(), kOthers.end(), keyword.text) == kOthers.end()) {
            line.want(0, "v, f or another keyword of an OBJ file");
        }
    });
}

void check_ascii_stl(std::string_view text)
{
    bool in_solid = false;
    std::size_t step = 0;
    const std::size_t last = for_each_line(text, [&](const Line& line) {
        if (!in_solid) {
            if (line.words[0].text != "solid") {
                line.want(0, "'solid'");
            }
            in_solid = true;
        } else if (step == 0 && line.words[0].text == "endsolid") {
            in_solid = false;
        } else {
            check_facet_line(line, kFacet[step], step == 0);
            step = (step + 1) % kFacet.size();
        }
    });
    if (last == 0 || in_solid) {
        throw CannotBuild(std::max<std::size_t>(last, 1), 1,
                          std::string(last == 0 ? "'solid'" : "'endsolid'") + " is wanted, not the end of the file");
    }
}

bool is_binary_stl(std::string_view bytes)
{
    constexpr std::size_t kHeader = 84;
    constexpr std::size_t kFacetBytes = 50;
    if (bytes.size() < kHeader) {
        return false;
    }
    std::uint64_t facets = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        facets |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[kHeader - 4 + i])) << (8 * i);
    }
    return bytes.size() == kHeader + kFacetBytes * facets;
}

}  // namespace jink::mesh
