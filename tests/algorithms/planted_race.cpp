// A solver with a data race: solve() increments a member without a lock. `make tsan` expects the thread sanitizer to
// report it, which proves that the sanitizer works. No other build includes this test.
#include "algorithms/session/session.h"

#include <iostream>
#include <thread>

using namespace hausbench;

namespace {

class Racing final : public Solver {
public:
    void prepare(const Scene&, const Prepared&) override {}
    Result solve(const Query&, State*, Trace&) const override {
        for (int i = 0; i < 1000; ++i) counted_ = counted_ + 1;
        return {};
    }

private:
    mutable std::uint64_t counted_ = 0;
};

}  // namespace

int main() {
    SolverEntry entry;
    entry.info.name = "racing";
    entry.info.source.points = entry.info.target.points = true;
    entry.make = [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Racing>(); };
    const PointSet point{Points::Zero(1, 3)};
    const Session session(entry, Options("racing", {}, {}), {point, point}, {});
    const auto ask = [&] {
        Query query;
        query.tolerance.value = 1;
        Trace trace;
        for (int i = 0; i < 100; ++i) (void)session.solve(query, trace);
    };
    std::thread first(ask), second(ask);
    first.join();
    second.join();
    std::cout << "asked from two threads\n";
}
