#include "base/error.h"
#include "mpi/communicator.h"
#include "mpi/launcher.h"
#include "render/film.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdlib>
#include <list>
#include <thread>

namespace tristim {
namespace {

constexpr int root = 0;

/// What is reduced at a time: MPI keeps a few copies of so much, and not of the whole film.
constexpr std::size_t bytes_at_once = std::size_t{24} << 20U;

/// Waits until an operation is done, without the spinning of MPI_Wait: others render meanwhile.
void wait(MPI_Request& request) {
    int done = 0;
    for (;;) {
        MPI_Test(&request, &done, MPI_STATUS_IGNORE);
        if (done != 0)
            return;
        std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
}

void add_pixels(void* more, void* film, int* count, MPI_Datatype*) {
    const auto pixels = static_cast<std::size_t>(*count);
    add_film({static_cast<FilmPixel*>(film), pixels}, {static_cast<const FilmPixel*>(more), pixels});
}

class MpiCommunicator final : public Communicator {
  public:
    MpiCommunicator() {
        // Waiting in MPI_Reduce spins, while devices need the cores. Two ranks on two busy cores add up 199 MB in 0.23
        // s if it lets others run in between, else in 0.4 to 4.4 s.
        ::setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
        // Messages of ours must not meet those of others, so we have a communicator of our own.
        MPI_Comm_dup(MPI_COMM_WORLD, &all_);
        MPI_Comm_rank(all_, &rank_);
        MPI_Comm_size(all_, &size_);
        MPI_Comm local = MPI_COMM_NULL;
        MPI_Comm_split_type(all_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &local);
        MPI_Comm_rank(local, &local_rank_);
        MPI_Comm_size(local, &local_size_);
        MPI_Comm_free(&local);
        MPI_Type_contiguous(sizeof(FilmPixel), MPI_BYTE, &pixel_);
        MPI_Type_commit(&pixel_);
        MPI_Op_create(add_pixels, 1, &add_pixels_);
        if (provided < MPI_THREAD_FUNNELED)
            fail("this MPI allows no threads beside the one that calls it");
    }
    MpiCommunicator(const MpiCommunicator&) = delete;
    MpiCommunicator& operator=(const MpiCommunicator&) = delete;
    ~MpiCommunicator() override {
        for (Sending& sending : sending_)
            wait(sending.request);
        MPI_Op_free(&add_pixels_);
        MPI_Type_free(&pixel_);
        MPI_Comm_free(&all_);
        MPI_Finalize();
    }

    int rank() const override { return rank_; }
    int size() const override { return size_; }
    int local_rank() const override { return local_rank_; }
    int local_size() const override { return local_size_; }

    void send(int to, const Words& words) override {
        forget_sent();
        Sending& sending = sending_.emplace_back();
        sending.words = words;
        MPI_Isend(sending.words.data(), static_cast<int>(words.size()), MPI_UINT64_T, to, 0, all_, &sending.request);
    }

    std::optional<Message> receive() override {
        forget_sent();
        int found = 0;
        MPI_Message message = MPI_MESSAGE_NULL;
        MPI_Status status{};
        MPI_Improbe(MPI_ANY_SOURCE, 0, all_, &found, &message, &status);
        if (found == 0)
            return {};
        int count = 0;
        MPI_Get_count(&status, MPI_UINT64_T, &count);
        Message received{status.MPI_SOURCE, Words(static_cast<std::size_t>(count))};
        MPI_Mrecv(received.words.data(), count, MPI_UINT64_T, &message, MPI_STATUS_IGNORE);
        return received;
    }

    std::string broadcast(const std::string& text) override {
        std::uint64_t bytes = text.size();
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ibcast(&bytes, 1, MPI_UINT64_T, root, all_, &request);
        wait(request);
        std::string received = rank_ == root ? text : std::string(bytes, '\0');
        for (std::size_t begin = 0; begin < bytes; begin += INT_MAX) {
            const auto count = static_cast<int>(std::min<std::size_t>(bytes - begin, INT_MAX));
            MPI_Ibcast(received.data() + begin, count, MPI_CHAR, root, all_, &request);
            wait(request);
        }
        return received;
    }

    std::vector<std::string> gather(const std::string& text) override {
        const bool here = rank_ == root;
        const auto ranks = here ? static_cast<std::size_t>(size_) : 0;
        const auto bytes = static_cast<int>(text.size());
        std::vector<int> counts(ranks), starts(ranks);
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Igather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, root, all_, &request);
        wait(request);
        int total = 0;
        for (std::size_t i = 0; i < ranks; ++i) {
            starts[i] = total;
            total += counts[i];
        }
        std::string texts(static_cast<std::size_t>(total), '\0');
        MPI_Igatherv(text.data(), bytes, MPI_CHAR, texts.data(), counts.data(), starts.data(), MPI_CHAR, root, all_,
                     &request);
        wait(request);
        std::vector<std::string> result;
        for (std::size_t i = 0; i < ranks; ++i)
            result.push_back(texts.substr(static_cast<std::size_t>(starts[i]), static_cast<std::size_t>(counts[i])));
        return result;
    }

    void reduce(std::vector<FilmPixel>& film) override { reduce(film, pixel_, add_pixels_); }
    void reduce(std::vector<float>& sums) override { reduce(sums, MPI_FLOAT, MPI_SUM); }

    [[noreturn]] void abort(int exit_code) override {
        MPI_Abort(all_, exit_code);
        std::_Exit(exit_code);
    }

  private:
    struct Sending {
        Words words;
        MPI_Request request = MPI_REQUEST_NULL;
    };

    template <typename Item>
    void reduce(std::vector<Item>& items, MPI_Datatype type, MPI_Op add) {
        constexpr std::size_t items_at_once = bytes_at_once / sizeof(Item);
        for (std::size_t begin = 0; begin < items.size(); begin += items_at_once) {
            const auto count = static_cast<int>(std::min(items.size() - begin, items_at_once));
            Item* const some = items.data() + begin;
            MPI_Reduce(rank_ == root ? MPI_IN_PLACE : some, some, count, type, add, root, all_);
        }
    }

    void forget_sent() {
        sending_.remove_if([](Sending& sending) {
            int done = 0;
            MPI_Test(&sending.request, &done, MPI_STATUS_IGNORE);
            return done != 0;
        });
    }

    MPI_Comm all_ = MPI_COMM_NULL;
    MPI_Datatype pixel_ = MPI_DATATYPE_NULL;
    MPI_Op add_pixels_ = MPI_OP_NULL;
    int rank_ = 0, size_ = 1, local_rank_ = 0, local_size_ = 1;
    std::list<Sending> sending_;
};

/// Not left by itself at the end of the process: one that has failed must not wait for the others.
MpiCommunicator* joined = nullptr;

} // namespace

bool built_with_mpi() {
    return true;
}

Communicator* join_ranks() {
    const std::optional<Launcher> launcher = find_launcher();
    if (!launcher || launcher->size == 1)
        return nullptr;
    if (joined == nullptr)
        joined = new MpiCommunicator;
    if (launcher->size > 1 && joined->size() != launcher->size)
        fail("{} started {} ranks, but Open MPI finds {}: start tristim with Open MPI's mpirun, or srun --mpi=pmix",
             launcher->name, launcher->size, joined->size());
    return joined->size() > 1 ? joined : nullptr;
}

Communicator* joined_ranks() {
    return joined;
}

void leave_ranks() {
    delete joined;
    joined = nullptr;
}

} // namespace tristim
