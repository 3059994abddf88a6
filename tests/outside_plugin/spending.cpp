// A solver that answers like vertex_only, and uses a known amount of memory and CPU time, so that
// tests can check what the harness measures.
#include <hausbench/plugin.h>

#include <time.h>

#include <thread>
#include <vector>

using namespace hausbench;

SolverEntry vertex_only_solver();  // vertex_only.cpp

namespace {

// Allocates memory, touches every page of it, and frees it.
void touch(std::int64_t megabytes) {
    const std::size_t size = std::size_t(megabytes) << 20;
    std::vector<char> memory(size);
    for (std::size_t i = 0; i < size; i += 4096) static_cast<volatile char&>(memory[i]) = 1;
}

// Keeps the calling thread busy for this many seconds of CPU time.
void burn(double seconds) {
    const auto now = [] {
        timespec t{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
    };
    for (const double end = now() + seconds; now() < end;) {
    }
}

class Spending final : public Solver {
public:
    explicit Spending(const Options& options)
        : prepare_megabytes_(options.integer("prepare_megabytes")),
          solve_megabytes_(options.integer("solve_megabytes")),
          at_(options.real("at")),
          threads_(options.integer("threads")),
          seconds_(options.real("seconds")),
          good_(vertex_only_solver().make(Options("vertex_only", {}, {}))) {}

    void prepare(const Scene& scene, const Prepared& prepared) override {
        touch(prepare_megabytes_);
        good_->prepare(scene, prepared);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        if (query.source_pose.translation.x() == at_) touch(solve_megabytes_);
        std::vector<std::thread> threads;
        for (std::int64_t i = 0; i < threads_; ++i) threads.emplace_back(burn, seconds_);
        for (std::thread& thread : threads) thread.join();
        Result result = good_->solve(query, nullptr, trace);
        result.reported["threads"] = std::to_string(threads_) + "\nof its own";
        return result;
    }

private:
    std::int64_t prepare_megabytes_, solve_megabytes_;
    double at_;
    std::int64_t threads_;
    double seconds_;
    std::unique_ptr<Solver> good_;
};

ParameterSpec parameter(const char* name, ParameterValue none, const char* what) {
    return {.name = name, .default_value = std::move(none), .unit = "", .paper_value = "", .description = what};
}

}  // namespace

SolverEntry spending_solver() {
    SolverInfo info = vertex_only_solver().info;
    info.name = info.title = "spending";
    info.original_coordinates = true;  // so that `at` is not rescaled
    info.parameters = {parameter("prepare_megabytes", std::int64_t(0), "touched while preparing"),
                       parameter("solve_megabytes", std::int64_t(0), "touched while solving the pose `at`"),
                       parameter("at", 0.0, "x of its translation"),
                       parameter("threads", std::int64_t(0), "started by each solve"),
                       parameter("seconds", 0.0, "CPU time that each of them burns")};
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Spending>(options); }};
}
