// SPDX-License-Identifier: BSD-3-Clause
// Every scenario file against the real program in real time, all at once, and the same flights in process beside them.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <gtest/gtest.h>

#include "toolchain/sim/daemon.hpp"
#include "toolchain/sim/envelope.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::sim {
namespace {

namespace fs = std::filesystem;

/// Two batches: 27 programs at once load two cores so much that ticks are late.
constexpr unsigned kAtOnce = 14;

std::vector<Scenario>& scenarios()
{
    static std::vector<Scenario> all;
    return all;
}

/// Flown once, by whichever test asks first.
const std::vector<Record>& daemon_records()
{
    static const std::vector<Record> records = [] {
        std::string pattern = (fs::temp_directory_path() / "jink-scenario-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) {
            throw std::runtime_error("no folder for logs");
        }
        std::vector<Record> flown = fly_daemons(scenarios(), {JINKD_PATH, ""}, pattern, kAtOnce);
        std::error_code ignored;  // a folder left behind in /tmp fails no test
        fs::remove_all(pattern, ignored);
        return flown;
    }();
    return records;
}

class Flight : public ::testing::Test {
public:
    explicit Flight(std::size_t index) : index_(index) {}

protected:
    std::size_t index_;
};

class Daemon : public Flight {
public:
    using Flight::Flight;
    void TestBody() override
    {
        const Record& record = daemon_records()[index_];
        for (const std::string& missing : unmet(scenarios()[index_], record)) {
            ADD_FAILURE() << missing;
        }
        for (const std::string& fault : record.faults) {
            ADD_FAILURE() << fault;
        }
        std::cout << record.name << ": " << to_string(record.outcome) << ", least " << record.closest.surface
                  << " m at " << record.closest.time << " s, " << record.repeats << " repeats, latest step "
                  << record.latest_step << " s\n";
    }
};

/// For every phase of ticks, line and sightings, the real program ends as the same code in process does in one of many
/// phases.
class WithinPhases : public Flight {
public:
    using Flight::Flight;
    void TestBody() override
    {
        const Record& real = daemon_records()[index_];
        const std::vector<std::string> wrong = outside_phases(scenarios()[index_], real);
        for (const std::string& what : wrong) {
            ADD_FAILURE() << what;
        }
        for (std::size_t i = 0; i < real.heard.texts.size() && !wrong.empty(); ++i) {
            std::cout << real.heard.texts[i].time << " s: " << real.heard.texts[i].text << "\n";
        }
    }
};

void choose(const std::string& only)
{
    for (const fs::path& file : scenario_files(JINK_SCENARIOS)) {
        std::istringstream names(only);
        bool wanted = only.empty();
        for (std::string name; std::getline(names, name, ',');) {
            wanted = wanted || file.stem() == name;
        }
        if (wanted) {
            scenarios().push_back(load_scenario(file));
            if (scenarios().back().lidar) {
                scenarios().pop_back();  // in process only
            }
        }
    }
}

void register_tests()
{
    for (std::size_t i = 0; i < scenarios().size(); ++i) {
        const std::string& name = scenarios()[i].name;
        ::testing::RegisterTest("Daemon", name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                                [i]() -> Flight* { return new Daemon(i); });
    }
    for (std::size_t i = 0; i < scenarios().size(); ++i) {
        const std::string& name = scenarios()[i].name;
        ::testing::RegisterTest("WithinPhases", name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                                [i]() -> Flight* { return new WithinPhases(i); });
    }
}

}  // namespace
}  // namespace jink::sim

/// --only NAME,NAME: these scenarios alone.
int main(int argc, char** argv)
{
    ::testing::InitGoogleTest(&argc, argv);
    const bool some = argc == 3 && std::string(argv[1]) == "--only";
    jink::sim::choose(some ? argv[2] : "");
    if (jink::sim::scenarios().empty()) {
        std::cerr << "no such scenario\n";
        return EXIT_FAILURE;
    }
    jink::sim::register_tests();
    return RUN_ALL_TESTS();
}
