// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "core/base/vec3.hpp"
#include "firmware/linux/complaint.hpp"

namespace jink::files {

/// The single document of a YAML file. If the file cannot be read, is not YAML, holds a zero byte (UTF-16 does) or none
/// or several documents: complaints and nothing.
[[nodiscard]] std::optional<YAML::Node> load_yaml(const std::filesystem::path& path, Complaints& complaints);

/// The same for text already read; `file` is the file's name in complaints.
[[nodiscard]] std::optional<YAML::Node> parse_yaml(const std::string& text, const std::string& file,
                                                   Complaints& complaints);

/// A mapping of a YAML file, read key by key with a complaint for each error: not a mapping at all, a key twice, a
/// value of another type, a tag, not finite, out of range, missing, and, on `finish`, unknown keys.
///
/// Each reader returns a valid value, or nothing after a complaint. An absent key gives nothing, with a complaint only
/// if it is `required`.
class YamlMap {
public:
    enum class Need { optional, required };

    /// `where` is the mapping's name in complaints ("threats[2]"); empty for the file itself.
    YamlMap(const YAML::Node& node, std::string where, std::string file, Complaints& complaints);

    [[nodiscard]] bool is_map() const { return is_map_; }
    [[nodiscard]] const std::string& file() const { return file_; }
    /// True if the key is there, whatever its value. Marks the key as known.
    bool has(std::string_view key);

    std::optional<float> number(std::string_view key, Range range, Need need = Need::optional);
    std::optional<float> whole(std::string_view key, Range range, Need need = Need::optional);
    std::optional<bool> boolean(std::string_view key, Need need = Need::optional);
    std::optional<std::string> text(std::string_view key, Need need = Need::optional);
    /// Three numbers, each in `range`.
    std::optional<Vec3> vector(std::string_view key, Range range, Need need = Need::optional);
    /// Index of the word in `words`.
    std::optional<std::size_t> choice(std::string_view key, std::initializer_list<std::string_view> words,
                                      Need need = Need::optional);
    /// Any value, for the caller to read further.
    std::optional<YAML::Node> node(std::string_view key, Need need = Need::optional);
    /// Elements of a sequence.
    std::optional<std::vector<YAML::Node>> list(std::string_view key, Need need = Need::optional);
    /// A mapping below `key`.
    std::optional<YamlMap> map(std::string_view key, Need need = Need::optional);

    /// Complains about unknown keys, with the name that may have been meant. Call it last.
    void finish();

    /// A complaint about the value of `key`, or about the mapping if the key is absent.
    void complain(std::string_view key, const std::string& what);
    /// Name of the value of `key` in complaints.
    [[nodiscard]] std::string name(std::string_view key) const;

private:
    struct Entry {
        std::string key;
        YAML::Mark mark;
        YAML::Node value;
    };
    [[nodiscard]] const Entry* find(std::string_view key, Need need);
    std::optional<float> scalar(std::string_view key, Range range, bool integer, Need need);
    void complain_at(const YAML::Mark& mark, const std::string& what);

    std::vector<Entry> entries_;
    std::vector<std::string> asked_;
    YAML::Mark mark_ = YAML::Mark::null_mark();
    std::string where_;
    std::string file_;
    Complaints* complaints_;
    bool is_map_ = false;
};

/// For a required value.
inline constexpr auto kNeed = YamlMap::Need::required;

/// Complaint at the position of a node.
[[nodiscard]] Complaint complaint_at(const YAML::Mark& mark, const std::string& file, std::string text);
/// A number of a sequence; nothing, with a complaint named `where`, if it is invalid or out of range.
[[nodiscard]] std::optional<float> element(const YAML::Node& node, Range range, const std::string& where,
                                           const std::string& file, Complaints& complaints);
/// A sequence of three numbers.
[[nodiscard]] std::optional<Vec3> vector_of(const YAML::Node& node, Range range, const std::string& where,
                                            const std::string& file, Complaints& complaints);

}  // namespace jink::files
