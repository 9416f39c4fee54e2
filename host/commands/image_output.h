#pragma once

#include "image/image.h"
#include "image/write_image.h"
#include "render/error_estimate.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace tristim {

/// The options that say where an image goes and how.
struct ImageOutput {
    std::vector<std::string> outfiles;
    std::string space = "srgb";
    std::string tone_mapping = "photographic";
    double exposure = 0.0;
    std::vector<std::string> aov; ///< more channels of EXR files: error, bias, count
};

/// Registers --outfile (with its help), --space, --tonemap, --exposure and --aov.
void add_image_output(CLI::App& command, ImageOutput& output, const std::string& outfile_help);

/// Throws Error for values that make no sense and for files that cannot be written, or that are checkpoints or
/// `checkpoint`, the path where one will be or ""; changes nothing.
void check(const ImageOutput& output, const std::string& checkpoint);

/// Writes all files; EXR files with the channels that were asked for, and with the estimate in the header. Throws Error
/// if some cannot be written, after those that can.
void write(const ImageOutput& output, const XyzImage& image, const ImageMetadata& metadata,
           const ErrorEstimate& estimate, const std::vector<FilmPixel>& film);

/// Whether error or bias is among the channels that EXR files are to have.
bool wants_error_estimate(const ImageOutput& output);

} // namespace tristim
