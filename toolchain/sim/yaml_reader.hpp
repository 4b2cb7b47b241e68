// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <set>
#include <string>

#include <yaml-cpp/yaml.h>

#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {

/// One map of a scenario file: hands out values by key and complains, with the line, about keys that nobody asked for.
class YamlMap {
public:
    YamlMap(const YAML::Node& node, std::string file) : node_(node), file_(std::move(file))
    {
        if (!node_.IsMap()) {
            fail(node_, "expected a map of keys and values");
        }
    }

    [[noreturn]] void fail(const YAML::Node& at, const std::string& why) const
    {
        throw BadScenario(file_ + ":" + std::to_string(at.Mark().line + 1) + ": " + why);
    }

    [[nodiscard]] bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }

    [[nodiscard]] YAML::Node at(const std::string& key)
    {
        used_.insert(key);
        const YAML::Node value = node_[key];
        if (!value) {
            fail(node_, "'" + key + "' is missing");
        }
        return value;
    }

    template <class T>
    [[nodiscard]] T get(const std::string& key)
    {
        const YAML::Node value = at(key);
        try {
            return value.as<T>();
        } catch (const YAML::Exception&) {
            fail(value, "'" + key + "' has a value of the wrong kind");
        }
    }

    template <class T>
    void read(const std::string& key, T& value)
    {
        if (has(key)) {
            value = get<T>(key);
        }
    }

    /// A number within [low, high]; the default stays where the key is missing.
    void number(const std::string& key, double& value, double low, double high)
    {
        if (has(key)) {
            value = get<double>(key);
            if (!(value >= low && value <= high)) {
                fail(at(key), "'" + key + "' must lie between " + shown(low) + " and " + shown(high));
            }
        }
    }

    [[nodiscard]] Vec vector(const YAML::Node& node) const
    {
        Vec v;
        if (!node.IsSequence() || node.size() != 3) {
            fail(node, "expected [x, y, z]");
        }
        for (int i = 0; i < 3; ++i) {
            try {
                v[i] = node[i].as<double>();
            } catch (const YAML::Exception&) {
                fail(node[i], "expected a number");
            }
            if (!std::isfinite(v[i])) {
                fail(node[i], "expected a finite number");
            }
        }
        return v;
    }
    [[nodiscard]] Vec vector(const std::string& key) { return vector(at(key)); }

    [[nodiscard]] YamlMap map(const std::string& key) { return {at(key), file_}; }
    [[nodiscard]] const std::string& file() const noexcept { return file_; }
    [[nodiscard]] const YAML::Node& node() const noexcept { return node_; }

    /// To be called when everything was read.
    void finish() const
    {
        for (const auto& entry : node_) {
            const auto key = entry.first.as<std::string>();
            if (used_.count(key) == 0) {
                fail(entry.first, "unknown key '" + key + "'");
            }
        }
    }

private:
    static std::string shown(double value)
    {
        std::string text = std::to_string(value);
        text.erase(text.find_last_not_of('0') + 1);
        return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
    }

    YAML::Node node_;
    std::string file_;
    std::set<std::string> used_;
};

}  // namespace jink::sim
