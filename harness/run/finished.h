// The cases of a plan that the journal already answers, with their fields.
#pragma once

#include "harness/plan/plan.h"
#include "harness/run/journal.h"

#include <cstddef>
#include <filesystem>
#include <functional>

namespace hausbench {

// Which answers will do, of those that are not of this build on this machine, alone on it.
struct Accepted {
    bool any_build = false;     // of any build and machine
    bool any_machine = false;   // of this build, on any machine
    bool side_by_side = false;  // whose times compare with none
};

class Finished {
public:
    // Journal and fields stand in `folder`, in files that begin with `name`. Throws InputError as Journal does. `start_over`: what an
    // earlier run finished of these cases is forgotten.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, bool start_over,
             const Accepted& accepted);

    // What a run that may still go on has finished so far; nothing may be appended.
    Finished(const Plan& plan, const std::filesystem::path& folder, const std::string& name, const Accepted& accepted,
             Journal::ReadOnly);

    // Takes over the answers to these cases that another journal has, with its fields, where this one has none and they will do.
    // Throws InputError where it cannot be read.
    void take_over(const std::filesystem::path& folder, const std::string& name);

    // The answer of a row in a round; null where it has to be run (again).
    const Outcome* kept(std::size_t row, int round) const;
    void forget(std::size_t row);
    std::size_t forget_those(const std::function<bool(const Row&)>& chosen);  // returns how many
    void append(std::size_t row, int round, const Outcome& outcome);

    // Whether a round has to run the row: it is not there, or lacks its fields, and there is something to time.
    bool is_open(std::size_t row, int round) const;

    // Of the cases of a job, how many some round has to run.
    std::size_t open_cases(const Job& job) const;

    // Where the fields of a row belong; empty: it has none.
    std::filesystem::path fields_file(std::size_t row) const;
    bool lacks_fields(std::size_t row, const Outcome& outcome) const;

    // The row with what is known of it: its rounds together, or what it is read off from, and its fields.
    Row row(std::size_t number) const;

    const std::string& started() const { return journal_.started(); }

private:
    bool will_do(std::size_t row, const Outcome& outcome) const;
    bool traces_chain(std::size_t row) const;
    bool is_surface(const std::string& name) const;
    Fields fields_of(std::size_t row, Outcome& outcome) const;
    Outcome gather(std::size_t row) const;
    Outcome read_off(std::size_t row, const FromTrace& from) const;

    const Plan& plan_;
    Accepted accepted_;
    Journal journal_;
    std::filesystem::path fields_;  // folder
};

}  // namespace hausbench
