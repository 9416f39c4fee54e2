#pragma once

#include "image/image.h"
#include "image/write_image.h"

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
};

/// Registers --outfile (with its help), --space, --tonemap and --exposure.
void add_image_output(CLI::App& command, ImageOutput& output, const std::string& outfile_help);

/// Throws Error for values that make no sense and for files that cannot be written, or that are checkpoints or
/// `checkpoint`, the path where one will be or ""; changes nothing.
void check(const ImageOutput& output, const std::string& checkpoint);

/// Writes all files. Throws Error.
void write(const ImageOutput& output, const XyzImage& image, const ImageMetadata& metadata);

} // namespace tristim
