#include "timing.h"

#include <benchmark/benchmark.h>

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

}  // namespace

Timing time_once(const Session& session, const Query& query, std::int64_t iterations) {
    benchmark::ClearRegisteredBenchmarks();
    benchmark::RegisterBenchmark("solve",
                                 [&](benchmark::State& state) {
                                     for (auto _ : state) {
                                         Trace untraced;
                                         Result result = session.solve(query, untraced);
                                         benchmark::DoNotOptimize(result);
                                     }
                                 })
        ->Iterations(iterations)
        ->UseRealTime();
    Collector collector;
    benchmark::RunSpecifiedBenchmarks(&collector, "solve");
    if (collector.runs().size() != 1) throw std::logic_error("time_once: Google Benchmark did not report one run");
    const auto& run = collector.runs().front();
    const double n = double(run.iterations);
    return {run.real_accumulated_time / n, run.cpu_accumulated_time / n};
}

}  // namespace hausbench
