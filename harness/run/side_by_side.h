// Runs tasks side by side on this machine, as many at once as its cores and memory allow.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace hausbench {

// The resources that a task needs.
struct Demand {
    double seconds = 0;      // an estimate, only for the order: the longest task starts first
    int cores = 1;           // a task that asks for more cores than there are gets all of them
    std::int64_t bytes = 0;  // a task that asks for more memory than there is waits until all of it is free
};

// Keeps track of the free cores and memory. A class of its own, so that it can be tested without threads.
class Capacity {
public:
    Capacity(std::vector<int> cores, std::int64_t bytes);

    std::size_t cores() const { return all_cores_; }
    bool fits(const Demand& demand) const;
    std::vector<int> take(const Demand& demand);  // returns the cores to run on; call fits() first
    void give_back(const Demand& demand, const std::vector<int>& cores);

private:
    std::size_t cores_of(const Demand& demand) const;
    std::int64_t bytes_of(const Demand& demand) const;

    std::size_t all_cores_;
    std::int64_t all_bytes_, free_bytes_;
    std::vector<int> free_;
};

// Returns the kernel's numbers of `count` cores that this process may run on, and claims these cores until the process
// ends. Takes cores that another run has claimed only if there are too few others. Throws InputError if this process
// may run on fewer than `count` cores.
std::vector<int> cores_here(int count);

// Runs one task for each demand, on several threads: calls `work` with the index of the demand and the cores to run on.
// The longest task that fits into the free resources starts first. Returns when all tasks have ended. Once `stop`
// returns true or `work` throws, no further task starts; the first exception is rethrown after all running tasks have
// ended.
void run_side_by_side(const std::vector<Demand>& demands, Capacity capacity,
                      const std::function<void(std::size_t, const std::vector<int>&)>& work,
                      const std::function<bool()>& stop);

}  // namespace hausbench
