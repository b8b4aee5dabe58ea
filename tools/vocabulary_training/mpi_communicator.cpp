#include <algorithm>
#include <array>
#include <cstdlib>

#include "kinloop/core/errors.hpp"
#include "tools/vocabulary_training/communicator.hpp"

#ifdef KINLOOP_WITH_MPI

#include <exception>
#include <numeric>

#include <mpi.h>

#endif

namespace kinloop {
namespace {

/// Whether a launcher of several processes started this one: variables set by Open MPI, MPICH and Slurm.
bool started_as_one_of_many() {
  constexpr std::array kNames = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

}  // namespace

#ifdef KINLOOP_WITH_MPI

namespace {

/// By default MPI ends all processes with a message on an error, so return values need no check.
class MpiCommunicator : public Communicator {
 public:
  MpiCommunicator() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiCommunicator() override {
    if (std::uncaught_exceptions() == 0) MPI_Finalize();
  }
  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  void sum(std::span<uint64_t> numbers) const override {
    for (size_t begin = 0; begin < numbers.size(); begin += kMaxAtOnce) {
      const size_t count = std::min(kMaxAtOnce, numbers.size() - begin);
      MPI_Allreduce(MPI_IN_PLACE, numbers.data() + begin, static_cast<int>(count), MPI_UINT64_T, MPI_SUM,
                    MPI_COMM_WORLD);
    }
  }

  /// In chunks, since MPI counts in int.
  [[nodiscard]] std::vector<Message> exchange(std::vector<Message> outgoing) const override {
    const auto process_count = static_cast<size_t>(size_);
    const size_t piece = kMaxAtOnce / process_count;
    std::vector<uint64_t> sending(process_count), receiving(process_count);
    std::transform(outgoing.begin(), outgoing.end(), sending.begin(),
                   [](const Message& m) { return m.size(); });
    MPI_Alltoall(sending.data(), 1, MPI_UINT64_T, receiving.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
    uint64_t longest = *std::max_element(sending.begin(), sending.end());
    MPI_Allreduce(MPI_IN_PLACE, &longest, 1, MPI_UINT64_T, MPI_MAX, MPI_COMM_WORLD);

    std::vector<Message> incoming(process_count);
    for (uint64_t begin = 0; begin < longest; begin += piece) {
      const Layout out(sending, begin, piece), in(receiving, begin, piece);
      Message sent(out.total()), received(in.total());
      for (size_t r = 0; r < process_count; ++r) {
        if (out.counts[r] == 0) continue;
        const auto from = outgoing[r].begin() + static_cast<ptrdiff_t>(begin);
        std::copy_n(from, out.counts[r], sent.begin() + out.begins[r]);
      }
      MPI_Alltoallv(sent.data(), out.counts.data(), out.begins.data(), MPI_BYTE, received.data(),
                    in.counts.data(), in.begins.data(), MPI_BYTE, MPI_COMM_WORLD);
      for (size_t r = 0; r < process_count; ++r) {
        const auto from = received.begin() + in.begins[r];
        incoming[r].insert(incoming[r].end(), from, from + in.counts[r]);
      }
    }
    return incoming;
  }

 private:
  static constexpr size_t kMaxAtOnce = size_t{1} << 30;

  /// Layout of the chunks [begin, begin + piece) of messages in one buffer.
  struct Layout {
    Layout(const std::vector<uint64_t>& sizes, uint64_t begin, uint64_t piece)
        : counts(sizes.size()), begins(sizes.size()) {
      std::transform(sizes.begin(), sizes.end(), counts.begin(), [&](uint64_t size) {
        return static_cast<int>(std::min(piece, size - std::min(size, begin)));
      });
      std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
    }
    [[nodiscard]] size_t total() const {
      return static_cast<size_t>(begins.back()) + static_cast<size_t>(counts.back());
    }

    std::vector<int> counts, begins;
  };

  int rank_ = 0;
  int size_ = 1;
};

}  // namespace

bool mpi_available() {
  return true;
}

std::unique_ptr<Communicator> join_mpi() {
  if (!started_as_one_of_many()) return std::make_unique<Communicator>();
  return std::make_unique<MpiCommunicator>();
}

#else

bool mpi_available() {
  return false;
}

std::unique_ptr<Communicator> join_mpi() {
  if (started_as_one_of_many()) {
    throw UsageError(
        "this kinloop was built without MPI and cannot share its work with other processes; install "
        "libopenmpi-dev and rebuild, or start it without mpirun");
  }
  return std::make_unique<Communicator>();
}

#endif

}  // namespace kinloop
