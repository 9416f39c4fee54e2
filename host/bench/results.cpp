#include "bench/results.h"

#include "base/error.h"
#include "base/read_file.h"

#include <array>
#include <type_traits>
#include <utility>

namespace tristim {
namespace {

using Json = nlohmann::ordered_json;

/// The members of each struct, by name, for both directions. T is the struct, const when it is written.
template <typename T, typename Struct>
concept Same = std::is_same_v<std::remove_const_t<T>, Struct>;

template <typename Visit>
void fields(Visit& visit, Same<CurvePoint> auto& c) {
    visit("seconds", c.seconds);
    visit("passes", c.passes);
    visit("photons", c.photons);
    visit("memory", c.memory);
    visit("rmse", c.rmse);
    visit("rel_mse", c.rel_mse);
}

template <typename Visit>
void fields(Visit& visit, Same<Repeat> auto& r) {
    visit("seed", r.seed);
    visit("method", r.method);
    visit("trial_seconds", r.trial_seconds);
    visit("build_seconds", r.build_seconds);
    visit("compare_seconds", r.compare_seconds);
    visit("finished", r.finished);
    visit("checkpoints", r.checkpoints);
}

template <typename Visit>
void fields(Visit& visit, Same<MemoryUse> auto& m) {
    visit("photons", m.photons);
    visit("pixels", m.pixels);
    visit("scene", m.scene);
    visit("bytes_per_photon", m.bytes_per_photon);
    visit("bytes_per_pixel", m.bytes_per_pixel);
}

template <typename Visit>
void fields(Visit& visit, Same<Run> auto& r) {
    visit("id", r.id);
    visit("label", r.label);
    visit("device", r.device);
    visit("options", r.options);
    visit("memory", r.memory);
    visit("image", r.image);
    visit("error_map", r.error_map);
    visit("repeats", r.repeats);
}

template <typename Visit>
void fields(Visit& visit, Same<NamedRegion> auto& r) {
    visit("name", r.name);
    visit("region", r.region);
}

template <typename Visit>
void fields(Visit& visit, Same<ReferenceSummary> auto& r) {
    visit("file", r.file);
    visit("method", r.method);
    visit("passes", r.passes);
    visit("seconds", r.seconds);
    visit("seed", r.seed);
    visit("noise", r.noise);
    visit("bias", r.bias);
    visit("floor", r.floor);
}

template <typename Visit>
void fields(Visit& visit, Same<RunGroup> auto& g) {
    visit("name", g.name);
    visit("title", g.title);
    visit("runs", g.runs);
    visit("labels", g.labels);
    visit("baseline", g.baseline);
    visit("notes", g.notes);
}

template <typename Visit>
void fields(Visit& visit, Same<SceneResults> auto& s) {
    visit("name", s.name);
    visit("file", s.file);
    visit("width", s.width);
    visit("height", s.height);
    visit("regions", s.regions);
    visit("reference", s.reference);
    visit("image", s.image);
    visit("error_map_scale", s.error_map_scale);
    visit("runs", s.runs);
    visit("groups", s.groups);
}

template <typename Visit>
void fields(Visit& visit, Same<BenchDevice> auto& d) {
    visit("name", d.name);
    visit("platform", d.platform);
    visit("driver", d.driver);
    visit("opencl_c", d.opencl_c);
}

template <typename Visit>
void fields(Visit& visit, Same<BenchMachine> auto& m) {
    visit("processor", m.processor);
    visit("threads", m.threads);
    visit("memory", m.memory);
    visit("system", m.system);
}

template <typename Visit>
void fields(Visit& visit, Same<BenchResults> auto& r) {
    visit("kind", r.kind);
    visit("version", r.version);
    visit("started", r.started);
    visit("command", r.command);
    visit("machine", r.machine);
    visit("devices", r.devices);
    visit("seconds", r.seconds);
    visit("repeats", r.repeats);
    visit("seed", r.seed);
    visit("peak_process_memory", r.peak_process_memory);
    visit("scenes", r.scenes);
}

struct Writer {
    Json json = Json::object();

    template <typename T>
    void operator()(const char* name, const T& value) {
        json[name] = encode(value);
    }

    template <typename T>
    static Json encode(const T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string> || std::is_same_v<T, Json>)
            return value;
        else if constexpr (std::is_same_v<T, Region>)
            return {value.x, value.y, value.x + value.width, value.y + value.height};
        else if constexpr (requires { typename T::value_type; }) {
            Json array = Json::array();
            for (const auto& element : value)
                array.push_back(encode(element));
            return array;
        } else {
            Writer writer;
            fields(writer, value);
            return writer.json;
        }
    }
};

/// Where it is: "scenes[0].runs", for messages.
struct Reader {
    const Json& json;
    const std::string& source;
    std::string path;

    template <typename T>
    void operator()(const char* name, T& value) {
        const std::string member = path.empty() ? name : path + "." + name;
        if (!json.is_object() || !json.contains(name))
            fail("cannot use \"{}\": \"{}\" is missing", source, member);
        decode(json.at(name), value, member);
    }

    template <typename T>
    void decode(const Json& from, T& value, const std::string& where) const {
        const auto require = [&](bool right, const char* what) {
            if (!right)
                fail("cannot use \"{}\": \"{}\" is not {}", source, where, what);
        };
        if constexpr (std::is_same_v<T, Json>) {
            value = from;
        } else if constexpr (std::is_same_v<T, bool>) {
            require(from.is_boolean(), "true or false");
            value = from.get<bool>();
        } else if constexpr (std::is_unsigned_v<T>) {
            require(from.is_number_unsigned() && std::in_range<T>(from.get<std::uint64_t>()),
                    "a whole number from 0 on");
            value = from.get<T>();
        } else if constexpr (std::is_integral_v<T>) {
            require(from.is_number_integer() && std::in_range<T>(from.get<std::int64_t>()), "a whole number");
            value = from.get<T>();
        } else if constexpr (std::is_arithmetic_v<T>) {
            require(from.is_number(), "a number");
            value = from.get<T>();
        } else if constexpr (std::is_same_v<T, std::string>) {
            require(from.is_string(), "a text");
            value = from.get<std::string>();
        } else if constexpr (std::is_same_v<T, Region>) {
            std::vector<int> corners;
            decode(from, corners, where);
            require(corners.size() == 4, "a list of four numbers");
            value = {corners[0], corners[1], corners[2] - corners[0], corners[3] - corners[1]};
        } else if constexpr (requires { typename T::value_type; }) {
            require(from.is_array(), "a list");
            value.resize(from.size());
            for (std::size_t i = 0; i < from.size(); ++i)
                decode(from[i], value[i], fmt::format("{}[{}]", where, i));
        } else {
            Reader reader{from, source, where};
            fields(reader, value);
        }
    }
};

/// What indices and lists of one value per region promise.
void check(const BenchResults& results, const std::string& source) {
    const auto require = [&](bool right, const std::string& what) {
        if (!right)
            fail("cannot use \"{}\": {}", source, what);
    };
    for (const SceneResults& scene : results.scenes) {
        const std::size_t regions = scene.regions.size();
        const std::string name = "scene \"" + scene.name + "\"";
        require(regions > 0, name + " has no region");
        for (const auto* values : {&scene.reference.noise, &scene.reference.bias, &scene.reference.floor})
            require(values->size() == regions, name + " has a reference without an error for each region");
        for (const Run& run : scene.runs) {
            require(run.device < results.devices.size(), "\"" + run.label + "\" ran on a device that is not listed");
            for (const Repeat& repeat : run.repeats) {
                for (const CurvePoint& checkpoint : repeat.checkpoints)
                    require(checkpoint.rmse.size() == regions && checkpoint.rel_mse.size() == regions,
                            "\"" + run.label + "\" has a checkpoint without an error for each region");
            }
        }
        for (const RunGroup& group : scene.groups) {
            bool listed = group.baseline < scene.runs.size() && group.labels.size() == group.runs.size();
            for (const std::size_t run : group.runs)
                listed = listed && run < scene.runs.size();
            require(listed,
                    "group \"" + group.name + "\" names a run that is not listed, or has not one label for each");
        }
    }
}

} // namespace

Json to_json(const BenchResults& results) {
    return Writer::encode(results);
}

BenchResults results_from_json(const Json& json, const std::string& source) {
    BenchResults results;
    Reader{json, source, ""}.decode(json, results, "");
    check(results, source);
    return results;
}

BenchResults read_results(const std::string& path) {
    const Json json = Json::parse(read_whole_file(path), nullptr, false);
    if (json.is_discarded())
        fail("cannot read \"{}\": it is not a whole JSON file", path);
    return results_from_json(json, path);
}

} // namespace tristim
