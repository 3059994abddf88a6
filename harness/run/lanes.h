// Runs work side by side on this machine: as much at a time as its cores and its memory carry.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace hausbench {

// What a piece of work takes.
struct Demand {
    double seconds = 0;      // only for the order: what takes longest begins first
    int cores = 1;           // a piece that wants more than there are gets all
    std::int64_t bytes = 0;  // likewise: it then runs alone
};

// What is free; for a test, apart from threads.
class Room {
public:
    Room(std::vector<int> cores, std::int64_t bytes);

    std::size_t cores() const { return all_cores_; }
    bool fits(const Demand& demand) const;
    std::vector<int> take(const Demand& demand);  // the cores that are its own; call fits() first
    void give_back(const Demand& demand, const std::vector<int>& cores);

private:
    std::size_t cores_of(const Demand& demand) const;
    std::int64_t bytes_of(const Demand& demand) const;

    std::size_t all_cores_;
    std::int64_t all_bytes_, free_bytes_;
    std::vector<int> free_;
};

// Returns `count` cores that this process may run on, by the kernel's numbers: first those that no other run on this machine has, which
// are this run's until it ends, then those of other runs. Throws InputError where it may run on fewer.
std::vector<int> cores_here(int count);

// Calls `work` with each number of a demand and its cores, on threads of its own, until all are done. The longest that fits goes first.
// No other one begins once `stop` says so. What `work` throws is thrown here, once all that had begun have ended.
void run_side_by_side(const std::vector<Demand>& demands, Room room,
                      const std::function<void(std::size_t, const std::vector<int>&)>& work,
                      const std::function<bool()>& stop);

}  // namespace hausbench
