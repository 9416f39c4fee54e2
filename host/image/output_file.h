#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tristim {

/// Throws Error if a file cannot be written at `path`: its folder is missing or takes no new file, or something other
/// than a writable file stands there. Meant for the start of a long computation; what is there stays as it is.
void check_output_file(const std::string& path);

/// Whether both lead to one file, be it there already or not.
bool is_same_file(const std::string& a, const std::string& b);

/// Makes a folder and those above it, if they are missing. Throws Error.
void make_folder(const std::string& path);

/// Replaces the file as a whole, or leaves what was there: writes a temporary file in the same folder, flushes it to
/// the disk and renames it; and flushes the folder, as far as its file system can. A symbolic link stays and its target
/// is replaced. Throws Error, with the temporary file removed.
void replace_file(const std::string& path, std::span<const unsigned char> bytes);

/// Removes what a process that was killed while it replaced the file may have left beside it, but not what another one
/// is writing.
void remove_leftovers(const std::string& path);

/// The same as the first, with text.
void replace_file(const std::string& path, std::string_view text);

} // namespace tristim
