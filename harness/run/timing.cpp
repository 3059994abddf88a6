#include "harness/run/timing.h"

#include <benchmark/benchmark.h>

#include <sys/resource.h>
#include <time.h>

#include <optional>
#include <stdexcept>
#include <vector>

namespace hausbench {

namespace {

class Collector : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override { runs_.insert(runs_.end(), runs.begin(), runs.end()); }
    const std::vector<Run>& runs() const { return runs_; }

private:
    std::vector<Run> runs_;
};

double seconds_of(clockid_t clock) {
    timespec now{};
    ::clock_gettime(clock, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

rusage of_children() {
    rusage used{};
    ::getrusage(RUSAGE_CHILDREN, &used);
    return used;
}

double seconds_of(const rusage& used) {
    return double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

}  // namespace

// Reads the process clock last; spent() reads it first. Reading the other clocks takes microseconds, which would
// otherwise count as CPU time of a short solve. The intervals of the thread and wall clocks thus contain the interval
// of the process clock, so a process with one thread never seems to have spent CPU time in another thread.
Stopwatch::Stopwatch() : Stopwatch(of_children()) {}

Stopwatch::Stopwatch(const rusage& children)
    : children_(seconds_of(children)),
      faults_(children.ru_minflt),
      wall_(std::chrono::steady_clock::now()),
      thread_(seconds_of(CLOCK_THREAD_CPUTIME_ID)),
      process_(seconds_of(CLOCK_PROCESS_CPUTIME_ID)) {}

Spent Stopwatch::spent() const {
    const double process = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - process_;
    const double thread = seconds_of(CLOCK_THREAD_CPUTIME_ID) - thread_;
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    const rusage ended = of_children();
    const double children = seconds_of(ended) - children_;
    const bool others = process - thread > 0.01 * process;  // 1 %, because the clocks differ a little
    const bool elsewhere = ended.ru_minflt != faults_ && works_elsewhere(wall, process + children);
    return {wall, process + children, others || elsewhere || several_at_once(wall, process + children)};
}

Timing time_once(const Session& session, const Query& query, std::int64_t iterations) {
    benchmark::ClearRegisteredBenchmarks();
    std::optional<Stopwatch> watch;
    std::optional<Spent> spent;
    std::int64_t done = 0;
    benchmark::RegisterBenchmark("solve",
                                 [&](benchmark::State& state) {
                                     // The stopwatch starts and stops within the time that the benchmark measures.
                                     for (auto _ : state) {
                                         if (done == 0) watch.emplace();
                                         Trace untraced;
                                         Result result = session.solve(query, untraced);
                                         benchmark::DoNotOptimize(result);
                                         if (++done == iterations) spent = watch->spent();
                                     }
                                 })
        ->Iterations(iterations)
        ->UseRealTime();
    Collector collector;
    benchmark::RunSpecifiedBenchmarks(&collector, "solve");
    if (collector.runs().size() != 1) throw std::logic_error("time_once: Google Benchmark did not report one run");
    const auto& run = collector.runs().front();
    const double n = double(run.iterations);
    return {run.real_accumulated_time / n, spent.value().cpu_seconds / n};
}

}  // namespace hausbench
