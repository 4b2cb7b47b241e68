// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/yaml_map.hpp"

#include <algorithm>

namespace jink::files {
namespace {

/// No valid mapping has more keys; keeps the search for duplicates cheap.
constexpr std::size_t kMaxKeys = 256;

const char* kind_of(const YAML::Node& node)
{
    switch (node.Type()) {
    case YAML::NodeType::Undefined: return "nothing";
    case YAML::NodeType::Null: return "nothing";
    case YAML::NodeType::Scalar: return "a single value";
    case YAML::NodeType::Sequence: return "a list";
    case YAML::NodeType::Map: return "a mapping";
    }
    return "nothing";
}

/// Scalars in quotes are text even if they look like a number: yaml-cpp marks them with the tag "!".
bool is_quoted(const YAML::Node& node) { return node.IsScalar() && node.Tag() == "!"; }

/// A tag that the file gives, as !!binary. No value of ours has one: what the tag asks for would be ignored.
bool has_tag(const YAML::Node& node) { return !node.Tag().empty() && node.Tag() != "?" && node.Tag() != "!"; }

bool is_plain(const YAML::Node& node) { return node.IsScalar() && !is_quoted(node) && !has_tag(node); }

std::string tag_text(const YAML::Node& node) { return "no tag is wanted, such as " + in_quotes(node.Tag()); }

/// The place of a byte of a text.
Complaint complaint_at(std::string_view text, std::size_t at, const std::string& file, std::string what)
{
    const std::string_view before = text.substr(0, at);
    const auto line = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
    const std::size_t start = before.rfind('\n');
    return {line, start == std::string_view::npos ? at + 1 : at - start, std::move(what), file};
}

}  // namespace

Complaint complaint_at(const YAML::Mark& mark, const std::string& file, std::string text)
{
    if (mark.is_null()) {
        return {0, 0, std::move(text), file};
    }
    return {static_cast<std::size_t>(mark.line) + 1, static_cast<std::size_t>(mark.column) + 1, std::move(text), file};
}

std::optional<float> element(const YAML::Node& node, Range range, const std::string& where, const std::string& file,
                             Complaints& complaints)
{
    if (!is_plain(node)) {
        complaints.push_back(complaint_at(node.Mark(), file,
                                          where + ": a number is wanted, not " +
                                              (has_tag(node)     ? "a value with the tag " + in_quotes(node.Tag())
                                               : is_quoted(node) ? "quoted text"
                                                                 : kind_of(node))));
        return std::nullopt;
    }
    float value = 0.0F;
    if (const auto wrong = judge_number(node.Scalar(), range, false, value)) {
        complaints.push_back(complaint_at(node.Mark(), file, where + ": " + *wrong));
        return std::nullopt;
    }
    return value;
}

std::optional<Vec3> vector_of(const YAML::Node& node, Range range, const std::string& where, const std::string& file,
                              Complaints& complaints)
{
    if (has_tag(node)) {
        complaints.push_back(complaint_at(node.Mark(), file, where + ": " + tag_text(node)));
        return std::nullopt;
    }
    if (!node.IsSequence()) {
        complaints.push_back(
            complaint_at(node.Mark(), file, where + ": a list of three numbers is wanted, not " + kind_of(node)));
        return std::nullopt;
    }
    if (node.size() != 3) {
        complaints.push_back(
            complaint_at(node.Mark(), file, where + ": three numbers are wanted, not " + std::to_string(node.size())));
        return std::nullopt;
    }
    Vec3 out = Vec3::Zero();
    bool good = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value = element(node[i], range, where + "[" + std::to_string(i) + "]", file, complaints);
        good = good && value.has_value();
        out[static_cast<Eigen::Index>(i)] = value.value_or(0.0F);
    }
    return good ? std::optional<Vec3>(out) : std::nullopt;
}

std::optional<YAML::Node> parse_yaml(const std::string& text, const std::string& file, Complaints& complaints)
{
    // yaml-cpp takes other encodings too, and may end the document at a zero byte.
    if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
        complaints.push_back(complaint_at(text, zero, file, "a zero byte: the file has to be text in UTF-8"));
        return std::nullopt;
    }
    if (const std::size_t end = end_of_utf8(text); end < text.size()) {
        complaints.push_back(complaint_at(text, end, file, "a byte that is no UTF-8"));
        return std::nullopt;
    }
    try {
        std::vector<YAML::Node> documents = YAML::LoadAll(text);
        if (documents.size() != 1) {
            const char* what = documents.empty() ? "is empty" : "holds several documents; one is wanted";
            complaints.push_back({0, 0, what, file});
            return std::nullopt;
        }
        return documents.front();
    } catch (const YAML::Exception& error) {
        complaints.push_back(complaint_at(error.mark, file, "is not YAML: " + printable(error.msg)));
    } catch (const std::exception& error) {
        complaints.push_back({0, 0, "is not YAML: " + printable(error.what()), file});
    }
    return std::nullopt;
}

std::optional<YAML::Node> load_yaml(const std::filesystem::path& path, Complaints& complaints)
{
    const std::optional<std::string> text = read_text_file(path, complaints);
    return text ? parse_yaml(*text, path.string(), complaints) : std::nullopt;
}

YamlMap::YamlMap(const YAML::Node& node, std::string where, std::string file, Complaints& complaints)
    : mark_(node.Mark()), where_(std::move(where)), file_(std::move(file)), complaints_(&complaints),
      is_map_(node.IsMap())
{
    if (!is_map_) {
        complain_at(mark_, (where_.empty() ? std::string() : where_ + ": ") +
                               "a mapping of keys to values is wanted, not " + kind_of(node));
        return;
    }
    if (has_tag(node)) {
        complain_at(mark_, (where_.empty() ? std::string() : where_ + ": ") + tag_text(node));
        is_map_ = false;
        return;
    }
    if (node.size() > kMaxKeys) {
        complain_at(mark_, (where_.empty() ? std::string() : where_ + ": ") + "more than " + std::to_string(kMaxKeys) +
                               " keys");
        is_map_ = false;
        return;
    }
    for (const auto& pair : node) {
        if (!pair.first.IsScalar()) {
            complain_at(pair.first.Mark(), std::string("a key must be a word, not ") + kind_of(pair.first));
            continue;
        }
        const std::string& key = pair.first.Scalar();
        const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
        if (known) {
            complain_at(pair.first.Mark(), name(printable(key)) + ": given twice");
            continue;
        }
        entries_.push_back({key, pair.first.Mark(), pair.second});
    }
}

std::string YamlMap::name(std::string_view key) const
{
    return where_.empty() ? std::string(key) : where_ + "." + std::string(key);
}

void YamlMap::complain_at(const YAML::Mark& mark, const std::string& what)
{
    complaints_->push_back(complaint_at(mark, file_, what));
}

void YamlMap::complain(std::string_view key, const std::string& what)
{
    for (const Entry& entry : entries_) {
        if (entry.key == key) {
            complain_at(entry.value.Mark(), name(key) + ": " + what);
            return;
        }
    }
    complain_at(mark_, name(key) + ": " + what);
}

const YamlMap::Entry* YamlMap::find(std::string_view key, Need need)
{
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) {
        asked_.emplace_back(key);
    }
    for (const Entry& entry : entries_) {
        if (entry.key == key) {
            if (entry.value.IsNull()) {
                complain_at(entry.mark, name(key) + ": has no value");
                return nullptr;
            }
            return &entry;
        }
    }
    if (need == Need::required && is_map_) {
        complain_at(mark_, "missing key " + in_quotes(name(key)));
    }
    return nullptr;
}

bool YamlMap::has(std::string_view key)
{
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) {
        asked_.emplace_back(key);
    }
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.key == key; });
}

std::optional<float> YamlMap::scalar(std::string_view key, Range range, bool integer, Need need)
{
    const Entry* entry = find(key, need);
    if (entry == nullptr) {
        return std::nullopt;
    }
    const auto value = element(entry->value, range, name(key), file_, *complaints_);
    if (value && integer && *value != static_cast<float>(static_cast<std::int64_t>(*value))) {
        complain(key, in_quotes(entry->value.Scalar()) + " is not a whole number");
        return std::nullopt;
    }
    return value;
}

std::optional<float> YamlMap::number(std::string_view key, Range range, Need need)
{
    return scalar(key, range, false, need);
}

std::optional<float> YamlMap::whole(std::string_view key, Range range, Need need)
{
    return scalar(key, range, true, need);
}

std::optional<bool> YamlMap::boolean(std::string_view key, Need need)
{
    const Entry* entry = find(key, need);
    if (entry == nullptr) {
        return std::nullopt;
    }
    if (is_plain(entry->value) && (entry->value.Scalar() == "true" || entry->value.Scalar() == "false")) {
        return entry->value.Scalar() == "true";
    }
    complain(key, "true or false is wanted");
    return std::nullopt;
}

std::optional<std::string> YamlMap::text(std::string_view key, Need need)
{
    const Entry* entry = find(key, need);
    if (entry == nullptr) {
        return std::nullopt;
    }
    if (!entry->value.IsScalar()) {
        complain(key, std::string("text is wanted, not ") + kind_of(entry->value));
        return std::nullopt;
    }
    if (has_tag(entry->value)) {
        complain(key, tag_text(entry->value));
        return std::nullopt;
    }
    const std::string& value = entry->value.Scalar();
    if (std::any_of(value.begin(), value.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; })) {
        complain(key, "text of one line without control characters is wanted");
        return std::nullopt;
    }
    return value;
}

std::optional<Vec3> YamlMap::vector(std::string_view key, Range range, Need need)
{
    const Entry* entry = find(key, need);
    return entry == nullptr ? std::nullopt : vector_of(entry->value, range, name(key), file_, *complaints_);
}

std::optional<std::size_t> YamlMap::choice(std::string_view key, std::initializer_list<std::string_view> words,
                                           Need need)
{
    const std::optional<std::string> word = text(key, need);
    if (!word) {
        return std::nullopt;
    }
    const auto* at = std::find(words.begin(), words.end(), *word);
    if (at != words.end()) {
        return static_cast<std::size_t>(at - words.begin());
    }
    std::string all;
    for (const std::string_view known : words) {
        all += (all.empty() ? "" : ", ") + std::string(known);
    }
    complain(key, in_quotes(*word) + " is none of: " + all);
    return std::nullopt;
}

std::optional<YAML::Node> YamlMap::node(std::string_view key, Need need)
{
    const Entry* entry = find(key, need);
    return entry == nullptr ? std::nullopt : std::optional<YAML::Node>(entry->value);
}

std::optional<std::vector<YAML::Node>> YamlMap::list(std::string_view key, Need need)
{
    const Entry* entry = find(key, need);
    if (entry == nullptr) {
        return std::nullopt;
    }
    if (!entry->value.IsSequence() || has_tag(entry->value)) {
        complain(key, has_tag(entry->value) ? tag_text(entry->value)
                                            : std::string("a list is wanted, not ") + kind_of(entry->value));
        return std::nullopt;
    }
    return std::vector<YAML::Node>(entry->value.begin(), entry->value.end());
}

std::optional<YamlMap> YamlMap::map(std::string_view key, Need need)
{
    const Entry* entry = find(key, need);
    if (entry == nullptr) {
        return std::nullopt;
    }
    YamlMap below(entry->value, name(key), file_, *complaints_);
    return below.is_map() ? std::optional<YamlMap>(std::move(below)) : std::nullopt;
}

void YamlMap::finish()
{
    const std::vector<std::string_view> names(asked_.begin(), asked_.end());
    for (const Entry& entry : entries_) {
        if (std::find(asked_.begin(), asked_.end(), entry.key) == asked_.end()) {
            complain_at(entry.mark, "unknown key " + in_quotes(name(entry.key)) + suggestion(entry.key, names));
        }
    }
}

}  // namespace jink::files
