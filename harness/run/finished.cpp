#include "harness/run/finished.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "datasets/hash.h"
#include "harness/record/json.h"
#include "harness/result/field_file.h"
#include "harness/result/provenance.h"
#include "harness/run/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace hausbench {

namespace {

const std::filesystem::path& made_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!error && !std::filesystem::is_directory(folder, error) && !error)
        error = std::make_error_code(std::errc::not_a_directory);
    if (error)
        throw InputError(fmt::format("{}: cannot make this folder for results ({}): name another with --results",
                                     folder.string(), error.message()));
    return folder;
}

}  // namespace

Finished::Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
                   const Accepted& accepted)
    : plan_(plan),
      accepted_(accepted),
      journal_(made_folder(folder) / (name + ".journal"), start_over && plan.whole),
      fields_(folder / (name + ".fields")) {
    if (start_over) {
        std::set<std::string> requested;
        for (const Case& spec : plan.cases) requested.insert(spec.identity);
        journal_.forget(requested);
        for (std::size_t row = 0; row < plan.cases.size(); ++row) {
            if (const auto file = fields_file(row); !file.empty()) std::filesystem::remove(file);
        }
    }
    if (plan.experiment.fields) made_folder(fields_);
}

void Finished::forget(std::size_t row) { journal_.forget({plan_.cases[row].identity}); }

std::size_t Finished::forget_those(const std::function<bool(const Row&)>& chosen) {
    std::size_t count = 0;
    for (std::size_t number = 0; number < plan_.cases.size(); ++number) {
        const bool finished = !plan_.decided.contains(number) && !plan_.traced.contains(number) && kept(number, 0);
        if (!finished || !chosen(row(number))) continue;
        forget(number);
        ++count;
    }
    return count;
}

void Finished::append(std::size_t row, int round, const Outcome& outcome) {
    const Outcome* earlier = kept(row, round);
    // The first case of a search may also belong to another scene, in which other rows are read off its trace. So an
    // outcome without a trace must not replace one that has a trace.
    const bool has_less =
        earlier && earlier->cutoff_used == outcome.cutoff_used && !earlier->trace.empty() && outcome.trace.empty();
    if (!has_less) journal_.append({plan_.cases[row].identity, round}, outcome);
}

bool Finished::is_open(std::size_t row, int round) const {
    if (const Outcome* outcome = kept(row, round)) return round == 0 && lacks_fields(row, *outcome);
    if (round == 0) return true;
    const Outcome* first = kept(row, 0);
    return first && is_timed(first->status);  // otherwise there is nothing to time
}

Row Finished::row(std::size_t number) const {
    const auto from = plan_.traced.find(number);
    Row row{plan_.cases[number], from == plan_.traced.end() ? gather(number) : read_off(number, from->second), {}};
    row.fields = fields_of(number, row.outcome);
    return row;
}

Finished::Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name,
                   const Accepted& accepted, Journal::ReadOnly read_only)
    : plan_(plan),
      accepted_(accepted),
      journal_(folder / (name + ".journal"), read_only),
      fields_(folder / (name + ".fields")) {}

std::size_t Finished::open_cases(const Job& job) const {
    return std::size_t(std::count_if(job.cases.begin(), job.cases.end(), [&](std::size_t row) {
        for (int round = 0; round < plan_.experiment.rounds; ++round) {
            if (is_open(row, round)) return true;
        }
        return false;
    }));
}

void Finished::take_over(const std::filesystem::path& folder, const std::string& name) {
    std::map<std::string, std::size_t> rows;
    for (std::size_t row = 0; row < plan_.cases.size(); ++row) rows.emplace(plan_.cases[row].identity, row);
    const Journal other(folder / (name + ".journal"), Journal::ReadOnly{});
    for (const auto& [key, outcome] : other.outcomes()) {
        const auto at = rows.find(key.first);
        if (at == rows.end()) continue;
        if (kept(at->second, key.second) || !will_do(at->second, outcome)) continue;
        const auto entry = journal_.outcomes().find(key);
        if (entry == journal_.outcomes().end() || to_json(entry->second) != to_json(outcome))
            journal_.append(key, outcome);
        const auto mine = fields_file(at->second);
        const auto theirs = folder / (name + ".fields") / mine.filename();
        if (!mine.empty() && !outcome.fields_sha256.empty() && std::filesystem::exists(theirs))
            std::filesystem::copy_file(theirs, mine, std::filesystem::copy_options::overwrite_existing);
    }
}

bool Finished::will_do(std::size_t row, const Outcome& outcome) const {
    if (accepted_.any_build) return true;
    if (outcome.build != build_of(plan_.cases[row].solver)) return false;
    if (outcome.machine != this_machine().id && !accepted_.any_machine) return false;
    return accepted_.side_by_side || !outcome.side_by_side;  // other work may have caused a timeout or crash
}

const Outcome* Finished::kept(std::size_t row, int round) const {
    const auto at = journal_.outcomes().find({plan_.cases[row].identity, round});
    if (at == journal_.outcomes().end()) return nullptr;
    const Outcome& outcome = at->second;
    if (!will_do(row, outcome)) return nullptr;
    // Repeats, stages and traces are not part of a case's identity, so the experiment may now request more than an
    // earlier run delivered.
    if (is_timed(outcome.status) && outcome.repeats_asked < plan_.experiment.repeats) return nullptr;
    if (round == 0 && is_timed(outcome.status) && plan_.experiment.stages && !outcome.stages_asked) return nullptr;
    // A later round of a search is stale if round 0 has since been run again with another cutoff.
    const Outcome* first = round > 0 ? kept(row, 0) : nullptr;
    if (first && first->cutoff_used != outcome.cutoff_used) return nullptr;
    const bool traced = !plan_.marks(row).empty() || traces_chain(row);
    if (round == 0 && outcome.status == RowStatus::ok && outcome.trace.empty() && traced) return nullptr;
    return &outcome;
}

bool Finished::traces_chain(std::size_t row) const {
    const Case& spec = plan_.cases[row];
    return spec.warm && plan_.experiment.trace && find_solver(spec.solver).info.can(Ability::traces);
}

std::filesystem::path Finished::fields_file(std::size_t row) const {
    const Case& spec = plan_.cases[row];
    if (!plan_.experiment.fields || is_surface(spec.source) || is_surface(spec.target)) return {};
    return fields_ / (spec.identity + ".bin");
}

bool Finished::is_surface(const std::string& name) const {
    return std::any_of(plan_.models.begin(), plan_.models.end(), [&](const ModelRow& model) {
        return model.info->name == name && model.resolved.kind == ShapeKind::surface;
    });
}

// Returns whether fields are required but their file is missing or does not match the hash in the outcome.
bool Finished::lacks_fields(std::size_t row, const Outcome& outcome) const {
    const auto file = fields_file(row);
    if (file.empty() || !is_timed(outcome.status)) return false;
    return !std::filesystem::is_regular_file(file) || sha256_of_file(file) != outcome.fields_sha256;
}

// Reads the fields of a row. Returns no fields, and clears their hash in `outcome`, if none were requested, if they
// cannot be read, or if the row is read off the run of another row.
Fields Finished::fields_of(std::size_t row, Outcome& outcome) const {
    const auto file = fields_file(row);
    if (!file.empty() && !outcome.from_trace && !outcome.fields_sha256.empty()) {
        if (auto fields = read_fields(file, outcome.fields_sha256)) return std::move(*fields);
    }
    outcome.fields_sha256.clear();
    return {};
}

// Returns the outcome of a row: from Plan::decided if it has one, otherwise combined from the accepted answers of all
// rounds. Without an answer in round 0, the outcome is `skipped` with the reason `not_run_yet`.
Outcome Finished::gather(std::size_t row) const {
    if (const auto at = plan_.decided.find(row); at != plan_.decided.end()) {
        Outcome outcome = at->second;
        outcome.build = build_of(plan_.cases[row].solver);
        outcome.machine = this_machine().id;
        return outcome;
    }
    if (!kept(row, 0)) {
        Outcome outcome;
        outcome.reason = not_run_yet;
        return outcome;
    }
    std::map<int, const Outcome*> rounds;
    for (int round = 0; round < plan_.experiment.rounds; ++round) {
        if (const Outcome* outcome = kept(row, round)) rounds[round] = outcome;
    }
    return gather_rounds(rounds);
}

Outcome Finished::read_off(std::size_t row, const FromTrace& from) const {
    const Outcome fine = gather(from.of);
    const double gap = plan_.cases[row].resolved_tolerance().gap(fine.bounds.lower);
    return from.ignores_tolerance ? read_off_answer(fine, gap) : read_off_trace(fine, gap);
}

}  // namespace hausbench
