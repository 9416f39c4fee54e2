#pragma once

#include "mpi/communicator.h"
#include "render/film.h"

#include <barrier>
#include <cstdlib>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace tristim::test {

/// Ranks that are threads of this process.
class ThreadRanks {
  public:
    explicit ThreadRanks(int size) : size_(size), inboxes_(static_cast<std::size_t>(size)), barrier_(size) {}

    /// Runs each rank in a thread of its own. Throws what the first of them that failed has thrown.
    void run(const std::function<void(Communicator&)>& body) {
        std::vector<std::thread> threads;
        std::vector<std::exception_ptr> failures(inboxes_.size());
        for (int r = 0; r < size_; ++r) {
            threads.emplace_back([&, r] {
                Rank rank(*this, r);
                try {
                    body(rank);
                } catch (...) {
                    failures[static_cast<std::size_t>(r)] = std::current_exception();
                    barrier_.arrive_and_drop();
                }
            });
        }
        for (std::thread& thread : threads)
            thread.join();
        for (const std::exception_ptr& failure : failures) {
            if (failure)
                std::rethrow_exception(failure);
        }
    }

  private:
    class Rank final : public Communicator {
      public:
        Rank(ThreadRanks& all, int rank) : all_(all), rank_(rank) {}
        int rank() const override { return rank_; }
        int size() const override { return all_.size_; }
        int local_rank() const override { return rank_; }
        int local_size() const override { return all_.size_; }

        void send(int to, const Words& words) override {
            const std::lock_guard lock(all_.mutex_);
            all_.inboxes_[static_cast<std::size_t>(to)].push_back({rank_, words});
        }

        std::optional<Message> receive() override {
            const std::lock_guard lock(all_.mutex_);
            auto& inbox = all_.inboxes_[static_cast<std::size_t>(rank_)];
            if (inbox.empty())
                return {};
            const Message first = inbox.front();
            inbox.pop_front();
            return first;
        }

        std::string broadcast(const std::string& text) override {
            if (rank_ == 0)
                all_.text_ = text;
            all_.barrier_.arrive_and_wait();
            const std::string result = all_.text_;
            all_.barrier_.arrive_and_wait();
            return result;
        }

        std::vector<std::string> gather(const std::string& text) override {
            in_turn([&] { all_.texts_.push_back(text); });
            std::vector<std::string> result;
            if (rank_ == 0)
                result.swap(all_.texts_);
            all_.barrier_.arrive_and_wait();
            return result;
        }

        void reduce(std::vector<FilmPixel>& film) override {
            in_turn([&] {
                if (rank_ == 0)
                    all_.film_ = film;
                else
                    add_film(all_.film_, film);
            });
            if (rank_ == 0)
                film.swap(all_.film_);
            all_.barrier_.arrive_and_wait();
        }

        void reduce(std::vector<float>& sums) override {
            in_turn([&] {
                all_.sums_.resize(sums.size());
                for (std::size_t i = 0; i < sums.size(); ++i)
                    all_.sums_[i] += sums[i];
            });
            if (rank_ == 0)
                sums.swap(all_.sums_);
            all_.barrier_.arrive_and_wait();
            if (rank_ == 0)
                all_.sums_.clear();
            all_.barrier_.arrive_and_wait();
        }

        [[noreturn]] void abort(int exit_code) override { std::_Exit(exit_code); }

      private:
        void in_turn(const std::function<void()>& step) {
            for (int turn = 0; turn < all_.size_; ++turn) {
                if (turn == rank_)
                    step();
                all_.barrier_.arrive_and_wait();
            }
        }

        ThreadRanks& all_;
        int rank_;
    };

    int size_;
    std::mutex mutex_;
    std::vector<std::deque<Message>> inboxes_;
    std::barrier<> barrier_;
    std::string text_;
    std::vector<std::string> texts_;
    std::vector<FilmPixel> film_;
    std::vector<float> sums_;
};

} // namespace tristim::test
