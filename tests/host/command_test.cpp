// SPDX-License-Identifier: BSD-3-Clause
// The jink command from the user's view: arguments, exit statuses, output streams, the report.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>

#include <nlohmann/json.hpp>

#include "tests/host/scratch.hpp"

namespace {

using jink::test::Scratch;
using jink::test::slurp;

struct Ran {
    int status = -1;
    std::string out;
    std::string err;
};

/// Runs jink in the scratch folder; arguments are shell words.
Ran jink(const Scratch& scratch, const std::string& arguments)
{
    const std::string command =
        "cd '" + scratch.path().string() + "' && '" JINK_PROGRAM "' " + arguments + " >out.txt 2>err.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(scratch.path() / "out.txt"),
            slurp(scratch.path() / "err.txt")};
}

const std::string kGood = "vehicle: default\nleg: {start: [0, 0, 20], end: [60, 0, 20], speed: 5}\n"
                          "threats: [{position: [20, 1, 20], velocity: [-3, 0, 0], radius: 1.5}]\n";
const std::string kStop = "vehicle: default\nstart: [0, 0, 20]\ndirection: [1, 0, 0]\ndistance: 2.4\n"
                          "threats: [{position: [2.4, 0, 20], radius: 1}]\n";

TEST(Command, PlanExitsWithZeroTwoOrOne)
{
    const Scratch scratch;
    static_cast<void>(scratch.write("good.yaml", kGood));
    static_cast<void>(scratch.write("stop.yaml", kStop));
    static_cast<void>(scratch.write("bad.yaml", kGood + "speeed: 5\n"));
    const Ran good = jink(scratch, "plan good.yaml");
    EXPECT_EQ(good.status, 0) << good.err;
    EXPECT_NE(good.out.find("Fly candidate"), std::string::npos);
    EXPECT_EQ(good.err, "");
    const Ran stop = jink(scratch, "plan stop.yaml");
    EXPECT_EQ(stop.status, 1);
    EXPECT_NE(stop.out.find("Stop: "), std::string::npos);
    const Ran bad = jink(scratch, "plan bad.yaml");
    EXPECT_EQ(bad.status, 2);
    EXPECT_EQ(bad.out, "");
    EXPECT_EQ(bad.err, "bad.yaml:4:1: unknown key 'speeed'; did you mean 'speed'?\n");
    const Ran none = jink(scratch, "plan none.yaml");
    EXPECT_EQ(none.status, 2);
    EXPECT_EQ(none.err, "none.yaml: no such file\n");
}

TEST(Command, PlanInEveryFormat)
{
    const Scratch scratch;
    static_cast<void>(scratch.write("good.yaml", kGood));
    const auto json = nlohmann::json::parse(jink(scratch, "plan good.yaml --format json --points").out);
    EXPECT_EQ(json["status"], "found");
    EXPECT_EQ(json["candidates"].size(), 32U);
    EXPECT_EQ(json["candidates"][0]["points"].size(), 25U);
    const std::string csv = jink(scratch, "plan good.yaml --format csv").out;
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 33);
    EXPECT_EQ(jink(scratch, "plan good.yaml --format table").out, jink(scratch, "plan good.yaml").out);
}

TEST(Command, PlanAsTheSourceOrInAnotherMode)
{
    const Scratch scratch;
    static_cast<void>(scratch.write("good.yaml", kGood));
    const std::string source = jink(scratch, "plan good.yaml --source").out;
    EXPECT_NE(source.find("swept security, offsets by the source's rule"), std::string::npos);
    EXPECT_EQ(source.find("not flyable"), std::string::npos) << "the source does not ask";
    EXPECT_NE(jink(scratch, "plan good.yaml --mode swept").out.find("swept security, offsets by the clearing rule"),
              std::string::npos);
    EXPECT_NE(jink(scratch, "plan good.yaml --source --mode time-aware")
                  .out.find("time-aware security, offsets by the source's rule"),
              std::string::npos);
    EXPECT_EQ(jink(scratch, "plan good.yaml --budget 1").status, 1);
}

TEST(Command, WrongCommandLinesExitWithTwoAndHelpWithZero)
{
    const Scratch scratch;
    static_cast<void>(scratch.write("good.yaml", kGood));
    for (const char* arguments : {"", "fly", "plan", "plan good.yaml --format xml", "plan good.yaml --mode fast",
                                  "plan good.yaml --sauce", "plan good.yaml --budget 0", "plan good.yaml --budget -5",
                                  "check", "check --as poem good.yaml", "report", "report a b c", "report . --run x"}) {
        const Ran ran = jink(scratch, arguments);
        EXPECT_EQ(ran.status, 2) << arguments;
        EXPECT_NE(ran.err, "") << arguments;
    }
    for (const char* arguments : {"--help", "plan --help", "check --help", "report --help"}) {
        const Ran ran = jink(scratch, arguments);
        EXPECT_EQ(ran.status, 0) << arguments;
        EXPECT_NE(ran.out.find("Usage"), std::string::npos) << arguments;
    }
}

TEST(Command, CheckKnowsEveryKindOfFile)
{
    const Scratch scratch;
    static_cast<void>(scratch.write("problem.yaml", kGood));
    static_cast<void>(scratch.write("p.parm", "JNK_MODE,1\n"));
    static_cast<void>(scratch.write("bad.parm", "JNK_MOOD,1\nJNK_MODE,7\n"));
    static_cast<void>(scratch.write("odd.parm", "GEO_OFFSETS,5\n"));
    static_cast<void>(
        scratch.write("scenario.yaml", "mission: [[0, 0, 30], [10, 0, 30]]\nexpect: {outcome: clear}\nseeed: 3\n"));
    static_cast<void>(scratch.write("riddle.yaml", "what: is it\n"));
    static_cast<void>(scratch.write("broken.yaml", "a: [1\n"));
    const Ran good =
        jink(scratch, "check problem.yaml p.parm '" JINK_SOURCES "/firmware/vehicles/default/vehicle.yaml'");
    EXPECT_EQ(good.status, 0) << good.err;
    EXPECT_EQ(good.out, "problem.yaml: good (problem)\np.parm: good (params)\n" JINK_SOURCES
                        "/firmware/vehicles/default/vehicle.yaml: good (vehicle)\n");
    EXPECT_EQ(good.err, "");

    const Ran bad = jink(scratch, "check bad.parm problem.yaml odd.parm");
    EXPECT_EQ(bad.status, 2);
    EXPECT_EQ(bad.out, "problem.yaml: good (problem)\n");
    EXPECT_NE(bad.err.find("bad.parm:1:1: unknown parameter 'JNK_MOOD'; did you mean 'JNK_MODE'?\n"), std::string::npos)
        << bad.err;
    EXPECT_NE(bad.err.find("bad.parm:2:10: JNK_MODE: '7' is out of range: 0 to 2"), std::string::npos) << bad.err;
    EXPECT_NE(bad.err.find("odd.parm: GEO_OFFSETS must be even"), std::string::npos) << bad.err;

    const Ran scenario = jink(scratch, "check scenario.yaml");
    EXPECT_EQ(scenario.status, 2);
    EXPECT_EQ(scenario.err, "scenario.yaml:3:1: unknown key 'seeed'; did you mean 'seed'?\n");
    EXPECT_NE(jink(scratch, "check riddle.yaml").err.find("is neither a vehicle nor a problem nor a scenario"),
              std::string::npos);
    EXPECT_NE(jink(scratch, "check broken.yaml").err.find("is not YAML"), std::string::npos);
    EXPECT_NE(jink(scratch, "check --as vehicle problem.yaml").err.find("missing key 'kind'"), std::string::npos);
    EXPECT_NE(jink(scratch, "check none.parm").err.find("no such file"), std::string::npos);
    EXPECT_NE(jink(scratch, "check --as scenario none.yaml").err.find("none.yaml: no such file"), std::string::npos);
}

TEST(Command, EveryFileThatIsShippedIsGood)
{
    const Scratch scratch;
    const Ran ran = jink(scratch, "check '" JINK_SOURCES "'/firmware/vehicles/*/vehicle.yaml '" JINK_SOURCES
                                  "'/tests/scenario/*.yaml '" JINK_SOURCES "'/tests/scenario/problems/*.yaml");
    EXPECT_EQ(ran.status, 0) << ran.err;
}

/// A run with one flight of each kind, as jink-sim writes it.
nlohmann::json sample_run()
{
    nlohmann::json series{{"t", nlohmann::json::array()},
                          {"position", nlohmann::json::array()},
                          {"mode", nlohmann::json::array()},
                          {"separation", nlohmann::json::array()}};
    nlohmann::json way = nlohmann::json::array();
    for (int i = 0; i < 60; ++i) {
        series["t"].push_back(0.1 * i);
        series["position"].push_back({0.5 * i, i > 20 && i < 40 ? 2.0 : 0.0, 30.0});
        series["mode"].push_back(i > 20 && i < 40 ? "external" : "mission");
        series["separation"].push_back(std::abs(30 - i) + 1.5);
        way.push_back({30.0 - 0.5 * i, 0.0, 30.0});
    }
    const nlohmann::json flight{
        {"name", "one"},
        {"title", "A title with <script>alert(1)</script> & \"quotes\""},
        {"transport", "daemon"},
        {"stack", "px4"},
        {"outcome", "avoided"},
        {"expected", {"avoided"}},
        {"as_expected", true},
        {"promise", 0.7},
        {"duration", 6.0},
        {"least",
         {{"surface", 1.5},
          {"alone", -1.0},
          {"t", 3.0},
          {"threat", "intruder"},
          {"own", {15, 2, 30}},
          {"centre", {15, 0, 30}}}},
        {"link", {{"texts", {{{"t", 1.9}, {"severity", 4}, {"text", "jink: conflict, traffic in 3.0 s"}}}}}},
        {"mission", {{0, 0, 30}, {60, 0, 30}}},
        {"threats",
         {{{"name", "intruder"},
           {"radius", 1.0},
           {"half_height", 0.0},
           {"moves", true},
           {"appeared", 1.0},
           {"positions", way}}}},
        {"series", series},
        {"inside", {{"plan_steps", {{"count", 3}, {"mean_us", 40.0}, {"worst_us", 75.0}}}, {"first_candidate", "x"}}},
        {"decisions",
         {{{"t", 2.0},
           {"text", "answer of method geometric"},
           {"start", {0, 0, 30}},
           {"own_at_closest", {10, 0, 30}},
           {"candidates",
            {{{"family", "smooth"}, {"plane", 0.0}, {"offset", 2.0}, {"status", "chosen"}, {"cost", 0.2}},
             {{"family", "simple"}, {"plane", 1.5}, {"offset", -2.0}, {"status", "hits_moving"}, {"cost", 0.1}}}}}}}};
    nlohmann::json random = flight;
    random["name"] = "random_1";
    random["judge"] = {{"avoidable", true}};
    random["outcome"] = "breach";
    random["least"]["surface"] = 0.2;
    return {{"format", "jink-sim run"}, {"version", 2}, {"flights", {flight, random}}};
}

/// Whether the viewer has been built; without it `jink report` says what to do.
bool has_viewer(const Scratch& scratch)
{
    static_cast<void>(scratch.write("probe.json", R"({"format": "jink-sim run", "version": 2, "flights": []})"));
    const Ran ran = jink(scratch, "report probe.json --out probe.html");
    EXPECT_TRUE(ran.status == 0 || ran.err.find("toolchain/viewer/setup.sh") != std::string::npos) << ran.err;
    return ran.status == 0;
}

TEST(Command, ReportIsOneFileThatFetchesNothing)
{
    const Scratch scratch;
    if (!has_viewer(scratch)) {
        GTEST_SKIP() << "the viewer has not been built";
    }
    static_cast<void>(scratch.write("run.json", sample_run().dump()));
    const Ran ran = jink(scratch, "report .");
    ASSERT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, "Written: report.html\n");
    const std::string page = slurp(scratch.path() / "report.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    for (const char* outside :
         {"src=\"http", "href=\"http", "@import", "<link rel=\"style", "<script src", "<iframe"}) {
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    }
    EXPECT_EQ(page.find("<script>alert"), std::string::npos) << "a title stays a title";
    EXPECT_EQ(page.find("JINK_FLIGHTS"), std::string::npos);
    EXPECT_NE(page.find("jink: conflict, traffic in 3.0 s"), std::string::npos);
    EXPECT_NE(page.find("three.js"), std::string::npos) << "the licence's line of what is bundled";
    EXPECT_EQ(jink(scratch, "report run.json --out again.html").status, 0);
    EXPECT_TRUE(slurp(scratch.path() / "again.html") == page) << "the same flights, the same page";
    EXPECT_EQ(jink(scratch, "report run.json . --out two.html").status, 0);
    EXPECT_GT(slurp(scratch.path() / "two.html").size(), page.size());
}

TEST(Command, ReportBearsWhatIsMissingAndRefusesWhatIsNoRun)
{
    const Scratch scratch;
    if (!has_viewer(scratch)) {
        GTEST_SKIP() << "the viewer has not been built";
    }
    nlohmann::json bare = sample_run();
    bare["flights"] = {
        nlohmann::json::object(),
        {{"name", "named"}, {"series", {{"t", {0, 1}}, {"separation", {nullptr, 2.0}}}}},
        {{"least", nullptr},
         {"decisions", {{{"t", 1}}, {{"t", 2}, {"candidates", {{{"family", "wait"}, {"status", "chosen"}}}}}}}}};
    static_cast<void>(scratch.write("bare.json", bare.dump()));
    const Ran ran = jink(scratch, "report bare.json --out page.html");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(ran.out, "Written: page.html\n");
    const nlohmann::json run = sample_run();
    const auto headed = [](const char* flights) {
        return std::string(R"({"format": "jink-sim run", "version": 2, )") + flights + "}";
    };
    const auto changed = [&](const char* at, const nlohmann::json& value) {
        nlohmann::json one = run;
        one[nlohmann::json::json_pointer(at)] = value;
        return one.dump();
    };
    const struct {
        std::string text;
        std::string complaint;
    } cases[] = {
        {"{", "wrong.json:1:2: is not JSON: syntax error"},
        {"", "wrong.json:1:1: is not JSON"},
        {"{\n  \"a\": }", "wrong.json:2:8: is not JSON"},
        {" []", "wrong.json:1:2: holds no list of flights"},
        {headed(R"("flights": 3)"), "wrong.json:1:1: holds no list of flights"},
        {headed(R"("flights": [3])"), "wrong.json:1:54: flights[0]: expected an object"},
        {headed(R"("flights": [null])"), "wrong.json:1:54: flights[0]: expected an object"},
        {R"({"flights": []})", "wrong.json:1:1: format: expected 'jink-sim run'"},
        {"{\n\t\"format\":\n \"jink-sim walk\"}", "wrong.json:3:2: format: expected 'jink-sim run'"},
        {R"({"format": "jink-sim run", "version": 3})", "wrong.json:1:39: version: expected 2"},
        {headed(R"("flights": [{"name": "a", "name": "b"}])"), "wrong.json:1:68: key 'name' comes twice"},
        {headed((R"("flights": [{"promise": 1)" + std::string(400, '0') + "}]").c_str()),
         "wrong.json:1:66: expected a number that double precision holds"},
        {changed("/flights/0/promise", 1e300), "flights[0].promise: expected a number from -1e7 to 1e7"},
        {"ULog\1", "wrong.json: not a ULog file"},
        {changed("/flights/1/name", 3), ": flights[1].name: expected a text"},
        {changed("/flights/0/promise", "far"), "flights[0].promise: expected a number"},
        {changed("/flights/0/series", 4), "flights[0].series: expected an object"},
        {changed("/flights/0/series/t/7", 0.0), "flights[0].series.t[7]: expected a time that is not before the last"},
        {changed("/flights/0/series/position/5", {1, 2}), "flights[0].series.position[5]: expected three numbers"},
        {changed("/flights/0/series/mode", {"mission"}),
         "flights[0].series.mode: 1 values, expected 60 as in series.t"},
        {changed("/flights/0/threats/0/positions/3", "there"), "flights[0].threats[0].positions[3]: expected a list"},
        {changed("/flights/0/threats/0/form", "cube"), "flights[0].threats[0].form: expected sphere, cylinder or box"},
        {changed("/flights/0/decisions/0/candidates/1/status", "maybe"),
         "flights[0].decisions[0].candidates[1].status: expected a candidate's status, not 'maybe'"},
        {changed("/flights/0/decisions/0/candidates/1/status", "hits_"),
         "flights[0].decisions[0].candidates[1].status: expected a candidate's status, not 'hits_'"},
        {changed("/flights/0/decisions/0/candidates/0/family", "loop"),
         "flights[0].decisions[0].candidates[0].family: expected a candidate's family, not 'loop'"},
        {changed("/flights/0/decisions/0/start", {1, 2}), "flights[0].decisions[0].start: expected three numbers"},
        {changed("/flights/0/decisions/0/t", nullptr), "flights[0].decisions[0].t: expected a time"},
        {changed("/flights/0/series/work", {1, 2, 3}), "flights[0].series.work: 3 values, expected 60 as in series.t"},
    };
    for (const auto& c : cases) {
        static_cast<void>(scratch.write("wrong.json", c.text));
        const Ran wrong = jink(scratch, "report wrong.json --out wrong.html");
        EXPECT_EQ(wrong.status, 2) << c.text;
        EXPECT_NE(wrong.err.find(c.complaint), std::string::npos) << wrong.err << " expected: " << c.complaint;
        EXPECT_FALSE(std::filesystem::exists(scratch.path() / "wrong.html")) << c.complaint;
    }
    EXPECT_NE(jink(scratch, "report none.json").err.find("none.json: cannot be read"), std::string::npos);
    EXPECT_NE(jink(scratch, "report none.ulg").err.find("none.ulg: cannot be read"), std::string::npos);
    const Ran nowhere = jink(scratch, "report bare.json --out /nowhere/page.html");
    EXPECT_EQ(nowhere.status, 2);
    EXPECT_NE(nowhere.err.find("/nowhere/page.html: cannot be opened"), std::string::npos) << nowhere.err;
}

TEST(Command, TablesAreWrittenAndWhatTheyComeFromIsChecked)
{
    const Scratch scratch;
    const std::string vehicles = JINK_SOURCES "/firmware/vehicles/";
    const Ran made = jink(scratch, "tables " + vehicles + "uav2/vehicle.yaml --out made.hpp");
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_NE(made.out.find("uav2: 25 waypoints, 4892 bytes in 3 families"), std::string::npos) << made.out;
    EXPECT_EQ(slurp(scratch.path() / "made.hpp"), slurp(vehicles + "uav2/cost_tables.hpp"));

    const std::string good = slurp(vehicles + "uav2/vehicle.yaml");
    const auto refused = [&](const std::string& file, const std::string& options, const std::string& why) {
        const Ran ran = jink(scratch, "tables " + file + options + " --out none.hpp");
        EXPECT_EQ(ran.status, 2) << file << options;
        EXPECT_NE(ran.err.find(why), std::string::npos) << ran.err;
        EXPECT_FALSE(std::filesystem::exists(scratch.path() / "none.hpp"));
    };
    static_cast<void>(scratch.write("no_mass.yaml", good.substr(0, good.find("mass: 10"))));
    refused("no_mass.yaml", "", "mass");
    static_cast<void>(scratch.write("not_a_number.yaml", good + "air_density: .nan\n"));
    refused("not_a_number.yaml", "", "air_density");
    static_cast<void>(scratch.write("cut.yaml", good + "rotors: {count: 4"));
    refused("cut.yaml", "", "cut.yaml:");
    std::string named = good;
    static_cast<void>(scratch.write("name.yaml", named.replace(named.find("name: uav2"), 10, "name: '4\"'")));
    refused("name.yaml", "", "no C++ name");
    refused("nowhere.yaml", "", "no such file");
    refused(vehicles + "uav2/vehicle.yaml", " --waypoints 7", "waypoints");
    refused(vehicles + "uav2/vehicle.yaml", " --waypoints 65", "waypoints");
    const Ran unwritten = jink(scratch, "tables " + vehicles + "uav2/vehicle.yaml --out no_folder/a.hpp");
    EXPECT_EQ(unwritten.status, 2);
    EXPECT_NE(unwritten.err.find("no_folder/a.hpp: cannot be opened"), std::string::npos);
}

TEST(Command, WaypointsPrintsARowForEachNumber)
{
    const Scratch scratch;
    const Ran ran = jink(scratch, "waypoints --waypoints 12 25 --problems 5");
    EXPECT_EQ(ran.status, 0) << ran.err;
    EXPECT_NE(ran.out.find("\n       12 "), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("  default\n"), std::string::npos) << ran.out;
    EXPECT_EQ(jink(scratch, "waypoints --waypoints 7").status, 2);
    const Ran none = jink(scratch, "waypoints none.yaml");
    EXPECT_EQ(none.status, 2);
    EXPECT_EQ(none.err, "none.yaml: no such file\n");
}

}  // namespace
