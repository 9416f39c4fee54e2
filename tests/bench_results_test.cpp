// results.json and results.csv: nothing is lost on the way, and what is missing or wrong is named.
#include "bench/analysis.h"
#include "bench/results.h"
#include "scene_folder.h"

#include <algorithm>
#include <functional>

namespace tristim::test {
namespace {

using Json = nlohmann::ordered_json;

CurvePoint checkpoint(double seconds) {
    return {seconds,
            static_cast<std::uint64_t>(1000.0 * seconds),
            (1ULL << 40) + 7,
            123456789,
            {0.1 / seconds, 1.0 / 3.0},
            {1e-300, 2e-5}};
}

/// Every member differs from its default and from its neighbours.
BenchResults filled() {
    BenchResults r;
    r.kind = "costs";
    r.version = "9.8.7";
    r.started = "2001-02-03T04:05:06Z";
    r.command = "tristim bench 'a b.pbrt' --time 5";
    r.machine = {"A \"quoted\" processor", 12, 34567890123, "System 1.2"};
    r.devices = {{"first, with a comma", "platform", "driver", "OpenCL C 1.2"}, {"second", "p2", "d2", "c2"}};
    r.seconds = 1.0 / 3.0;
    r.repeats = 2;
    r.seed = 4294967295U;
    r.peak_process_memory = 987654321;
    SceneResults s;
    s.name = "glass";
    s.file = "meshes/glass/scene.pbrt";
    s.width = 640;
    s.height = 480;
    s.regions = {{"image", {0, 0, 640, 480}}, {"corner", {600, 400, 40, 80}}};
    s.reference = {"reference-glass.exr", "spectral:400", 621, 20.5, 77, {0.01, 0.02}, {0.03, 0.04}, {0.05, 0.06}};
    s.image = "images/glass-reference.png";
    s.error_map_scale = 0.2;
    tristim::Run a;
    a.id = "0-rgb";
    a.label = "rgb";
    a.device = 1;
    a.options = {{"method", "rgb"}, {"alpha", 0.5}};
    a.memory = {11, 12, 13, 14.5, 15.5};
    a.repeats = {{5, "rgb", 0.75, 1.5, 0.25, true, {checkpoint(0.1), checkpoint(0.3)}},
                 {6, "hero:4", 0.5, 1.25, 0.125, false, {checkpoint(0.2)}}};
    a.image = "images/a.png";
    a.error_map = "images/a-error.png";
    tristim::Run b = a;
    b.id = "1-other";
    b.device = 0;
    b.repeats.clear();
    s.runs = {a, b};
    s.groups = {{"methods", "Methods", {1, 0}, {"other", "rgb"}, 1, {"A note."}}};
    r.scenes = {s};
    return r;
}

TEST(BenchResultsFile, KeepsEverything) {
    const Json json = to_json(filled());
    const BenchResults again = results_from_json(Json::parse(json.dump()), "results.json");
    EXPECT_EQ(to_json(again), json);
    const tristim::Run& run = again.scenes.at(0).runs.at(0);
    EXPECT_EQ(again.kind, "costs");
    EXPECT_EQ(again.seconds, 1.0 / 3.0);
    EXPECT_EQ(again.devices, filled().devices);
    EXPECT_EQ(again.seed, 4294967295U);
    EXPECT_EQ(again.scenes[0].regions, filled().scenes[0].regions);
    EXPECT_EQ(run.repeats.at(1).method, "hero:4");
    EXPECT_EQ(run.repeats[1].trial_seconds, 0.5);
    EXPECT_EQ(run.repeats.at(0).checkpoints.at(1).rmse, filled().scenes[0].runs[0].repeats[0].checkpoints[1].rmse);
    EXPECT_EQ(run.repeats[0].checkpoints[0].photons, (1ULL << 40) + 7);
    EXPECT_FALSE(run.repeats.at(1).finished);
    EXPECT_EQ(run.options, filled().scenes[0].runs[0].options);
    EXPECT_EQ(again.scenes[0].groups.at(0).runs, (std::vector<std::size_t>{1, 0}));
    EXPECT_EQ(again.scenes[0].groups[0].notes, std::vector<std::string>{"A note."});
    EXPECT_EQ(json["scenes"][0]["regions"][1]["region"], (Json{600, 400, 640, 480})) << "two corners";
}

TEST(BenchResultsFile, SummariesAreNotRead) {
    Json json = to_json(filled());
    json["scenes"][0]["summary"] = {{"curves", "whatever"}};
    EXPECT_EQ(to_json(results_from_json(json, "results.json")), to_json(filled()));
}

/// Calls `visit` with each member of each struct: the object that holds it, its name and where it is.
void for_each_member(Json& json, const std::string& path,
                     const std::function<void(Json& owner, const std::string& name, const std::string& where)>& visit) {
    if (json.is_array()) {
        for (std::size_t i = 0; i < json.size(); ++i)
            for_each_member(json[i], path + "[" + std::to_string(i) + "]", visit);
        return;
    }
    if (!json.is_object())
        return;
    std::vector<std::string> names;
    for (const auto& [name, value] : json.items())
        names.push_back(name);
    for (const std::string& name : names) {
        const std::string where = path.empty() ? name : path + "." + name;
        if (name != "options") // anything goes
            for_each_member(json[name], where, visit);
        visit(json, name, where);
    }
}

TEST(BenchResultsFile, EveryMissingMemberIsNamed) {
    Json json = Json::parse(to_json(filled()).dump());
    int members = 0;
    for_each_member(json, "", [&](Json& owner, const std::string& name, const std::string& where) {
        const Json before = owner;
        owner.erase(name);
        const std::string message = error_of([&] { results_from_json(json, "DIR/results.json"); });
        expect_message(message, "cannot use \"DIR/results.json\": ", "\"" + where + "\" is missing");
        owner = before;
        ++members;
    });
    EXPECT_GT(members, 100);
    EXPECT_EQ(to_json(results_from_json(json, "")), to_json(filled())) << "the test has put all back";
}

TEST(BenchResultsFile, EveryMemberOfTheWrongKindIsNamed) {
    Json json = Json::parse(to_json(filled()).dump());
    for_each_member(json, "", [&](Json& owner, const std::string& name, const std::string& where) {
        if (name == "options")
            return;
        const Json before = owner[name];
        for (const Json& wrong : {Json(nullptr), Json(before.is_string() ? Json(5) : Json("five")), Json{{{"a", 1}}}}) {
            owner[name] = wrong;
            const std::string message = error_of([&] { results_from_json(json, "DIR/results.json"); });
            expect_message(message, "cannot use \"DIR/results.json\": ", "\"" + where);
        }
        owner[name] = before;
    });
    EXPECT_EQ(to_json(results_from_json(json, "")), to_json(filled())) << "the test has put all back";
}

TEST(BenchResultsFile, NumbersBeyondTheirTypeAreRefused) {
    const auto refused = [](const Json::json_pointer& where, const Json& value, const std::string& words) {
        Json json = Json::parse(to_json(filled()).dump());
        ASSERT_TRUE(json.contains(where));
        json[where] = value;
        json = Json::parse(json.dump()); // as from a file, where numbers that are not negative are unsigned
        expect_message(error_of([&] { results_from_json(json, "r.json"); }), "cannot use \"r.json\": ", words);
    };
    refused(Json::json_pointer("/seed"), 4294967296, "\"seed\" is not a whole number from 0 on");
    refused(Json::json_pointer("/seed"), -1, "\"seed\" is not a whole number from 0 on");
    refused(Json::json_pointer("/seed"), 1.5, "\"seed\" is not a whole number from 0 on");
    refused(Json::json_pointer("/repeats"), 2147483648, "\"repeats\" is not a whole number");
    refused(Json::json_pointer("/scenes/0/regions/1/region"), {1, 2, 3}, "scenes[0].regions[1].region");
    refused(Json::json_pointer("/scenes/0/runs/0/device"), 2, "\"rgb\" ran on a device that is not listed");
    refused(Json::json_pointer("/scenes/0/runs/0/repeats/0/checkpoints/1/rmse"), {0.5}, "without an error for each");
    refused(Json::json_pointer("/scenes/0/reference/bias"), Json::array(), "without an error for each region");
    refused(Json::json_pointer("/scenes/0/regions"), Json::array(), "has no region");
    refused(Json::json_pointer("/scenes/0/groups/0/runs/0"), 2, "names a run that is not listed");
    refused(Json::json_pointer("/scenes/0/groups/0/baseline"), 2, "names a run that is not listed");
    refused(Json::json_pointer("/scenes/0/groups/0/labels"), {"one"}, "one label for each");
}

TEST(BenchResultsFile, FilesThatCannotBeReadAreNamed) {
    const SceneFolder folder;
    expect_message(error_of([&] { read_results(folder.path("none.json")); }), "cannot open ",
                   "\"" + folder.path("none.json") + "\"");
    const std::string text = to_json(filled()).dump();
    EXPECT_EQ(to_json(read_results(folder.write("good.json", text))), to_json(filled()));
    for (const std::string& bad : {std::string(), text.substr(0, text.size() / 2), std::string("\x00\xff\x01", 3)}) {
        const std::string path = folder.write("bad.json", bad);
        expect_message(error_of([&] { read_results(path); }), "cannot read \"" + path + "\"", "not a whole JSON file");
    }
    for (const char* other : {"[]", "5", "null"}) {
        const std::string path = folder.write("other.json", other);
        expect_message(error_of([&] { read_results(path); }), "cannot use \"" + path + "\"", "\"kind\" is missing");
    }
}

/// RFC 4180: fields apart by commas; one in quotes may hold commas and doubled quotes.
std::vector<std::string> split_csv(const std::string& line) {
    std::vector<std::string> fields{""};
    bool quoted = false;
    for (const char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            fields.emplace_back();
        else
            fields.back() += c;
    }
    return fields;
}

TEST(BenchResultsFile, TableHasALineForEachCheckpointAndRegion) {
    std::istringstream csv(results_csv(filled()));
    std::vector<std::vector<std::string>> lines;
    for (std::string line; std::getline(csv, line);)
        lines.push_back(split_csv(line));
    ASSERT_EQ(lines.size(), 1U + 3U * 2U) << "three checkpoints, two regions";
    EXPECT_EQ(lines[0], (std::vector<std::string>{"scene", "device", "run", "seed", "region", "seconds", "passes",
                                                  "photons", "memory", "rmse", "relmse"}));
    for (const auto& line : lines)
        ASSERT_EQ(line.size(), lines[0].size());
    std::size_t next = 1;
    const BenchResults results = filled();
    for (const Repeat& repeat : results.scenes[0].runs[0].repeats) {
        for (const CurvePoint& point : repeat.checkpoints) {
            for (std::size_t r = 0; r < 2; ++r) {
                const auto& line = lines[next++];
                EXPECT_EQ(line[0], "glass");
                EXPECT_EQ(line[1], "second");
                EXPECT_EQ(line[2], "0-rgb");
                EXPECT_EQ(line[3], std::to_string(repeat.seed));
                EXPECT_EQ(line[4], r == 0 ? "image" : "corner");
                EXPECT_EQ(std::stod(line[5]), point.seconds);
                EXPECT_EQ(line[6], std::to_string(point.passes));
                EXPECT_EQ(line[7], std::to_string(point.photons));
                EXPECT_EQ(line[8], std::to_string(point.memory));
                EXPECT_EQ(std::strtod(line[9].c_str(), nullptr), point.rmse[r]) << "all digits";
                EXPECT_EQ(std::strtod(line[10].c_str(), nullptr), point.rel_mse[r]) << "all digits";
            }
        }
    }
}

} // namespace
} // namespace tristim::test
