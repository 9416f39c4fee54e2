#include "base/tell.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <poll.h>
#include <unistd.h>

namespace tristim {
namespace {

constexpr int longest_wait = 1000; ///< ms

/// Whether PIPE_BUF bytes can be written, or fail at once.
bool is_ready() {
    ::pollfd descriptor{STDERR_FILENO, POLLOUT, 0};
    return ::poll(&descriptor, 1, longest_wait) > 0;
}

} // namespace

void tell_text(std::string_view text) {
    while (!text.empty() && is_ready()) {
        const ::ssize_t count = ::write(STDERR_FILENO, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
        if (count < 0 && errno != EINTR)
            return;
        if (count > 0)
            text.remove_prefix(static_cast<std::size_t>(count));
    }
}

} // namespace tristim
