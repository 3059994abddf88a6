#include "harness/run/side_by_side.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <numeric>
#include <set>
#include <string>
#include <system_error>
#include <thread>

namespace hausbench {

Capacity::Capacity(std::vector<int> cores, std::int64_t bytes)
    : all_cores_(cores.size()), all_bytes_(bytes), free_bytes_(bytes), free_(std::move(cores)) {}

std::size_t Capacity::cores_of(const Demand& demand) const {
    return std::clamp<std::size_t>(std::size_t(std::max(1, demand.cores)), 1, all_cores_);
}

std::int64_t Capacity::bytes_of(const Demand& demand) const { return std::min(demand.bytes, all_bytes_); }

bool Capacity::fits(const Demand& demand) const {
    return cores_of(demand) <= free_.size() && bytes_of(demand) <= free_bytes_;
}

std::vector<int> Capacity::take(const Demand& demand) {
    const auto end = free_.begin() + std::ptrdiff_t(cores_of(demand));
    std::vector<int> taken(free_.begin(), end);
    free_.erase(free_.begin(), end);
    free_bytes_ -= bytes_of(demand);
    return taken;
}

void Capacity::give_back(const Demand& demand, const std::vector<int>& cores) {
    free_.insert(free_.end(), cores.begin(), cores.end());
    free_bytes_ += bytes_of(demand);
}

namespace {

// Claims a core until this process ends. Returns false if another process has claimed it. The claim is a socket name in
// the abstract namespace: only one process can hold it, and the kernel frees it however that process ends.
bool claim(int core) {
    static std::set<int> mine;
    if (mine.contains(core)) return true;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string name = fmt::format("hausbench-core-{}", core);
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1);  // abstract names begin with NUL
    const int claim = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const auto length = socklen_t(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (claim >= 0 && ::bind(claim, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
        mine.insert(core);
        return true;  // the socket stays open, which keeps the claim
    }
    if (claim >= 0) ::close(claim);
    return false;
}

}  // namespace

std::vector<int> cores_here(int count) {
    cpu_set_t set;
    CPU_ZERO(&set);
    std::vector<int> all;
    if (::sched_getaffinity(0, sizeof set, &set) == 0) {
        for (int core = 0; core < CPU_SETSIZE; ++core) {
            if (CPU_ISSET(core, &set)) all.push_back(core);
        }
    }
    if (all.size() < std::size_t(count))
        throw InputError(
            fmt::format("--jobs {}: this process may run on {} cores: ask for no more", count, all.size()));
    std::vector<int> cores, taken;
    for (const int core : all) {
        if (cores.size() == std::size_t(count)) break;
        (claim(core) ? cores : taken).push_back(core);
    }
    cores.insert(cores.end(), taken.begin(), taken.begin() + (count - std::ptrdiff_t(cores.size())));
    return cores;
}

namespace {

// The waiting tasks, and the resources that running tasks share. Each thread calls lane(), which runs one task after
// another.
class Lanes {
public:
    Lanes(const std::vector<Demand>& demands, Capacity capacity,
          const std::function<void(std::size_t, const std::vector<int>&)>& work, const std::function<bool()>& stop)
        : demands_(demands), capacity_(std::move(capacity)), work_(work), stop_(stop), waiting_(demands.size()) {
        std::iota(waiting_.begin(), waiting_.end(), 0);
        std::stable_sort(waiting_.begin(), waiting_.end(),
                         [&](std::size_t a, std::size_t b) { return demands_[a].seconds > demands_[b].seconds; });
    }

    void lane() {
        std::unique_lock lock(lock_);
        for (;;) {
            const auto next = std::find_if(waiting_.begin(), waiting_.end(),
                                           [&](std::size_t i) { return capacity_.fits(demands_[i]); });
            if (waiting_.empty() || failure_ || stop_()) return;
            if (next == waiting_.end()) {
                room_made_.wait(lock);  // some task is running, because each task fits if all resources are free
                continue;
            }
            const std::size_t number = *next;
            waiting_.erase(next);
            const std::vector<int> cores = capacity_.take(demands_[number]);
            lock.unlock();
            std::exception_ptr failure;
            try {
                work_(number, cores);
            } catch (...) {
                failure = std::current_exception();
            }
            lock.lock();
            if (!failure_) failure_ = failure;
            capacity_.give_back(demands_[number], cores);
            room_made_.notify_all();
        }
    }

    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    const std::vector<Demand>& demands_;
    Capacity capacity_;
    const std::function<void(std::size_t, const std::vector<int>&)>& work_;
    const std::function<bool()>& stop_;
    std::mutex lock_;
    std::condition_variable room_made_;
    std::vector<std::size_t> waiting_;  // longest first
    std::exception_ptr failure_;
};

}  // namespace

void run_side_by_side(const std::vector<Demand>& demands, Capacity capacity,
                      const std::function<void(std::size_t, const std::vector<int>&)>& work,
                      const std::function<bool()>& stop) {
    const std::size_t most = std::min(demands.size(), capacity.cores());
    Lanes lanes(demands, std::move(capacity), work, stop);
    {
        std::vector<std::jthread> threads;
        try {
            for (std::size_t i = 0; i < most; ++i) threads.emplace_back([&] { lanes.lane(); });
        } catch (const std::system_error&) {  // too many threads: the existing ones run all tasks
            if (threads.empty()) lanes.lane();
        }
    }
    lanes.rethrow();
}

}  // namespace hausbench
