#include "render/renderer.h"

#include "base/error.h"
#include "base/stopwatch.h"
#include "render/error_contrasts.h"
#include "render/radius_schedule.h"

#include <algorithm>
#include <bit>

namespace tristim {

void Renderer::reset() {
    clear_film();
    collect_times();
    statistics_.step_seconds = {};
    statistics_.passes = 0;
    statistics_.photons_emitted = 0;
    statistics_.photons_stored = 0;
    statistics_.render_seconds = 0.0;
}

void Renderer::clear_film() {
    item_rays_.fill(device_, 0U);
    non_finite_.fill(device_, 0U);
    film_clear_.setArg(0, radius0_.cl());
    film_clear_.setArg(1, film_.cl());
    enqueue(Step::Film, film_clear_, film_.size(), device_.tuning.pixel_group);
    if (options_.error_estimate)
        error_sums_.fill(device_, 0.0F);
}

void Renderer::render_pass(const PassSeeds& seeds) {
    const Stopwatch stopwatch;
    if (options_.record_rays)
        recorder_.clear(device_);
    fill_wavelengths(seeds);
    trace_eye_paths(seeds, static_cast<float>(radius_scale(seeds.radius_pass, options_.alpha)));
    trace_photons(seeds);
    sort_photons();
    gather_photons();
    check_loops();
    add_to_film();
    if (options_.error_estimate)
        add_to_error_sums(seeds.pass);
    collect_times();
    ++statistics_.passes;
    statistics_.photons_emitted += static_cast<std::uint64_t>(options_.photons_per_pass);
    statistics_.render_seconds += stopwatch.seconds();
}

void Renderer::fill_wavelengths(const PassSeeds& seeds) {
    cl_uint argument = 0;
    wavelengths_.setArg(argument++, seeds.wavelength_seed);
    wavelengths_.setArg(argument++, seeds.pass);
    wavelengths_.setArg(argument++, sampler_table_.cl());
    wavelengths_.setArg(argument++, spectra_.cl());
    wavelengths_.setArg(argument++, spectrum_is_smooth_.cl());
    wavelengths_.setArg(argument++, spectrum_rows_);
    wavelengths_.setArg(argument++, pass_table_.cl());
    const auto wavelengths = static_cast<std::size_t>(layout_.padded());
    enqueue(Step::Wavelengths, wavelengths_, wavelengths, std::min(wavelengths, device_.tuning.pixel_group));
    if (film_table_rows_ == 0)
        return;
    film_tables_.setArg(0, scene_->buffers().materials().cl());
    film_tables_.setArg(1, scene_->buffers().film_layers().cl());
    film_tables_.setArg(2, film_table_rows_);
    film_tables_.setArg(3, pass_table_.cl());
    film_tables_.setArg(4, non_finite_.cl());
    const std::size_t items = static_cast<std::size_t>(layout_.blocks) * static_cast<std::size_t>(film_table_rows_) *
                              scene_->buffers().materials().size();
    enqueue(Step::Wavelengths, film_tables_, items, 1);
}

void Renderer::trace_eye_paths(const PassSeeds& seeds, float scale) {
    cl_uint argument = scene_->buffers().bind(eye_pass_, pass_table_, recorder_);
    eye_pass_.setArg(argument++, seeds.seed);
    eye_pass_.setArg(argument++, seeds.pass);
    eye_pass_.setArg(argument++, radius0_.cl());
    eye_pass_.setArg(argument++, scale);
    eye_pass_.setArg(argument++, film_.cl());
    eye_pass_.setArg(argument++, visible_points_.cl());
    eye_pass_.setArg(argument++, visible_surfaces_.cl());
    eye_pass_.setArg(argument++, eye_spectra_.cl());
    eye_pass_.setArg(argument++, non_finite_.cl());
    enqueue(Step::EyePass, eye_pass_, visible_points_.size(), device_.tuning.pixel_group);

    const float largest = largest_radius0_ * scale;
    if (!options_.statistics_radius && largest >= largest_floor_) {
        largest_radius_.fill(device_, std::bit_cast<std::uint32_t>(largest));
        return;
    }
    largest_radius_.fill(device_, 0U);
    film_largest_radius_.setArg(0, visible_points_.cl());
    film_largest_radius_.setArg(1, largest_radius_.cl());
    enqueue(Step::EyePass, film_largest_radius_, visible_points_.size(), device_.tuning.pixel_group);
}

void Renderer::trace_photons(const PassSeeds& seeds) {
    std::vector<std::uint32_t> counted; // by a first attempt, and just so by the second
    for (;;) {
        cl_uint argument = scene_->buffers().bind(photon_pass_, pass_table_, recorder_);
        photon_pass_.setArg(argument++, seeds.seed);
        photon_pass_.setArg(argument++, seeds.pass);
        photon_pass_.setArg(argument++, static_cast<cl_uint>(options_.photons_per_pass));
        photon_pass_.setArg(argument++, capacity_per_item_);
        photon_pass_.setArg(argument++, photons_.cl());
        photon_pass_.setArg(argument++, photon_surfaces_.cl());
        photon_pass_.setArg(argument++, photon_spectra_.cl());
        photon_pass_.setArg(argument++, item_counts_.cl());
        photon_pass_.setArg(argument++, item_rays_.cl());
        photon_pass_.setArg(argument++, non_finite_.cl());
        enqueue(Step::PhotonPass, photon_pass_, photon_items_, device_.tuning.item_group);
        const PhotonSorter::Summary summary = sorter_.count(device_, item_counts_, enqueue_grid());
        photon_count_ = summary.photons;
        if (!counted.empty())
            non_finite_.write(device_, counted);
        if (summary.most_per_item == 0)
            return;
        allocate_photons(summary.most_per_item + summary.most_per_item / 4);
        counted = non_finite_.read(device_);
    }
}

void Renderer::sort_photons() {
    statistics_.photons_stored += photon_count_;
    sorter_.sort(scene_->buffers().constants(), photons_, largest_radius_, enqueue_grid());
}

void Renderer::gather_photons() {
    cl_uint argument = 0;
    for (const ::cl::Buffer* buffer : {&scene_->buffers().constants().cl(), &pass_table_.cl(), &visible_points_.cl(),
                                       &eye_spectra_.cl(), &photons_.cl(), &photon_spectra_.cl(), &sorter_.pairs().cl(),
                                       &sorter_.bucket_begin().cl(), &largest_radius_.cl()})
        gather_.setArg(argument++, *buffer);
    gather_.setArg(argument++, static_cast<cl_uint>(options_.photons_per_pass));
    for (const ::cl::Buffer* buffer :
         {&visible_surfaces_.cl(), &photon_surfaces_.cl(), &scene_->buffers().materials().cl(),
          &scene_->buffers().film_layers().cl(), &gathered_flux_.cl(), &non_finite_.cl()})
        gather_.setArg(argument++, *buffer);
    if (options_.error_estimate)
        gather_.setArg(argument, inner_flux_.cl());
    enqueue(Step::Gather, gather_, visible_points_.size(), device_.tuning.pixel_group);
}

void Renderer::check_loops() const {
    if (!device_.tuning.ends_loops())
        return;
    const std::uint32_t cut = non_finite_.read(device_)[2 * CUT_LOOPS];
    if (cut > 0)
        fail("device '{}' ended the loops of {} work-items before they were done, which would lose light: give a pass "
             "fewer photons (--photons), a smaller --initial-radius or --max-depth, or render on another device",
             device_.info.name, cut);
}

void Renderer::add_to_film() {
    film_add_.setArg(0, visible_points_.cl());
    film_add_.setArg(1, gathered_flux_.cl());
    film_add_.setArg(2, static_cast<float>(options_.alpha));
    film_add_.setArg(3, film_.cl());
    enqueue(Step::Film, film_add_, film_.size(), device_.tuning.pixel_group);
}

void Renderer::add_to_error_sums(std::uint32_t pass) {
    cl_uint argument = 0;
    for (const ::cl::Buffer* buffer : {&visible_points_.cl(), &gathered_flux_.cl(), &inner_flux_.cl()})
        error_add_.setArg(argument++, *buffer);
    error_add_.setArg(argument++, error_groups(pass));
    error_add_.setArg(argument++, static_cast<cl_uint>(visible_points_.size()));
    error_add_.setArg(argument++, error_sums_.cl());
    enqueue(Step::Film, error_add_, visible_points_.size(), device_.tuning.pixel_group);
}

void Renderer::enqueue(Step step, const ::cl::Kernel& kernel, std::size_t items, std::size_t group) {
    const std::size_t whole = items / group * group;
    const auto launch = [&](std::size_t offset, std::size_t count, std::size_t size) {
        ::cl::Event event;
        device_.before(DeviceCall::Launch);
        device_.queue.enqueueNDRangeKernel(kernel, ::cl::NDRange(offset), ::cl::NDRange(count), ::cl::NDRange(size),
                                           nullptr, &event);
        events_.emplace_back(step, event);
    };
    if (whole > 0)
        launch(0, whole, group);
    if (whole < items)
        launch(whole, items - whole, items - whole);
}

PhotonSorter::Enqueue Renderer::enqueue_grid() {
    return [this](const ::cl::Kernel& kernel, std::size_t items, std::size_t group) {
        enqueue(Step::Grid, kernel, items, group);
    };
}

void Renderer::collect_times() {
    device_.before(DeviceCall::Wait);
    device_.queue.finish();
    for (const auto& [step, event] : events_) {
        const auto begin = event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
        const auto end = event.getProfilingInfo<CL_PROFILING_COMMAND_END>();
        statistics_.step_seconds[static_cast<std::size_t>(step)] += 1e-9 * static_cast<double>(end - begin);
    }
    events_.clear();
}

void Renderer::restore(const std::vector<FilmPixel>& film, std::uint64_t passes, double seconds) {
    film_.write(device_, film);
    statistics_.passes = passes;
    statistics_.photons_emitted = passes * static_cast<std::uint64_t>(options_.photons_per_pass);
    statistics_.render_seconds = seconds;
}

RenderSums Renderer::sums() const {
    RenderSums sums;
    sums.film = film_.read(device_);
    sums.error = error_sums();
    for (const FilmPixel& pixel : sums.film) {
        sums.rays.camera += camera_rays(pixel);
        sums.rays.shadow += shadow_rays(pixel);
    }
    for (const std::uint64_t rays : item_rays_.read(device_))
        sums.rays.photon += rays;
    sums.photons_stored = statistics_.photons_stored;
    sums.non_finite = non_finite_counts(non_finite_.read(device_), sums.film);
    return sums;
}

FilmImage Renderer::film() const {
    return developed(sums(), options_);
}

std::vector<Photon> Renderer::photons() const {
    const std::vector<Photon> stored = photons_.read(device_);
    const std::vector<std::uint32_t> offsets = sorter_.item_offsets().read(device_);
    std::vector<Photon> photons;
    for (std::size_t item = 0; item < photon_items_; ++item) {
        const auto begin = stored.begin() + static_cast<std::ptrdiff_t>(item * capacity_per_item_);
        photons.insert(photons.end(), begin, begin + (offsets[item + 1] - offsets[item]));
    }
    return photons;
}

} // namespace tristim
