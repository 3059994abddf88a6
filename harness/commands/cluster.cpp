#include "harness/commands/cluster.h"

#include "algorithms/error.h"
#include "datasets/hash.h"
#include "datasets/paths.h"
#include "harness/commands/text_table.h"
#include "harness/plan/split.h"
#include "harness/run/finished.h"
#include "process/child.h"
#include "process/whole_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr int usual_shards = 16;
constexpr double seconds_for_slurm = 120;  // time limit of each of its commands

// Returns the text of a file, or an empty string if it cannot be read.
std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

// Runs a Slurm command and returns its output. Throws InputError if it fails or takes longer than `seconds`. If `code`
// is given, it receives the exit code, and a nonzero one is not an error.
std::string ask(std::vector<std::string> words, double seconds = seconds_for_slurm, int* code = nullptr) {
    const std::string name = words.front();
    words.insert(words.begin(), "/usr/bin/env");
    Launch launch;
    launch.command = std::move(words);
    launch.kept = std::size_t(1) << 22;
    Child child(std::move(launch));
    const Child::End end = child.wait({.seconds = seconds});
    if (end == Child::End::time)
        throw InputError(fmt::format("{}: no answer within {} s: is slurmctld up?", name, seconds));
    const std::string how = child.how_it_ended();
    if (child.exit_code() == 127)
        throw InputError(
            fmt::format("{}: not found: install Slurm's commands (slurm-client), or run parts with --shard i/n and "
                        "join them with `hausbench merge`",
                        name));
    if (end == Child::End::interrupt) throw InputError(fmt::format("{}: interrupted", name));
    if (code && !child.signal())
        *code = child.exit_code();
    else if (!how.empty())
        throw InputError(fmt::format("{}: {}: {}", name, how, child.last_words()));
    return child.output();
}

// Returns the folder with the experiment's files for Slurm: the split into shards, scripts and logs.
fs::path cluster_folder(const fs::path& results, const Experiment& experiment) {
    return results / fmt::format("{}.{}.slurm", experiment.stem, experiment.profile);
}

// Returns one path for every spelling of a folder (relative or absolute, with or without a final slash), because job
// names contain a hash of the path.
fs::path one_spelling(const fs::path& folder) {
    const fs::path text = fs::weakly_canonical(fs::absolute(folder));
    return text.has_filename() ? text : text.parent_path();
}

// Replaces everything but letters, digits, _ and - with _. Slurm separates job names by commas, so names must not
// contain any.
std::string safe(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return !std::isalnum(c) && c != '_' && c != '-'; }, '_');
    return text;
}

// Returns sbatch's option for a log file. Doubles each % in the folder's name, because Slurm expands patterns such as
// %a.
std::string log_name(const fs::path& folder, const std::string& name) {
    std::string text;
    for (const char c : folder.string()) text += c == '%' ? std::string("%%") : std::string(1, c);
    return "--output=" + text + "/logs/" + name;
}

// Manages the shards of one experiment and profile: their files and their jobs in Slurm's queue.
class Cluster {
public:
    Cluster(const ExperimentArguments& arguments, const Plan& plan, bool any_build = false)
        : arguments_(arguments),
          plan_(plan),
          any_build_(any_build),
          results_(one_spelling(results_of(arguments))),
          folder_(cluster_folder(results_, plan.experiment)),
          name_(safe(fmt::format("hausbench-{}-{}", plan.experiment.stem,
                                 Sha256().add(results_.string()).add(plan.experiment.profile).hex().substr(0, 8)))) {}

    bool is_split() const { return fs::exists(split_file()); }

    // Distributes the plan's jobs over shards and writes this split to a file. Keeps the shards of an earlier split if
    // `shards` is 0 or their number.
    void divide(int shards) {
        const Shards earlier = is_split() ? read_split(split_file()) : Shards{0, {}};
        if (shards > 0 && earlier.of > 0 && shards != earlier.of && !queue().shards.empty())
            throw InputError(
                fmt::format("--shards {}: tasks of {} shards are in the queue: wait until they end, or "
                            "`scancel --name={}` first",
                            shards, earlier.of, name_));
        const int jobs = std::max(1, int(plan_.jobs.size()));
        const int of = shards > 0 ? shards : earlier.of > 0 ? earlier.of : std::min(jobs, usual_shards);
        fs::create_directories(folder_ / "logs");
        write_split(split_file(), split(plan_, Estimates(results_), of, earlier));
    }

    struct Shard {
        std::size_t cases = 0, open = 0;  // open: not finished
        std::string state;                // in Slurm's queue, such as PENDING; empty: not in the queue
    };

    std::vector<Shard> shards(const std::map<int, std::string>& states) const {
        const Shards split = read_split(split_file());
        const std::vector<int> of_jobs = split.of_jobs(plan_);
        std::vector<Shard> all(std::size_t(split.of));
        for (int number = 1; number <= split.of; ++number) {
            Shard& shard = all[std::size_t(number - 1)];
            const std::string name = plan_.experiment.stem + shard_suffix(plan_.experiment, {number, split.of}, true);
            const Finished finished(plan_, results_, name, {any_build_, true, true}, Journal::ReadOnly{});
            for (std::size_t i = 0; i < of_jobs.size(); ++i) {
                if (of_jobs[i] != number) continue;
                shard.cases += plan_.jobs[i].cases.size();
                shard.open += finished.open_cases(plan_.jobs[i]);
            }
            if (const auto at = states.find(number); at != states.end()) shard.state = at->second;
        }
        return all;
    }

    // Submits an array job with one task per shard in `numbers`. Returns its job number.
    std::string submit_array(const std::vector<int>& numbers, int of, const std::vector<std::string>& options) const {
        int threads = 1;
        for (const Case& spec : plan_.cases) threads = std::max(threads, spec.threads);
        const fs::path script = folder_ / "shard.sh";
        write_whole_file(script, fmt::format("#!/bin/sh\nexec {} --shard \"$SLURM_ARRAY_TASK_ID/{}\" --split {}\n",
                                             run_words(), of, shell_quoted(split_file().string())));
        std::vector<std::string> words{"sbatch",
                                       "--parsable",
                                       "--job-name=" + name_,
                                       fmt::format("--array={}", fmt::join(numbers, ",")),
                                       fmt::format("--cpus-per-task={}", threads),
                                       "--requeue",
                                       "--open-mode=append",
                                       log_name(folder_, "shard-%a.log")};
        words.insert(words.end(), options.begin(), options.end());
        words.push_back(script.string());
        return number_in(ask(std::move(words)));
    }

    // Submits the job that collects the results (`run --collect`). Slurm starts it when all other jobs of this name
    // have ended. With --wait, waits for it and returns its exit code, otherwise returns 0.
    int submit_collection(const ClusterArguments& cluster) const {
        const fs::path script = folder_ / "collect.sh";
        write_whole_file(script, fmt::format("#!/bin/sh\nexec {} --collect\n", run_words()));
        std::vector<std::string> words{"sbatch",
                                       "--parsable",
                                       "--job-name=" + name_,
                                       "--dependency=singleton",
                                       "--requeue",
                                       log_name(folder_, "collect.log")};
        words.insert(words.end(), cluster.sbatch.begin(), cluster.sbatch.end());
        if (cluster.wait) words.push_back("--wait");
        words.push_back(script.string());
        int code = 0;
        if (cluster.wait)
            ask(std::move(words), std::numeric_limits<double>::infinity(), &code);
        else
            ask(std::move(words));
        return code;
    }

    struct Queue {
        std::map<int, std::string> shards;  // number of the shard -> its state
        bool collection = false;            // a collection is in the queue, too
    };

    Queue queue() const {
        Queue all;
        std::istringstream lines(ask({"squeue", "--noheader", "--array", "--format=%j|%K|%T", "--name=" + name_}));
        for (std::string line; std::getline(lines, line);) {
            const std::size_t first = line.find('|'), second = line.find('|', first + 1);
            if (second == std::string::npos || line.substr(0, first) != name_) continue;
            if (const int number = std::atoi(line.substr(first + 1).c_str()))
                all.shards[number] = line.substr(second + 1);
            else
                all.collection = true;
        }
        return all;
    }

    // Returns Slurm's queue. If squeue fails, returns an empty queue and sets `trouble` to the reason.
    Queue queue_if_it_answers(std::string& trouble) const {
        try {
            return queue();
        } catch (const InputError& error) {
            trouble = error.what();
            return {};
        }
    }

    const fs::path& folder() const { return folder_; }

private:
    fs::path split_file() const { return folder_ / "split.json"; }

    std::string run_words() const {
        std::string words =
            fmt::format("{} run {} --profile {} --results {} --cluster --quiet", shell_quoted(program_path().string()),
                        shell_quoted(fs::absolute(arguments_.file).string()), shell_quoted(arguments_.profile),
                        shell_quoted(results_.string()));
        if (any_build_) words += " --any-build";
        for (const fs::path& plugin : plugins_given())
            words += " --plugin " + shell_quoted(fs::absolute(plugin).string());
        for (const std::string& solver : arguments_.choice.solvers) words += " --solver " + shell_quoted(solver);
        for (const std::string& scene : arguments_.choice.scenes) words += " --scene " + shell_quoted(scene);
        return words;
    }

    // Extracts the job number from the last line of sbatch's output, "12" or "12;cluster".
    static std::string number_in(const std::string& said) {
        const std::size_t last = said.find_last_not_of(" \n");
        const std::size_t begin = said.find_last_of('\n', last);
        std::string line = said.substr(begin == std::string::npos ? 0 : begin + 1, last - begin);
        line = line.substr(0, line.find(';'));
        if (line.empty() || line.find_first_not_of("0123456789") != std::string::npos)
            throw InputError(fmt::format("sbatch: printed no job number: {}", one_line(said)));
        return line;
    }

    const ExperimentArguments& arguments_;
    const Plan& plan_;
    bool any_build_;
    fs::path results_;
    fs::path folder_;
    std::string name_;
};

}  // namespace

std::string shard_suffix(const Experiment& experiment, const Shard& shard, bool of_cluster) {
    return fmt::format("{}.shard-{}-of-{}", of_cluster ? "." + experiment.profile : "", shard.number, shard.of);
}

std::vector<std::string> shard_names(const fs::path& results, const Experiment& experiment) {
    std::vector<std::string> names;
    const fs::path file = cluster_folder(results, experiment) / "split.json";
    const bool split = fs::exists(file);
    const std::string begin = experiment.stem + (split ? "." + experiment.profile : "") + ".shard-";
    const std::string end = split ? fmt::format("-of-{}", read_split(file).of) : "";
    std::error_code none;
    for (fs::directory_iterator entry(results, none), last; !none && entry != last; entry.increment(none)) {
        const std::string name = entry->path().stem().string();
        if (entry->path().extension() == ".journal" && name.starts_with(begin) && name.ends_with(end))
            names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::optional<int> submit(const ExperimentArguments& arguments, const Plan& plan, const ClusterArguments& cluster) {
    Cluster here(arguments, plan, cluster.any_build);
    here.divide(cluster.shards);
    const auto queue = here.queue();
    const auto shards = here.shards(queue.shards);
    std::vector<int> numbers;
    std::size_t open = 0;
    for (std::size_t i = 0; i < shards.size(); ++i) {
        if (!shards[i].state.empty() || shards[i].open == 0) continue;
        numbers.push_back(int(i) + 1);
        open += shards[i].open;
    }
    if (!queue.shards.empty()) print(fmt::format("{} shards are in the queue already\n", queue.shards.size()));
    if (numbers.empty() && queue.shards.empty() && !queue.collection) return std::nullopt;
    if (!numbers.empty()) {
        const std::string job = here.submit_array(numbers, int(shards.size()), cluster.sbatch);
        print(fmt::format("job {}: {} cases in {} of {} shards; logs in {}\n", job, open, numbers.size(), shards.size(),
                          (here.folder() / "logs").string()));
    }
    if (numbers.empty() && queue.collection && !cluster.wait) return 0;
    const int code = here.submit_collection(cluster);
    if (cluster.wait) print(text_of(here.folder() / "logs" / "collect.log"));
    return code;
}

std::string cluster_status(const ExperimentArguments& arguments, const Plan& plan) {
    const Cluster here(arguments, plan);
    TextTable table({{"shard"}, {"cases", true}, {"finished", true}, {"state"}});
    std::size_t cases = 0, open = 0;
    const auto add = [&](const std::string& name, std::size_t all, std::size_t left, const std::string& state) {
        table.add({{name, fmt::format("{}", all), fmt::format("{}", all - left), state}});
    };
    if (here.is_split()) {
        std::string trouble;
        const auto shards = here.shards(here.queue_if_it_answers(trouble).shards);
        if (!trouble.empty()) say({"the queue is not known: " + trouble});
        for (std::size_t i = 0; i < shards.size(); ++i) {
            const auto& shard = shards[i];
            cases += shard.cases;
            open += shard.open;
            add(fmt::format("{}/{}", i + 1, shards.size()), shard.cases, shard.open,
                !shard.state.empty() ? shard.state
                : shard.open == 0    ? "finished"
                : !trouble.empty()   ? ""
                                     : "not in the queue: submit again");
        }
    } else {
        const Finished finished(plan, results_of(arguments), plan.experiment.stem, {false, true, true},
                                Journal::ReadOnly{});
        for (const Job& job : plan.jobs) {
            cases += job.cases.size();
            open += finished.open_cases(job);
        }
    }
    add("all", cases, open, open == 0 ? "finished" : "");
    return table.text(paper_of_output());
}

}  // namespace hausbench
