#pragma once

#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tristim {

/// FNV-1a with 64 bits (Fowler, Noll & Vo; RFC 9923).
class Hash {
  public:
    template <typename T>
    void add(const T& value) {
        // The structs of kernels/shared_types.h have four-byte members alone, so none of these bytes is padding.
        static_assert(std::is_arithmetic_v<T> || alignof(T) == 4);
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(reinterpret_cast<const unsigned char*>(&value), sizeof(T));
    }

    template <typename T>
    void add(const std::vector<T>& values) {
        add(static_cast<std::uint64_t>(values.size()));
        for (const T& value : values)
            add(value);
    }

    void add(std::string_view text) {
        add(static_cast<std::uint64_t>(text.size()));
        add_bytes(reinterpret_cast<const unsigned char*>(text.data()), text.size());
    }

    std::string hexadecimal() const { return fmt::format("{:016x}", state_); }

  private:
    void add_bytes(const unsigned char* bytes, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i)
            state_ = (state_ ^ bytes[i]) * 0x100000001b3U;
    }

    std::uint64_t state_ = 0xcbf29ce484222325U;
};

} // namespace tristim
