// Runs pieces of work side by side on this machine, as many at once as its cores and memory allow.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace hausbench {

// The resources that a piece of work needs.
struct Demand {
    double seconds = 0;      // only for the order: the longest piece begins first
    int cores = 1;           // a piece that wants more than there are gets all of them
    std::int64_t bytes = 0;  // a piece that wants more than there is runs alone
};

// The free cores and memory; a class of its own so that it can be tested without threads.
class Room {
public:
    Room(std::vector<int> cores, std::int64_t bytes);

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

// Returns `count` cores that this process may run on, by the kernel's numbers. Prefers cores that no other run on
// this machine has claimed, and claims them until this process ends; takes cores of other runs only if there are too
// few. Throws InputError if this process may run on fewer.
std::vector<int> cores_here(int count);

// Calls `work` with the index of each demand and its cores, on threads of its own, until all are done. The longest
// piece that fits starts first. No further piece starts once `stop` returns true or `work` throws; the first
// exception is rethrown after all running pieces have ended.
void run_side_by_side(const std::vector<Demand>& demands, Room room,
                      const std::function<void(std::size_t, const std::vector<int>&)>& work,
                      const std::function<bool()>& stop);

}  // namespace hausbench
