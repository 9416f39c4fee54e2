// What a renderer does before the first pass: buffers, kernels, pilot.
#include "render/renderer.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "opencl/program_cache.h"
#include "render/kernel_macros.h"
#include "render/pilot.h"
#include "render/radius_schedule.h"
#include "render/sampler_table.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tristim {
namespace {

/// Photons that an item has room for at first, per path; more are made as a pass needs them.
constexpr double photons_per_path = 1.5;
/// Rays that bench-pass can record, per pixel and photon path.
constexpr std::size_t recorded_rays_per_path = 24;

std::size_t rays_to_record(const RenderOptions& options) {
    if (!options.record_rays)
        return 0;
    return recorded_rays_per_path *
           (static_cast<std::size_t>(options.region.pixels()) + static_cast<std::size_t>(options.photons_per_pass));
}

} // namespace

Renderer::Renderer(const Scene& scene, const RenderOptions& options, const Device& device)
    : Renderer(std::make_shared<const DeviceScene>(scene, options, device), options, device) {}

Renderer::Renderer(std::shared_ptr<const DeviceScene> scene, const RenderOptions& options, const Device& device)
    : device_(device), options_(options), scene_(std::move(scene)), layout_(wavelength_layout(options.method)) {
    if (options.auto_method)
        fail("a method must be named here: auto is for render and bench");
    check_options(options);
    if (const std::string mismatch = scene_->mismatch(options, device); !mismatch.empty())
        fail("the scene is on the device for renders of another {}", mismatch);
    const FlatScene& flat = scene_->flat();
    const Effects& effects = scene_->effects();
    recorder_ = RayRecorder(device, rays_to_record(options));
    statistics_.bvh_seconds = scene_->buffers().bvh_seconds();

    sampler_table_ = Buffer<float>(device, "wavelength sampler", sampler_table(options.method, flat.emission));
    spectra_ = Buffer<float>(device, "spectra", flat.spectra.values(options.method));
    spectrum_is_smooth_ = Buffer<std::int32_t>(device, "spectrum kinds", flat.spectra.smooth());
    spectrum_rows_ = flat.spectra.rows();
    for (const SurfaceMaterial& material : flat.materials)
        film_table_rows_ = std::max(film_table_rows_, material.internal_rows);
    const auto padded = static_cast<std::size_t>(layout_.padded());
    pass_table_ =
        Buffer<float>(device, "pass table",
                      static_cast<std::size_t>(PASS_TABLE_SPECTRA + spectrum_rows_ + flat.film_table_rows) * padded);

    const auto pixels = static_cast<std::size_t>(options.region.pixels());
    radius0_ = Buffer<float>(device, "initial radii", pixels);
    visible_points_ = Buffer<VisiblePoint>(device, "visible points", pixels);
    visible_surfaces_ = Buffer<VisibleSurface>(device, "visible surfaces", effects.rough_photons ? pixels : 0);
    eye_spectra_ = Buffer<float>(device, "throughput spectra", has_coloured_eye(effects) ? pixels * padded : 0);
    largest_radius_ = Buffer<std::uint32_t>(device, "largest radius", 1);
    gathered_flux_ = Buffer<cl_float4>(device, "gathered flux", pixels);
    inner_flux_ = Buffer<cl_float4>(device, "flux gathered within radius/sqrt(2)", options.error_estimate ? pixels : 0);
    error_sums_ = Buffer<float>(device, "error sums", options.error_estimate ? ERROR_PLANES * pixels : 0);
    film_ = Buffer<FilmPixel>(device, "film", pixels);
    non_finite_ = Buffer<std::uint32_t>(device, "counts of values that are not finite", 2 * NON_FINITE_COUNTS);
    largest_floor_ = largest_radius_floor(flat.constants);

    const auto paths = static_cast<std::uint32_t>(options.photons_per_pass);
    const std::uint32_t paths_per_item = device.tuning.paths_per_item;
    photon_items_ = (paths + paths_per_item - 1) / paths_per_item;
    item_counts_ = Buffer<std::uint32_t>(device, "photon counts", photon_items_);
    item_rays_ = Buffer<std::uint64_t>(device, "photon rays", photon_items_);

    const Stopwatch building;
    build_kernels();
    allocate_photons(static_cast<std::uint32_t>(photons_per_path * std::min(paths, paths_per_item)));
    run_pilot();
    statistics_.build_kernels_seconds = building.seconds() - statistics_.pilot_seconds;
}

void Renderer::build_kernels() {
    const Macros macros = kernel_macros(options_, effects(), bvh(), device_.tuning);
    const BuildOptions build = build_options(options_);
    const auto kernel = [&](const char* file, const char* name) {
        return ::cl::Kernel(build_program(device_, file, macros, build), name);
    };
    wavelengths_ = kernel("wavelengths.cl", "wavelengths");
    if (film_table_rows_ > 0)
        film_tables_ = kernel("film_tables.cl", "film_tables");
    eye_pass_ = kernel("eye_pass.cl", "eye_pass");
    photon_pass_ = kernel("photon_pass.cl", "photon_pass");
    sorter_ = PhotonSorter(device_, macros, build, radix_bits(options_.photons_per_pass));
    gather_ = kernel("gather.cl", "gather");
    // Relaxed math would undo the film's compensated sums.
    const ::cl::Program film = build_program(device_, "film.cl", macros, build_options(options_, true));
    film_clear_ = ::cl::Kernel(film, "film_clear");
    film_largest_radius_ = ::cl::Kernel(film, "film_largest_radius");
    film_add_ = ::cl::Kernel(film, "film_add");
    if (options_.error_estimate)
        error_add_ = kernel("error_sums.cl", "error_add");
}

void Renderer::keep_programs() const {
    if (is_cheap_to_keep(device_.info))
        return;
    for (const ::cl::Kernel* kernel : {&wavelengths_, &film_tables_, &eye_pass_, &photon_pass_, &sorter_.kernel(),
                                       &gather_, &film_add_, &error_add_}) {
        if ((*kernel)() != nullptr)
            keep_program(device_, kernel->getInfo<CL_KERNEL_PROGRAM>());
    }
}

void Renderer::allocate_photons(std::uint32_t capacity_per_item) {
    capacity_per_item_ = std::max(capacity_per_item, 1U);
    const std::size_t photons = std::size_t{photon_items_} * capacity_per_item_;
    if (photons > std::numeric_limits<std::uint32_t>::max())
        fail("a pass would store up to {} photons, more than the {} that have numbers: lower the photons per pass",
             photons, std::numeric_limits<std::uint32_t>::max());
    const bool store_spectra = stores_spectral_flux(effects());
    const std::size_t floats = store_spectra ? photons * static_cast<std::size_t>(layout_.padded()) : 0;
    photons_ = Buffer<Photon>(device_, "photons", photons);
    photon_surfaces_ = Buffer<PhotonSurface>(device_, "photon surfaces", effects().rough_photons ? photons : 0);
    photon_spectra_ = Buffer<float>(device_, "photon spectra", floats);
    sorter_.allocate(device_, photon_items_, capacity_per_item_);

    statistics_.buffer_bytes = scene_->buffers().sizes();
    const auto add = [this](const auto& buffer) {
        statistics_.buffer_bytes.emplace_back(buffer.name(), buffer.bytes());
        return std::uint64_t{buffer.bytes()};
    };
    add(sampler_table_);
    add(spectra_);
    add(pass_table_);
    statistics_.pixel_bytes = add(radius0_) + add(visible_points_) + add(visible_surfaces_) + add(eye_spectra_) +
                              add(gathered_flux_) + add(film_);
    if (options_.error_estimate)
        statistics_.pixel_bytes += add(inner_flux_) + add(error_sums_);
    statistics_.bytes_per_pixel = static_cast<double>(statistics_.pixel_bytes) / options_.region.pixels();
    statistics_.photon_bytes = add(photons_) + add(photon_surfaces_) + add(photon_spectra_);
    for (const auto& size : sorter_.sizes()) {
        statistics_.buffer_bytes.push_back(size);
        statistics_.photon_bytes += size.second;
    }
    statistics_.bytes_per_photon = static_cast<double>(sizeof(Photon) + 2 * sizeof(cl_uint2)) +
                                   (effects().rough_photons ? static_cast<double>(sizeof(PhotonSurface)) : 0.0) +
                                   (store_spectra ? static_cast<double>(sizeof(float)) * layout_.padded() : 0.0);
}

void Renderer::run_pilot() {
    const double initial = options_.radius.value_or(1.0) * options_.radius_factor;
    if (!(initial >= SMALLEST_RADIUS && initial <= LARGEST_RADIUS))
        fail("an initial search radius of {:.3g} is not between {:.3g} and {:.3g}, whose squares are floats", initial,
             SMALLEST_RADIUS, LARGEST_RADIUS);
    largest_radius0_ = static_cast<float>(initial);
    radius0_.fill(device_, largest_radius0_);
    clear_film();
    const PassSeeds seeds{pilot_pass, options_.seed, 0, options_.seed};
    fill_wavelengths(seeds);
    trace_eye_paths(seeds, 1.0F);
    trace_photons(seeds);
    if (!options_.radius) {
        collect_times();
        const Stopwatch measuring;
        std::vector<float> radii = pilot_radii(visible_points(), options_.region.width, photons());
        for (float& radius : radii)
            radius = std::clamp(radius * static_cast<float>(options_.radius_factor), SMALLEST_RADIUS, LARGEST_RADIUS);
        set_initial_radii(radii);
        statistics_.pilot_seconds += measuring.seconds();
        trace_eye_paths(seeds, 1.0F); // visible points hold radii
    }
    sort_photons();
    gather_photons();
    add_to_film();
    if (options_.error_estimate)
        add_to_error_sums(seeds.pass);
    collect_times();
    const auto& steps = statistics_.step_seconds;
    statistics_.pilot_seconds += std::accumulate(steps.begin(), steps.end(), 0.0);
    reset();
}

void Renderer::set_initial_radii(const std::vector<float>& radii) {
    radius0_.write(device_, radii);
    largest_radius0_ = *std::max_element(radii.begin(), radii.end());
}

} // namespace tristim
