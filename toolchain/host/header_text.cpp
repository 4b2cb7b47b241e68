// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/header_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <fstream>

#include "toolchain/host/commands.hpp"

namespace jink::host {

std::string literal(float value)
{
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    std::string out(text.data(), end);
    if (out.find_first_of(".e") == std::string::npos) {
        out.append(".0");
    }
    return out.append("F");
}

void append_array_of(std::string& out, const std::string& type, const std::string& name,
                     const std::vector<std::string>& items)
{
    constexpr std::size_t kWidth = 118;
    out.append("inline constexpr std::array<").append(type).append(", ").append(std::to_string(items.size()));
    const bool nested = !items.empty() && items.front().front() == '{';
    out.append("> ").append(name).append(nested ? "{{" : "{");
    std::string line = "\n    ";
    for (const std::string& item : items) {
        const std::string text = item + ",";
        if (line.size() + text.size() > kWidth) {
            out.append(line);
            line = "\n    ";
        } else if (line.size() > 5) {
            line.append(" ");
        }
        line.append(text);
    }
    out.append(line).append(nested ? "\n}};\n" : "\n};\n");
}

std::string identifier_of(const std::string& name)
{
    std::string out;
    bool starts = true;
    for (const char c : name) {
        const auto code = static_cast<unsigned char>(c);
        if (code >= 128 || std::isalnum(code) == 0) {
            starts = true;
            continue;
        }
        out.push_back(starts ? static_cast<char>(std::toupper(code)) : c);
        starts = false;
    }
    return out.empty() || std::isdigit(static_cast<unsigned char>(out.front())) != 0 ? std::string() : out;
}

[[noreturn]] void refuse(const std::string& command, const std::string& why)
{
    std::fprintf(stderr, "jink %s: %s\n", command.c_str(), why.c_str());
    throw CLI::RuntimeError(kExitBadInput);
}

files::Vehicle read_named_vehicle(const std::string& command, const std::string& file)
{
    files::Complaints complaints;
    auto vehicle = files::read_vehicle_file(file, complaints);
    for (const files::Complaint& complaint : complaints) {
        std::fprintf(stderr, "%s\n", files::to_string(complaint).c_str());
    }
    if (!vehicle) {
        throw CLI::RuntimeError(kExitBadInput);
    }
    if (identifier_of(vehicle->name).empty() ||
        !std::all_of(vehicle->name.begin(), vehicle->name.end(), [](unsigned char c) {
            return c < 128 && (std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_' || c == '.');
        })) {
        refuse(command, file + ": no C++ name can be made of the vehicle's name " + files::in_quotes(vehicle->name));
    }
    return *std::move(vehicle);
}

void write_whole(const std::string& command, const std::string& file, const std::string& text)
{
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.flush();
    if (!out) {
        refuse(command, file + " cannot be written");
    }
}

}  // namespace jink::host
