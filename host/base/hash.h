#pragma once

#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tristim {

/// FNV-1a with 64 bits (Fowler, Noll & Vo; RFC 9923). Each step is one-to-one, so that one changed byte always changes
/// it.
class Hash {
  public:
    /// The bytes alone; the others put sizes in front of what has a size.
    void add_bytes(std::string_view bytes) {
        for (const char byte : bytes)
            state_ = (state_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
    }

    template <typename T>
    void add(const T& value) {
        // The structs of kernels/shared_types.h have four-byte members alone, so none of these bytes is padding.
        static_assert(std::is_arithmetic_v<T> || alignof(T) == 4);
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes({reinterpret_cast<const char*>(&value), sizeof(T)});
    }

    template <typename T>
    void add(const std::vector<T>& values) {
        add(static_cast<std::uint64_t>(values.size()));
        for (const T& value : values)
            add(value);
    }

    void add(std::string_view text) {
        add(static_cast<std::uint64_t>(text.size()));
        add_bytes(text);
    }

    std::uint64_t value() const { return state_; }
    std::string hexadecimal() const { return fmt::format("{:016x}", state_); }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325U;
};

} // namespace tristim
