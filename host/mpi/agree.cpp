#include "mpi/agree.h"

#include "base/error.h"
#include "base/parse_number.h"
#include "opencl/errors.h"
#include "render/identity.h"

#include <fmt/ranges.h>
#include <map>
#include <nlohmann/json.hpp>

namespace tristim {
namespace {

/// "rank 3: …; ranks 1, 2: …", each reason once.
std::string describe(const std::vector<std::string>& failures) {
    std::map<std::string, std::vector<std::size_t>> ranks_of;
    for (std::size_t rank = 0; rank < failures.size(); ++rank) {
        if (!failures[rank].empty())
            ranks_of[failures[rank]].push_back(rank);
    }
    std::vector<std::string> parts;
    for (const auto& [reason, ranks] : ranks_of) {
        if (ranks.size() == failures.size())
            return reason;
        parts.push_back(fmt::format("rank{} {}: {}", ranks.size() > 1 ? "s" : "", fmt::join(ranks, ", "), reason));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

} // namespace

void at_all_ranks(Communicator* ranks, const std::function<void()>& step) {
    if (ranks == nullptr)
        return step();
    std::string failure;
    try {
        step();
    } catch (const std::exception&) {
        failure = describe_current_exception();
    }
    const int rank = ranks->rank();
    const std::string all = ranks->broadcast(describe(ranks->gather(failure)));
    if (all.empty())
        return;
    leave_ranks();
    if (rank == 0)
        fail("{}", all);
    throw EndedElsewhere{1};
}

void check_same_image(Communicator& ranks, const Scene& scene, const RenderOptions& options) {
    std::string own;
    at_all_ranks(&ranks, [&] { own = nlohmann::json(render_identity(scene, options)).dump(); });
    const std::vector<std::string> all = ranks.gather(own);
    at_first_rank(&ranks, [&] {
        const RenderIdentity first = nlohmann::json::parse(all.front());
        for (std::size_t rank = 1; rank < all.size(); ++rank) {
            const RenderIdentity other = nlohmann::json::parse(all[rank]);
            std::vector<std::string> differ;
            for (const auto& [name, value] : first) {
                if (value_of(other, name) != value)
                    differ.push_back(name);
            }
            if (!differ.empty())
                fail("rank {} would render another image than rank 0: {} differ", rank, fmt::join(differ, ", "));
        }
        return 0;
    });
}

int at_first_rank(Communicator* ranks, const std::function<int()>& step) {
    if (ranks == nullptr)
        return step();
    int code = 1;
    std::exception_ptr failure;
    if (ranks->rank() == 0) {
        try {
            code = step();
        } catch (const std::exception&) {
            failure = std::current_exception();
        }
    }
    const std::string told = ranks->broadcast(failure ? "" : std::to_string(code));
    if (!told.empty())
        return *parse_number<int>(told);
    leave_ranks();
    if (failure)
        std::rethrow_exception(failure);
    throw EndedElsewhere{code};
}

} // namespace tristim
