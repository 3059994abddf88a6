#include "harness/plan/split.h"

#include "algorithms/error.h"
#include "datasets/hash.h"
#include "process/whole_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <numeric>

namespace hausbench {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int split_schema = 1;

std::string key_of(const Plan& plan, const Job& job) {
    Sha256 hash;
    for (const std::size_t row : job.cases) hash.add(plan.cases[row].identity);
    return hash.hex().substr(0, 16);
}

// Distributes jobs with these durations over parts that already have `taken` seconds of work, and returns each job's
// part, from 0. Adds the jobs, longest first, to the part with the least total so far. If all parts are empty, the
// longest takes at most 4/3 of the least possible time (Graham 1969).
std::vector<int> dealt(const std::vector<double>& seconds, std::vector<double> taken) {
    std::vector<std::size_t> order(seconds.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return seconds[a] > seconds[b]; });
    std::vector<int> parts(seconds.size());
    for (const std::size_t i : order) {
        const auto least = std::min_element(taken.begin(), taken.end());
        parts[i] = int(least - taken.begin());
        *least += seconds[i];
    }
    return parts;
}

}  // namespace

std::vector<int> Shards::of_jobs(const Plan& plan) const {
    std::vector<int> all;
    for (const Job& job : plan.jobs) {
        const auto at = shards.find(key_of(plan, job));
        if (at == shards.end())
            throw InputError(
                fmt::format("{}: is in no shard: the experiment, a model or a program has changed since it "
                            "was split: submit it again",
                            job.label));
        all.push_back(at->second);
    }
    return all;
}

Shards split(const Plan& plan, const Estimates& estimates, int of, const Shards& earlier) {
    Shards now{of, earlier.of == of ? earlier.shards : std::map<std::string, int>()};
    const auto parts_wanted = std::size_t(of);
    std::vector<double> taken(parts_wanted), seconds;
    std::vector<std::string> keys;
    // Jobs that have the same cases, on scenes with different names, share their answers and go to the same shard.
    std::map<std::string, std::size_t> places;
    for (const Job& job : plan.jobs) {
        const std::string key = key_of(plan, job);
        const double takes = estimates.of(plan, job).seconds;
        if (const auto at = now.shards.find(key); at != now.shards.end()) {
            taken[std::size_t(at->second - 1)] += takes;
            continue;
        }
        const auto [at, fresh] = places.emplace(key, keys.size());
        if (fresh) {
            keys.push_back(key);
            seconds.push_back(takes);
        } else {
            seconds[at->second] += takes;
        }
    }
    const std::vector<int> parts = dealt(seconds, taken);
    for (std::size_t i = 0; i < keys.size(); ++i) now.shards[keys[i]] = parts[i] + 1;
    return now;
}

Shards read_split(const fs::path& file) {
    try {
        expect_no_device(file);
        std::ifstream in(file);
        const json told = json::parse(in);
        if (told.at("hausbench_split") != split_schema) throw std::runtime_error("it is of another version");
        Shards split{told.at("of").get<int>(), told.at("shards").get<std::map<std::string, int>>()};
        const bool good = split.of >= 1 &&
                          std::all_of(split.shards.begin(), split.shards.end(),
                                      [&](const auto& entry) { return entry.second >= 1 && entry.second <= split.of; });
        if (!good) throw std::runtime_error("a shard has a number that there is not");
        return split;
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: is not a split of an experiment ({}): remove it and submit again",
                                     file.string(), error.what()));
    }
}

void write_split(const fs::path& file, const Shards& split) {
    write_whole_file(
        file, json{{"hausbench_split", split_schema}, {"of", split.of}, {"shards", split.shards}}.dump(1) + "\n");
}

}  // namespace hausbench
