#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tristim::fuzz {

/// One change of a text as a person might make it: a line doubled, moved or taken out, a number replaced by an extreme
/// one, or a word by another word of the text. Equal seeds make equal changes.
std::string mutate_lines(const std::string& text, unsigned seed);

/// A libFuzzer custom mutator: mutate_lines() for half of the seeds, libFuzzer's own changes of bytes for the others.
std::size_t mutate_text(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed);

} // namespace tristim::fuzz
