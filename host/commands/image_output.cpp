#include "commands/image_output.h"

#include "base/error.h"
#include "render/checkpoint.h"

#include <cmath>
#include <filesystem>
#include <strings.h>

namespace tristim {
namespace {

bool is_exr(const std::string& path) {
    return ::strcasecmp(std::filesystem::path(path).extension().c_str(), ".exr") == 0;
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
}

void check(const ImageOutput& output, const std::string& checkpoint) {
    if (!std::isfinite(output.exposure))
        fail("--exposure must be a finite number of stops");
    for (const std::string& path : output.outfiles) {
        check_writable(path);
        if (path == checkpoint || is_checkpoint(path))
            fail("cannot write an image to \"{}\": a checkpoint is there, or will be", path);
    }
}

void write(const ImageOutput& output, const XyzImage& image, const ImageMetadata& metadata) {
    const ColourSpace space = output.space == "xyz" ? ColourSpace::CieXyz : ColourSpace::Srgb;
    const ToneMapping tone_mapping{
        output.tone_mapping == "linear" ? ToneMapping::Kind::Linear : ToneMapping::Kind::Photographic, output.exposure};
    for (const std::string& path : output.outfiles) {
        if (is_exr(path))
            write_exr(path, image, space, metadata);
        else
            write_png(path, image, tone_mapping);
    }
}

} // namespace tristim
