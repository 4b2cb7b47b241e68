// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "firmware/linux/complaint.hpp"

namespace jink::test {

/// A folder that is removed at the end of the test.
class Scratch {
public:
    Scratch()
    {
        std::string name = (std::filesystem::temp_directory_path() / "jink_host_XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~Scratch() { std::filesystem::remove_all(path_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// Writes a file and returns its path.
    [[nodiscard]] std::filesystem::path write(const std::string& name, const std::string& text) const
    {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

inline std::string slurp(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// All complaints, one per line.
inline std::string all_of(const files::Complaints& complaints)
{
    std::string text;
    for (const files::Complaint& complaint : complaints) {
        text += files::to_string(complaint) + "\n";
    }
    return text;
}

/// The complaint that contains `part`, or null.
inline const files::Complaint* with(const files::Complaints& complaints, const std::string& part)
{
    for (const files::Complaint& complaint : complaints) {
        if (complaint.text.find(part) != std::string::npos) {
            return &complaint;
        }
    }
    return nullptr;
}

}  // namespace jink::test
