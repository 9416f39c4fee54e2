#pragma once

#include "base/region.h"

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

/// What a bench measured, as it stands in results.json. Everything the report, the plots and the table of values show
/// follows from it.

namespace tristim {

/// The error of a render in progress.
struct CurvePoint {
    double seconds = 0.0;      ///< of rendering so far: passes alone
    std::uint64_t passes = 0;  ///< so far
    std::uint64_t photons = 0; ///< photon paths emitted so far
    std::uint64_t memory = 0;  ///< bytes of device buffers, the most so far
    /// Per region of the scene: the paper's equation 12 and relMSE (image/compare_images.h).
    std::vector<double> rmse;
    std::vector<double> rel_mse;
};

/// One render, checkpoints in order of time.
struct Repeat {
    std::uint32_t seed = 0;
    std::string method;           ///< that rendered it: what auto chose, else the run's own
    double trial_seconds = 0.0;   ///< of auto's trial passes, part of the checkpoints' seconds
    double build_seconds = 0.0;   ///< kernels and pilot passes, outside of the checkpoints' seconds
    double compare_seconds = 0.0; ///< reading the film back and comparing it, outside as well
    bool finished = false;        ///< reached the bench's time
    std::vector<CurvePoint> checkpoints;
};

/// Bytes of device buffers at the end of the first repeat, by what they grow with.
struct MemoryUse {
    std::uint64_t photons = 0; ///< photons, their spectra and the grid
    std::uint64_t pixels = 0;
    std::uint64_t scene = 0; ///< geometry and spectra
    double bytes_per_photon = 0.0;
    double bytes_per_pixel = 0.0;
};

/// A method or setting on a device.
struct Run {
    std::string id;         ///< file names of its images: letters, digits, '-', '_' and '.'
    std::string label;      ///< as a legend shows it: "tristimulus:20"
    std::size_t device = 0; ///< index in BenchResults::devices
    nlohmann::ordered_json options = nlohmann::ordered_json::object(); ///< method, photons per pass and so on
    MemoryUse memory;
    std::vector<Repeat> repeats;
    std::string image;     ///< PNG at equal time (first repeat), relative to results.json; empty: none yet
    std::string error_map; ///< PNG beside it
};

/// A part of the image of which the error is measured by itself.
struct NamedRegion {
    std::string name;
    Region region;
    bool operator==(const NamedRegion&) const = default;
};

struct ReferenceSummary {
    std::string file; ///< as given, or relative to results.json if the bench rendered it
    std::string method;
    std::uint64_t passes = 0;
    double seconds = 0.0;
    std::uint32_t seed = 0;
    /// Per region, root mean square over pixels and channels, in units of XYZ.
    std::vector<double> noise; ///< standard error
    std::vector<double> bias;  ///< estimate of what the search radius still blurs
    std::vector<double> floor; ///< both together: errors measured below it mean nothing
};

/// Runs that one chart compares.
struct RunGroup {
    std::string name;                ///< file names: "methods", "wavelengths", …
    std::string title;               ///< "Wavelengths per path"
    std::vector<std::size_t> runs;   ///< indices in SceneResults::runs
    std::vector<std::string> labels; ///< of these runs in this group: "65536 photons"; as many as runs
    std::size_t baseline = 0;        ///< index in SceneResults::runs: what ratios refer to
    std::vector<std::string> notes;  ///< further findings, one sentence each
};

struct SceneResults {
    std::string name; ///< unique in the bench; file names
    std::string file; ///< as given
    int width = 0;
    int height = 0;
    std::vector<NamedRegion> regions; ///< the first is the whole rendered part, "image"
    ReferenceSummary reference;
    std::string image;            ///< PNG of the reference, relative to results.json
    double error_map_scale = 0.0; ///< RMS error over X, Y, Z that the error maps' brightest colour stands for
    std::vector<Run> runs;
    std::vector<RunGroup> groups; ///< a comparison of methods has one, --costs several
};

struct BenchDevice {
    std::string name, platform, driver, opencl_c;
    bool operator==(const BenchDevice&) const = default;
};

struct BenchMachine {
    std::string processor;
    unsigned threads = 0;
    std::uint64_t memory = 0; ///< bytes
    std::string system;       ///< "Linux 6.1.0"
};

struct BenchResults {
    std::string kind = "methods"; ///< or "costs"
    std::string version;          ///< of tristim
    std::string started;          ///< ISO 8601, UTC
    std::string command;          ///< the command line
    BenchMachine machine;
    std::vector<BenchDevice> devices;
    double seconds = 0.0; ///< of rendering, per repeat
    int repeats = 1;
    std::uint32_t seed = 0;                ///< of the first repeat
    std::uint64_t peak_process_memory = 0; ///< bytes, of the whole bench
    std::vector<SceneResults> scenes;
};

nlohmann::ordered_json to_json(const BenchResults& results);

/// The inverse of to_json; a "summary" is ignored. Throws Error naming `source` if something is missing or of the wrong
/// kind.
BenchResults results_from_json(const nlohmann::ordered_json& json, const std::string& source);

/// Reads a results.json. Throws Error.
BenchResults read_results(const std::string& path);

} // namespace tristim
