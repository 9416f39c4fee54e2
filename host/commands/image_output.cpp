#include "commands/image_output.h"

#include "base/error.h"
#include "image/output_file.h"
#include "render/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/ranges.h>
#include <strings.h>

namespace tristim {
namespace {

bool is_exr(const std::string& path) {
    return ::strcasecmp(std::filesystem::path(path).extension().c_str(), ".exr") == 0;
}

bool wants(const ImageOutput& output, const std::string& aov) {
    return std::find(output.aov.begin(), output.aov.end(), aov) != output.aov.end();
}

ImageMetadata with_estimate(ImageMetadata metadata, const ErrorEstimate& estimate) {
    if (estimate.complete) {
        metadata.emplace_back("estimated_rmse", estimate.rmse);
        metadata.emplace_back("estimated_noise", estimate.noise);
        metadata.emplace_back("estimated_bias", estimate.bias);
    } else {
        metadata.emplace_back("noise_at_most", estimate.noise);
    }
    return metadata;
}

} // namespace

void add_image_output(CLI::App& command, ImageOutput& output, const std::string& outfile_help) {
    command.add_option("--outfile", output.outfiles, outfile_help)
        ->type_name("FILE.exr|FILE.png")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command.add_option("--space", output.space, "Channels of EXR files: linear sRGB (R, G, B) or xyz (X, Y, Z)")
        ->check(CLI::IsMember({"srgb", "xyz"}))
        ->capture_default_str();
    command.add_option("--tonemap", output.tone_mapping, "Tone mapping of PNG files")
        ->check(CLI::IsMember({"photographic", "linear"}))
        ->capture_default_str();
    command.add_option("--exposure", output.exposure, "Exposure of PNG files in stops")->capture_default_str();
    command
        .add_option(
            "--aov", output.aov,
            "More channels of EXR files, in XYZ: error.X to error.Z (standard error of the mean of the passes), "
            "bias.X to bias.Z (by the search radius), count (passes in the pixel)")
        ->type_name("error,bias,count")
        ->delimiter(',')
        ->check(CLI::IsMember({"error", "bias", "count"}));
}

void check(const ImageOutput& output, const std::string& checkpoint) {
    if (!std::isfinite(output.exposure))
        fail("--exposure must be a finite number of stops");
    for (const std::string& path : output.outfiles) {
        check_writable(path);
        if (is_same_file(path, checkpoint) || is_checkpoint(path))
            fail("cannot write an image to \"{}\": a checkpoint is there, or will be", path);
    }
    if (!output.aov.empty() && std::none_of(output.outfiles.begin(), output.outfiles.end(), is_exr))
        fail("--aov adds channels to EXR files: give an --outfile that ends in .exr");
}

bool wants_error_estimate(const ImageOutput& output) {
    return wants(output, "error") || wants(output, "bias");
}

void write(const ImageOutput& output, const XyzImage& image, const ImageMetadata& metadata,
           const ErrorEstimate& estimate, const std::vector<FilmPixel>& film) {
    ImageLayers layers;
    ImagePlanes planes;
    if (wants(output, "error"))
        layers.emplace_back("error", estimate.pixel_noise);
    if (wants(output, "bias"))
        layers.emplace_back("bias", estimate.pixel_bias);
    if (wants(output, "count")) {
        planes.emplace_back("count", std::vector<float>());
        for (const FilmPixel& pixel : film)
            planes.back().second.push_back(static_cast<float>(pixel.samples));
    }
    const ColourSpace space = output.space == "xyz" ? ColourSpace::CieXyz : ColourSpace::Srgb;
    const ToneMapping tone_mapping{
        output.tone_mapping == "linear" ? ToneMapping::Kind::Linear : ToneMapping::Kind::Photographic, output.exposure};
    std::vector<std::string> failures;
    for (const std::string& path : output.outfiles) {
        try {
            if (is_exr(path))
                write_exr(path, image, space, with_estimate(metadata, estimate), layers, planes);
            else
                write_png(path, image, tone_mapping);
        } catch (const Error& failure) {
            failures.emplace_back(failure.what());
        }
    }
    if (!failures.empty())
        fail("{}", fmt::join(failures, "; "));
}

} // namespace tristim
